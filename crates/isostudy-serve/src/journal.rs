//! Participants and their answers on disk: `answers.sqlite`, and `identities.sqlite` for what a panel says of them.
//!
//! Changes are made in batches: what arrives while one is being synced goes into the next, and each is answered after its
//! batch was committed (write-ahead log, `synchronous = FULL`). A process that is killed loses nothing that was answered, nor does
//! a machine without power; `server/simulation` tries it at every operation of the disk.
//! Where a file is gone or was cut between two runs, `count` tells: it holds how much there was.
//!
//! Somebody is written down with the first answer; until then a form dealt is known in memory alone. All files, and the folder
//! if it is made here, are their owner's alone. One process changes them at a time (`lock`); others may read meanwhile.

mod about;
mod cameras;
mod change;
mod copy;
mod departures;
mod error;
mod files;
mod place;
mod read;
mod seal;
mod summary;
mod thread;
mod waiting;
mod withdraw;

#[cfg(test)]
mod tests;

pub(crate) use about::Taken;
pub use departures::Departures;
pub use error::JournalError;
#[cfg(test)]
pub(crate) use files::kept_on;
pub use files::{Kept, kept};
pub use seal::Held;
pub use summary::{OptionCount, Summary};
#[cfg(test)]
pub(crate) use thread::{Desk, desk};
pub use thread::{Handle, Keeper, Unsaved, start};

use crate::export::Given;
use crate::machine::{Machine, Owned, System};
use crate::record::{About, Answer, Choice, Identifiers, Refusal, check, first_place};
use copy::Copied;
use isostudy_design::config::AnswerKind;
use isostudy_design::forms::{AboutEntry, FormEntry, FormFile, Quotas};
use place::Place;
use rusqlite::{Connection, params};
use seal::{Seal, Sealed};
use serde::Serialize;
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use waiting::{Newcomer, Waiting};

/// Whoever has sent nothing for so long is taken to have given up; the form is dealt again.
const GIVEN_UP_MS: i64 = 2 * 3_600_000;
/// Most participants of a study.
const MOST: usize = 100_000;

/// What to do where a folder holds less than it did.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Loss {
    /// Do not go on.
    Refuse,
    /// Go on with what there is.
    Accept,
}

/// What somebody was asked, with what this person has answered so far, in the same order.
pub type Asked<'a> = (&'a FormEntry, &'a [Choice]);

/// Chooses what somebody is asked: of everybody who has answered something, of the form that is planned, and of how many have begun
/// before. Practice stays as it is planned, and so does the number of questions.
#[derive(Clone)]
pub struct Chooser(pub Arc<Choose>);

