//! The forms of a study that asks people.

use crate::pipeline::forms_digest;
use anyhow::{Context, Result};
use isostudy_design::Study;
use isostudy_design::forms::{FormFile, KeyEntry, Questionnaire};
use std::path::Path;

/// A study's forms, their key, and their digest.
///
/// # Errors
/// If it has none.
pub(super) fn forms(study: &Study) -> Result<(FormFile, Vec<KeyEntry>, String)> {
    let questionnaire = Questionnaire::of(study).with_context(|| no_forms(&study.path))?;
    let file = questionnaire.file();
    let digest = forms_digest(&file)?;
    Ok((file, questionnaire.key(), digest))
}

/// What to say of a study that asks nobody.
pub(super) fn no_forms(study: &Path) -> String {
    format!("{}: no [forms] section, or no comparisons; configs/balanced.toml has both", study.display())
}
