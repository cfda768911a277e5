//! The one thread that has the journal.

use super::{Journal, JournalError};
use crate::machine::Machine;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::thread::JoinHandle;
use std::time::Duration;
use tokio::sync::oneshot;

/// Most changes in one batch.
const BATCH: usize = 512;
/// How often the folder is looked at when nobody answers.
const LOOK: Duration = Duration::from_millis(500);

/// What is said after the batch was committed.
type Reply = Box<dyn FnOnce() + Send>;
type Change = Box<dyn FnOnce(&mut Journal) -> rusqlite::Result<Reply> + Send>;
type Read = Box<dyn FnOnce(&Journal) -> rusqlite::Result<Reply> + Send>;

pub(crate) enum Work {
    Change(Change),
    Read(Read),
}

/// Why something was not done; nothing was changed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Unsaved {
    /// What is written now nobody will find again.
    #[error("the folder of answers was removed or replaced, so nothing can be saved until it is back")]
    Missing,
    /// SQLite or the disk said no.
    #[error("nothing could be saved, and the server's log says why; try again")]
    Disk,
    /// SQLite or the disk said no to a reader.
    #[error("the answers could not be read, and the server's log says why")]
    Unread,
}

/// A way to the journal, for any number of tasks.
#[derive(Debug, Clone)]
pub struct Handle {
    work: Sender<Work>,
    missing: Arc<AtomicBool>,
}

impl Handle {
    /// Does something with the journal, and returns what it gives once that is on disk.
    ///
    /// # Errors
    /// If it, or something in the same batch, could not be saved.
    pub async fn change<T: Send + 'static>(
        &self,
        work: impl FnOnce(&mut Journal) -> rusqlite::Result<T> + Send + 'static,
    ) -> Result<T, Unsaved> {
        let (say, said) = oneshot::channel();
        let work: Change = Box::new(move |journal| {
            let value = work(journal)?;
            Ok(Box::new(move || drop(say.send(value))))
        });
        let why = || if self.missing.load(Ordering::Acquire) { Unsaved::Missing } else { Unsaved::Disk };
        self.work.send(Work::Change(work)).map_err(|_| why())?;
        said.await.map_err(|_| why())
    }

    /// Looks something up, on a full disk and in files that were removed too: as long as they are open they can be read.
    ///
    /// # Errors
    /// If it could not be read.
    pub async fn read<T: Send + 'static>(
        &self,
        work: impl FnOnce(&Journal) -> rusqlite::Result<T> + Send + 'static,
    ) -> Result<T, Unsaved> {
        let (say, said) = oneshot::channel();
        let work: Read = Box::new(move |journal| {
            let value = work(journal)?;
            Ok(Box::new(move || drop(say.send(value))))
        });
        self.work.send(Work::Read(work)).map_err(|_| Unsaved::Unread)?;
        said.await.map_err(|_| Unsaved::Unread)
    }
}

/// The thread that has the journal.
#[derive(Debug)]
pub struct Keeper {
    thread: JoinHandle<Result<(), JournalError>>,
    ended: oneshot::Receiver<()>,
}

impl Keeper {
    /// Waits until the thread ends, for whatever reason.
    pub async fn ended(&mut self) {
        // Nothing is ever sent: the other side is dropped, by a panic too.
        drop((&mut self.ended).await);
    }

    /// Waits for the thread's end, which comes when all handles are gone.
    ///
    /// # Errors
    /// If it ended for another reason, after which nothing was acknowledged; or if files are gone, and perhaps what was in them.
    pub fn join(self) -> Result<(), JournalError> {
        self.thread.join().unwrap_or(Err(JournalError::Ended))
    }
}

/// Gives the journal to a thread, which ends, with everything on disk, when all handles are gone.
pub fn start(journal: Journal) -> (Handle, Keeper) {
    let (handle, desk) = desk(journal);
    let (alive, ended) = oneshot::channel();
    let thread = std::thread::spawn(move || {
        let _alive: oneshot::Sender<()> = alive;
        desk.keep()
    });
    (handle, Keeper { thread, ended })
}

/// Where work for a journal arrives, and is done.
pub(crate) struct Desk {
    journal: Journal,
    waiting: Receiver<Work>,
    trouble: Trouble,
}

pub(crate) fn desk(journal: Journal) -> (Handle, Desk) {
    let (work, waiting) = channel();
    let missing = Arc::new(AtomicBool::new(false));
    let machine = Arc::clone(&journal.machine);
    let trouble = Trouble {
        machine,
        missing: Arc::clone(&missing),
        unsaved: None,
        unread: None,
        seal: None,
        scrub: None,
    };
    (Handle { work, missing }, Desk { journal, waiting, trouble })
}

impl Desk {
    fn keep(mut self) -> Result<(), JournalError> {
        loop {
            match self.waiting.recv_timeout(LOOK) {
                Ok(first) => self.batch(Some(first))?,
                Err(RecvTimeoutError::Timeout) => self.batch(None)?,
                Err(RecvTimeoutError::Disconnected) => return self.close(),
            }
        }
    }

