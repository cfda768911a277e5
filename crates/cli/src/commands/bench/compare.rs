//! `isostudy bench compare`: two finished runs side by side.

use crate::outcome::Outcome;
use crate::run_file;
use crate::terminal::{counted, say};
use anyhow::{Context, Result, bail};
use clap::{Args, ValueEnum};
use design::record::BenchRun;
use design::{ConfigurationId, Stage};
use std::path::{Path, PathBuf};
use timing::{Comparison, Limits};

/// Where a results folder keeps its runs; the full one stands for the short one.
const RUNS: [&str; 3] = ["bench/full/run.json", "bench/short/run.json", "run.json"];

#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// Results folder, or a run.json in it: what B is compared with
    a: PathBuf,
    /// Results folder, or a run.json in it
    b: PathBuf,
    /// A slower configuration is a regression beyond this share of its time in A ...
    ///
    /// What is within the noise is never told, however small the share: the column "Smallest detectable" says how large that is.
    #[arg(long, default_value_t = 0.05, value_name = "SHARE", value_parser = not_negative)]
    relative: f64,
    /// ... and beyond this many seconds
    #[arg(long, default_value_t = 0.0001, value_name = "SECONDS", value_parser = not_negative)]
    absolute: f64,
    /// Compare runs of machines that differ, in their settings too; every heading and verdict then says so
    #[arg(long)]
    across_machines: bool,
    /// What to print
    #[arg(long, default_value = "markdown")]
    format: Format,
}

/// How a table is printed.
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

/// Prints the comparison; a regression is a check that failed.
///
/// # Errors
/// If the runs cannot be read or compared.
pub(crate) fn run(arguments: &Arguments) -> Result<Outcome> {
    let [a, b] = [&arguments.a, &arguments.b].map(|path| run_file::read(&run_at(path)?));
    let (a, b) = (a?, b?);
    let across = timing::machine_differences(&a, &b);
    if !across.is_empty() && !arguments.across_machines {
        let list = across.join("\n  ");
        bail!(
            "A and B were not measured alike:\n  {list}\n--across-machines compares them nevertheless, and says so"
        );
    }
    let comparison = timing::compare(&a, &b, across);
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
    let tables = timing::comparison_tables(&a, &b, &comparison);
    match arguments.format {
        Format::Json => say(&serde_json::to_string_pretty(&comparison)?)?,
        format => {
            for table in &tables {
                say(&match format {
                    Format::Csv => table.to_csv(),
                    Format::Latex => table.to_latex(),
                    _ => table.to_markdown(),
                })?;
            }
        }
    }
    let limits = Limits { relative: arguments.relative, absolute_s: arguments.absolute };
    let regressions = comparison.regressions(&limits);
    for row in &regressions {
        let (id, a, b) = (&row.id, 1e3 * row.a_s, 1e3 * row.b_s);
        let label = if comparison.across.is_empty() { "" } else { " (not measured alike)" };
        let stage = row.stage.label();
        tell!("regression{label}: {id}, {stage}: {b:.3} ms, {a:.3} ms before");
    }
    // What a total's noise hides, a stage shows.
    for stage in Stage::ALL {
        let slower = regressions.iter().filter(|row| row.stage == stage).count();
        if slower > 0 {
            let of = comparison.of_stage(stage).count();
            tell!("{}: slower on {slower} of {}", stage.label(), counted(of as u64, "configuration"));
        }
    }
    if let Some((least, most)) = comparison.smallest_detectable(Stage::Total) {
        let percent = |ratio: f64| format!("{:.0}", 100.0 * (ratio - 1.0));
        tell!(
            "totals that grew by less than {} to {} %, by configuration, are not told from noise here",
            percent(least),
            percent(most)
        );
    }
    // A build that drops a configuration must not pass for one that is as fast.
    let missing = missing_in_b(&a, &comparison);
    for id in &missing {
        tell!("missing: {id} is in A and not in B");
    }
    Ok(Outcome::of_check(regressions.is_empty() && missing.is_empty()))
}

/// What B should have been measured for and was not; an imported table may have fewer rows.
fn missing_in_b<'a>(a: &BenchRun, comparison: &'a Comparison) -> Vec<&'a ConfigurationId> {
    let of_a = |id: &&ConfigurationId| a.samples.iter().any(|sample| sample.id == **id);
    comparison.unmatched.iter().filter(of_a).collect()
}

/// The file of a run, or that in the results folder that has one.
fn run_at(path: &Path) -> Result<PathBuf> {
    if !path.is_dir() {
        return Ok(path.to_owned());
    }
    let found = RUNS.iter().map(|run| path.join(run)).find(|run| run.is_file());
    found.with_context(|| {
        format!("{} has none of {}; `isostudy bench` makes them", path.display(), RUNS.join(", "))
    })
}
