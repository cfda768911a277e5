//! `isostudy study`: everything, from meshes to the page.

use super::study_run::{Run, with_page};
use crate::outcome::Outcome;
use anyhow::Result;
use clap::Args;

#[derive(Debug, Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    run: Run,
}

/// Makes everything.
///
/// # Errors
/// If the study is wrong or a file cannot be written.
pub(crate) fn run(arguments: &Arguments) -> Result<Outcome> {
    with_page(&arguments.run, |pipeline| pipeline.study())
}
