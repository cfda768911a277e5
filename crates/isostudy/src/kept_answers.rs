//! Answers that `isostudy serve` keeps, beside the results and never among them, since results can be made again.

use isostudy_design::Study;
use isostudy_serve::journal;
use std::path::{Path, PathBuf};

/// Where a server keeps them.
pub(crate) fn folder(study: &Study, given: Option<&PathBuf>) -> PathBuf {
    given.cloned().unwrap_or_else(|| Path::new("answers").join(&study.file.study.id))
}

/// Whether a server has kept any there.
pub(crate) fn are_in(folder: &Path) -> bool {
    folder.join("answers.sqlite").is_file()
}

/// Answers that nobody has read.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Waiting {
    pub(crate) answers: usize,
    pub(crate) people: usize,
    pub(crate) folder: PathBuf,
}

/// The answers to a study that names no responses, if a server has kept some. What cannot be read is none: `analyse` says why.
pub(crate) fn waiting(study: &Study) -> Option<Waiting> {
    let folder = folder(study, None);
    if study.responses.is_some() || !are_in(&folder) {
        return None;
    }
    let given = journal::kept(&folder, &study.file.study.id).ok()?.given;
    let mut people: Vec<&str> = given.iter().map(|given| given.participant.as_str()).collect();
    people.sort_unstable();
    people.dedup();
    (!given.is_empty()).then_some(Waiting { answers: given.len(), people: people.len(), folder })
}
