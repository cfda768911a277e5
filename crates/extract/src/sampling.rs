//! Sampling stage: the field at every stored point.

use rayon::prelude::*;

use crate::ExtractError;
use crate::field::ScalarField;
use crate::lattice::{Coordinates, Layout};
use crate::settings::Execution;

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
        0 => samples.par_chunks_exact_mut(layer_len).enumerate().for_each(sample_layer),
        1 => samples.chunks_exact_mut(layer_len).enumerate().for_each(sample_layer),
        threads => {
            // More threads than layers would have nothing to do.
            let threads = threads.min(layout.grid()[2]);
            rayon::ThreadPoolBuilder::new()
                .num_threads(threads)
                .build()
                .map_err(|error| ExtractError::Threads { threads, reason: error.to_string() })?
                .install(|| samples.par_chunks_exact_mut(layer_len).enumerate().for_each(sample_layer));
        }
    }
    Ok(())
}
