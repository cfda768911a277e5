//! Participants and their answers on disk: `answers.sqlite`, and `identities.sqlite` for what a panel says of them.
//!
//! Changes are made in batches: what arrives while one is being synced goes into the next, and each is answered after its
//! batch was committed (write-ahead log, `synchronous = FULL`). A process that is killed loses nothing that was answered.

mod thread;

#[cfg(test)]
mod tests;

pub use thread::{Handle, Unsaved, start};

use crate::export::Given;
use crate::record::{Answer, Choice, Identifiers, Refusal, check, first_place};
use design::forms::{FormEntry, FormFile};
use rusqlite::{Connection, params};
use serde::Serialize;
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Whoever has sent nothing for so long is taken to have given up; the form is dealt again.
const GIVEN_UP_MS: i64 = 2 * 3_600_000;
/// Most participants of a study.
const MOST: usize = 100_000;

const SCHEMA: &str = "
    CREATE TABLE IF NOT EXISTS study (name TEXT NOT NULL, digest TEXT NOT NULL);
    CREATE TABLE IF NOT EXISTS participants (
        number INTEGER PRIMARY KEY, name TEXT NOT NULL UNIQUE, token TEXT NOT NULL UNIQUE, form INTEGER NOT NULL,
        started_ms INTEGER NOT NULL, last_ms INTEGER NOT NULL, finished_ms INTEGER);
    CREATE TABLE IF NOT EXISTS answers (
        participant INTEGER NOT NULL REFERENCES participants, place INTEGER NOT NULL, stimulus TEXT NOT NULL,
        choice TEXT NOT NULL, rt_ms INTEGER NOT NULL, received_ms INTEGER NOT NULL, PRIMARY KEY (participant, place))
        WITHOUT ROWID;";

const IDENTITIES: &str = "
    CREATE TABLE IF NOT EXISTS identities (
        participant TEXT PRIMARY KEY, prolific_pid TEXT, study_id TEXT, session_id TEXT) WITHOUT ROWID;";

/// Why the journal cannot be used.
#[derive(Debug, thiserror::Error)]
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
    /// Another server has it.
    #[error("{path}: in use by another process, such as a running server")]
    InUse {
        /// The folder.
        path: PathBuf,
    },
}

/// What a participant is dealt.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Dealt {
    /// The participant's name in the answers.
    pub participant: String,
    /// What proves to be the participant; never exported.
    pub token: String,
    /// The form.
    pub form: FormEntry,
    /// How many questions have been answered already.
    pub answered: u32,
}

/// How a study stands, without a word on what was chosen.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Summary {
    /// Participants who began.
    pub started: usize,
    /// Who answered all questions.
    pub finished: usize,
    /// Who have neither finished nor been silent for two hours.
    pub answering: usize,
    /// By form: number, who began and did not give up, who finished.
    pub forms: Vec<[usize; 3]>,
    /// Answers.
    pub answers: u64,
    /// Answers in each of the last 60 minutes, the newest last.
    pub per_minute: Vec<u64>,
    /// By place in the form: place, answers, median time in milliseconds.
    pub places: Vec<(u32, u64, f64)>,
}

struct Person {
    number: i64,
    name: String,
    form: usize,
    choices: Vec<Choice>,
    last_ms: i64,
    finished: bool,
}

/// The journal of one study; one process has it at a time.
pub struct Journal {
    folder: PathBuf,
    answers: Connection,
    identities: Connection,
    forms: Vec<FormEntry>,
    people: Vec<Person>,
    by_token: HashMap<String, usize>,
    by_identifiers: HashMap<Identifiers, usize>,
}

impl std::hash::Hash for Identifiers {
    fn hash<H: std::hash::Hasher>(&self, state: &mut H) {
        self.named().hash(state);
    }
}

