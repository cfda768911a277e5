//! `isostudy analyse --self-test`: the analysis proved on studies with a known truth.

use crate::commands::parts::{self, Simulation};
use crate::outcome::Outcome;
use crate::store;
use crate::terminal::say;
use anyhow::{Context, Result, ensure};
use clap::Args;
use isostudy_inference::self_test::{Outcomes, blank, simulated};
use isostudy_inference::series::Part;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

const SIMULATION: Simulation<'static> = Simulation { command: "analyse --self-test", study: None };

#[derive(Debug, Args)]
pub(crate) struct SelfTest {
    /// Read no answers: simulate studies with a known truth, and show that each probe finds its own defect and no other, that
    /// tests reject and intervals cover as they should
    #[arg(long, conflicts_with_all = ["input", "responses"])]
    pub(super) self_test: bool,
    /// Studies to simulate for each line
    #[arg(long, requires = "self_test", default_value_t = 10_000, value_name = "N", value_parser = clap::value_parser!(u64).range(parts::STUDIES))]
    studies: u64,
    /// Seed of the simulated studies; the same seed gives the same tables on any number of threads
    #[arg(long, requires = "self_test", default_value_t = 1, value_name = "SEED")]
    seed: u64,
    /// Threads to simulate with; 0 takes every core
    #[arg(long, requires = "self_test", default_value_t = 0, value_name = "N", value_parser = clap::value_parser!(u32).range(..=1024))]
    threads: u32,
    /// Simulate one part of all studies, such as 3/100 for the third of 100 parts, and write what it counted to the file --out
    #[arg(long, requires_all = ["self_test", "out"], value_name = "K/N", value_parser = parts::part)]
    part: Option<Part>,
    /// Simulate nothing, and read the files of all parts in any order: what is written is what one run of all studies writes
    #[arg(
        long,
        requires = "self_test",
        value_name = "FILE",
        num_args = 1..,
        conflicts_with_all = ["part", "studies", "seed", "threads"]
    )]
    merge: Vec<PathBuf>,
}

/// All that the simulated studies depend on.
#[derive(Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Simulated {
    studies: u64,
    seed: u64,
}

impl Simulated {
    fn check(&self) -> Result<()> {
        let (least, most) = parts::STUDIES.into_inner();
        ensure!(
            parts::STUDIES.contains(&self.studies),
            "studies = {}: allowed: {least} to {most}",
            self.studies
        );
        Ok(())
    }
}

/// Simulates studies, or a part of them, or reads all parts; prints how probes, tests and intervals did. One that did not as it should
/// fails it.
///
/// # Errors
/// If a part cannot be read or is none of this simulation, or a file cannot be written.
pub(super) fn run(settings: &SelfTest, out: Option<&Path>) -> Result<Outcome> {
    if settings.threads > 0 {
        rayon::ThreadPoolBuilder::new().num_threads(settings.threads as usize).build_global()?;
    }
    let of = Simulated { studies: settings.studies, seed: settings.seed };
    if let (Some(part), Some(out)) = (settings.part, out) {
        say(&SIMULATION.write(out, &of, part, &simulated(of.studies, of.seed, part))?)?;
        return Ok(Outcome::Done);
    }
    if settings.merge.is_empty() {
        let outcomes = Outcomes::of(&simulated(of.studies, of.seed, Part::WHOLE));
        return write(&outcomes, of.seed, out);
    }
    let (outcomes, seed) = merged(&settings.merge)?;
    write(&outcomes, seed, out)
}

/// How all parts together came out, and their seed.
fn merged(paths: &[PathBuf]) -> Result<(Outcomes, u64)> {
    let parts = SIMULATION.read(paths)?;
    let of = parts.arguments(Simulated::check)?;
    Ok((Outcomes::of(&parts.whole(blank(of.studies))?), of.seed))
}

/// Prints the tables, and writes them into a folder if there is one.
fn write(outcomes: &Outcomes, seed: u64, out: Option<&Path>) -> Result<Outcome> {
    for table in isostudy_report::self_test_tables(outcomes, seed) {
        say(&table.to_markdown())?;
        if let Some(out) = out {
            std::fs::create_dir_all(out).with_context(|| out.display().to_string())?;
            for (ending, text) in [("csv", table.to_csv()), ("md", table.to_markdown())] {
                let path = out.join(format!("{}.{ending}", table.name));
                store::write_whole(&path, text.as_bytes())?;
                say(&path.display().to_string())?;
            }
        }
    }
    let passed = outcomes.sound();
    if !passed {
        tell!("self-test failed: see the rows that say NO");
    }
    Ok(Outcome::of_check(passed))
}
