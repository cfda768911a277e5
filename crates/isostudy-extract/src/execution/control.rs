//! How an extraction is run: on which threads, until when, and who is told. None of it changes the mesh.

use std::fmt;
use std::num::NonZeroUsize;
use std::sync::atomic::{AtomicBool, Ordering};

use crate::extraction::ExtractError;
use crate::memory::is_short;
use crate::settings::Execution;

/// Threads that somebody else has: a game's job system, a pool.
///
/// ```
/// use std::num::NonZeroUsize;
/// use isostudy_extract::Jobs;
///
/// /// The worst job system there is.
/// struct Alone;
///
/// impl Jobs for Alone {
///     fn threads(&self) -> NonZeroUsize {
///         NonZeroUsize::MIN
///     }
///     fn run(&self, job: &(dyn Fn(usize) + Sync)) {
///         (0..self.threads().get()).for_each(job);
///     }
/// }
/// ```
pub trait Jobs: Sync {
    /// How many jobs are worth while at a time.
    fn threads(&self) -> NonZeroUsize;

    /// Calls `job` once with each number below [`threads`](Self::threads), from any threads, in any order, and returns
    /// when all calls have returned. A job never waits for another one.
    fn run(&self, job: &(dyn Fn(usize) + Sync));
}

#[cfg(feature = "rayon")]
impl Jobs for rayon::ThreadPool {
    fn threads(&self) -> NonZeroUsize {
        NonZeroUsize::new(self.current_num_threads()).unwrap_or(NonZeroUsize::MIN)
    }

    fn run(&self, job: &(dyn Fn(usize) + Sync)) {
        self.scope(|scope| (0..self.current_num_threads()).for_each(|i| scope.spawn(move |_| job(i))));
    }
}

/// On which threads.
#[derive(Clone, Copy, Default)]
#[non_exhaustive]
pub enum Threads<'a> {
    /// On the thread that calls, and no other.
    #[default]
    Here,
    /// On so many, of which all but the one that calls are started and ended with each call.
    Scoped(NonZeroUsize),
    /// On threads that are there.
    Jobs(&'a dyn Jobs),
}

impl Threads<'_> {
    /// How many there are.
    pub(crate) fn count(self) -> usize {
        match self {
            Self::Here => 1,
            Self::Scoped(threads) => threads.get(),
            Self::Jobs(jobs) => jobs.threads().get(),
        }
    }
}

impl fmt::Debug for Threads<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Here => f.write_str("Here"),
            Self::Scoped(threads) => f.debug_tuple("Scoped").field(threads).finish(),
            Self::Jobs(jobs) => f.debug_tuple("Jobs").field(&jobs.threads()).finish(),
        }
    }
}

/// How an extraction is run. By default on the thread that calls, to the end.
///
/// ```
/// use std::sync::atomic::AtomicBool;
/// use isostudy_extract::Control;
///
/// let stop = AtomicBool::new(false);
/// let control = Control::default().with_cancel(&stop);
/// # let _ = control;
/// ```
#[derive(Clone, Copy, Default)]
#[non_exhaustive]
pub struct Control<'a> {
    /// On which threads.
    pub threads: Threads<'a>,
    /// When this is set, from any thread, the extraction ends soon with [`ExtractError::Cancelled`]. It is looked at
    /// before each layer of samples, of which a chunk of 32 cells has about 70; not while edges are collapsed.
    pub cancel: Option<&'a AtomicBool>,
    /// Told how many layers of how many are done, from any of the threads.
    pub progress: Option<&'a (dyn Fn(usize, usize) + Sync)>,
}

impl<'a> Control<'a> {
    /// The same on other threads.
    pub fn with_threads(self, threads: Threads<'a>) -> Self {
        Self { threads, ..self }
    }

    /// The same with a flag that ends it.
    pub fn with_cancel(self, cancel: &'a AtomicBool) -> Self {
        Self { cancel: Some(cancel), ..self }
    }

    /// The same with somebody to be told.
    pub fn with_progress(self, progress: &'a (dyn Fn(usize, usize) + Sync)) -> Self {
        Self { progress: Some(progress), ..self }
    }

    /// # Errors
    /// [`ExtractError::Cancelled`] if somebody said so, [`ExtractError::NoMemoryForMesh`] if the [watch](crate::watch_memory) did.
    pub(crate) fn check(&self) -> Result<(), ExtractError> {
        match self.cancel {
            Some(cancel) if cancel.load(Ordering::Relaxed) => Err(ExtractError::Cancelled),
            _ if is_short() => Err(ExtractError::NoMemoryForMesh),
            _ => Ok(()),
        }
    }
}

impl fmt::Debug for Control<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Control")
            .field("threads", &self.threads)
            .field("cancel", &self.cancel)
            .field("progress", &self.progress.map(|_| "..."))
            .finish()
    }
}

impl From<&Execution> for Control<'_> {
    /// On one thread the one that calls, otherwise on threads of its own.
    fn from(execution: &Execution) -> Self {
        let threads = match execution.threads {
            0 => std::thread::available_parallelism().unwrap_or(NonZeroUsize::MIN),
            threads => NonZeroUsize::new(threads).unwrap_or(NonZeroUsize::MIN),
        };
        Self::default().with_threads(match threads {
            NonZeroUsize::MIN => Threads::Here,
            threads => Threads::Scoped(threads),
        })
    }
}

impl<'a> From<&Control<'a>> for Control<'a> {
    fn from(control: &Control<'a>) -> Self {
        *control
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_thread_is_the_one_that_calls() {
        let of = |threads| Control::from(&Execution { threads }).threads;
        assert!(matches!(of(1), Threads::Here));
        assert_eq!(of(3).count(), 3);
        assert!(of(0).count() >= 1);
        assert_eq!(Control::default().threads.count(), 1);
    }
}
