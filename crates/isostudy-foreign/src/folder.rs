//! Temporary folders that do not stay.

use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Once;

use tempfile::{NamedTempFile, TempDir};

use crate::interrupt;

const PREFIX: &str = "isostudy-";
/// In each, locked as long as its process lives.
const HELD: &str = ".held";

/// An empty folder in the system's temporary one. It goes when this is dropped, and when a signal ends this process.
///
/// A process that is killed leaves its folders. The next one that makes a folder removes them: a lock tells that nobody has them.
#[derive(Debug)]
pub struct Folder {
    // The lock is given up last, when nothing is left to be removed.
    outer: TempDir,
    inner: PathBuf,
    _held: File,
}

impl Folder {
    /// Makes one.
    ///
    /// # Errors
    /// What the file system reports.
    pub fn new() -> io::Result<Self> {
        static ONCE: Once = Once::new();
        ONCE.call_once(|| sweep(&std::env::temp_dir()));
        let outer = TempDir::with_prefix(PREFIX)?;
        interrupt::register_folder(outer.path());
        // It is locked before it has its name, so that nobody finds it unlocked.
        let held = NamedTempFile::new_in(outer.path())?;
        held.as_file().try_lock()?;
        let held = held.persist(outer.path().join(HELD))?;
        let inner = outer.path().join("own");
        fs::create_dir(&inner)?;
        Ok(Self { outer, inner, _held: held })
    }

    /// Where it is; nothing else is in there.
    pub fn path(&self) -> &Path {
        &self.inner
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        interrupt::forget_folder(self.outer.path());
    }
}

/// Removes what processes left that were killed.
fn sweep(folder: &Path) {
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        if !entry.file_name().to_string_lossy().starts_with(PREFIX) {
            continue;
        }
        // Not through a link, and not what has no lock: it is another's, or is being made.
        let path = entry.path();
        let is_folder = entry.file_type().is_ok_and(|found| found.is_dir());
        let held = path.join(HELD);
        let is_held = fs::symlink_metadata(&held).is_ok_and(|found| found.is_file());
        if is_folder && is_held && crate::open(&held).is_ok_and(|file| file.try_lock().is_ok()) {
            let _ = fs::remove_dir_all(&path);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_nobody_holds_is_swept_and_all_else_stays() {
        let root = tempfile::tempdir().unwrap();
        let make = |name: &str, held: bool| {
            let folder = root.path().join(name);
            fs::create_dir(&folder).unwrap();
            if held {
                fs::write(folder.join(HELD), "").unwrap();
            }
            folder
        };
        let (left, alive) = (make("isostudy-left", true), make("isostudy-alive", true));
        let (strange, other) = (make("isostudy-strange", false), make("other", true));
        let lock = File::open(alive.join(HELD)).unwrap();
        lock.try_lock().unwrap();
        std::os::unix::fs::symlink(&other, root.path().join("isostudy-link")).unwrap();
        sweep(root.path());
        assert!(!left.exists());
        assert!([&alive, &strange, &other].iter().all(|folder| folder.is_dir()));
    }

    #[test]
    fn a_folder_is_empty_and_goes() {
        let folder = Folder::new().unwrap();
        let (path, outer) = (folder.path().to_owned(), folder.outer.path().to_owned());
        assert_eq!(fs::read_dir(&path).unwrap().count(), 0);
        fs::write(path.join("file"), "x").unwrap();
        drop(folder);
        assert!(!outer.exists());
    }
}
