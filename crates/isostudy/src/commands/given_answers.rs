//! The answers that people gave through the page: where a server keeps them, and as a file that `analyse` reads.

use super::study_forms::forms;
use crate::{kept_answers, store};
use anyhow::Result;
use isostudy_design::Study;
use isostudy_design::forms::{FormFile, KeyEntry};
use isostudy_serve::export::{self, Given};
use isostudy_serve::{deidentify, journal};
use std::path::{Path, PathBuf};

/// The answers that `isostudy serve` kept, if there are any, as a file beside them.
pub(super) fn served(study: &Study, folder: &Path) -> Result<Option<PathBuf>> {
    if !kept_answers::are_in(folder) {
        return Ok(None);
    }
    let (file, key, _) = forms(study)?;
    let given = deidentify::deidentified(&journal::kept(folder, &file.study)?.given);
    let path = folder.join("answers.csv");
    store::write_whole(&path, csv(&file, &given, &key)?.as_bytes())?;
    tell!("answers of `isostudy serve`: {}", path.display());
    Ok(Some(path))
}

/// The long format.
///
/// # Errors
/// If an answer is to a question that the key has not.
pub(super) fn csv(file: &FormFile, given: &[Given], key: &[KeyEntry]) -> Result<String> {
    Ok(export::csv(&export::lines(given, key)?, &export::header(file.way)))
}

/// How many people gave them.
pub(super) fn participants(given: &[Given]) -> usize {
    let mut names: Vec<&str> = given.iter().map(|given| given.participant.as_str()).collect();
    names.sort_unstable();
    names.dedup();
    names.len()
}
