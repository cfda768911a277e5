//! The answers that people gave through the page: where a server keeps them, and as a file that `analyse` reads.

use anyhow::Result;
use isostudy_design::Study;
use isostudy_design::forms::KeyEntry;
use isostudy_serve::export::{self, Given, HEADER};
use std::path::{Path, PathBuf};

/// Answers are never among the results, which can be made again.
pub(super) fn answers_folder(study: &Study, given: Option<&PathBuf>) -> PathBuf {
    given.cloned().unwrap_or_else(|| Path::new("answers").join(&study.file.study.id))
}

/// The long format.
///
/// # Errors
/// If an answer is to a question that the key has not.
pub(super) fn csv(given: &[Given], key: &[KeyEntry]) -> Result<String> {
    Ok(export::csv(&export::lines(given, key)?, &HEADER))
}

/// How many people gave them.
pub(super) fn participants(given: &[Given]) -> usize {
    let mut names: Vec<&str> = given.iter().map(|given| given.participant.as_str()).collect();
    names.sort_unstable();
    names.dedup();
    names.len()
}
