//! A folder whose files may not be changed, on a backup, say, or before it is known whether anything is missing: read from a copy.

use super::{JournalError, random_hex};
use std::fs::{DirBuilder, File};
use std::io;
use std::os::unix::fs::DirBuilderExt;
use std::path::{Path, PathBuf};

/// A copy of a folder's databases, the user's alone, which is removed when it is dropped.
pub(super) struct Copied(PathBuf);

impl Copied {
    /// Copies the databases of these names, each with its log.
    pub(super) fn of(folder: &Path, databases: &[&str]) -> Result<Self, JournalError> {
        let failed = |path: &Path, source| JournalError::Folder { path: path.into(), source };
        let path = std::env::temp_dir().join(format!("isostudy-{}", random_hex(8)));
        DirBuilder::new().mode(0o700).create(&path).map_err(|e| failed(&path, e))?;
        let copied = Self(path);
        for name in databases.iter().flat_map(|name| [(*name).to_owned(), format!("{name}-wal")]) {
            let (there, here) = (folder.join(&name), copied.0.join(&name));
            // Contents alone: permissions to write may be what is missing.
            match File::open(&there) {
                Ok(mut from) => File::create_new(&here)
                    .and_then(|mut to| io::copy(&mut from, &mut to))
                    .map(drop)
                    .map_err(|e| failed(&here, e))?,
                Err(error) if error.kind() == io::ErrorKind::NotFound => {}
                Err(error) => return Err(failed(&there, error)),
            }
        }
        Ok(copied)
    }

    pub(super) fn folder(&self) -> &Path {
        &self.0
    }
}

impl Drop for Copied {
    fn drop(&mut self) {
        drop(std::fs::remove_dir_all(&self.0));
    }
}
