//! `isostudy bench sweep`: every resolution on every number of threads.

use crate::commands::study_run::{Run, with_pipeline};
use crate::outcome::Outcome;
use crate::terminal::say;
use anyhow::Result;
use clap::Args;

#[derive(Debug, Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    run: Run,
}

/// Measures, and prints the tables.
///
/// # Errors
/// If the study is wrong or has no sweep, or a measurement fails.
pub(crate) fn run(arguments: &Arguments) -> Result<Outcome> {
    with_pipeline(&arguments.run, |pipeline, out| {
        for table in pipeline.thread_sweep()? {
            say(&table)?;
        }
        say(&out.join("bench/sweep").display().to_string())
    })
}
