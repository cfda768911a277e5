//! `--object`: an object of a study, by its id.

use anyhow::{Result, bail};
use isostudy_design::Study;

/// Where the object stands in its study.
///
/// # Errors
/// If no object has the id, with those that there are.
pub(super) fn object_of_study(study: &Study, id: &str) -> Result<usize> {
    let objects = &study.file.objects;
    let Some(index) = objects.iter().position(|object| object.id == id) else {
        let known: Vec<&str> = objects.iter().map(|object| object.id.as_str()).collect();
        bail!("--object {id}: {} has {}", study.path.display(), known.join(", "));
    };
    Ok(index)
}
