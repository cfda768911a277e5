//! What a server has of the machine under it: files, a clock, chance and a log. [`System`] is the machine itself. Tests have
//! another one, whose disk fails and whose clock they set.

use crate::log;
use std::fs::{DirBuilder, File, OpenOptions, Permissions};
use std::io::{self, ErrorKind, Read};
use std::os::unix::fs::{DirBuilderExt, FileExt, OpenOptionsExt, PermissionsExt};
use std::path::Path;
use std::time::{SystemTime, UNIX_EPOCH};

/// A machine.
pub(crate) trait Machine: Send + Sync {
    /// Milliseconds since 1970; may go back.
    fn now_ms(&self) -> i64;

    /// Fills bytes so that nobody can guess them.
    fn random(&self, bytes: &mut [u8]);

    /// Tells whoever runs the server a line, now or soon or never.
    fn note(&self, line: String);

    /// By which name SQLite knows the files.
    fn vfs(&self) -> &str;

    /// Makes a folder that nobody else may read, and those above it, where it is not there; has their names on disk.
    fn make_folders(&self, path: &Path) -> io::Result<()>;

    /// Makes a folder that nobody else may read, which must not be there.
    fn make_folder(&self, path: &Path) -> io::Result<()>;

    /// Removes a folder and all that is in it.
    fn remove_folder(&self, path: &Path) -> io::Result<()>;

    /// Has the names of a folder's files on disk.
    fn sync_folder(&self, path: &Path) -> io::Result<()>;

    /// Opens a file that nobody else may read, and makes it if it is not there.
    fn open(&self, path: &Path) -> io::Result<Box<dyn Owned>>;

    /// The first bytes of a file, so many at most.
    fn read(&self, path: &Path, most: u64) -> io::Result<Vec<u8>>;

    /// Copies the contents of a file, and no permissions, to a file that must not be there.
    ///
    /// # Errors
    /// Which of them is to blame, and why.
    fn copy<'a>(&self, from: &'a Path, to: &'a Path) -> Result<(), (&'a Path, io::Error)>;
}

/// An open file that nobody else may read.
pub(crate) trait Owned: Send + Sync {
    /// Writes over its beginning.
    fn write(&self, bytes: &[u8]) -> io::Result<()>;

    /// Has its bytes on disk.
    fn sync(&self) -> io::Result<()>;

    /// Whether it was taken for this process, for as long as it is open.
    fn try_lock(&self) -> bool;
}

/// The machine itself.
pub(crate) struct System;

impl Machine for System {
    fn now_ms(&self) -> i64 {
        SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| since.as_millis() as i64)
    }

    /// # Panics
    /// If the system has no random numbers, in which case nothing here is safe.
    fn random(&self, bytes: &mut [u8]) {
        getrandom::fill(bytes).expect("the system gives random numbers");
    }

    fn note(&self, line: String) {
        log::note(line);
    }

    fn vfs(&self) -> &str {
        "unix"
    }

    fn make_folders(&self, path: &Path) -> io::Result<()> {
        let new = path.ancestors().take_while(|above| !above.exists()).count();
        DirBuilder::new().recursive(true).mode(0o700).create(path)?;
        let here = |above: &Path| {
            if above.as_os_str().is_empty() { Path::new(".").into() } else { above.to_owned() }
        };
        path.ancestors().skip(1).take(new).try_for_each(|above| self.sync_folder(&here(above)))
    }

    fn make_folder(&self, path: &Path) -> io::Result<()> {
        DirBuilder::new().mode(0o700).create(path)
    }

    fn remove_folder(&self, path: &Path) -> io::Result<()> {
        std::fs::remove_dir_all(path)
    }

    fn sync_folder(&self, path: &Path) -> io::Result<()> {
        match File::open(path)?.sync_all() {
            // Some file systems of networks cannot, and have names on disk by other means or by none.
            Err(error) if matches!(error.kind(), ErrorKind::InvalidInput | ErrorKind::Unsupported) => Ok(()),
            synced => synced,
        }
    }

    fn open(&self, path: &Path) -> io::Result<Box<dyn Owned>> {
        let file =
            OpenOptions::new().read(true).write(true).create(true).truncate(false).mode(0o600).open(path)?;
        file.set_permissions(Permissions::from_mode(0o600))?;
        Ok(Box::new(file))
    }

    fn read(&self, path: &Path, most: u64) -> io::Result<Vec<u8>> {
        let mut bytes = Vec::new();
        File::open(path)?.take(most).read_to_end(&mut bytes)?;
        Ok(bytes)
    }

    fn copy<'a>(&self, from: &'a Path, to: &'a Path) -> Result<(), (&'a Path, io::Error)> {
        let mut there = File::open(from).map_err(|error| (from, error))?;
        let copied = File::create_new(to).and_then(|mut here| io::copy(&mut there, &mut here));
        copied.map(drop).map_err(|error| (to, error))
    }
}

impl Owned for File {
    fn write(&self, bytes: &[u8]) -> io::Result<()> {
        self.write_all_at(bytes, 0)
    }

    fn sync(&self) -> io::Result<()> {
        self.sync_all()
    }

    fn try_lock(&self) -> bool {
        File::try_lock(self).is_ok()
    }
}
