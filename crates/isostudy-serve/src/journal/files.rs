//! The files: `answers.sqlite`, `identities.sqlite`, and `lock`.

use super::copy::Copied;
use super::departures::{Departure, Departures};
use super::{JournalError, seal};
use crate::cameras::Tracked;
use crate::export::Given;
use crate::machine::{Machine, Owned, System};
use crate::record::{About, Answer, Choice, Identifiers};
use rusqlite::config::DbConfig;
use rusqlite::{Connection, OpenFlags};
use std::collections::BTreeMap;
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
        PRIMARY KEY (participant, place)) WITHOUT ROWID;
    CREATE TABLE IF NOT EXISTS changes (
        participant INTEGER NOT NULL REFERENCES participants, place INTEGER NOT NULL, number INTEGER NOT NULL,
        PRIMARY KEY (participant, place)) WITHOUT ROWID;
    CREATE TABLE IF NOT EXISTS cameras (
        participant INTEGER NOT NULL REFERENCES participants, place INTEGER NOT NULL, track TEXT NOT NULL,
        PRIMARY KEY (participant, place)) WITHOUT ROWID;
    CREATE TABLE IF NOT EXISTS chosen (
        participant INTEGER PRIMARY KEY REFERENCES participants, questions TEXT NOT NULL);
    CREATE TABLE IF NOT EXISTS languages (
        participant INTEGER PRIMARY KEY REFERENCES participants, language TEXT NOT NULL);
    CREATE TABLE IF NOT EXISTS departures (kind TEXT PRIMARY KEY, number INTEGER NOT NULL) WITHOUT ROWID;";

const IDENTITIES_SCHEMA: &str = "
    CREATE TABLE IF NOT EXISTS identities (
        participant TEXT PRIMARY KEY, prolific_pid TEXT, study_id TEXT, session_id TEXT) WITHOUT ROWID;
    CREATE TABLE IF NOT EXISTS about (
        participant TEXT NOT NULL, question TEXT NOT NULL, value TEXT NOT NULL, PRIMARY KEY (participant, question))
        WITHOUT ROWID;";

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
            // What is deleted is written over, and nothing of it is put into files of SQLite's own.
            connection.pragma_update(None, "secure_delete", true)?;
            connection.pragma_update(None, "temp_store", "MEMORY")?;
            // One sync for all tables of a new file.
            connection.execute_batch(&format!("BEGIN; {schema} COMMIT;"))?;
            Ok(connection)
        };
        open().map_err(|source| error(folder, source))
    };
    Ok(Opened {
        answers: database(ANSWERS, ANSWERS_SCHEMA)?,
        identities: database(IDENTITIES, IDENTITIES_SCHEMA)?,
    })
}

/// Code names of what was chosen for people to be asked, by the numbers of these people. What cannot be read is nobody's.
pub(super) fn chosen(answers: &Connection) -> rusqlite::Result<Vec<(i64, Vec<String>)>> {
    let mut statement = answers.prepare("SELECT participant, questions FROM chosen")?;
    let rows = statement.query_map([], |row| Ok((row.get::<_, i64>(0)?, row.get::<_, String>(1)?)))?;
    let read = |(number, questions): (i64, String)| Some((number, serde_json::from_str(&questions).ok()?));
    Ok(rows.collect::<rusqlite::Result<Vec<_>>>()?.into_iter().filter_map(read).collect())
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
    let of = |table: &str, column: &str| -> rusqlite::Result<String> {
        Ok(if has_table(answers, table)? {
            format!(
                "(SELECT {column} FROM {table} t WHERE t.participant = a.participant AND t.place = a.place)"
            )
        } else {
            "NULL".into()
        })
    };
    let (screens, changes) = (of("screens", "screen")?, of("changes", "number")?);
    let mut statement = answers.prepare(&format!(
        "SELECT name, form, place, stimulus, choice, rt_ms, {screens}, {changes}
         FROM answers a JOIN participants ON participant = number ORDER BY participant, place"
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
            answer: Answer {
                order,
                stimulus,
                choice,
                rt_ms,
                screen: screen.and_then(Result::ok),
                change: row.get::<_, Option<u32>>(7)?.unwrap_or(0),
            },
        });
    }
    Ok(given)
}

/// From where models were looked at, in the order of [`given`].
pub(super) fn cameras(answers: &Connection) -> rusqlite::Result<Vec<Tracked>> {
    if !has_table(answers, "cameras")? {
        return Ok(Vec::new());
    }
    let mut statement = answers.prepare(
        "SELECT name, form, c.place, stimulus, track FROM cameras c JOIN participants ON c.participant = number
         JOIN answers a ON a.participant = c.participant AND a.place = c.place ORDER BY c.participant, c.place",
    )?;
    let mut rows = statement.query([])?;
    let mut found = Vec::new();
    while let Some(row) = rows.next()? {
        let Ok(track) = serde_json::from_str(&row.get::<_, String>(4)?) else { continue };
        let form = row.get::<_, i64>(1)? as usize;
        let (participant, order, stimulus) = (row.get(0)?, row.get(2)?, row.get(3)?);
        found.push(Tracked { participant, form, order, stimulus, track });
    }
    Ok(found)
}

