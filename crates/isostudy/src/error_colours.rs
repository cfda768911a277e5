//! How far triangles are from the isosurface, as colours. The one place where `extract` meets `raster`.

use anyhow::Result;
use isostudy_extract::Execution;
use isostudy_field::StudyField;
use isostudy_mesh::TriangleMesh;
use isostudy_raster::{Colouring, Values};

/// The distances of the triangles of a mesh to the isosurface of a field, at an isovalue, in units of a spacing; the scale
/// ends at `most`. A triangle without a distance is far away.
///
/// # Errors
/// If threads cannot be started.
pub(crate) fn of(
    mesh: &TriangleMesh,
    (field, isovalue, spacing): (&dyn StudyField, f32, f32),
    most: f32,
    threads: usize,
) -> Result<Colouring> {
    let distances =
        isostudy_extract::triangle_distances(mesh, field, isovalue, spacing, &Execution { threads })?;
    let in_spacings = |d: Option<f64>| d.map_or(f32::INFINITY, |d| (d / f64::from(spacing)) as f32);
    Ok(Colouring::distance(Values::PerTriangle(distances.into_iter().map(in_spacings).collect()), most))
}
