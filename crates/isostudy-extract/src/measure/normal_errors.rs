//! How far each normal of a mesh is from the field's.

use isostudy_field::{FieldCache, StudyField};
use isostudy_mesh::TriangleMesh;

use crate::execution::threads::{SHARE, mapped, on_threads};
use crate::extraction::ExtractError;
use crate::measure::accuracy::normal_error_deg;
use crate::sampling::level::Level;
use crate::settings::Execution;

/// The angle between the normal of each vertex of `mesh` and the field's outward direction at the vertex's foot on the
/// isosurface, in degrees, 0 to 180; as many as the mesh has normals. `None` where the normal has no direction, or no surface
/// is found along the gradient within three times `spacing`, which is that of the lattice the mesh was extracted on.
///
/// It is what [`crate::measure::accuracy`] takes the distribution of.
///
/// The result does not depend on `execution`.
///
/// # Errors
/// [`ExtractError::Threads`] if threads cannot be started.
///
/// # Panics
/// If there are more normals than vertices.
pub fn normal_errors_deg(
    mesh: &TriangleMesh,
    field: &dyn StudyField,
    isovalue: f32,
    spacing: f32,
    execution: &Execution,
) -> Result<Vec<Option<f64>>, ExtractError> {
    let mut kept = FieldCache::default();
    let level = Level { field: field.prepared(&mut kept).unwrap_or(field), isovalue, spacing };
    let vertices: Vec<usize> = (0..mesh.normals.len()).collect();
    on_threads(execution, (vertices.len() / SHARE).max(1), || {
        mapped(&vertices, |&v: &usize| normal_error_deg(&level, mesh.positions[v], mesh.normals[v]))
    })
}
