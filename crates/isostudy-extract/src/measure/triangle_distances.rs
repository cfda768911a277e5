//! How far each triangle of a mesh is from the isosurface.

use glam::DVec3;
use isostudy_field::{FieldCache, StudyField};
use isostudy_mesh::TriangleMesh;

use crate::execution::threads::{SHARE, mapped, on_threads};
use crate::extraction::ExtractError;
use crate::measure::isosurface::foot;
use crate::sampling::level::Level;
use crate::settings::Execution;

/// The distance from each triangle of `mesh` to the isosurface of `field`, in the unit of the coordinates, never
/// negative: the largest at seven points, which are the corners, the middles of the edges and the centroid. At its corners
/// alone a coarse mesh would look right, since that is where crossings are. `None` where one of the points has no
/// distance.
///
/// The distance of a point is as in [`crate::measure::accuracy`]: exact where the field knows its isosurface, else along the
/// gradient, up to three times `spacing`, which is that of the lattice the mesh was extracted on.
///
/// The result does not depend on `execution`.
///
/// # Errors
/// [`ExtractError::Threads`] if threads cannot be started.
///
/// # Panics
/// If a triangle's index is out of range.
pub fn triangle_distances(
    mesh: &TriangleMesh,
    field: &dyn StudyField,
    isovalue: f32,
    spacing: f32,
    execution: &Execution,
) -> Result<Vec<Option<f64>>, ExtractError> {
    let mut kept = FieldCache::default();
    let level = Level { field: field.prepared(&mut kept).unwrap_or(field), isovalue, spacing };
    let distance = |p: DVec3| foot(field, &level, p).map(|foot| foot.distance);
    on_threads(execution, (mesh.triangles.len() / SHARE).max(1), || {
        let vertices: Vec<_> = mapped(&mesh.positions, |p| distance(p.as_dvec3()));
        let farthest = |corners: &[u32; 3]| {
            let [a, b, c] = corners.map(|v| mesh.positions[v as usize].as_dvec3());
            let inner = [(a + b) * 0.5, (b + c) * 0.5, (c + a) * 0.5, (a + b + c) / 3.0];
            let at_corners = corners.iter().map(|&v| vertices[v as usize]);
            at_corners.chain(inner.map(distance)).try_fold(0.0, |most: f64, at| Some(most.max(at?)))
        };
        mapped(&mesh.triangles, farthest)
    })
}
