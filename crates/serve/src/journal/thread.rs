//! The one thread that has the journal.

use super::Journal;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread::JoinHandle;
use tokio::sync::oneshot;

/// Most changes in one batch.
const BATCH: usize = 512;

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

/// Gives the journal to a thread, which ends, with everything on disk, when all handles are gone.
pub fn start(journal: Journal) -> (Handle, JoinHandle<()>) {
    let (work, waiting) = channel();
    (Handle { work }, std::thread::spawn(move || keep(journal, &waiting)))
}

fn keep(mut journal: Journal, waiting: &Receiver<Work>) {
    while let Ok(first) = waiting.recv() {
        let batch = std::iter::once(first).chain(std::iter::from_fn(|| waiting.try_recv().ok())).take(BATCH);
        match commit(&mut journal, batch.collect()) {
            Ok(replies) => replies.into_iter().for_each(|reply| reply()),
            Err(error) => {
                // Whoever waits learns of it since the replies are gone. Memory must know no more than the disk does.
                eprintln!("answers could not be saved: {error}");
                if !journal.answers.is_autocommit() {
                    drop(journal.answers.execute_batch("ROLLBACK"));
                }
                if let Err(error) = journal.load() {
                    eprintln!("the answers cannot be read any more: {error}");
                    return;
                }
            }
        }
    }
}

fn commit(journal: &mut Journal, batch: Vec<Work>) -> rusqlite::Result<Vec<Reply>> {
    journal.answers.execute_batch("BEGIN IMMEDIATE")?;
    let replies = batch.into_iter().map(|work| work(journal)).collect::<rusqlite::Result<Vec<_>>>()?;
    journal.answers.execute_batch("COMMIT")?;
    journal.waiting.arrived();
    Ok(replies)
}
