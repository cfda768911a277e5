//! `isostudy bench compare`: two finished runs side by side.

use super::baseline;
use crate::input;
use crate::outcome::Outcome;
use crate::run_file;
use crate::terminal::{counted, say};
use anyhow::{Context, Result, bail};
use clap::{Args, ValueEnum};
use isostudy_design::Stage;
use isostudy_design::record::BenchRun;
use isostudy_timing::{Comparison, Gate, GateRecord, GateResult, GateStatus, Limits};
use std::path::{Path, PathBuf};

/// Where a results folder keeps its runs; the full one stands for the others.
const RUNS: [&str; 4] =
    ["bench/full/run.json", "bench/short/run.json", "bench/selected/run.json", "run.json"];

#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// What B is compared with: results folder, run.json, or the name of a baseline in B's folder
    a: PathBuf,
    /// Results folder, or a run.json in it
    b: PathBuf,
    /// A slower configuration is a regression beyond this share of its time in A ...
    ///
    /// What is within the noise is never told, however small the share: the column "Smallest detectable" says how large that is.
    #[arg(long, default_value = "0.05", value_name = "SHARE", value_parser = share)]
    relative: f64,
    /// ... and beyond this many seconds
    #[arg(long, default_value_t = 0.0001, value_name = "SECONDS", value_parser = not_negative)]
    absolute: f64,
    /// Exit 3 if a total that grew by this share would not have been told: 0.10, or 10%
    #[arg(long, value_name = "SHARE", value_parser = share)]
    must_tell: Option<f64>,
    /// Compare runs of machines that differ, in their settings too; every heading and verdict then says so
    #[arg(long)]
    across_machines: bool,
    /// Compare runs that were measured beside other work, which is otherwise refused
    #[arg(long)]
    beside_other_work: bool,
    /// Print every row as tables, in place of ten lines
    #[arg(long)]
    all: bool,
    /// Print every row in this format
    #[arg(long)]
    format: Option<Format>,
}

/// How tables are printed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Format {
    Markdown,
    Csv,
    Latex,
    Json,
}

/// A number that is finite and not negative.
fn not_negative(text: &str) -> Result<f64, String> {
    let number: f64 = text.parse().map_err(|_| "is not a number".to_owned())?;
    if number.is_finite() && number >= 0.0 {
        Ok(number)
    } else {
        Err("must be finite and not negative".into())
    }
}

/// A share, as 0.05 or as 5%.
pub(super) fn share(text: &str) -> Result<f64, String> {
    match text.strip_suffix('%') {
        Some(percent) => Ok(not_negative(percent.trim_end())? / 100.0),
        None => not_negative(text),
    }
}

/// Prints the comparison; a regression is a check that failed.
///
/// # Errors
/// If the runs cannot be read or compared.
pub(crate) fn run(arguments: &Arguments) -> Result<Outcome> {
    let at_a = baseline::named(&arguments.a, &arguments.b).map_or_else(|| run_at(&arguments.a), Ok)?;
    let both = [at_a, run_at(&arguments.b)?];
    both.iter().try_for_each(|path| input::open(path).map(drop))?;
    let [a, b] = both.map(|path| run_file::read(&path));
    let (a, b) = (a?, b?);
    let comparison = compared(&a, &b, arguments)?;
    let limits = Limits { relative: arguments.relative, absolute_s: arguments.absolute };
    let gate = Gate { limits, must_tell: arguments.must_tell };
    let found = gate.judge(&a, &comparison);
    let outcome = match found.status() {
        GateStatus::Passed => Outcome::Done,
        GateStatus::Failed => Outcome::CheckFailed,
        GateStatus::Blind => Outcome::Blind,
    };
    let format = arguments.format.or(arguments.all.then_some(Format::Markdown));
    match format {
        None => {
            for line in isostudy_timing::brief([&a, &b], &comparison, &gate, &found) {
                say(&line)?;
            }
            say("--all prints every row.")?;
            return Ok(outcome);
        }
        Some(Format::Json) => {
            let record = GateRecord::new([&a, &b], &comparison, gate, &found, outcome.status());
            say(&serde_json::to_string_pretty(&record)?)?;
        }
        Some(format) => {
            for table in isostudy_timing::comparison_tables(&a, &b, &comparison) {
                say(&match format {
                    Format::Csv => table.to_csv(),
                    Format::Latex => table.to_latex(),
                    _ => table.to_markdown(),
                })?;
            }
        }
    }
    tell_findings(&comparison, &gate, &found);
    Ok(outcome)
}

