//! Answers that lie where nothing can be written, such as on a backup: read from a copy.

use super::files::ANSWERS;
use super::random_hex;
use std::fs::{DirBuilder, File};
use std::io;
use std::os::unix::fs::DirBuilderExt;
use std::path::{Path, PathBuf};

/// A copy of a folder's answers, the user's alone, which is removed when it is dropped. Identifiers are not copied.
pub(super) struct Copied(PathBuf);

impl Copied {
    pub(super) fn of(folder: &Path) -> io::Result<Self> {
        let path = std::env::temp_dir().join(format!("isostudy-{}", random_hex(8)));
        DirBuilder::new().mode(0o700).create(&path)?;
        let copied = Self(path);
        for name in [ANSWERS.to_owned(), format!("{ANSWERS}-wal")] {
            // Contents alone: permissions to write are what is missing.
            match File::open(folder.join(&name)) {
                Ok(mut from) => drop(io::copy(&mut from, &mut File::create_new(copied.0.join(&name))?)?),
                Err(error) if error.kind() == io::ErrorKind::NotFound => {}
                Err(error) => return Err(error),
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
