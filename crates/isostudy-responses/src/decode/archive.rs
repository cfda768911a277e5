//! Zip files, with limits on what is inside.

use crate::error::{Fault, shorten};
use std::io::{Cursor, Read};

/// Most bytes that a zip file may hold, all entries together.
pub const LARGEST_ARCHIVE: u64 = 512 << 20;
/// Most bytes that a byte of a zip file may stand for, in files that hold more than [`SMALL`]. Text of a thousand equal
/// rows packs to a hundredth; deflate can do 1032.
const RATIO: u64 = 200;
/// Bytes at which the ratio does not matter.
const SMALL: u64 = 16 << 20;
const MOST_ENTRIES: usize = 10_000;

/// A zip file in memory.
pub(crate) struct Archive<'a> {
    zip: zip::ZipArchive<Cursor<&'a [u8]>>,
    names: Vec<String>,
    /// Bytes that may still be unpacked.
    left: u64,
}

/// Whether the bytes begin as a zip file does.
pub(crate) fn is_zip(bytes: &[u8]) -> bool {
    bytes.starts_with(b"PK\x03\x04") || bytes.starts_with(b"PK\x05\x06")
}

impl<'a> Archive<'a> {
    /// Opens a zip file without unpacking anything.
    ///
    /// # Errors
    /// If it is cut short, damaged, or has too many entries.
    pub(crate) fn open(bytes: &'a [u8]) -> Result<Self, Fault> {
        let zip = zip::ZipArchive::new(Cursor::new(bytes))
            .map_err(|error| Fault::Archive(format!("a zip file that is cut short or damaged: {error}")))?;
        if zip.len() > MOST_ENTRIES {
            let message = format!("a zip file of {} files; at most {MOST_ENTRIES} are read", zip.len());
            return Err(Fault::Archive(message));
        }
        // A name in no encoding that is known is no name that is looked for.
        let names = zip.file_names().flatten().map(|name| name.into_owned()).collect();
        let left = LARGEST_ARCHIVE.min((bytes.len() as u64).saturating_mul(RATIO).max(SMALL));
        Ok(Self { zip, names, left })
    }

    /// The paths inside.
    pub(crate) fn names(&self) -> &[String] {
        &self.names
    }

    /// Unpacks one file; what it says about its size is not believed.
    ///
    /// # Errors
    /// If it is not there, damaged, encrypted, or makes the whole too large.
    pub(crate) fn read(&mut self, name: &str) -> Result<Vec<u8>, Fault> {
        let damaged = |error: &dyn std::fmt::Display| {
            Fault::Archive(format!("{} in the zip file cannot be unpacked: {error}", shorten(name)))
        };
        let file = self.zip.by_name(name).map_err(|error| damaged(&error))?;
        let mut content = Vec::new();
        file.take(self.left + 1).read_to_end(&mut content).map_err(|error| damaged(&error))?;
        let unpacked = content.len() as u64;
        if unpacked > self.left {
            let message = format!(
                "{} in the zip file makes it hold more than {} bytes: at most {LARGEST_ARCHIVE}, and {RATIO} a byte of the file, \
                 are unpacked",
                shorten(name),
                self.left
            );
            return Err(Fault::Archive(message));
        }
        self.left -= unpacked;
        Ok(content)
    }
}