impl Journal {
    /// Opens the journal in a folder, which is made if it is not there. `digest` is that of the forms.
    ///
    /// # Errors
    /// [`JournalError`].
    pub fn open(folder: &Path, file: &FormFile, digest: &str) -> Result<Self, JournalError> {
        std::fs::create_dir_all(folder)
            .map_err(|source| JournalError::Folder { path: folder.into(), source })?;
        let answers = open(folder, "answers.sqlite", SCHEMA)?;
        let identities = open(folder, "identities.sqlite", IDENTITIES)?;
        let mut journal = Self {
            folder: folder.into(),
            answers,
            identities,
            forms: file.forms.clone(),
            people: Vec::new(),
            by_token: HashMap::new(),
            by_identifiers: HashMap::new(),
        };
        let known = journal.answers.query_row("SELECT name, digest FROM study", [], |row| {
            Ok((row.get::<_, String>(0)?, row.get::<_, String>(1)?))
        });
        match known {
            Err(rusqlite::Error::QueryReturnedNoRows) => {
                let add = "INSERT INTO study VALUES (?1, ?2)";
                journal.answers.execute(add, params![file.study, digest]).map_err(|e| error(folder, e))?;
            }
            Err(source) => return Err(error(folder, source)),
            Ok((found, version)) if found != file.study || version != digest => {
                return Err(JournalError::OtherStudy { path: folder.into(), found, version });
            }
            Ok(_) => {}
        }
        journal.load()?;
        Ok(journal)
    }

    /// Reads what is on disk, and nothing else, into memory.
    fn load(&mut self) -> Result<(), JournalError> {
        self.read().map_err(|e| error(&self.folder, e))
    }

    fn read(&mut self) -> rusqlite::Result<()> {
        self.people.clear();
        self.by_token.clear();
        self.by_identifiers.clear();
        let mut by_number = HashMap::new();
        let all = "SELECT number, name, token, form, last_ms, finished_ms FROM participants ORDER BY number";
        let mut statement = self.answers.prepare(all)?;
        let mut rows = statement.query([])?;
        while let Some(row) = rows.next()? {
            let (number, form): (i64, i64) = (row.get(0)?, row.get(3)?);
            let finished = row.get::<_, Option<i64>>(5)?.is_some();
            let person = Person {
                number,
                name: row.get(1)?,
                form: form as usize,
                choices: Vec::new(),
                last_ms: row.get(4)?,
                finished,
            };
            by_number.insert(number, self.people.len());
            self.by_token.insert(row.get(2)?, self.people.len());
            self.people.push(person);
        }
        let mut statement =
            self.answers.prepare("SELECT participant, choice FROM answers ORDER BY participant, place")?;
        let mut rows = statement.query([])?;
        while let Some(row) = rows.next()? {
            let choice: String = row.get(1)?;
            let of = by_number.get(&row.get::<_, i64>(0)?);
            if let (Some(&person), Some(choice)) = (of, Choice::of_code(&choice)) {
                self.people[person].choices.push(choice);
            }
        }
        let by_name: HashMap<&str, usize> =
            self.people.iter().enumerate().map(|(i, person)| (person.name.as_str(), i)).collect();
        let mut found = HashMap::new();
        for (name, identifiers) in identities(&self.identities)? {
            if let Some(&person) = by_name.get(name.as_str()) {
                found.insert(identifiers, person);
            }
        }
        self.by_identifiers = found;
        Ok(())
    }

    /// Deals a form to somebody new; whom a panel has sent before gets the same form again. Not yet on disk when this
    /// returns: see [`Handle::change`].
    ///
    /// # Errors
    /// If SQLite fails.
    pub(crate) fn begin(
        &mut self,
        given: Identifiers,
        now_ms: i64,
    ) -> rusqlite::Result<Result<Dealt, Refusal>> {
        if let Err(refusal) = given.check() {
            return Ok(Err(refusal));
        }
        // Without a session of the panel's own, two people could be taken for one.
        let known = given.prolific_pid.is_some() && given.session_id.is_some();
        if let Some(&person) = self.by_identifiers.get(&given).filter(|_| known) {
            let token = self.by_token.iter().find(|(_, of)| **of == person).map(|(token, _)| token.clone());
            return Ok(Ok(self.dealt(person, token.expect("everybody has one"))));
        }
        if self.people.len() == MOST {
            return Ok(Err(Refusal::Full));
        }
        let mut load = vec![0_usize; self.forms.len()];
        for person in &self.people {
            if person.finished || now_ms - person.last_ms < GIVEN_UP_MS {
                load[person.form - 1] += 1;
            }
        }
        // The first of those with the fewest.
        let form = load.iter().enumerate().min_by_key(|&(_, load)| load).map_or(1, |(form, _)| form + 1);
        let (name, token) = (random_hex(8), random_hex(16));
        if !given.is_empty() {
            let add = "INSERT INTO identities VALUES (?1, ?2, ?3, ?4)";
            let values = params![name, given.prolific_pid, given.study_id, given.session_id];
            self.identities.execute(add, values)?;
        }
        self.answers.execute(
            "INSERT INTO participants (name, token, form, started_ms, last_ms) VALUES (?1, ?2, ?3, ?4, ?4)",
            params![name, token, form as i64, now_ms],
        )?;
        let person = Person {
            number: self.answers.last_insert_rowid(),
            name,
            form,
            choices: Vec::new(),
            last_ms: now_ms,
            finished: false,
        };
        let place = self.people.len();
        self.people.push(person);
        self.by_token.insert(token.clone(), place);
        if known {
            self.by_identifiers.insert(given, place);
        }
        Ok(Ok(self.dealt(place, token)))
    }

