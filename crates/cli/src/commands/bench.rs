//! `isostudy bench`: every configuration timed; and runs compared, swept and imported.

mod baseline;
mod compare;
mod import;
mod sweep;
mod worker;

use super::study_run::{Run, with_pipeline};
use crate::outcome::Outcome;
use crate::pipeline::PlanLength;
use crate::terminal::say;
use anyhow::{Context, Result};
use clap::{Args, Subcommand};

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
}

#[derive(Debug, Subcommand)]
enum Verb {
    /// Say of every configuration whether it is faster in B than in A; exit 1 if one is slower beyond both limits, 3 if that could not have been told
    Compare(compare::Arguments),
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
        Some(Verb::Sweep(arguments)) => sweep::run(arguments),
        Some(Verb::Import(arguments)) => import::run(arguments),
        Some(Verb::Worker(arguments)) => worker::run(arguments),
        None => time(arguments),
    }
}

fn time(arguments: &Arguments) -> Result<Outcome> {
    let run = arguments.run.as_ref().context("a study file is needed")?;
    let length = if arguments.short { PlanLength::Short } else { PlanLength::Full };
    with_pipeline(run, |pipeline, _| {
        let timings = pipeline.timings(length)?;
        for table in pipeline.timing_statements(&timings)? {
            say(&table)?;
        }
        Ok(())
    })
}
