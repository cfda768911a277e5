//! Why a folder of answers cannot be used.

use super::Held;
use std::path::PathBuf;

/// Why the journal cannot be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum JournalError {
    /// The folder cannot be made.
    #[error("{path}: {source}")]
    Folder {
        /// Which.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// SQLite says no.
    #[error("{path}: {source}")]
    Database {
        /// The folder.
        path: PathBuf,
        /// Why.
        source: rusqlite::Error,
    },
    /// Answers of another study, or of another version of it, are there.
    #[error(
        "{path}: holds answers to study {found}, version {version}, not to this one; keep them and name another folder"
    )]
    OtherStudy {
        /// The folder.
        path: PathBuf,
        /// Id of the study there.
        found: String,
        /// Digest of its forms.
        version: String,
    },
    /// Somebody was dealt a form that there no longer is.
    #[error(
        "{path}: holds answers to form {form}, and the study plans {planned} participants; plan no fewer than before"
    )]
    FewerForms {
        /// The folder.
        path: PathBuf,
        /// Which.
        form: usize,
        /// How many there are now.
        planned: usize,
    },
    /// Another server has it.
    #[error("{path}: in use by another process, such as a running server")]
    InUse {
        /// The folder.
        path: PathBuf,
    },
    /// There is less than there was.
    #[error(
        "{path}: holds {found}, and held {before} when a server last wrote to it. A file was removed, cut or put back from an \
         older copy. Keep a copy of the folder and look for a better one, or accept the loss with --accept-loss"
    )]
    Lost {
        /// The folder.
        path: PathBuf,
        /// What there is.
        found: Held,
        /// What there was.
        before: Held,
    },
    /// Files that were open when the server stopped are not where they were.
    #[error(
        "{path}: removed or replaced while the server ran, and not back when it stopped. Answers that were acknowledged may be \
         lost. Look for the folder where it was moved to, or for a copy of it"
    )]
    Gone {
        /// The first of them.
        path: PathBuf,
    },
    /// What tells how much there was cannot be read.
    #[error(
        "{path}: the file `count` is damaged, so nobody can tell whether answers are missing; {found} are there. If that is \
         right, start with --accept-loss"
    )]
    Damaged {
        /// The folder.
        path: PathBuf,
        /// What there is.
        found: Held,
    },
    /// The thread that keeps the answers has ended, which is a fault of the program.
    #[error(
        "the thread that saves answers has ended; what was acknowledged is saved, start the server again"
    )]
    Ended,
}
