//! Sampling stage: the field at every stored point.

use std::sync::Mutex;

#[cfg(feature = "rayon")]
use rayon::prelude::*;

use crate::ExtractError;
use crate::execution::control::{Control, Threads};
use crate::lattice::{Coordinates, Layout};
use crate::settings::Execution;
use crate::slabs::on_each;
use isostudy_field::StudyField;

/// The fewest items that are worth a thread.
pub(crate) const SHARE: usize = 256;

/// Fills `samples`, layer by layer, fillers too. Layers are handed out to threads; each value depends on its own
/// position alone, so the number of threads cannot show.
pub(crate) fn sample(
    field: &dyn StudyField,
    layout: &Layout,
    coordinates: &Coordinates,
    control: Control,
    samples: &mut [f32],
) -> Result<(), ExtractError> {
    // A layer of a mesh's distance may cost twice another's: handed out one by one, no thread waits long at the end.
    in_parts(control.threads, samples, layout.layer_len(), |layer, values| {
        control.check()?;
        let kind = layout.kind(layer);
        let (x, z) = (coordinates.x(kind), coordinates.z()[layer]);
        for (row, &y) in values.chunks_exact_mut(x.len()).zip(coordinates.y(kind)) {
            field.sample_row(x, y, z, row);
        }
        Ok(())
    })
}

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
fn in_parts<T: Send>(
    threads: Threads,
    items: &mut [T],
    each: usize,
    work: impl Fn(usize, &mut [T]) -> Result<(), ExtractError> + Sync,
) -> Result<(), ExtractError> {
    let most = threads.count().min(items.len().div_ceil(each));
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