    fn dealt(&self, person: usize, token: String) -> Dealt {
        let Person { name, form, choices, .. } = &self.people[person];
        let (form, answered) = (self.forms[form - 1].clone(), choices.len() as u32);
        Dealt { participant: name.clone(), token, form, answered }
    }

    /// Keeps an answer; one that is kept already is kept.
    ///
    /// # Errors
    /// If SQLite fails.
    pub(crate) fn answer(
        &mut self,
        token: &str,
        answer: &Answer,
        now_ms: i64,
    ) -> rusqlite::Result<Result<(), Refusal>> {
        let Some(&person) = self.by_token.get(token) else { return Ok(Err(Refusal::UnknownToken)) };
        let person = &mut self.people[person];
        let form = &self.forms[person.form - 1];
        if let Err(refusal) = check(answer, form, person.choices.len() as u32) {
            return Ok(Err(refusal));
        }
        let place = (answer.order - first_place(form)) as usize;
        if let Some(&kept) = person.choices.get(place) {
            return Ok(if kept == answer.choice { Ok(()) } else { Err(Refusal::Answered(answer.order)) });
        }
        let values =
            params![person.number, answer.order, answer.stimulus, answer.choice.code(), answer.rt_ms, now_ms];
        self.answers
            .prepare_cached("INSERT INTO answers VALUES (?1, ?2, ?3, ?4, ?5, ?6)")?
            .execute(values)?;
        let touch = "UPDATE participants SET last_ms = ?2 WHERE number = ?1";
        self.answers.prepare_cached(touch)?.execute(params![person.number, now_ms])?;
        person.choices.push(answer.choice);
        person.last_ms = now_ms;
        Ok(Ok(()))
    }

    /// Notes that everything has been answered.
    ///
    /// # Errors
    /// If SQLite fails.
    pub(crate) fn finish(&mut self, token: &str, now_ms: i64) -> rusqlite::Result<Result<(), Refusal>> {
        let Some(&person) = self.by_token.get(token) else { return Ok(Err(Refusal::UnknownToken)) };
        let person = &mut self.people[person];
        let left = self.forms[person.form - 1].questions.len() - person.choices.len();
        if left > 0 {
            return Ok(Err(Refusal::Unfinished(left as u32)));
        }
        if !person.finished {
            let finish = "UPDATE participants SET finished_ms = ?2, last_ms = ?2 WHERE number = ?1";
            self.answers.execute(finish, params![person.number, now_ms])?;
            person.finished = true;
        }
        Ok(Ok(()))
    }

    /// Every answer, participant by participant in the order in which they began.
    ///
    /// # Errors
    /// If SQLite fails.
    pub fn given(&self) -> rusqlite::Result<Vec<Given>> {
        let mut statement = self.answers.prepare(
            "SELECT name, form, place, stimulus, choice, rt_ms FROM answers JOIN participants ON participant = number
             ORDER BY participant, place",
        )?;
        let mut rows = statement.query([])?;
        let mut given = Vec::new();
        while let Some(row) = rows.next()? {
            let choice: String = row.get(4)?;
            let Some(choice) = Choice::of_code(&choice) else { continue };
            let (order, stimulus, rt_ms) = (row.get(2)?, row.get(3)?, row.get(5)?);
            let form = row.get::<_, i64>(1)? as usize;
            given.push(Given {
                participant: row.get(0)?,
                form,
                answer: Answer { order, stimulus, choice, rt_ms },
            });
        }
        Ok(given)
    }

