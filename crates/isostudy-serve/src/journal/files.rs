//! The files: `answers.sqlite`, `identities.sqlite`, and `lock`.

use super::copy::Copied;
use super::{JournalError, seal};
use crate::export::Given;
use crate::machine::{Machine, Owned, System};
use crate::record::{Answer, Choice, Identifiers};
use rusqlite::config::DbConfig;
use rusqlite::{Connection, OpenFlags};
use std::path::Path;
use std::time::Duration;

pub(super) const ANSWERS: &str = "answers.sqlite";
pub(super) const IDENTITIES: &str = "identities.sqlite";
pub(super) const LOCK: &str = "lock";

const ANSWERS_SCHEMA: &str = "
    CREATE TABLE IF NOT EXISTS study (name TEXT NOT NULL, digest TEXT NOT NULL);
    CREATE TABLE IF NOT EXISTS participants (
        number INTEGER PRIMARY KEY, name TEXT NOT NULL UNIQUE, token TEXT NOT NULL UNIQUE, form INTEGER NOT NULL,
        started_ms INTEGER NOT NULL, last_ms INTEGER NOT NULL, finished_ms INTEGER);
    CREATE TABLE IF NOT EXISTS answers (
        participant INTEGER NOT NULL REFERENCES participants, place INTEGER NOT NULL, stimulus TEXT NOT NULL,
        choice TEXT NOT NULL, rt_ms INTEGER NOT NULL, received_ms INTEGER NOT NULL, PRIMARY KEY (participant, place))
        WITHOUT ROWID;
    CREATE TABLE IF NOT EXISTS screens (
        participant INTEGER NOT NULL REFERENCES participants, place INTEGER NOT NULL, screen TEXT NOT NULL,
        PRIMARY KEY (participant, place)) WITHOUT ROWID;";

const IDENTITIES_SCHEMA: &str = "
    CREATE TABLE IF NOT EXISTS identities (
        participant TEXT PRIMARY KEY, prolific_pid TEXT, study_id TEXT, session_id TEXT) WITHOUT ROWID;";

/// Makes a folder if it is not there, and takes it for this process: two servers on one file would each know half of the
/// participants.
pub(super) fn lock(machine: &dyn Machine, folder: &Path) -> Result<Box<dyn Owned>, JournalError> {
    let failed = |source| JournalError::Folder { path: folder.into(), source };
    if std::fs::metadata(folder).is_ok_and(|found| !found.is_dir()) {
        return Err(failed(std::io::Error::other("not a folder")));
    }
    machine.make_folders(folder).map_err(failed)?;
    regular(folder)?;
    let lock = machine.open(&folder.join(LOCK)).map_err(failed)?;
    // A program that was started while the folder was open inherits the lock for the moment until it runs.
    for _ in 0..TRIES {
        if lock.try_lock() {
            return Ok(lock);
        }
        std::thread::sleep(BETWEEN_TRIES);
    }
    Err(JournalError::InUse { path: folder.into() })
}

/// How often a lock is tried before somebody else has it, and the pause between.
const TRIES: usize = 20;
const BETWEEN_TRIES: Duration = Duration::from_millis(10);

/// Sees to it that whatever of a journal is there is a file: a pipe would be waited for without end.
fn regular(folder: &Path) -> Result<(), JournalError> {
    let beside = |name: &str| ["", "-wal", "-shm", "-journal"].map(|end| format!("{name}{end}"));
    let others = [LOCK, seal::NAME].map(String::from);
    for name in beside(ANSWERS).into_iter().chain(beside(IDENTITIES)).chain(others) {
        let path = folder.join(name);
        if std::fs::metadata(&path).is_ok_and(|found| !found.is_file()) {
            return Err(JournalError::Folder { path, source: std::io::Error::other("not a file") });
        }
    }
    Ok(())
}

/// The databases of a journal.
pub(super) struct Opened {
    pub(super) answers: Connection,
    pub(super) identities: Connection,
}

/// Opens the databases in a folder, which messages call `folder`, and makes what is not there. Until [`may_tidy`] logs are not
/// removed.
pub(super) fn open(machine: &dyn Machine, from: &Path, folder: &Path) -> Result<Opened, JournalError> {
    let failed = |source| JournalError::Folder { path: folder.into(), source };
    let database = |name: &str, schema: &str| {
        let path = from.join(name);
        // What SQLite puts beside it gets the same permissions.
        machine.open(&path).map_err(failed)?;
        let open = || -> rusqlite::Result<Connection> {
            let connection = Connection::open_with_flags_and_vfs(&path, OpenFlags::default(), machine.vfs())?;
            connection.busy_timeout(Duration::from_millis(500))?;
            connection.set_db_config(DbConfig::SQLITE_DBCONFIG_NO_CKPT_ON_CLOSE, true)?;
            connection.pragma_update(None, "journal_mode", "WAL")?;
            connection.pragma_update(None, "synchronous", "FULL")?;
            connection.execute_batch(schema)?;
            Ok(connection)
        };
        open().map_err(|source| error(folder, source))
    };
    Ok(Opened {
        answers: database(ANSWERS, ANSWERS_SCHEMA)?,
        identities: database(IDENTITIES, IDENTITIES_SCHEMA)?,
    })
}

/// Nothing is missing: the log may be merged into the database, and removed, when it is closed.
pub(super) fn may_tidy(database: &Connection) -> rusqlite::Result<()> {
    database.set_db_config(DbConfig::SQLITE_DBCONFIG_NO_CKPT_ON_CLOSE, false).map(drop)
}