/// What a [`Chooser`] does.
pub type Choose = dyn Fn(&[Asked<'_>], &FormEntry, usize) -> FormEntry + Send + Sync;

impl std::fmt::Debug for Chooser {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Chooser")
    }
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

struct Person {
    number: i64,
    name: String,
    form: usize,
    /// What was chosen for this person, in the place of what the form plans.
    chosen: Option<FormEntry>,
    choices: Vec<Choice>,
    last_ms: i64,
    finished: bool,
    about: About,
}

/// The journal of one study; one process has it at a time.
pub struct Journal {
    machine: Arc<dyn Machine>,
    folder: PathBuf,
    answers: Connection,
    identities: Connection,
    /// The answers that can be given.
    kinds: Vec<AnswerKind>,
    forms: Vec<FormEntry>,
    languages: Vec<String>,
    questions: Vec<AboutEntry>,
    quotas: Quotas,
    /// Whether answers may be changed.
    go_back: bool,
    people: Vec<Person>,
    by_token: HashMap<String, usize>,
    by_identifiers: HashMap<Identifiers, usize>,
    waiting: Waiting,
    /// What chooses questions, in a study that asks each person where an answer tells most.
    chooser: Option<Chooser>,
    held: Held,
    uncounted: bool,
    /// Whether the files may hold what was deleted.
    remnants: bool,
    seal: Seal,
    place: Place,
    /// Held as long as the journal is.
    _lock: Arc<dyn Owned>,
}

impl std::hash::Hash for Identifiers {
    fn hash<H: std::hash::Hasher>(&self, state: &mut H) {
        self.named().hash(state);
    }
}

impl Journal {
    /// Opens the journal in a folder, which is made if it is not there. `digest` tells one version of the forms from another,
    /// whatever their number.
    ///
    /// # Errors
    /// [`JournalError`].
    pub fn open(folder: &Path, file: &FormFile, digest: &str, loss: Loss) -> Result<Self, JournalError> {
        Self::open_on(Arc::new(System), folder, file, digest, loss)
    }

    pub(crate) fn open_on(
        machine: Arc<dyn Machine>,
        folder: &Path,
        file: &FormFile,
        digest: &str,
        loss: Loss,
    ) -> Result<Self, JournalError> {
        let failed = |source| JournalError::Folder { path: folder.into(), source };
        let database = |source| files::error(folder, source);
        let lock: Arc<dyn Owned> = files::lock(&*machine, folder)?.into();
        let sealed = Sealed::read(&*machine, folder).map_err(failed)?;
        // Whatever SQLite opens it changes: it makes files, begins logs anew and throws away those of a database that is gone. A
        // folder that is refused stays as it is, so a copy is looked at first.
        let whole = {
            let copy = Copied::of(&*machine, folder, &[files::ANSWERS, files::IDENTITIES])?;
            let (copied, _) = Self::at(&machine, copy.folder(), folder, file, digest, &lock)?;
            compare(folder, copied.held, sealed, loss)?
        };
        let (mut journal, nobodys) = Self::at(&machine, folder, folder, file, digest, &lock)?;
        journal.uncounted = sealed == Sealed::Nothing && journal.held != Held::default();
        files::may_tidy(&journal.answers)
            .and_then(|()| files::may_tidy(&journal.identities))
            .map_err(database)?;
        files::settle(&*journal.machine, folder, files::ANSWERS, &journal.answers)?;
        files::settle(&*journal.machine, folder, files::IDENTITIES, &journal.identities)?;
        // After a loss they may be all that is left of somebody.
        if whole {
            journal.forget(&nobodys).map_err(database)?;
        }
        journal.scrub_left()?;
        journal.seal().and_then(|()| journal.seal.sync()).map_err(failed)?;
        // The name of `count` too: without it nobody could tell what is missing.
        journal.machine.sync_folder(folder).map_err(failed)?;
        Ok(journal)
    }

    /// Opens and reads the files in `from`, which messages call `folder`. Returns names with identifiers and without an answer too.
    fn at(
        machine: &Arc<dyn Machine>,
        from: &Path,
        folder: &Path,
        file: &FormFile,
        digest: &str,
        lock: &Arc<dyn Owned>,
    ) -> Result<(Self, Vec<String>), JournalError> {
        let failed = |source| JournalError::Folder { path: folder.into(), source };
        let database = |source| files::error(folder, source);
        let files::Opened { answers, identities } = files::open(&**machine, from, folder)?;
        let seal = Seal::open(&**machine, from).map_err(failed)?;
        match files::study(&answers).map_err(database)? {
            None => {
                let add = "INSERT INTO study VALUES (?1, ?2)";
                answers.execute(add, params![file.study, digest]).map_err(database)?;
            }
            Some((found, version)) if found != file.study || version != digest => {
                return Err(JournalError::OtherStudy { path: folder.into(), found, version });
            }
            Some(_) => {}
        }
        let mut journal = Self {
            machine: Arc::clone(machine),
            folder: folder.into(),
            answers,
            identities,
            kinds: file.answers(),
            forms: file.forms.clone(),
            languages: file.languages.clone(),
            questions: file.about.clone(),
            quotas: Quotas::default(),
            go_back: file.go_back,
            people: Vec::new(),
            by_token: HashMap::new(),
            by_identifiers: HashMap::new(),
            waiting: Waiting::default(),
            chooser: None,
            held: Held::default(),
            uncounted: false,
            remnants: false,
            seal,
            place: Place::default(),
            _lock: Arc::clone(lock),
        };
        let nobodys = journal.read().map_err(database)?;
        // Whatever SQLite makes beside its files it has made by now.
        journal.place = Place::of(from);
        let planned = journal.forms.len();
        if let Some(form) =
            journal.people.iter().map(|person| person.form).max().filter(|form| *form > planned)
        {
            return Err(JournalError::FewerForms { path: folder.into(), form, planned });
        }
        Ok((journal, nobodys))
    }

    /// How much there is on disk.
    pub fn held(&self) -> Held {
        self.held
    }

    /// Whether there were answers and no count of them at the start: nobody can tell whether all are there.
    pub fn is_uncounted(&self) -> bool {
        self.uncounted
    }

    /// Takes no more people than this from now on.
    pub fn limit(&mut self, quotas: Quotas) {
        self.quotas = quotas;
    }

    /// Chooses questions of newcomers by this from now on.
    pub fn choose_by(&mut self, chooser: Chooser) {
        self.chooser = Some(chooser);
    }

    /// What somebody is asked.
    fn entry<'a>(&'a self, form: usize, chosen: &'a Option<FormEntry>) -> &'a FormEntry {
        chosen.as_ref().unwrap_or(&self.forms[form - 1])
    }

    /// What is chosen for somebody new, before the first answer.
    fn chosen(&self, form: usize) -> Option<FormEntry> {
        let chooser = self.chooser.as_ref()?;
        let others: Vec<Asked<'_>> =
            self.people.iter().map(|of| (self.entry(of.form, &of.chosen), &of.choices[..])).collect();
        let before = self.people.len() + self.waiting.iter().count();
        Some((chooser.0)(&others, &self.forms[form - 1], before))
    }

    /// Writes down how much there will be, where that is less than there was: before it is deleted, so that a machine that stops in
    /// between does not take for lost what somebody wanted gone.
    fn seal_less(&mut self) -> std::io::Result<()> {
        let less = self.seal.less(self.held);
        less.map_or(Ok(()), |less| self.seal.write(less).and_then(|()| self.seal.sync()))
    }

    /// Writes down how much there is, for whoever opens the folder next.
    fn seal(&mut self) -> std::io::Result<()> {
        self.seal.write(self.held)
    }

    /// Takes back what was not committed, and reads again what was; whoever is not there still waits.
    fn roll_back(&mut self) -> Result<(), JournalError> {
        for database in [&self.answers, &self.identities] {
            if !database.is_autocommit() {
                drop(database.execute_batch("ROLLBACK"));
            }
        }
        self.waiting.turned_back();
        // Identifiers that were committed stay, although their answers were not: of those the log may hold all but the sync, and a
        // kill brings them back. Whoever sends an answer again writes them again; the next start removes those of nobody.
        self.read().map(drop).map_err(|e| files::error(&self.folder, e))
    }

    /// Removes the identifiers of those who have answered nothing.
    fn forget(&self, names: &[String]) -> rusqlite::Result<()> {
        if names.is_empty() {
            return Ok(());
        }
        let transaction = self.identities.unchecked_transaction()?;
        for name in names {
            transaction.execute("DELETE FROM identities WHERE participant = ?1", [name])?;
            transaction.execute("DELETE FROM about WHERE participant = ?1", [name])?;
        }
        transaction.commit()
    }

    /// Deals one of the forms with the fewest participants to somebody new, which one by chance, so that forms do not tell
    /// who came when; whom a panel has sent before gets the same form again.
    pub(crate) fn begin_in(
        &mut self,
        language: Option<String>,
        given: Identifiers,
        now_ms: i64,
    ) -> Result<Dealt, Refusal> {
        given.check()?;
        // Without a session of the panel's own, two people could be taken for one.
        let known = given.prolific_pid.is_some() && given.session_id.is_some();
        if let Some(&person) = self.by_identifiers.get(&given).filter(|_| known) {
            let token = self.by_token.iter().find(|(_, of)| **of == person).map(|(token, _)| token.clone());
            return Ok(self.dealt(person, token.expect("everybody has one")));
        }
        if let Some(newcomer) = self.waiting.iter().find(|one| known && one.identifiers == given) {
            return Ok(self.welcome(newcomer));
        }
        if self.people.len() >= MOST || self.is_closed(now_ms) {
            return Err(Refusal::Full);
        }
        let mut load = vec![0_usize; self.forms.len()];
        let mut count = |form: usize, last_ms: i64, finished: bool| {
            load[form - 1] += usize::from(finished || now_ms - last_ms < GIVEN_UP_MS);
        };
        self.people.iter().for_each(|person| count(person.form, person.last_ms, person.finished));
        self.waiting.iter().for_each(|newcomer| count(newcomer.form, newcomer.since_ms, false));
        let least = load.iter().min().copied().unwrap_or_default();
        if self.quotas.per_form.is_some_and(|most| least >= most as usize) {
            return Err(Refusal::Full);
        }
        let free: Vec<usize> = (1..=load.len()).filter(|form| load[form - 1] == least).collect();
        let form = free[self.random_index(free.len())];
        let newcomer = Newcomer {
            name: hex(&*self.machine, 8),
            token: hex(&*self.machine, 16),
            form,
            chosen: self.chosen(form),
            identifiers: given,
            language: language.filter(|lang| self.languages.contains(lang)),
            about: About::new(),
            since_ms: now_ms,
        };
        let dealt = self.welcome(&newcomer);
        self.waiting.add(newcomer)?;
        Ok(dealt)
    }

    /// As [`begin_in`](Self::begin_in), in no language that is known.
    #[cfg(test)]
    pub(crate) fn begin(&mut self, given: Identifiers, now_ms: i64) -> Result<Dealt, Refusal> {
        self.begin_in(None, given, now_ms)
    }

    /// One of so many, by chance.
    fn random_index(&self, count: usize) -> usize {
        let mut number = [0; 8];
        self.machine.random(&mut number);
        // Some are likelier than others by less than one in 10^14.
        (u64::from_ne_bytes(number) % count as u64) as usize
    }

    /// Where somebody stands.
    pub(crate) fn state(&self, token: &str) -> Result<Dealt, Refusal> {
        match self.by_token.get(token) {
            Some(&person) => Ok(self.dealt(person, token.into())),
            None => self.waiting.by_token(token).map(|one| self.welcome(one)).ok_or(Refusal::UnknownToken),
        }
    }

    /// Somebody who waits; whoever is written down is found without looking through them.
    fn newcomer(&self, token: &str) -> Option<&Newcomer> {
        if self.by_token.contains_key(token) { None } else { self.waiting.by_token(token) }
    }

    fn welcome(&self, newcomer: &Newcomer) -> Dealt {
        let Newcomer { name, token, form, chosen, .. } = newcomer;
        let form = self.entry(*form, chosen).clone();
        Dealt { participant: name.clone(), token: token.clone(), form, answered: 0 }
    }

    /// Writes down somebody who waits: a first answer has come.
    fn write_down(&mut self, token: &str) -> rusqlite::Result<()> {
        let Some(newcomer) = self.waiting.take(token).cloned() else { return Ok(()) };
        let Newcomer { name, token, form, chosen, identifiers, language, about, since_ms } = &newcomer;
        if !identifiers.is_empty() || !about.is_empty() {
            self.change_identities()?;
        }
        for (id, value) in about {
            self.add_about(name, id, value)?;
        }
        if !identifiers.is_empty() {
            // There already if the answers' part of a batch failed.
            let add = "INSERT OR REPLACE INTO identities VALUES (?1, ?2, ?3, ?4)";
            let Identifiers { prolific_pid, study_id, session_id } = identifiers;
            self.identities.execute(add, params![name, prolific_pid, study_id, session_id])?;
        }
        self.answers.execute(
            "INSERT INTO participants (name, token, form, started_ms, last_ms) VALUES (?1, ?2, ?3, ?4, ?4)",
            params![name, token, *form as i64, since_ms],
        )?;
        let number = self.answers.last_insert_rowid();
        if let Some(language) = language {
            self.answers
                .execute("INSERT OR REPLACE INTO languages VALUES (?1, ?2)", params![number, language])?;
        }
        if let Some(chosen) = chosen {
            let questions = serde_json::to_string(&chosen.questions).expect("words alone");
            self.answers
                .execute("INSERT OR REPLACE INTO chosen VALUES (?1, ?2)", params![number, questions])?;
        }
        let place = self.people.len();
        self.people.push(Person {
            number,
            name: name.clone(),
            form: *form,
            chosen: chosen.clone(),
            choices: Vec::new(),
            last_ms: *since_ms,
            finished: false,
            about: about.clone(),
        });
        self.by_token.insert(token.clone(), place);
        self.held.participants += 1;
        if !identifiers.is_empty() {
            self.held.identities += 1;
            self.by_identifiers.insert(identifiers.clone(), place);
        }
        Ok(())
    }

    fn dealt(&self, person: usize, token: String) -> Dealt {
        let Person { name, form, chosen, choices, .. } = &self.people[person];
        let (form, answered) = (self.entry(*form, chosen).clone(), choices.len() as u32);
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
        if let Some(newcomer) = self.newcomer(token) {
            let form = self.entry(newcomer.form, &newcomer.chosen);
            if let Err(refusal) = check(answer, &self.kinds, form, 0) {
                return Ok(Err(refusal));
            }
            if self.people.len() >= MOST {
                return Ok(Err(Refusal::Full));
            }
            self.write_down(token)?;
        }
        let Some(&place) = self.by_token.get(token) else { return Ok(Err(Refusal::UnknownToken)) };
        let person = &self.people[place];
        let form = self.entry(person.form, &person.chosen);
        if let Err(refusal) = check(answer, &self.kinds, form, person.choices.len() as u32) {
            return Ok(Err(refusal));
        }
        if ((answer.order - first_place(form)) as usize) < person.choices.len() {
            return self.again(place, answer, now_ms);
        }
        let values =
            params![person.number, answer.order, answer.stimulus, answer.choice.code(), answer.rt_ms, now_ms];
        self.answers
            .prepare_cached("INSERT INTO answers VALUES (?1, ?2, ?3, ?4, ?5, ?6)")?
            .execute(values)?;
        self.keep_screen(person.number, answer)?;
        self.keep_change(person.number, answer)?;
        let touch = "UPDATE participants SET last_ms = ?2 WHERE number = ?1";
        self.answers.prepare_cached(touch)?.execute(params![person.number, now_ms])?;
        let person = &mut self.people[place];
        person.choices.push(answer.choice);
        person.last_ms = now_ms;
        self.held.answers += 1;
        Ok(Ok(()))
    }

    /// Notes that everything has been answered.
    ///
    /// # Errors
    /// If SQLite fails.
    pub(crate) fn finish(&mut self, token: &str, now_ms: i64) -> rusqlite::Result<Result<(), Refusal>> {
        if let Some(newcomer) = self.newcomer(token) {
            let form = self.entry(newcomer.form, &newcomer.chosen);
            return Ok(Err(Refusal::Unfinished(form.questions.len() as u32)));
        }
        let Some(&person) = self.by_token.get(token) else { return Ok(Err(Refusal::UnknownToken)) };
        let of = &self.people[person];
        let left = self.entry(of.form, &of.chosen).questions.len() - of.choices.len();
        if left > 0 {
            return Ok(Err(Refusal::Unfinished(left as u32)));
        }
        let person = &mut self.people[person];
        if !person.finished {
            let finish = "UPDATE participants SET finished_ms = ?2, last_ms = ?2 WHERE number = ?1";
            self.answers.execute(finish, params![person.number, now_ms])?;
            person.finished = true;
        }
        Ok(Ok(()))
    }

    /// Every answer, participant by participant in the order in which they began to answer.
    ///
    /// # Errors
    /// If SQLite fails.
    pub fn given(&self) -> rusqlite::Result<Vec<Given>> {
        files::given(&self.answers)
    }

    /// Names of participants and what a panel says of them, in the order of names.
    ///
    /// # Errors
    /// If SQLite fails.
    pub fn identities(&self) -> rusqlite::Result<Vec<(String, Identifiers)>> {
        files::identities(&self.identities)
    }
}

/// Whether there is as much as there was; an error where there is less and the loss is not accepted.
fn compare(folder: &Path, found: Held, sealed: Sealed, loss: Loss) -> Result<bool, JournalError> {
    let path = folder.into();
    match sealed {
        Sealed::Held(before) if found.lacks(&before) && loss == Loss::Refuse => {
            Err(JournalError::Lost { path, found, before })
        }
        Sealed::Damaged if loss == Loss::Refuse => Err(JournalError::Damaged { path, found }),
        Sealed::Held(before) => Ok(!found.lacks(&before)),
        Sealed::Nothing | Sealed::Damaged => Ok(false),
    }
}

/// So many random bytes, 16 at most, as text: names and tokens that nobody can guess.
///
/// # Panics
/// If the system has no random numbers, in which case nothing here is safe.
pub fn random_hex(bytes: usize) -> String {
    hex(&System, bytes)
}

fn hex(machine: &dyn Machine, bytes: usize) -> String {
    let mut buffer = [0; 16];
    machine.random(&mut buffer[..bytes]);
    buffer[..bytes].iter().map(|byte| format!("{byte:02x}")).collect()
}
