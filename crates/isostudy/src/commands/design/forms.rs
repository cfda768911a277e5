//! `isostudy design forms`: the participants' forms, and the key to them.

use crate::commands::study_forms::no_forms;
use crate::commands::study_run::{Run, without_programs};
use crate::outcome::Outcome;
use crate::terminal::say;
use anyhow::{Context, Result};
use clap::Args;

#[derive(Debug, Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    run: Run,
}

/// Deals them.
///
/// # Errors
/// If the study is wrong or has none, or a file cannot be written.
pub(crate) fn run(arguments: &Arguments) -> Result<Outcome> {
    without_programs(&arguments.run, |pipeline, out| {
        pipeline.forms()?.with_context(|| no_forms(&arguments.run.study))?;
        say(&out.join("forms").display().to_string())
    })
}
