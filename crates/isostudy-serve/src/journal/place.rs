//! Whether the files that are open are those that the folder shows: what is written to others nobody will find again.

use super::files::{ANSWERS, IDENTITIES, LOCK};
use super::seal;
use std::os::unix::fs::MetadataExt;
use std::path::{Path, PathBuf};

/// The files of a journal, each by its device and its inode. As long as a file is open its inode is not given to another.
#[derive(Default)]
pub(super) struct Place {
    files: Vec<(PathBuf, (u64, u64))>,
}

impl Place {
    /// What the folder shows now; to be asked once all files are open.
    pub(super) fn of(folder: &Path) -> Self {
        let log = |name: &str| format!("{name}-wal");
        let others = [LOCK, seal::NAME].map(String::from);
        let databases = [ANSWERS.into(), log(ANSWERS), IDENTITIES.into(), log(IDENTITIES)];
        let names = databases.into_iter().chain(others);
        let shown = |name: String| {
            let path = folder.join(name);
            identity(&path).map(|found| (path, found))
        };
        Self { files: names.filter_map(shown).collect() }
    }

    /// The first file that is gone, or is another.
    pub(super) fn missing(&self) -> Option<&Path> {
        let changed = self.files.iter().find(|(path, opened)| identity(path) != Some(*opened));
        changed.map(|(path, _)| path.as_path())
    }
}

fn identity(path: &Path) -> Option<(u64, u64)> {
    std::fs::metadata(path).ok().map(|found| (found.dev(), found.ino()))
}
