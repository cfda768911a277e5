//! Two finished runs side by side, and published tables made into runs.

use crate::args::{Compare, Format, Import};
use crate::store::write_whole;
use crate::{Outcome, counted, input, run_file, say};
use anyhow::{Context, Result, bail};
use design::machine::CpuProfile;
use design::published::read_benchmark;
use design::record::BenchRun;
use design::{ConfigurationId, Stage};
use std::path::{Path, PathBuf};
use timing::{Comparison, Limits};

/// Where a results folder keeps its runs; the full one stands for the short one.
const RUNS: [&str; 3] = ["bench/full/run.json", "bench/short/run.json", "run.json"];

/// In the program, so that a table can be imported from any folder.
const PAPERS_MACHINE: &str = include_str!("../../../configs/cpu/i7-11700.toml");

/// Prints the comparison; a regression is a check that failed.
pub(crate) fn compare(arguments: &Compare) -> Result<Outcome> {
    let [a, b] = [&arguments.a, &arguments.b].map(|path| run_file::read(&run_at(path)?));
    let (a, b) = (a?, b?);
    if let (Some(of_a), Some(of_b)) = (&a.workload, &b.workload)
        && of_a != of_b
    {
        bail!(
            "A (study {}) and B (study {}) were asked for different extractions: other fields, spacings, rules or cells per axis; \
             their times say nothing of each other",
            a.study,
            b.study
        );
    }
    let across = timing::machine_differences(&a, &b);
    if !across.is_empty() && !arguments.across_machines {
        let list = across.join("\n  ");
        bail!(
            "A and B were not measured alike:\n  {list}\n--across-machines compares them nevertheless, and says so"
        );
    }
    let comparison = timing::compare(&a, &b, across);
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
    if let Some((least, most)) = comparison.tellable(Stage::Total) {
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
    Ok(if regressions.is_empty() && missing.is_empty() { Outcome::Sound } else { Outcome::CheckFailed })
}

/// What B should have been measured for and was not; an imported table may have fewer rows.
fn missing_in_b<'a>(a: &BenchRun, comparison: &'a Comparison) -> Vec<&'a ConfigurationId> {
    let of_a = |id: &&ConfigurationId| a.samples.iter().any(|sample| sample.id == **id);
    comparison.unmatched.iter().filter(of_a).collect()
}

/// Writes the run that a table of means makes.
pub(crate) fn import(arguments: &Import) -> Result<()> {
    input::regular(&arguments.table)?;
    let rows = read_benchmark(&arguments.table)?;
    let machine = match &arguments.machine {
        Some(path) => {
            input::regular(path)?;
            CpuProfile::load(path)?
        }
        None => CpuProfile::parse(PAPERS_MACHINE, Path::new("configs/cpu/i7-11700.toml"))?,
    };
    let run = bench::import(&rows, &arguments.source, arguments.iterations, arguments.threads, &machine)
        .with_context(|| arguments.table.display().to_string())?;
    let mut json = serde_json::to_vec_pretty(&run)?;
    json.push(b'\n');
    write_whole(&arguments.out, &json)?;
    say(&arguments.out.display().to_string())
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
