//! Metro distances between a mesh and the isosurface of a field.

use glam::DVec3;
use isostudy_mesh::TriangleMesh;
use isostudy_mesh::metro::{Foot, Metro, MetroError, Sampling, Surface, deviation_at};

use crate::execution::threads::on_threads;
use crate::extraction::ExtractError;
use crate::lattice::BoxGrid;
use crate::measure::crossings::Crossings;
use crate::measure::isosurface::Isosurface;
use crate::sampling::level::Level;
use crate::settings::Execution;
use crate::wording::in_words;
use isostudy_field::{FieldCache, StudyField};

/// Most points of an isosurface that lines are sent for.
const MOST_POINTS: u64 = 16_777_216;

/// Why a mesh and an isosurface cannot be measured against each other.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum DistanceError {
    /// The isosurface cannot be extracted.
    Extract(ExtractError),
    /// There is no isosurface in the box, or it cannot be sampled so.
    Isosurface(MetroError),
    /// The mesh cannot be sampled so.
    Mesh(MetroError),
}

in_words! {
    DistanceError {
        Self::Extract(error) => "{error}";
        Self::Isosurface(error) => "the isosurface: {error}";
        Self::Mesh(error) => "{error}";
    }
    from { ExtractError => Self::Extract, MetroError => Self::Mesh }
}

/// The distances from `mesh` to the isosurface of `field` in the box of `grid`, and back; `diagonal` is that of the
/// isosurface's bounding box.
///
/// Distances, their errors and what is not seen are as in [`crate::measure::accuracy`], with as many points as `sampling` asks for.
/// Of an isosurface that lines are sent for, it is about as many and at most 16,777,216, and the seed changes nothing. Distances are
/// exact where the field knows its isosurface, else along the gradient up to three spacings. Farther away it is the distance
/// to the point that the nearest triangle of an extraction stands for: not less than the true one, and more by at most
/// twice what that extraction is off. Points without a distance and, on the way back, points outside the box are counted
/// as lost. The result does not depend on `execution`.
///
/// # Errors
/// [`DistanceError`].
pub fn distances(
    mesh: &Surface,
    field: &dyn StudyField,
    isovalue: f32,
    grid: &BoxGrid,
    sampling: &Sampling,
    execution: &Execution,
) -> Result<Metro, DistanceError> {
    let mut kept = FieldCache::default();
    let prepared = field.prepared(&mut kept).unwrap_or(field);
    let level = Level { field: prepared, isovalue, spacing: grid.spacing };
    let isosurface = Isosurface::new(field, level, grid, &grid.bounds, execution)?;
    let reference = joined(&isosurface.triangles).map_err(DistanceError::Isosurface)?;
    sampling.amount.on(reference.area()).map_err(DistanceError::Isosurface)?;
    on_threads(execution, usize::MAX, || {
        // Too far for the gradient, the nearest triangle of the extraction says where to look.
        let by_triangle = |p: DVec3| {
            let position = isosurface.point(reference.nearest(p, f64::INFINITY).position)?;
            Some(Foot { position, distance: p.distance(position) })
        };
        let forward = mesh.deviation_by(sampling, |p, _| isosurface.foot(p).or_else(|| by_triangle(p)))?;
        let backward = if isosurface.is_exact() {
            let to_mesh = |p: DVec3, _| Some(mesh.nearest(isosurface.in_box(p)?, f64::INFINITY));
            reference.deviation_by(sampling, to_mesh).map_err(DistanceError::Isosurface)?
        } else {
            let wanted =
                |area: f64| sampling.amount.on(area).map_or(1, |count| count.min(MOST_POINTS)) as f64;
            let Crossings { points, area_each } = isosurface.points(wanted, sampling.seed);
            deviation_at(&points, area_each, |p, _| Some(mesh.nearest(p, f64::INFINITY)))
        };
        Ok(Metro { forward, backward, diagonal: reference.diagonal() })
    })?
}

/// Triangles as a surface whose vertices are there once.
fn joined(triangles: &[[glam::Vec3; 3]]) -> Result<Surface, MetroError> {
    let corners = triangles.iter().flatten().copied().collect();
    let numbers = (0..triangles.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    let soup = TriangleMesh { positions: corners, normals: Vec::new(), triangles: numbers };
    Surface::try_new(&isostudy_mesh::weld(&soup))
}
