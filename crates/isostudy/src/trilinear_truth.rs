//! What the trilinear interpolant of a configuration's samples has for a surface.

use crate::memory::{Limit, amount};
use crate::prepare::Prepared;
use crate::recipe::Recipe;
use crate::terminal::tell_once;
use isostudy_design::record::Trilinear;
use isostudy_extract::CornerSamples;
use isostudy_trilinear::{Samples, Ties, topology};

/// Bytes for each sample: its value, its place among the edges, and as much again while both grow.
const BYTES_PER_SAMPLE: u64 = 16;

/// The truth that a mesh is held against; `None` where the method's samples are not the corners of the grid's cells, or not all numbers,
/// or more than the limit allows, which is said.
pub(crate) fn trilinear_truth(prepared: &Prepared<'_>, cells: [u32; 3], limit: Limit) -> Option<Trilinear> {
    let samples: u64 = cells.iter().map(|&along| u64::from(along) + 1).product();
    let has_corners = !matches!(prepared.recipe, Recipe::Meshes(_) | Recipe::Family(_));
    if has_corners && samples.saturating_mul(BYTES_PER_SAMPLE) > limit.bytes {
        tell_once(&format!(
            "{}: it is not held against the trilinear surface of its samples, which takes {}; {}",
            prepared.id,
            amount(samples.saturating_mul(BYTES_PER_SAMPLE), f64::ceil),
            limit.allowed()
        ));
        return None;
    }
    let (counts, values) = match &prepared.recipe {
        Recipe::Extractor(method) => {
            let CornerSamples { counts, values } =
                method.corner_samples(prepared.field, &prepared.grid).ok()??;
            (counts, values)
        }
        Recipe::Program(_) => (cells.map(|n| n as usize + 1), prepared.samples(cells)),
        Recipe::Meshes(_) | Recipe::Family(_) => return None,
    };
    let samples = Samples::try_new(counts, &values).ok()?;
    let surface = topology(&samples, prepared.isovalue, Ties::Outside).ok()?;
    let cells_otherwise = match &prepared.recipe {
        Recipe::Extractor(method) => method.cells_otherwise(counts, &values, prepared.isovalue),
        _ => None,
    };
    Some(Trilinear {
        components: surface.components.len() as u64,
        euler_characteristic: surface.components.iter().map(|component| component.euler_characteristic).sum(),
        genus: surface.genus(),
        tunnel_cells: surface.tunnel_cells,
        cells_otherwise,
    })
}
