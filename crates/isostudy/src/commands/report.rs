//! `isostudy report`: tables, figures and pages again, from the results that are there.

use super::study_run::{Run, with_page};
use crate::outcome::Outcome;
use anyhow::Result;
use clap::Args;

#[derive(Debug, Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    run: Run,
}

/// Writes them again.
///
/// # Errors
/// If a result is missing or out of date.
pub(crate) fn run(arguments: &Arguments) -> Result<Outcome> {
    with_page(&arguments.run, |pipeline| pipeline.report())
}