/// Has on disk what a log holds. A server that was killed may have written to it and not synced it: that is read again, and told
/// to whoever asks, and the power may go after that.
pub(super) fn settle(
    machine: &dyn Machine,
    folder: &Path,
    name: &str,
    database: &Connection,
) -> Result<(), JournalError> {
    // The log alone is not enough after a sync that failed: the system may take its bytes for written.
    let merged = database.query_row("PRAGMA wal_checkpoint(TRUNCATE)", [], |_| Ok(()));
    if let Err(source) = merged {
        // Then the log stays, so that answers can be read on a full disk too.
        if source.sqlite_error_code() != Some(rusqlite::ErrorCode::DiskFull) {
            return Err(error(folder, source));
        }
    }
    let log = folder.join(format!("{name}-wal"));
    let synced = machine.open(&log).and_then(|log| log.sync());
    synced.map_err(|source| JournalError::Folder { path: log, source })
}

pub(super) fn error(folder: &Path, source: rusqlite::Error) -> JournalError {
    let path = folder.into();
    match source.sqlite_error_code() {
        Some(rusqlite::ErrorCode::DatabaseBusy | rusqlite::ErrorCode::DatabaseLocked) => {
            JournalError::InUse { path }
        }
        _ => JournalError::Database { path, source },
    }
}

/// Id and digest of the study that is there.
pub(super) fn study(answers: &Connection) -> rusqlite::Result<Option<(String, String)>> {
    let found = answers.query_row("SELECT name, digest FROM study", [], |row| Ok((row.get(0)?, row.get(1)?)));
    match found {
        Err(rusqlite::Error::QueryReturnedNoRows) => Ok(None),
        found => found.map(Some),
    }
}

pub(super) fn given(answers: &Connection) -> rusqlite::Result<Vec<Given>> {
    // Folders of earlier versions have no screens, and what only reads them makes none.
    let known = "SELECT count(*) FROM sqlite_master WHERE type = 'table' AND name = 'screens'";
    let screens = match answers.query_row(known, [], |row| row.get::<_, i64>(0))? {
        0 => "NULL",
        _ => "(SELECT screen FROM screens s WHERE s.participant = a.participant AND s.place = a.place)",
    };
    let mut statement = answers.prepare(&format!(
        "SELECT name, form, place, stimulus, choice, rt_ms, {screens} FROM answers a JOIN participants ON participant = number
         ORDER BY participant, place"
    ))?;
    let mut rows = statement.query([])?;
    let mut given = Vec::new();
    while let Some(row) = rows.next()? {
        let choice: String = row.get(4)?;
        let Some(choice) = Choice::of_code(&choice) else { continue };
        let (order, stimulus, rt_ms) = (row.get(2)?, row.get(3)?, row.get(5)?);
        let form = row.get::<_, i64>(1)? as usize;
        let screen: Option<String> = row.get(6)?;
        let screen = screen.map(|text| serde_json::from_str(&text));
        given.push(Given {
            participant: row.get(0)?,
            form,
            answer: Answer { order, stimulus, choice, rt_ms, screen: screen.and_then(Result::ok) },
        });
    }
    Ok(given)
}

pub(super) fn identities(connection: &Connection) -> rusqlite::Result<Vec<(String, Identifiers)>> {
    let all = "SELECT participant, prolific_pid, study_id, session_id FROM identities ORDER BY participant";
    let mut statement = connection.prepare(all)?;
    let rows = statement.query_map([], |row| {
        let of = Identifiers { prolific_pid: row.get(1)?, study_id: row.get(2)?, session_id: row.get(3)? };
        Ok((row.get(0)?, of))
    })?;
    rows.collect()
}

/// What a folder holds.
#[derive(Debug, Clone, PartialEq)]
pub struct Kept {
    /// Digest of the forms when the first answer came.
    pub digest: String,
    /// Every answer, participant by participant in the order in which they began to answer.
    pub given: Vec<Given>,
}

/// The answers to a study in a folder, whether or not a server is at work there, on media that cannot be written to as well.
/// Nothing is changed.
///
/// # Errors
/// [`JournalError`]; [`JournalError::OtherStudy`] only for another study, not for another version of this one.
pub fn kept(folder: &Path, study: &str) -> Result<Kept, JournalError> {
    kept_on(&System, folder, study)
}

pub(crate) fn kept_on(machine: &dyn Machine, folder: &Path, study: &str) -> Result<Kept, JournalError> {
    regular(folder)?;
    let (found, given) = match read(machine, folder) {
        // SQLite reads a log only where it may write beside it.
        Err(error) if cannot_write(&error) => {
            let copy = Copied::of(machine, folder, &[ANSWERS])?;
            read(machine, copy.folder())
        }
        found => found,
    }
    .map_err(|source| error(folder, source))?;
    match found {
        Some((found, version)) if found != study => {
            Err(JournalError::OtherStudy { path: folder.into(), found, version })
        }
        found => Ok(Kept { digest: found.map(|(_, digest)| digest).unwrap_or_default(), given }),
    }
}

type Found = (Option<(String, String)>, Vec<Given>);

fn read(machine: &dyn Machine, folder: &Path) -> rusqlite::Result<Found> {
    let flags = OpenFlags::SQLITE_OPEN_READ_WRITE | OpenFlags::SQLITE_OPEN_NO_MUTEX;
    let mut connection = Connection::open_with_flags_and_vfs(folder.join(ANSWERS), flags, machine.vfs())?;
    connection.busy_timeout(Duration::from_secs(5))?;
    connection.pragma_update(None, "query_only", true)?;
    // One moment of a file that a server may be writing to.
    let moment = connection.transaction()?;
    Ok((study(&moment)?, given(&moment)?))
}

fn cannot_write(error: &rusqlite::Error) -> bool {
    use rusqlite::ErrorCode::{CannotOpen, PermissionDenied, ReadOnly};
    matches!(error.sqlite_error_code(), Some(CannotOpen | PermissionDenied | ReadOnly))
}
