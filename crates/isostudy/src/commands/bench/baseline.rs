//! Runs that are kept under a name, to compare later ones with, and their history.

use crate::store::write_whole;
use anyhow::{Context, Result};
use isostudy_design::record::BenchRun;
use isostudy_timing::history::Kept;
use std::path::{Path, PathBuf};

/// Where a results folder keeps them.
const FOLDER: &str = "bench/baselines";
/// A line of JSON for each run that was kept, in the order in which they were.
pub(super) const HISTORY: &str = "bench/history.jsonl";

/// A name that can be a file's: letters, digits, dots, hyphens and underscores, no dot first.
pub(super) fn name(text: &str) -> Result<String, String> {
    let plain = |c: char| c.is_ascii_alphanumeric() || "._-".contains(c);
    if text.is_empty() || text.starts_with('.') || !text.chars().all(plain) {
        return Err("must be of letters, digits, dots, hyphens and underscores, and begin with no dot".into());
    }
    Ok(text.to_owned())
}

/// The file of the baseline that is meant by `a`: a name, no path, in the results folder `b`. `None` if there is none.
pub(super) fn named(a: &Path, b: &Path) -> Option<PathBuf> {
    let name = a.to_str().filter(|_| a.components().count() == 1 && !a.exists())?;
    Some(file(b, name)).filter(|path| path.is_file())
}

/// Keeps a run, and returns its file.
///
/// # Errors
/// If a file cannot be read or written.
pub(super) fn save(folder: &Path, name: &str, run: &BenchRun) -> Result<PathBuf> {
    let path = file(folder, name);
    let mut json = serde_json::to_vec_pretty(run)?;
    json.push(b'\n');
    write_whole(&path, &json)?;
    let history = folder.join(HISTORY);
    let mut lines = match std::fs::read_to_string(&history) {
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => String::new(),
        read => read.with_context(|| format!("cannot read {}", history.display()))?,
    };
    lines += &(serde_json::to_string(&Kept::of(name, run))? + "\n");
    write_whole(&history, lines.as_bytes())?;
    Ok(path)
}

/// The file of a name.
fn file(folder: &Path, name: &str) -> PathBuf {
    folder.join(FOLDER).join(format!("{name}.json"))
}