/// Whether a database has a table: folders of earlier versions lack some, and what only reads them makes none.
fn has_table(database: &Connection, table: &str) -> rusqlite::Result<bool> {
    let known = "SELECT count(*) FROM sqlite_master WHERE type = 'table' AND name = ?1";
    Ok(database.query_row(known, [table], |row| row.get::<_, i64>(0))? > 0)
}

/// The languages of participants, by their names.
pub(super) fn languages(answers: &Connection) -> rusqlite::Result<BTreeMap<String, String>> {
    if !has_table(answers, "languages")? {
        return Ok(BTreeMap::new());
    }
    let all = "SELECT name, language FROM languages JOIN participants ON participant = number";
    let mut statement = answers.prepare(all)?;
    statement.query_map([], |row| Ok((row.get(0)?, row.get(1)?)))?.collect()
}

/// How many have left of whom nothing is kept.
pub(super) fn departures(answers: &Connection) -> rusqlite::Result<Departures> {
    if !has_table(answers, "departures")? {
        return Ok(Departures::default());
    }
    let mut statement = answers.prepare("SELECT kind, number FROM departures")?;
    let found: BTreeMap<String, u64> = statement
        .query_map([], |row| Ok((row.get(0)?, row.get::<_, i64>(1)?.unsigned_abs())))?
        .collect::<rusqlite::Result<_>>()?;
    let [withdrawn, screened_out, full] =
        Departure::ALL.map(|kind| found.get(kind.name()).copied().unwrap_or(0));
    Ok(Departures { withdrawn, screened_out, full })
}

/// Answers about people, by their names.
pub(super) fn about(identities: &Connection) -> rusqlite::Result<BTreeMap<String, About>> {
    let mut all: BTreeMap<String, About> = BTreeMap::new();
    if !has_table(identities, "about")? {
        return Ok(all);
    }
    let mut statement = identities.prepare("SELECT participant, question, value FROM about")?;
    let mut rows = statement.query([])?;
    while let Some(row) = rows.next()? {
        all.entry(row.get(0)?).or_default().insert(row.get(1)?, row.get(2)?);
    }
    Ok(all)
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
    /// From where models were looked at, in the same order.
    pub cameras: Vec<Tracked>,
    /// Answers about people, by their names.
    pub about: BTreeMap<String, About>,
    /// The languages of people, by their names.
    pub languages: BTreeMap<String, String>,
    /// How many have left of whom nothing is kept.
    pub departures: Departures,
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
    let (found, mut kept) = match read(machine, folder) {
        // SQLite reads a log only where it may write beside it.
        Err(error) if cannot_write(&error) => {
            let copy = Copied::of(machine, folder, &[ANSWERS, IDENTITIES])?;
            read(machine, copy.folder())
        }
        found => found,
    }
    .map_err(|source| error(folder, source))?;
    // Who gave no answer that was kept is nobody.
    kept.about.retain(|name, _| kept.given.iter().any(|given| given.participant == *name));
    match found {
        Some((found, version)) if found != study => {
            Err(JournalError::OtherStudy { path: folder.into(), found, version })
        }
        found => {
            kept.digest = found.map(|(_, digest)| digest).unwrap_or_default();
            Ok(kept)
        }
    }
}

type Found = (Option<(String, String)>, Kept);

fn read(machine: &dyn Machine, folder: &Path) -> rusqlite::Result<Found> {
    let open = |name: &str| -> rusqlite::Result<Connection> {
        let flags = OpenFlags::SQLITE_OPEN_READ_WRITE | OpenFlags::SQLITE_OPEN_NO_MUTEX;
        let connection = Connection::open_with_flags_and_vfs(folder.join(name), flags, machine.vfs())?;
        connection.busy_timeout(Duration::from_secs(5))?;
        connection.pragma_update(None, "query_only", true)?;
        Ok(connection)
    };
    // What is said about people may be given without their answers, or not at all.
    let about = match machine.read(&folder.join(IDENTITIES), 1) {
        Ok(begin) if !begin.is_empty() => about(&open(IDENTITIES)?)?,
        _ => BTreeMap::new(),
    };
    let mut connection = open(ANSWERS)?;
    // One moment of a file that a server may be writing to.
    let moment = connection.transaction()?;
    let (given, cameras) = (given(&moment)?, cameras(&moment)?);
    let (languages, departures) = (languages(&moment)?, departures(&moment)?);
    Ok((study(&moment)?, Kept { digest: String::new(), given, cameras, about, languages, departures }))
}

fn cannot_write(error: &rusqlite::Error) -> bool {
    use rusqlite::ErrorCode::{CannotOpen, PermissionDenied, ReadOnly};
    matches!(error.sqlite_error_code(), Some(CannotOpen | PermissionDenied | ReadOnly))
}
