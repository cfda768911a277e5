//! `isostudy study`: everything, from meshes to the page.

use super::study_run::{Run, with_page};
use crate::outcome::Outcome;
use crate::terminal::counted;
use crate::{input, kept_answers};
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
    let outcome = with_page(&arguments.run, |pipeline| pipeline.study())?;
    if let Some(waiting) = kept_answers::waiting(&input::study(&arguments.run.study)?) {
        tell!(
            "{} holds {}, not read here: `isostudy analyse {}` reads them",
            waiting.folder.display(),
            counted(waiting.answers as u64, "answer"),
            arguments.run.study.display()
        );
    }
    Ok(outcome)
}