    /// Names of participants and what a panel says of them, in the order of names.
    ///
    /// # Errors
    /// If SQLite fails.
    pub fn identities(&self) -> rusqlite::Result<Vec<(String, Identifiers)>> {
        identities(&self.identities)
    }

    /// How the study stands.
    ///
    /// # Errors
    /// If SQLite fails.
    pub fn summary(&self, now_ms: i64) -> rusqlite::Result<Summary> {
        let mut forms: Vec<[usize; 3]> = (1..=self.forms.len()).map(|form| [form, 0, 0]).collect();
        let mut answering = 0;
        for person in &self.people {
            let here = now_ms - person.last_ms < GIVEN_UP_MS;
            answering += usize::from(here && !person.finished);
            forms[person.form - 1][1] += usize::from(here || person.finished);
            forms[person.form - 1][2] += usize::from(person.finished);
        }
        let mut per_minute = vec![0; 60];
        let mut times: HashMap<u32, Vec<u32>> = HashMap::new();
        let mut statement = self.answers.prepare("SELECT place, rt_ms, received_ms FROM answers")?;
        let mut rows = statement.query([])?;
        let mut answers = 0;
        while let Some(row) = rows.next()? {
            answers += 1;
            times.entry(row.get(0)?).or_default().push(row.get(1)?);
            let ago = (now_ms - row.get::<_, i64>(2)?).max(0) / 60_000;
            if ago < 60 {
                per_minute[59 - ago as usize] += 1;
            }
        }
        let mut places: Vec<(u32, u64, f64)> =
            times.into_iter().map(|(place, times)| (place, times.len() as u64, median(times))).collect();
        places.sort_by_key(|&(place, ..)| place);
        let finished = self.people.iter().filter(|person| person.finished).count();
        Ok(Summary { started: self.people.len(), finished, answering, forms, answers, per_minute, places })
    }
}

fn median(mut times: Vec<u32>) -> f64 {
    times.sort_unstable();
    let half = times.len() / 2;
    if times.len() % 2 == 1 {
        f64::from(times[half])
    } else {
        (f64::from(times[half - 1]) + f64::from(times[half])) / 2.0
    }
}

fn identities(connection: &Connection) -> rusqlite::Result<Vec<(String, Identifiers)>> {
    let all = "SELECT participant, prolific_pid, study_id, session_id FROM identities ORDER BY participant";
    let mut statement = connection.prepare(all)?;
    let rows = statement.query_map([], |row| {
        let of = Identifiers { prolific_pid: row.get(1)?, study_id: row.get(2)?, session_id: row.get(3)? };
        Ok((row.get(0)?, of))
    })?;
    rows.collect()
}

fn open(folder: &Path, name: &str, schema: &str) -> Result<Connection, JournalError> {
    let begin = || -> rusqlite::Result<Connection> {
        let connection = Connection::open(folder.join(name))?;
        connection.busy_timeout(Duration::from_millis(500))?;
        // One process: two servers on one file would each know half of the participants.
        connection.pragma_update(None, "locking_mode", "EXCLUSIVE")?;
        connection.pragma_update(None, "journal_mode", "WAL")?;
        connection.pragma_update(None, "synchronous", "FULL")?;
        connection.execute_batch(schema)?;
        Ok(connection)
    };
    begin().map_err(|e| error(folder, e))
}

fn error(folder: &Path, source: rusqlite::Error) -> JournalError {
    let path = folder.into();
    match source.sqlite_error_code() {
        Some(rusqlite::ErrorCode::DatabaseBusy | rusqlite::ErrorCode::DatabaseLocked) => {
            JournalError::InUse { path }
        }
        _ => JournalError::Database { path, source },
    }
}

/// So many random bytes, 16 at most, as text: names and tokens that nobody can guess.
///
/// # Panics
/// If the system has no random numbers, in which case nothing here is safe.
pub fn random_hex(bytes: usize) -> String {
    let mut buffer = [0; 16];
    getrandom::fill(&mut buffer[..bytes]).expect("the system gives random numbers");
    buffer[..bytes].iter().map(|byte| format!("{byte:02x}")).collect()
}
