//! A folder whose files may not be changed, on a backup, say, or before it is known whether anything is missing: read from a copy.

use super::{JournalError, hex};
use crate::machine::Machine;
use std::io;
use std::path::{Path, PathBuf};

/// A copy of a folder's databases, the user's alone, which is removed when it is dropped.
pub(super) struct Copied<'a> {
    machine: &'a dyn Machine,
    path: PathBuf,
}

impl<'a> Copied<'a> {
    /// Copies the databases of these names, each with its log, and the journal of one that was being made.
    pub(super) fn of(
        machine: &'a dyn Machine,
        folder: &Path,
        databases: &[&str],
    ) -> Result<Self, JournalError> {
        let failed = |path: &Path, source| JournalError::Folder { path: path.into(), source };
        let path = std::env::temp_dir().join(format!("isostudy-{}", hex(machine, 8)));
        machine.make_folder(&path).map_err(|e| failed(&path, e))?;
        let copied = Self { machine, path };
        for name in
            databases.iter().flat_map(|name| ["", "-wal", "-journal"].map(|end| format!("{name}{end}")))
        {
            let (there, here) = (folder.join(&name), copied.path.join(&name));
            // Contents alone: permissions to write may be what is missing.
            match machine.copy(&there, &here) {
                Err((path, error)) if path != there || error.kind() != io::ErrorKind::NotFound => {
                    return Err(failed(path, error));
                }
                _ => {}
            }
        }
        Ok(copied)
    }

    pub(super) fn folder(&self) -> &Path {
        &self.path
    }
}

impl Drop for Copied<'_> {
    fn drop(&mut self) {
        drop(self.machine.remove_folder(&self.path));
    }
}
