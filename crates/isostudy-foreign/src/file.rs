//! Files that somebody names: opened without waiting, and read up to a limit.

use std::fmt;
use std::fs::{self, File, FileType, OpenOptions};
use std::io::{self, Read};
use std::os::unix::fs::{FileTypeExt, OpenOptionsExt};
use std::path::{Path, PathBuf};

use rustix::fs::OFlags;
use thiserror::Error;

/// The longest line of a text, without its end. A study's longest lines are formulas and answers of a few thousand bytes.
pub const LINE_LIMIT_BYTES: usize = 1 << 20;

/// What is wrong, and with which file.
#[derive(Debug, Error)]
#[error("{}: {problem}", path.display())]
pub struct FileError {
    /// The file, as it was named.
    pub path: PathBuf,
    /// What is wrong with it. It is in the message, hence not a source of its own.
    pub problem: FileProblem,
}

/// What may be wrong with a file.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum FileProblem {
    /// Something else, which may never end, or never begin.
    #[error("not a file, but a {0}")]
    NotAFile(Kind),
    /// More than may be read.
    #[error("larger than {limit} bytes, the limit for such a file")]
    TooLarge {
        /// How many bytes may be read.
        limit: u64,
    },
    /// A text with a line without end.
    #[error("line {line} has more than {limit} bytes")]
    LineTooLong {
        /// Which, from 1.
        line: usize,
        /// How long a line may be.
        limit: usize,
    },
    /// No text.
    #[error("stream did not contain valid UTF-8: byte {at} is none")]
    NotUtf8 {
        /// Where, from 0.
        at: usize,
    },
    /// Somebody wrote to a file of which [`Parts`](crate::Parts) are read, or cut it off.
    #[error("the file changed while it was read{}", lengths(*was_bytes, *is_bytes))]
    Changed {
        /// How long it was.
        was_bytes: u64,
        /// How long it is.
        is_bytes: u64,
    },
    /// What the system said.
    #[error("{0}")]
    Io(io::Error),
}

/// What is known of a change by how long the file is.
fn lengths(was: u64, is: u64) -> String {
    if was == is { String::new() } else { format!(": it had {was} bytes and has {is}") }
}

/// What is there in place of a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Kind {
    /// A folder.
    Folder,
    /// A named pipe.
    Pipe,
    /// A device.
    Device,
    /// A socket.
    Socket,
}

impl fmt::Display for Kind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Folder => "folder",
            Self::Pipe => "pipe",
            Self::Device => "device",
            Self::Socket => "socket",
        })
    }
}

impl FileProblem {
    fn at(self, path: &Path) -> FileError {
        FileError { path: path.to_owned(), problem: self }
    }
}

impl From<FileError> for io::Error {
    /// Without the path, for errors that name it themselves.
    fn from(error: FileError) -> Self {
        match error.problem {
            FileProblem::Io(error) => error,
            problem => Self::other(problem.to_string()),
        }
    }
}

/// Opens a regular file for reading. Nothing is waited for: it is looked at before, since to open a device may do something, and
/// again when it is open, since it may have been replaced.
///
/// # Errors
/// If it is not there, is something else, or cannot be opened.
pub fn open(path: &Path) -> Result<File, FileError> {
    let opened = || -> Result<File, FileProblem> {
        check(fs::metadata(path).map_err(FileProblem::Io)?.file_type())?;
        let flags = (OFlags::NONBLOCK | OFlags::NOCTTY).bits() as i32;
        let file = OpenOptions::new().read(true).custom_flags(flags).open(path).map_err(FileProblem::Io)?;
        check(file.metadata().map_err(FileProblem::Io)?.file_type())?;
        Ok(file)
    };
    opened().map_err(|problem| problem.at(path))
}

fn check(found: FileType) -> Result<(), FileProblem> {
    let kind = match () {
        () if found.is_file() => return Ok(()),
        () if found.is_dir() => Kind::Folder,
        () if found.is_fifo() => Kind::Pipe,
        () if found.is_socket() => Kind::Socket,
        () => Kind::Device,
    };
    Err(FileProblem::NotAFile(kind))
}

