//! Files that are named to be read, each through `isostudy_foreign`, up to a limit.

mod benchmark_file;

use crate::recipe::{finish, recipe};
use anyhow::{Context, Result, bail};
use isostudy_design::Study;
use isostudy_design::record::Purpose;
use std::io::Read;
use std::path::{Path, PathBuf};

/// The largest file that is read whole: a mesh or a program.
const LARGEST_BYTES: u64 = 4 << 30;
/// The largest that is read as text or JSON by hand-written readers: tables and downloads.
const LARGEST_TEXT_BYTES: u64 = 64 << 20;

/// What is there must be a file; that it is not there at all its reader says.
///
/// # Errors
/// If it is something else, is too large, or cannot be opened. The path is named.
pub(crate) fn regular(path: &Path) -> Result<()> {
    if path.symlink_metadata().is_ok() {
        open(path)?;
    }
    Ok(())
}

/// A file to read a mesh from.
///
/// # Errors
/// If it is none, cannot be opened, or is larger than any that is read. The path is named.
pub(crate) fn open(path: &Path) -> Result<impl Read + use<>> {
    let file = isostudy_foreign::open(path)?;
    if file.metadata().is_ok_and(|found| found.len() > LARGEST_BYTES) {
        bail!("{}: larger than {LARGEST_BYTES} bytes, the limit for such a file", path.display());
    }
    // It may grow while it is read.
    Ok(file.take(LARGEST_BYTES))
}

/// What a file holds.
///
/// # Errors
/// If it is no file, is too large, or cannot be read. The path is named.
pub(crate) fn bytes(path: &Path) -> Result<Vec<u8>> {
    Ok(isostudy_foreign::bytes(path, LARGEST_BYTES)?)
}

/// The same of a small text, whose lines have any length.
///
/// # Errors
/// As [`bytes`]; if it is no text.
pub(crate) fn text(path: &Path) -> Result<String> {
    let bytes = isostudy_foreign::bytes(path, LARGEST_TEXT_BYTES)?;
    String::from_utf8(bytes).with_context(|| path.display().to_string())
}

/// A study, and what it names; or that of a [benchmark file](benchmark_file).
///
/// # Errors
/// If it is no file, or something in it is wrong.
pub(crate) fn study(path: &Path) -> Result<Study> {
    study_with(path, &|_| Ok(()))
}

/// The same. Of a benchmark file, what `more` finds wrong is said together with all else.
///
/// # Errors
/// The same.
pub(crate) fn study_with(path: &Path, more: &dyn Fn(&Study) -> Result<()>) -> Result<Study> {
    check_study(path)?;
    // What cannot be read as a text its reader says.
    if let Ok(text) = text(path)
        && let Some(study) = benchmark_file::study(path, &text, more)?
    {
        return Ok(study);
    }
    let study = Study::load(path)?;
    if study.shown_files().is_some() {
        return Ok(study);
    }
    for method in &study.methods {
        recipe(&study, method.id, Purpose::Benchmark)?;
        finish(&study, method.id)?;
    }
    Ok(study)
}

/// Says of what cannot be a study file what it may be instead.
fn check_study(path: &Path) -> Result<()> {
    let inside = path.join("study.toml");
    if inside.is_file() {
        bail!("{}: is a folder; did you mean {}?", path.display(), inside.display());
    }
    regular(path)?;
    let ending = path.extension().unwrap_or_default().to_ascii_lowercase();
    if ["csv", "tsv", "json", "jsonl", "xlsx", "parquet"].iter().any(|other| ending == *other) {
        bail!(
            "{}: is no study file, whose name ends in .toml; `isostudy analyse {0}` reads answers without a study",
            path.display()
        );
    }
    Ok(())
}

/// The files of a folder with an extension, in the order of names; none where there is no folder.
///
/// # Errors
/// If the folder cannot be read.
pub(crate) fn files_of(folder: &Path, extension: &str) -> Result<Vec<PathBuf>> {
    let mut files = Vec::new();
    if folder.is_dir() {
        for entry in std::fs::read_dir(folder).with_context(|| folder.display().to_string())? {
            let path = entry?.path();
            files.extend(path.extension().is_some_and(|e| e == extension).then_some(path));
        }
    }
    files.sort();
    Ok(files)
}

/// Whether two paths lead to one file, which need not be there.
pub(crate) fn is_same(a: &Path, b: &Path) -> bool {
    match (resolved(a), resolved(b)) {
        (Some(a), Some(b)) => a == b,
        _ => a == b,
    }
}

/// Where a file is or would be, whatever way leads there.
fn resolved(path: &Path) -> Option<PathBuf> {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    path.canonicalize().ok().or_else(|| Some(folder.canonicalize().ok()?.join(path.file_name()?)))
}
