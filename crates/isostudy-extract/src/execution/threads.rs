//! Work handed out to threads: each takes what comes next, and which one that is does not show.

use std::sync::Mutex;

#[cfg(feature = "rayon")]
use rayon::prelude::*;

use crate::execution::control::Threads;
use crate::extraction::ExtractError;
use crate::settings::Execution;

/// Whether a program can have more threads than one: not in a module of WebAssembly without atomics.
pub(crate) const ARE_THERE: bool = cfg!(not(all(target_family = "wasm", not(target_feature = "atomics"))));

/// The fewest items that are worth a thread.
pub(crate) const SHARE: usize = 256;

/// Calls `work` with each item and its number, on some threads.
pub(crate) fn for_each_on_threads<T: Send>(
    threads: Threads,
    items: &mut [T],
    work: impl Fn(usize, &mut T) + Sync,
) -> Result<(), ExtractError> {
    in_parts(threads, items, SHARE, |part, items| {
        items.iter_mut().enumerate().for_each(|(i, item)| work(SHARE * part + i, item));
        Ok(())
    })
}

/// Calls `work` with each part of so many items and its number, handed out one by one to as many threads as have some.
pub(crate) fn in_parts<T: Send>(
    threads: Threads,
    items: &mut [T],
    each: usize,
    work: impl Fn(usize, &mut [T]) -> Result<(), ExtractError> + Sync,
) -> Result<(), ExtractError> {
    let most = if ARE_THERE { threads.count().min(items.len().div_ceil(each)) } else { 1 };
    let parts = items.chunks_mut(each).enumerate();
    if most <= 1 {
        return parts.into_iter().try_for_each(|(part, items)| work(part, items));
    }
    let left = Mutex::new(parts);
    let mut turns = vec![(); most];
    on_each(threads, &mut turns, |_, ()| {
        loop {
            let next = left.lock().expect("nothing panics with it").next();
            let Some((part, items)) = next else { return Ok(()) };
            work(part, items)?;
        }
    })
}

/// What comes of each item, in their order; on the threads of [`on_threads`].
pub(crate) fn mapped<T: Sync, R: Send>(items: &[T], of: impl Fn(&T) -> R + Sync + Send) -> Vec<R> {
    #[cfg(feature = "rayon")]
    return items.par_iter().map(of).collect();
    #[cfg(not(feature = "rayon"))]
    return items.iter().map(of).collect();
}

/// Runs `work` where rayon has as many threads as `execution` asks for, and no more than `most`. Without the feature
/// `rayon`, on the thread that calls.
pub(crate) fn on_threads<R: Send>(
    execution: &Execution,
    most: usize,
    work: impl FnOnce() -> R + Send,
) -> Result<R, ExtractError> {
    #[cfg(not(feature = "rayon"))]
    {
        let _ = (execution, most);
        Ok(work())
    }
    #[cfg(feature = "rayon")]
    {
        if execution.threads == 0 {
            return Ok(work());
        }
        let threads = execution.threads.min(most);
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        let pool = pool.map_err(|error| ExtractError::Threads { threads, reason: error.to_string() })?;
        Ok(pool.install(work))
    }
}

/// Does `work` with each item, on as many threads, which are started for it, or as jobs. Each thread takes the next item that is left.
///
/// # Errors
/// [`ExtractError::Threads`], and an error of `work`; items that nobody had begun are left out then.
pub(crate) fn on_each<T: Send>(
    on: Threads,
    items: &mut [T],
    work: impl Fn(usize, &mut T) -> Result<(), ExtractError> + Sync,
) -> Result<(), ExtractError> {
    if !ARE_THERE {
        return items.iter_mut().enumerate().try_for_each(|(i, item)| work(i, item));
    }
    let threads = items.len();
    let left = Mutex::new(items.iter_mut().enumerate());
    run(on, threads, &|| {
        let next = left.lock().expect("no thread panics with it").next();
        next.map(|(i, item)| work(i, item))
    })
}

/// Calls `next` on all threads until nothing is left. It is not generic: what starts threads is long, and compiled once.
fn run(
    on: Threads,
    threads: usize,
    next: &(dyn Fn() -> Option<Result<(), ExtractError>> + Sync),
) -> Result<(), ExtractError> {
    let all = || -> Result<(), ExtractError> { std::iter::from_fn(next).collect() };
    if let Threads::Jobs(jobs) = on {
        let result = Mutex::new(Ok(()));
        jobs.run(&|_| {
            if let Err(error) = all() {
                *result.lock().expect("no job panics with it") = Err(error);
            }
        });
        return result.into_inner().expect("no job panics with it");
    }
    std::thread::scope(|scope| {
        // The calling thread is one of them.
        let handles = (1..threads)
            .map(|_| {
                std::thread::Builder::new()
                    .spawn_scoped(scope, all)
                    .map_err(|error| ExtractError::Threads { threads, reason: error.to_string() })
            })
            .collect::<Result<Vec<_>, _>>()?;
        all()?;
        handles
            .into_iter()
            .try_for_each(|handle| handle.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)))
    })
}