    /// Does what has arrived.
    pub(crate) fn batch(&mut self, first: Option<Work>) -> Result<(), JournalError> {
        let Self { journal, waiting, trouble } = self;
        let more = std::iter::from_fn(|| waiting.try_recv().ok());
        let (mut changes, mut reads) = (Vec::new(), Vec::new());
        for work in first.into_iter().chain(more).take(BATCH) {
            match work {
                Work::Change(change) => changes.push(change),
                Work::Read(read) => reads.push(read),
            }
        }
        if trouble.missing(journal) {
            // Whoever waits learns that nothing was saved since the replies are gone.
            changes.clear();
        }
        if !changes.is_empty() {
            change(journal, changes, trouble)?;
        } else if !trouble.missing.load(Ordering::Acquire) {
            trouble.scrubbed(journal.scrub());
        }
        for read in reads {
            match read(journal) {
                Ok(reply) => {
                    trouble.unread = None;
                    reply();
                }
                Err(error) => trouble.unread(&error),
            }
        }
        Ok(())
    }

    /// Nothing more can arrive.
    pub(crate) fn close(mut self) -> Result<(), JournalError> {
        let Self { journal, trouble, .. } = &mut self;
        if let Some(path) = journal.place.missing() {
            return Err(JournalError::Gone { path: path.into() });
        }
        trouble.seal(journal.seal().and_then(|()| journal.seal.sync()));
        Ok(())
    }
}

/// Makes the changes of a batch and answers them, or none.
fn change(journal: &mut Journal, batch: Vec<Change>, trouble: &mut Trouble) -> Result<(), JournalError> {
    let before = journal.held;
    match commit(journal, batch) {
        Ok(replies) => {
            if journal.held != before {
                trouble.saved();
            }
            trouble.seal(journal.seal());
            trouble.scrubbed(journal.scrub());
            replies.into_iter().for_each(|reply| reply());
            Ok(())
        }
        Err(error) => {
            trouble.unsaved(&error);
            // Memory must know no more than the disk does.
            journal.roll_back()
        }
    }
}

/// The identities first: an answer is never there without the identifiers of who gave it, and identifiers without an answer,
/// which a kill between the two leaves, are removed when the journal is opened.
fn commit(journal: &mut Journal, batch: Vec<Change>) -> rusqlite::Result<Vec<Reply>> {
    journal.answers.execute_batch("BEGIN IMMEDIATE")?;
    let replies = batch.into_iter().map(|work| work(journal)).collect::<rusqlite::Result<Vec<_>>>()?;
    let stopped = |error| rusqlite::Error::ToSqlConversionFailure(Box::new(error));
    journal.seal_less().map_err(stopped)?;
    if !journal.identities.is_autocommit() {
        journal.identities.execute_batch("COMMIT")?;
    }
    journal.answers.execute_batch("COMMIT")?;
    journal.waiting.arrived();
    Ok(replies)
}

/// What is wrong, so that each trouble is told once, and its end too.
struct Trouble {
    machine: Arc<dyn Machine>,
    missing: Arc<AtomicBool>,
    unsaved: Option<String>,
    unread: Option<String>,
    seal: Option<String>,
    scrub: Option<String>,
}

impl Trouble {
    /// Whether what is open is no longer what the folder shows.
    fn missing(&mut self, journal: &Journal) -> bool {
        let missing = journal.place.missing();
        let was = self.missing.swap(missing.is_some(), Ordering::AcqRel);
        match missing {
            Some(path) if !was => self.machine.note(format!(
                "{}: removed or replaced while the server runs; no answer is taken until it is back. Before you stop the server, \
                 download the answers from the researcher's page",
                path.display()
            )),
            None if was => self.machine.note("the folder of answers is back; answers are taken again".into()),
            _ => {}
        }
        missing.is_some()
    }

    fn unsaved(&mut self, error: &rusqlite::Error) {
        let error = error.to_string();
        if self.unsaved.as_ref() != Some(&error) {
            self.machine.note(format!("answers cannot be saved: {error}"));
            self.unsaved = Some(error);
        }
    }

    fn unread(&mut self, error: &rusqlite::Error) {
        let error = error.to_string();
        if self.unread.as_ref() != Some(&error) {
            self.machine.note(format!("answers cannot be read: {error}"));
            self.unread = Some(error);
        }
    }

    fn saved(&mut self) {
        if self.unsaved.take().is_some() {
            self.machine.note("answers are saved again".into());
        }
    }

    fn scrubbed(&mut self, clean: rusqlite::Result<bool>) {
        let error = match clean {
            Ok(true) => None,
            Ok(false) => Some("somebody reads an older state".to_owned()),
            Err(error) => Some(error.to_string()),
        };
        if let Some(error) = error.as_ref().filter(|_| self.scrub != error) {
            self.machine.note(format!(
                "deleted answers may still be in the files, which is tried again every half second: {error}"
            ));
        }
        self.scrub = error;
    }

    fn seal(&mut self, written: std::io::Result<()>) {
        let error = written.err().map(|error| error.to_string());
        if let Some(error) = error.as_ref().filter(|_| self.seal != error) {
            self.machine.note(format!("the count of answers could not be written: {error}"));
        }
        self.seal = error;
    }
}
