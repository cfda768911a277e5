//! Sampling stage: the field at every stored point.

use rayon::prelude::*;

use crate::ExtractError;
use crate::lattice::{Coordinates, Layout};
use crate::settings::Execution;
use field::ScalarField;

/// The fewest items that are worth a thread.
pub(crate) const SHARE: usize = 256;

/// Fills `samples`, layer by layer, fillers too. Layers are handed out to threads; each value depends on its own
/// position alone, so the number of threads cannot show.
pub(crate) fn sample(
    field: &dyn ScalarField,
    layout: &Layout,
    coordinates: &Coordinates,
    execution: &Execution,
    samples: &mut [f32],
) -> Result<(), ExtractError> {
    let layer_len = layout.layer_len();
    let sample_layer = |(layer, values): (usize, &mut [f32])| {
        let kind = layout.kind(layer);
        let (x, z) = (coordinates.x(kind), coordinates.z()[layer]);
        for (row, &y) in values.chunks_exact_mut(x.len()).zip(coordinates.y(kind)) {
            field.sample_row(x, y, z, row);
        }
    };
    match execution.threads {
        1 => samples.chunks_exact_mut(layer_len).enumerate().for_each(sample_layer),
        // More threads than layers would have nothing to do.
        _ => on_threads(execution, layout.grid()[2], || {
            // A layer of a mesh's distance may cost twice another's: handed out one by one, no thread waits long at the end.
            samples.par_chunks_exact_mut(layer_len).enumerate().with_max_len(1).for_each(sample_layer);
        })?,
    }
    Ok(())
}

/// Runs `work` where rayon has as many threads as `execution` asks for, and no more than `most`.
pub(crate) fn on_threads<R: Send>(
    execution: &Execution,
    most: usize,
    work: impl FnOnce() -> R + Send,
) -> Result<R, ExtractError> {
    if execution.threads == 0 {
        return Ok(work());
    }
    let threads = execution.threads.min(most);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    let pool = pool.map_err(|error| ExtractError::Threads { threads, reason: error.to_string() })?;
    Ok(pool.install(work))
}

/// Calls `work` with each item and its number, on as many threads as `execution` asks for.
pub(crate) fn for_each_on_threads<T: Send>(
    execution: &Execution,
    items: &mut [T],
    work: impl Fn(usize, &mut T) + Sync + Send,
) -> Result<(), ExtractError> {
    if execution.threads == 1 {
        items.iter_mut().enumerate().for_each(|(i, item)| work(i, item));
        return Ok(());
    }
    on_threads(execution, items.len().div_ceil(SHARE).max(1), || {
        items.par_iter_mut().enumerate().with_min_len(SHARE).for_each(|(i, item)| work(i, item));
    })
}
