//! `isostudy deidentify`: a server's answers without anything that leads to a person.

use super::given_answers::{csv, participants};
use super::study_forms::{forms, no_forms};
use crate::outcome::Outcome;
use crate::terminal::say;
use crate::{input, kept_answers, store};
use anyhow::{Context, Result, bail};
use clap::Args;
use isostudy_design::forms::Questionnaire;
use isostudy_serve::{cameras, deidentify, journal, people};
use std::path::PathBuf;

#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// Study file that was served
    study: PathBuf,
    /// Folder of the answers [default: answers/<study id>]
    #[arg(long, value_name = "DIR")]
    answers: Option<PathBuf>,
    /// Folder to write answers.csv, codebook.md and, where there are any, about.csv of people and cameras.csv of models to
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
    let names = deidentify::names(&stored.given);
    let questionnaire = Questionnaire::of(&study).with_context(|| no_forms(&study.path))?;
    let asks = file.about.iter().any(|question| !question.is_free());
    let about =
        asks.then(|| people::shared_about_csv(&file, &questionnaire.attention(), &stored.about, &names));
    std::fs::create_dir_all(&arguments.out).with_context(|| arguments.out.display().to_string())?;
    let said = about.as_ref().map(|(_, said)| said.as_str());
    let cameras = deidentify::deidentified_cameras(&stored.cameras, &names);
    let mut codebook = deidentify::codebook(
        &file,
        (&stored.digest, &digest),
        participants(&given),
        given.len(),
        stored.departures,
        said,
    );
    let mut files = vec![("answers.csv", csv(&file, &given, &key)?)];
    if !cameras.is_empty() {
        codebook.push_str(deidentify::CAMERAS);
        files.push(("cameras.csv", cameras::csv(&cameras, &key)));
    }
    files.push(("codebook.md", codebook));
    if let Some((about, said)) = about {
        tell!("about.csv: {said}");
        files.push(("about.csv", about));
    }
    for (name, text) in files {
        let path = arguments.out.join(name);
        store::write_whole(&path, text.as_bytes())?;
        say(&path.display().to_string())?;
    }
    Ok(Outcome::Done)
}
