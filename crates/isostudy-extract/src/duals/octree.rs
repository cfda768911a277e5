//! Simplification: cells become cells of twice the size, again and again, where one vertex will do (Ju, Losasso, Schaefer & Warren 2002,
//! sections 3 and 4).
//!
//! Eight cells become one where that changes no topology, and where one point is near enough to the tangent planes at all of their
//! crossings. What is left is an octree, contoured round its minimal edges. No walk over the octree is needed for that: a minimal edge
//! has one crossing at most, so its polygon is the quadrilateral of that crossing in the uniform net, with the vertices of merged cells
//! in place of those that they had.

mod hermite;
mod merging;
mod net;

use self::hermite::Hermite;
use self::merging::{Merged, Merging, merged_cells};
pub(super) use self::net::Standing;
use self::net::{Net, Simplified};
use super::quads::Quadrilateral;
use super::sharp::Sharp;
use crate::clock::Moment;
use crate::cubes::grid::CubeGrid;
use crate::extraction::{ExtractError, Extraction};
use crate::memory::collected;
use crate::sampling::level::Level;
use crate::source::Request;
use crate::surface::trace::Trace;
use isostudy_mesh::TriangleMesh;

/// Merges cells of an extraction with tangent planes, whose trace is given. No vertex of a merged cell is farther than `tolerance` spacings from the
/// tangent plane at a crossing of its cell.
///
/// # Errors
/// [`ExtractError::NoMemoryForMesh`], [`ExtractError::Threads`], [`ExtractError::Cancelled`].
pub(super) fn simplify(
    request: &Request,
    sharp: Sharp,
    tolerance: f32,
    trace: &mut Trace,
    extraction: &mut Extraction,
) -> Result<(), ExtractError> {
    let Some(level) = request.level() else { return Ok(()) };
    let start = Moment::now();
    let grid = &CubeGrid::new(request.lattice)?;
    let mesh = &mut extraction.mesh;
    let triangles_before = mesh.triangles.len();
    let (parts, simplified) = parts(request, level, grid, (sharp, tolerance), trace, mesh)?;
    simplified.write(&parts.net(level, grid), trace, mesh)?;
    extraction.renew()?;
    extraction.counts.discarded_triangles = triangles_before as u64 - extraction.counts.triangles;
    extraction.times.vertex += start.elapsed();
    Ok(())
}

/// The same cells, as boxes: by vertex of the uniform net the one that stands for it, where that is then, and the cell that it is in.
///
/// # Errors
/// As [`simplify`].
pub(super) fn merged(
    request: &Request,
    level: Level,
    grid: &CubeGrid,
    how: (Sharp, f32),
    trace: &Trace,
    mesh: &TriangleMesh,
) -> Result<Standing, ExtractError> {
    let (parts, simplified) = parts(request, level, grid, how, trace, mesh)?;
    simplified.standing(&parts.net(level, grid))
}

/// What a net is made of.
struct Parts {
    hermite: Hermite,
    merged: Vec<Merged>,
    quadrilaterals: Vec<Quadrilateral>,
}

impl Parts {
    fn net<'a>(&'a self, level: Level<'a>, grid: &'a CubeGrid<'a>) -> Net<'a> {
        let Self { hermite, merged, quadrilaterals } = self;
        Net { level, grid, hermite, merged, quadrilaterals }
    }
}

fn parts(
    request: &Request,
    level: Level,
    grid: &CubeGrid,
    (sharp, tolerance): (Sharp, f32),
    trace: &Trace,
    mesh: &TriangleMesh,
) -> Result<(Parts, Simplified), ExtractError> {
    let hermite = Hermite::of(request, level, grid, trace)?;
    let most = f64::from(tolerance) * f64::from(level.spacing);
    let merged = merged_cells(request, &Merging { grid, hermite: &hermite, sharp, most })?;
    let quadrilaterals = mesh.triangles.as_chunks::<2>().0.iter().map(|&pair| Quadrilateral::of(pair));
    let parts = Parts { hermite, merged, quadrilaterals: collected(quadrilaterals)? };
    let simplified = parts.net(level, grid).unfolded(request, &mesh.positions)?;
    Ok((parts, simplified))
}
