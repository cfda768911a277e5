//! `isostudy deidentify`: a server's answers without anything that leads to a person.

use super::given_answers::{csv, participants};
use super::study_forms::forms;
use crate::outcome::Outcome;
use crate::terminal::say;
use crate::{input, kept_answers, store};
use anyhow::{Context, Result, bail};
use clap::Args;
use isostudy_serve::{deidentify, journal};
use std::path::PathBuf;

#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// Study file that was served
    study: PathBuf,
    /// Folder of the answers [default: answers/<study id>]
    #[arg(long, value_name = "DIR")]
    answers: Option<PathBuf>,
    /// Folder to write answers.csv and codebook.md to
    #[arg(long, short, value_name = "DIR")]
    out: PathBuf,
}

/// Writes the answers of a server without anything that leads to a person, and a codebook.
///
/// # Errors
/// If the answers cannot be read, or the files not be written.
pub(crate) fn run(arguments: &Arguments) -> Result<Outcome> {
    let study = input::study(&arguments.study)?;
    let (file, key, digest) = forms(&study)?;
    let folder = kept_answers::folder(&study, arguments.answers.as_ref());
    if !kept_answers::are_in(&folder) {
        bail!(
            "{}: no answers.sqlite there; `isostudy serve` keeps answers in it, and --answers names another folder",
            folder.display()
        );
    }
    let stored = journal::kept(&folder, &file.study)?;
    if stored.digest != digest {
        tell!("the study file was changed since the first answer; the codebook says what it says now");
    }
    let given = deidentify::deidentified(&stored.given);
    std::fs::create_dir_all(&arguments.out).with_context(|| arguments.out.display().to_string())?;
    let codebook = deidentify::codebook(&file, (&stored.digest, &digest), participants(&given), given.len());
    for (name, text) in [("answers.csv", csv(&given, &key)?), ("codebook.md", codebook)] {
        let path = arguments.out.join(name);
        store::write_whole(&path, text.as_bytes())?;
        say(&path.display().to_string())?;
    }
    Ok(Outcome::Done)
}
