//! Files of answers, and what a study declares about them.

use anyhow::{Context, Result};
use design::Study;
use responses::{Mapping, Plan, Responses};
use std::path::Path;

/// The answers that a study names, if it names any.
///
/// # Errors
/// If they cannot be read for this study.
pub(crate) fn of_study(study: &Study) -> Result<Option<Responses>> {
    study.responses.as_deref().map(|path| read(path, study)).transpose()
}

/// Answers to a study's questions, read as the study declares.
///
/// # Errors
/// If they cannot be read for this study.
pub(crate) fn read(path: &Path, study: &Study) -> Result<Responses> {
    let mapping = match &study.file.responses {
        Some(section) => Mapping::of(section).with_context(|| study.path.display().to_string())?,
        None => Mapping::default(),
    };
    Ok(responses::read(path, Some(&Plan::of_study(study)), &mapping)?.responses)
}
