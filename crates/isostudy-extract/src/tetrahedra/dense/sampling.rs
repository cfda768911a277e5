//! Sampling stage: the field at every stored point.

use isostudy_field::StudyField;

use crate::execution::control::Control;
use crate::execution::threads::in_parts;
use crate::extraction::ExtractError;
use crate::lattice::{Coordinates, Layout};

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
