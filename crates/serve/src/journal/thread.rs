//! The one thread that has the journal.

use super::{Journal, JournalError};
use crate::log;
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
type Work = Box<dyn FnOnce(&mut Journal) -> rusqlite::Result<Reply> + Send>;

/// The disk said no; nothing was changed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("the answer could not be saved; try again")]
pub struct Unsaved;

/// A way to the journal, for any number of tasks.
#[derive(Debug, Clone)]
pub struct Handle {
    work: Sender<Work>,
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
        let work: Work = Box::new(move |journal| {
            let value = work(journal)?;
            Ok(Box::new(move || drop(say.send(value))))
        });
        self.work.send(work).map_err(|_| Unsaved)?;
        said.await.map_err(|_| Unsaved)
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
    /// If it ended for another reason, after which nothing was acknowledged.
    pub fn join(self) -> Result<(), JournalError> {
        self.thread.join().unwrap_or(Err(JournalError::Ended))
    }
}

/// Gives the journal to a thread, which ends, with everything on disk, when all handles are gone.
pub fn start(journal: Journal) -> (Handle, Keeper) {
    let (work, waiting) = channel();
    let (alive, ended) = oneshot::channel();
    let thread = std::thread::spawn(move || {
        let _alive: oneshot::Sender<()> = alive;
        keep(journal, &waiting)
    });
    (Handle { work }, Keeper { thread, ended })
}

fn keep(mut journal: Journal, waiting: &Receiver<Work>) -> Result<(), JournalError> {
    let mut trouble = Trouble::default();
    loop {
        let first = match waiting.recv_timeout(LOOK) {
            Ok(first) => Some(first),
            Err(RecvTimeoutError::Timeout) => None,
            Err(RecvTimeoutError::Disconnected) => {
                trouble.seal(journal.seal().and_then(|()| journal.seal.sync()));
                return Ok(());
            }
        };
        let more = std::iter::from_fn(|| waiting.try_recv().ok());
        let batch: Vec<Work> = first.into_iter().chain(more).take(BATCH).collect();
        // Whoever waits learns that nothing was saved since the replies are gone.
        if trouble.missing(&journal) || batch.is_empty() {
            continue;
        }
        let before = journal.held;
        match commit(&mut journal, batch) {
            Ok(replies) => {
                if journal.held != before {
                    trouble.saved();
                }
                trouble.seal(journal.seal());
                replies.into_iter().for_each(|reply| reply());
            }
            Err(error) => {
                trouble.unsaved(&error);
                // Memory must know no more than the disk does.
                journal.roll_back()?;
            }
        }
    }
}

/// The identities first: an answer is never there without the identifiers of who gave it, and identifiers without an answer,
/// which a kill between the two leaves, are removed when the journal is opened.
fn commit(journal: &mut Journal, batch: Vec<Work>) -> rusqlite::Result<Vec<Reply>> {
    journal.answers.execute_batch("BEGIN IMMEDIATE")?;
    let replies = batch.into_iter().map(|work| work(journal)).collect::<rusqlite::Result<Vec<_>>>()?;
    if !journal.identities.is_autocommit() {
        journal.identities.execute_batch("COMMIT")?;
    }
    journal.answers.execute_batch("COMMIT")?;
    journal.waiting.arrived();
    Ok(replies)
}

/// What is wrong, so that each trouble is told once, and its end too.
#[derive(Default)]
struct Trouble {
    missing: bool,
    unsaved: Option<String>,
    seal: Option<String>,
}

impl Trouble {
    /// Whether what is open is no longer what the folder shows.
    fn missing(&mut self, journal: &Journal) -> bool {
        let missing = journal.place.missing();
        match missing {
            Some(path) if !self.missing => log::note(format!(
                "{}: removed or replaced while the server runs; no answer is taken until it is back",
                path.display()
            )),
            None if self.missing => log::note("the folder of answers is back; answers are taken again"),
            _ => {}
        }
        self.missing = missing.is_some();
        self.missing
    }

    fn unsaved(&mut self, error: &rusqlite::Error) {
        let error = error.to_string();
        if self.unsaved.as_ref() != Some(&error) {
            log::note(format!("answers cannot be saved: {error}"));
            self.unsaved = Some(error);
        }
    }

    fn saved(&mut self) {
        if self.unsaved.take().is_some() {
            log::note("answers are saved again");
        }
    }

    fn seal(&mut self, written: std::io::Result<()>) {
        let error = written.err().map(|error| error.to_string());
        if let Some(error) = error.as_ref().filter(|_| self.seal != error) {
            log::note(format!("the count of answers could not be written: {error}"));
        }
        self.seal = error;
    }
}
