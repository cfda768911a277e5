//! `isostudy bench`: every configuration timed; and runs compared, swept and imported.

mod ab;
mod baseline;
mod compare;
mod count;
mod export;
mod history;
mod import;
mod sweep;
mod worker;

use super::study_run::{Run, Selection, with_selection};
use crate::outcome::Outcome;
use crate::pipeline::{Choice, PlanLength};
use crate::terminal::say;
use anyhow::{Context, Result};
use clap::{Args, Subcommand};
use isostudy_design::ConfigurationId;
use isostudy_design::record::BenchRun;

#[derive(Debug, Args)]
#[command(args_conflicts_with_subcommands = true, subcommand_negates_reqs = true)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    verb: Option<Verb>,
    #[command(flatten)]
    run: Option<Run>,
    /// Take the short plan of `isostudy study` instead: no A/A block, no memory; a full run that is up to date stands for it
    #[arg(long)]
    short: bool,
    /// Measure this configuration alone, such as ss_bi; may be given several times. The run is kept in bench/selected
    #[arg(long, value_name = "ID", conflicts_with = "short")]
    only: Vec<String>,
    /// Measure so many rounds, in place of the study's; with --until, so many at most
    #[arg(long, value_name = "N", conflicts_with = "short", value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    rounds: Option<u32>,
    /// Measure batch after batch of the study's rounds until growth of every total by this share would be told, such as 5%;
    /// exit 3 if so many rounds as --rounds says, or ten batches, are not enough
    #[arg(long, value_name = "SHARE", conflicts_with = "short", value_parser = compare::share)]
    until: Option<f64>,
    /// Exit 1 if others had more than a quarter of the CPU time in half of the run: such a run is compared with none
    #[arg(long)]
    require_quiet: bool,
    /// Keep the run under this name in bench/baselines, and add it to the history
    #[arg(long, value_name = "NAME", value_parser = baseline::name)]
    save_baseline: Option<String>,
}

#[derive(Debug, Subcommand)]
enum Verb {
    /// Say of every configuration whether it is faster in B than in A; exit 1 if one is slower beyond both limits, 3 if that could not have been told
    Compare(compare::Arguments),
    /// Time two builds of isostudy in turn, in the same rounds: is NEW slower than OLD? Exit 1 if it is
    Ab(ab::Arguments),
    /// Count the instructions of two builds by valgrind, where the CPU's counters are not allowed: does NEW take more than OLD? Exit 1 if it does
    Count(count::Arguments),
    /// Show the runs that were kept with --save-baseline, one after the other; table and figure
    History(history::Arguments),
    /// Write a run as criterion or hyperfine writes its own
    Export(export::Arguments),
    /// Measure the study's [benchmark.sweep]: every resolution on every number of threads; tables and figures
    Sweep(sweep::Arguments),
    /// Make a run of a published table of means, so that it can stand beside a run of ours
    Import(import::Arguments),
    /// Measure what is asked on standard input; `isostudy bench` starts this
    #[command(hide = true)]
    Worker(worker::Arguments),
}

/// Times a study, or does what the verb says.
///
/// # Errors
/// If the study is wrong or a measurement fails; as the verb.
pub(crate) fn run(arguments: &Arguments) -> Result<Outcome> {
    match &arguments.verb {
        Some(Verb::Compare(arguments)) => compare::run(arguments),
        Some(Verb::Ab(arguments)) => ab::run(arguments),
        Some(Verb::Count(arguments)) => count::run(arguments),
        Some(Verb::History(arguments)) => history::run(arguments),
        Some(Verb::Export(arguments)) => export::run(arguments),
        Some(Verb::Sweep(arguments)) => sweep::run(arguments),
        Some(Verb::Import(arguments)) => import::run(arguments),
        Some(Verb::Worker(arguments)) => worker::run(arguments),
        None => time(arguments),
    }
}

fn time(arguments: &Arguments) -> Result<Outcome> {
    let run = arguments.run.as_ref().context("a study file is needed")?;
    let selection = Selection { run: run.clone(), only: arguments.only.clone() };
    let mut as_asked = Outcome::Done;
    let done = with_selection(&selection, |pipeline, only, out| {
        let length = arguments.length(only);
        let timings = pipeline.timings(&length)?;
        for table in pipeline.timing_statements(&timings)? {
            say(&table)?;
        }
        let run = pipeline.bench_run(&timings)?;
        as_asked = judge(arguments, &run);
        if let Some(name) = &arguments.save_baseline {
            say(&baseline::save(out, name, &run)?.display().to_string())?;
        }
        Ok(())
    })?;
    Ok(if done == Outcome::Done { as_asked } else { done })
}

impl Arguments {
    fn length(&self, only: &[ConfigurationId]) -> PlanLength {
        if self.short {
            return PlanLength::Short;
        }
        let choice = Choice { only: only.to_vec(), rounds: self.rounds, until: self.until };
        if choice == Choice::default() { PlanLength::Full } else { PlanLength::Selected(choice) }
    }
}

/// Whether the run is as quiet, and tells as much, as was asked.
fn judge(arguments: &Arguments, run: &BenchRun) -> Outcome {
    if let Some(reason) = isostudy_timing::beside_other_work(run) {
        tell!("timings: {reason}");
        if arguments.require_quiet {
            return Outcome::CheckFailed;
        }
    }
    let percent = |ratio: f64| format!("{:.1} %", 100.0 * (ratio - 1.0));
    let told = isostudy_timing::would_tell(run);
    if let Some((least, most)) = told {
        tell!(
            "timings: between two runs like this one, totals must grow by {} to {} to be found, by configuration",
            percent(least),
            percent(most)
        );
    }
    let enough = |share: f64| told.is_some_and(|(_, most)| most <= 1.0 + share);
    if arguments.until.is_some_and(|share| !enough(share)) {
        tell!("timings: {} rounds are not enough for what --until asks", run.iterations);
        return Outcome::Blind;
    }
    Outcome::Done
}