/// The comparison of runs that can be compared.
///
/// # Errors
/// What keeps them from being compared.
fn compared(a: &BenchRun, b: &BenchRun, arguments: &Arguments) -> Result<Comparison> {
    let across = isostudy_timing::machine_differences(a, b);
    if !across.is_empty() && !arguments.across_machines {
        let list = across.join("\n  ");
        bail!(
            "A and B were not measured alike:\n  {list}\n--across-machines compares them nevertheless, and says so"
        );
    }
    for (name, run) in [("A", a), ("B", b)] {
        if let Some(reason) = isostudy_timing::beside_other_work(run).filter(|_| !arguments.beside_other_work)
        {
            bail!(
                "{name} was {reason}. Its times are no evidence of a program: close other programs and measure again; \
                 --beside-other-work compares it nevertheless"
            );
        }
    }
    let comparison = isostudy_timing::compare(a, b, across);
    if comparison.rows.is_empty() && !comparison.changed.is_empty() {
        bail!(
            "A (study {}) and B (study {}) were asked for different extractions: other fields, spacings, isovalues or recipes; \
             their times say nothing of each other",
            a.study,
            b.study
        );
    }
    if comparison.rows.is_empty() {
        bail!("A and B have no configuration in common: there is nothing to compare");
    }
    Ok(comparison)
}

/// What was found, on standard error, where tables are on standard output.
fn tell_findings(comparison: &Comparison, gate: &Gate, found: &GateResult<'_>) {
    if comparison.itself {
        tell!("A and B are the same run: this says nothing of any program");
    }
    for row in &found.regressions {
        let (id, a, b) = (&row.id, 1e3 * row.a_s, 1e3 * row.b_s);
        let label = if comparison.across.is_empty() { "" } else { " (not measured alike)" };
        let stage = row.stage.label();
        tell!("regression{label}: {id}, {stage}: {b:.3} ms, {a:.3} ms before");
    }
    // What a total's noise hides, a stage shows.
    for stage in Stage::ALL {
        let slower = found.regressions.iter().filter(|row| row.stage == stage).count();
        if slower > 0 {
            let of = comparison.of_stage(stage).count();
            tell!("{}: slower on {slower} of {}", stage.label(), counted(of as u64, "configuration"));
        }
    }
    let percent = |ratio: f64| format!("{:.0}", 100.0 * (ratio - 1.0));
    if let Some((least, most)) = comparison.smallest_detectable(Stage::Total) {
        tell!(
            "growth of totals below {} to {} %, by configuration, would not be found here",
            percent(least),
            percent(most)
        );
    }
    for id in &found.missing {
        tell!("missing: {id} is in A and not in B");
    }
    for row in &found.blind {
        let asked = 100.0 * gate.must_tell.unwrap_or_default();
        let reason = match row.smallest_detectable {
            Some(ratio) => format!("less than {} % is not told", percent(ratio)),
            None => row.judgement.reason.into(),
        };
        tell!("blind: {}: growth by {asked} % must be told, and {reason}", row.id);
    }
}

/// The file of a run, or that in the results folder that has one.
pub(super) fn run_at(path: &Path) -> Result<PathBuf> {
    if !path.is_dir() {
        return Ok(path.to_owned());
    }
    let found = RUNS.iter().map(|run| path.join(run)).find(|run| run.is_file());
    found.with_context(|| {
        format!("{} has none of {}; `isostudy bench` makes them", path.display(), RUNS.join(", "))
    })
}
