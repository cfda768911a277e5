//! Digests of files, each of which is read once.

use crate::store::sha256_of_file;
use anyhow::Result;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Digests of files that several programs are: each file is read once.
#[derive(Default)]
pub(crate) struct Digests(BTreeMap<PathBuf, String>);

impl Digests {
    /// As [`sha256_of_file`].
    ///
    /// # Errors
    /// The same.
    pub(crate) fn of(&mut self, path: &Path) -> Result<String> {
        if let Some(known) = self.0.get(path) {
            return Ok(known.clone());
        }
        let digest = sha256_of_file(path)?;
        self.0.insert(path.to_owned(), digest.clone());
        Ok(digest)
    }
}