/// What a file holds, at most `limit` bytes.
///
/// # Errors
/// As [`open`]; if it holds more, which is known before it is read unless it grows.
pub fn bytes(path: &Path, limit: u64) -> Result<Vec<u8>, FileError> {
    let file = open(path)?;
    let read = || -> Result<Vec<u8>, FileProblem> {
        let size = file.metadata().map_err(FileProblem::Io)?.len();
        let mut bytes = Vec::new();
        if size <= limit {
            bytes.reserve_exact(size as usize);
            file.take(limit + 1).read_to_end(&mut bytes).map_err(FileProblem::Io)?;
        }
        if size > limit || bytes.len() as u64 > limit {
            return Err(FileProblem::TooLarge { limit });
        }
        Ok(bytes)
    };
    read().map_err(|problem| problem.at(path))
}

/// The text in a file, at most `limit` bytes in lines of at most [`LINE_LIMIT_BYTES`].
///
/// # Errors
/// As [`bytes`]; if a line is longer, or it is not UTF-8.
pub fn text(path: &Path, limit: u64) -> Result<String, FileError> {
    let bytes = bytes(path, limit)?;
    if let Some(line) = bytes.split(|&byte| byte == b'\n').position(|line| line.len() > LINE_LIMIT_BYTES) {
        return Err(FileProblem::LineTooLong { line: line + 1, limit: LINE_LIMIT_BYTES }.at(path));
    }
    String::from_utf8(bytes)
        .map_err(|error| FileProblem::NotUtf8 { at: error.utf8_error().valid_up_to() }.at(path))
}

#[cfg(test)]
mod tests {
    use super::*;
    use rustix::fs::{CWD, FileType, Mode, mknodat};
    use std::os::unix::net::UnixListener;

    #[test]
    fn what_is_no_file_is_told_at_once_and_by_name() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        mknodat(CWD, at("pipe"), FileType::Fifo, Mode::RWXU, 0).unwrap();
        let _socket = UnixListener::bind(at("socket")).unwrap();
        std::os::unix::fs::symlink("/dev/zero", at("zero")).unwrap();
        fs::create_dir(at("folder")).unwrap();
        let of = |name: &str| bytes(&at(name), 10).unwrap_err();
        for (name, kind) in
            [("pipe", Kind::Pipe), ("socket", Kind::Socket), ("zero", Kind::Device), ("folder", Kind::Folder)]
        {
            let error = of(name);
            assert!(matches!(error.problem, FileProblem::NotAFile(found) if found == kind), "{error}");
            assert_eq!(
                error.to_string(),
                format!("{}: not a file, but a {name}", at(name).display()).replace("a zero", "a device")
            );
        }
        let missing = of("missing");
        assert!(
            matches!(&missing.problem, FileProblem::Io(error) if error.kind() == io::ErrorKind::NotFound)
        );
        assert!(missing.to_string().starts_with(&at("missing").display().to_string()), "{missing}");
    }

    #[test]
    fn a_file_of_the_limit_is_read_and_one_byte_more_is_not() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("ten");
        fs::write(&path, b"0123456789").unwrap();
        assert_eq!(bytes(&path, 10).unwrap(), b"0123456789");
        assert!(matches!(bytes(&path, 9).unwrap_err().problem, FileProblem::TooLarge { limit: 9 }));
        // Without contents, and as large as no memory is.
        File::create(&path).unwrap().set_len(1 << 40).unwrap();
        assert!(matches!(bytes(&path, 1 << 20).unwrap_err().problem, FileProblem::TooLarge { .. }));
        // Files of the system say that they have none.
        assert!(matches!(
            bytes(Path::new("/proc/self/stat"), 5).unwrap_err().problem,
            FileProblem::TooLarge { .. }
        ));
    }

    #[test]
    fn a_line_without_end_and_what_is_no_text_are_told_by_their_place() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("text");
        fs::write(&path, ["short\n", &"x".repeat(LINE_LIMIT_BYTES), "\n"].concat()).unwrap();
        assert_eq!(text(&path, 1 << 30).unwrap().lines().count(), 2);
        fs::write(&path, ["short\n", &"x".repeat(LINE_LIMIT_BYTES + 1), "\n"].concat()).unwrap();
        assert!(matches!(
            text(&path, 1 << 30).unwrap_err().problem,
            FileProblem::LineTooLong { line: 2, .. }
        ));
        fs::write(&path, b"ab\xff").unwrap();
        assert!(matches!(text(&path, 1 << 30).unwrap_err().problem, FileProblem::NotUtf8 { at: 2 }));
    }
}
