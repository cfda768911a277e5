//! `isostudy collect`: what participants downloaded from the page, in one file of answers.

use super::given_answers::{csv, participants};
use super::study_forms::forms;
use crate::outcome::Outcome;
use crate::terminal::{counted, say};
use crate::{input, store};
use anyhow::{Context, Result, anyhow, bail, ensure};
use clap::Args;
use isostudy_design::forms::Questionnaire;
use isostudy_serve::cameras::{self, Tracked};
use isostudy_serve::download::{self, DownloadError};
use isostudy_serve::export::{self, Given};
use isostudy_serve::people;
use isostudy_serve::record::About;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// Study file whose bundle was answered
    study: PathBuf,
    /// Files that the page gave, CSV or JSON, or folders of nothing else
    #[arg(required = true)]
    downloads: Vec<PathBuf>,
    /// File to write, in the long format
    #[arg(long, short, value_name = "FILE")]
    out: PathBuf,
    /// File to write what people said of themselves to, which JSON files have
    #[arg(long, value_name = "FILE")]
    about: Option<PathBuf>,
    /// File to write to from where people looked at models that they turned, which JSON files have
    #[arg(long, value_name = "FILE")]
    cameras: Option<PathBuf>,
}

/// Joins the page's downloads with the key into one file that `analyse` reads.
///
/// # Errors
/// If a file cannot be read or contradicts another, or the study is not the one that was answered.
pub(crate) fn run(arguments: &Arguments) -> Result<Outcome> {
    let study = input::study(&arguments.study)?;
    let (file, key, _) = forms(&study)?;
    let mut all: BTreeMap<(String, u32), Given> = BTreeMap::new();
    let mut again = 0;
    let mut about: BTreeMap<String, About> = BTreeMap::new();
    let mut cameras: BTreeMap<(String, u32), Tracked> = BTreeMap::new();
    let downloads: Vec<Vec<PathBuf>> =
        arguments.downloads.iter().map(|path| files(path)).collect::<Result<_>>()?;
    for path in downloads.iter().flatten() {
        let place = || path.display().to_string();
        ensure!(
            !input::is_same(path, &arguments.out),
            "{}: is a download; it would be written over",
            place()
        );
        let text = input::text(path)?;
        let given = download::read(&text, &file).map_err(|error| match error {
            DownloadError::Columns { .. } => anyhow!(
                "{}: {error}. `isostudy analyse {} --responses {0}` reads answers of other kinds",
                place(),
                arguments.study.display()
            ),
            other => anyhow::Error::from(other).context(place()),
        })?;
        ensure!(!given.is_empty(), "{}: no answers in it", place());
        export::lines(&given, &key).with_context(place)?;
        if let Some((name, said)) = download::read_about(&text).with_context(place)? {
            let wrong = said.iter().find(|(id, value)| {
                let question = file.about.iter().find(|question| question.id == **id);
                question.is_none_or(|question| !question.takes(value))
            });
            if let Some((id, value)) = wrong {
                bail!("{}: about.{id} = {value:?}: the study asks no question that takes it", place());
            }
            about.insert(name, said);
        }
        for tracked in download::read_cameras(&text).with_context(place)? {
            cameras.insert((tracked.participant.clone(), tracked.order), tracked);
        }
        again += download::add(&mut all, given).with_context(place)?;
    }
    let given: Vec<Given> = all.into_values().collect();
    store::write_whole(&arguments.out, csv(&file, &given, &key)?.as_bytes())?;
    match &arguments.about {
        Some(path) => {
            let attention = Questionnaire::of(&study).map(|of| of.attention()).unwrap_or_default();
            store::write_whole(path, people::about_csv(&file, &attention, &about).as_bytes())?;
        }
        None if about.values().any(|said| !said.is_empty()) => {
            tell!("people said something of themselves; --about FILE writes it");
        }
        None => {}
    }
    let cameras: Vec<Tracked> = cameras.into_values().collect();
    match &arguments.cameras {
        Some(path) => store::write_whole(path, cameras::csv(&cameras, &key).as_bytes())?,
        None if !cameras.is_empty() => {
            tell!("people turned models; --cameras FILE writes from where they looked")
        }
        None => {}
    }
    let repeated = if again > 0 { format!("; {again} came twice") } else { String::new() };
    let people = counted(participants(&given) as u64, "participant");
    tell!("{} of {people}{repeated}", counted(given.len() as u64, "answer"));
    say(&arguments.out.display().to_string())?;
    Ok(Outcome::Done)
}

/// The file itself, or all files of a folder by their names; those that begin with a dot are no downloads.
///
/// # Errors
/// If the folder cannot be read, or has no file.
fn files(path: &Path) -> Result<Vec<PathBuf>> {
    if !path.is_dir() {
        return Ok(vec![path.to_owned()]);
    }
    let place = || path.display().to_string();
    let entries = std::fs::read_dir(path).with_context(place)?.map(|entry| Ok(entry?.path()));
    let mut files: Vec<PathBuf> = entries.collect::<std::io::Result<_>>().with_context(place)?;
    let is_hidden =
        |file: &Path| file.file_name().is_some_and(|name| name.to_string_lossy().starts_with('.'));
    files.retain(|file| file.is_file() && !is_hidden(file));
    files.sort();
    ensure!(!files.is_empty(), "{}: no files in it", place());
    Ok(files)
}
