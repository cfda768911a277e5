//! `isostudy analyse --self-test`: the analysis proved on studies with a known truth.

use crate::outcome::Outcome;
use crate::store;
use crate::terminal::say;
use anyhow::{Context, Result};
use clap::Args;
use std::path::Path;

#[derive(Debug, Args)]
pub(crate) struct SelfTest {
    /// Read no answers: simulate studies with a known truth, and show that each probe finds its own defect and no other, that
    /// tests reject and intervals cover as they should
    #[arg(long, conflicts_with_all = ["input", "responses"])]
    pub(super) self_test: bool,
    /// Studies to simulate for each line
    #[arg(long, requires = "self_test", default_value_t = 10_000, value_name = "N", value_parser = clap::value_parser!(u64).range(100..=10_000_000))]
    studies: u64,
    /// Seed of the simulated studies; the same seed gives the same tables on any number of threads
    #[arg(long, requires = "self_test", default_value_t = 1, value_name = "SEED")]
    seed: u64,
    /// Threads to simulate with; 0 takes every core
    #[arg(long, requires = "self_test", default_value_t = 0, value_name = "N", value_parser = clap::value_parser!(u32).range(..=1024))]
    threads: u32,
}

/// Simulates studies and prints how probes, tests and intervals did; one that did not as it should fails it.
///
/// # Errors
/// If a file cannot be written.
pub(super) fn run(settings: &SelfTest, out: Option<&Path>) -> Result<Outcome> {
    if settings.threads > 0 {
        rayon::ThreadPoolBuilder::new().num_threads(settings.threads as usize).build_global()?;
    }
    let (tables, passed) = isostudy_report::self_test_tables(settings.studies, settings.seed);
    for table in &tables {
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
    if !passed {
        tell!("self-test failed: see the rows that say NO");
    }
    Ok(Outcome::of_check(passed))
}
