//! Runs that are kept under a name, to compare later ones with.

use std::path::{Path, PathBuf};

/// Where a results folder keeps them.
const FOLDER: &str = "bench/baselines";

/// The file of the baseline that is meant by `a`: a name, no path, in the results folder `b`. `None` if there is none.
pub(super) fn named(a: &Path, b: &Path) -> Option<PathBuf> {
    let name = a.to_str().filter(|_| a.components().count() == 1 && !a.exists())?;
    Some(file(b, name)).filter(|path| path.is_file())
}

/// The file of a name.
fn file(folder: &Path, name: &str) -> PathBuf {
    folder.join(FOLDER).join(format!("{name}.json"))
}
