//! A file of which parts are read, and which must stay as it is meanwhile.

use std::fs::File;
use std::io;
use std::os::unix::fs::FileExt;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use crate::file::{FileError, FileProblem, open};

/// A regular file whose parts are read in any order, by any number of threads.
///
/// What is read belongs together: a file that became longer or shorter, or was written to, is an error with the next part that is
/// read, as far as the file system's clock can tell. A file that is replaced by another of the same name is read on as it was.
#[derive(Debug)]
pub struct Parts {
    file: File,
    path: PathBuf,
    was: State,
}

/// What would not be the same if somebody had written.
#[derive(Debug, Clone, Copy, PartialEq)]
struct State {
    bytes: u64,
    /// Where the system knows.
    written: Option<SystemTime>,
}

impl State {
    fn of(file: &File) -> io::Result<Self> {
        let metadata = file.metadata()?;
        Ok(Self { bytes: metadata.len(), written: metadata.modified().ok() })
    }
}

impl Parts {
    /// Opens a file as it is now.
    ///
    /// # Errors
    /// As [`open`].
    pub fn open(path: &Path) -> Result<Self, FileError> {
        Self::of(open(path)?, path)
    }

    /// Of a file that [`open`] gave, as it is now.
    ///
    /// # Errors
    /// If the system says nothing of it.
    pub fn of(file: File, path: &Path) -> Result<Self, FileError> {
        let problem = |error| FileError { path: path.to_owned(), problem: FileProblem::Io(error) };
        let was = State::of(&file).map_err(problem)?;
        Ok(Self { file, path: path.to_owned(), was })
    }

    /// How long the file is.
    pub fn bytes(&self) -> u64 {
        self.was.bytes
    }

    /// The file, as it was named.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Fills `part` with the bytes from `at` on.
    ///
    /// # Errors
    /// [`FileProblem::Changed`]; [`FileProblem::Io`], also for a part beyond the end. Then `part` has anything in it.
    pub fn read(&self, at: u64, part: &mut [u8]) -> Result<(), FileError> {
        self.try_read(at, part).map_err(|problem| FileError { path: self.path.clone(), problem })
    }

    fn try_read(&self, at: u64, part: &mut [u8]) -> Result<(), FileProblem> {
        let result = self.file.read_exact_at(part, at);
        // Looked at after the bytes, since somebody may write while they are read; and before their error, since this explains it.
        let is = State::of(&self.file).map_err(FileProblem::Io)?;
        if is != self.was {
            return Err(FileProblem::Changed { was_bytes: self.was.bytes, is_bytes: is.bytes });
        }
        result.map_err(FileProblem::Io)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs::{self, OpenOptions};
    use std::time::Duration;

    /// Of ten bytes.
    fn ten() -> (tempfile::TempDir, PathBuf) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("ten");
        fs::write(&path, b"0123456789").unwrap();
        (folder, path)
    }

    fn read(parts: &Parts, at: u64, bytes: usize) -> Result<Vec<u8>, FileProblem> {
        let mut part = vec![0; bytes];
        parts.read(at, &mut part).map(|()| part).map_err(|error| {
            assert!(error.to_string().starts_with(&parts.path().display().to_string()), "{error}");
            error.problem
        })
    }

    #[test]
    fn parts_are_read_in_any_order() {
        let (_folder, path) = ten();
        let parts = Parts::open(&path).unwrap();
        assert_eq!(parts.bytes(), 10);
        assert_eq!(read(&parts, 7, 3).unwrap(), b"789");
        assert_eq!(read(&parts, 0, 4).unwrap(), b"0123");
        assert_eq!(read(&parts, 10, 0).unwrap(), b"");
        for (at, bytes) in [(8, 3), (10, 1), (u64::MAX - 4, 2)] {
            assert!(matches!(read(&parts, at, bytes), Err(FileProblem::Io(_))), "{at}");
        }
        assert!(matches!(Parts::open(&path.join("x")).unwrap_err().problem, FileProblem::Io(_)));
    }

    /// Another time than now, so that it does not matter how finely the file system's clock goes.
    fn write_later(path: &Path, change: impl FnOnce(&File)) {
        let file = OpenOptions::new().write(true).open(path).unwrap();
        let later = file.metadata().unwrap().modified().unwrap() + Duration::from_secs(2);
        change(&file);
        file.set_modified(later).unwrap();
    }

    #[test]
    fn a_file_that_changes_is_an_error_wherever_it_is_read() {
        type Change = fn(&File);
        let was = "the file changed while it was read";
        let changes: [(Change, u64, String); 3] = [
            (|file| file.set_len(4).unwrap(), 4, format!("{was}: it had 10 bytes and has 4")),
            (|file| file.set_len(11).unwrap(), 11, format!("{was}: it had 10 bytes and has 11")),
            (|file| file.write_all_at(b"x", 9).unwrap(), 10, was.into()),
        ];
        for (change, bytes, said) in changes {
            let (_folder, path) = ten();
            let parts = Parts::open(&path).unwrap();
            assert_eq!(read(&parts, 0, 10).unwrap(), b"0123456789");
            write_later(&path, change);
            for at in [0, 8] {
                let problem = read(&parts, at, 2).unwrap_err();
                assert!(
                    matches!(problem, FileProblem::Changed { was_bytes: 10, is_bytes } if is_bytes == bytes),
                    "{problem}"
                );
                assert_eq!(problem.to_string(), said);
            }
        }
    }

    #[test]
    fn a_file_in_place_of_another_changes_nothing() {
        let (folder, path) = ten();
        let parts = Parts::open(&path).unwrap();
        fs::write(folder.path().join("other"), b"abcdefghijkl").unwrap();
        fs::rename(folder.path().join("other"), &path).unwrap();
        assert_eq!(read(&parts, 2, 3).unwrap(), b"234");
    }
}
