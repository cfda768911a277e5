//! Where a placement that calls the field wants vertices, once there are triangles.

use glam::Vec3;
use isostudy_mesh::Bounds;

use super::{Around, Moves, relax};
use crate::execution::control::Threads;
use crate::execution::threads::for_each_on_threads;
use crate::extraction::ExtractError;
use crate::lattice::Lattice;
use crate::memory::refilled;
use crate::sampling::level::Level;
use crate::settings::Placement;

/// Newton's step is not followed farther than this, in spacings: it is meant for vertices next to the surface.
const LONGEST_STEP: f32 = 0.5;

/// Where a placement that calls the field wants the vertices; the room is used again.
#[derive(Debug, Default)]
pub(crate) struct FieldTargets {
    targets: Vec<Vec3>,
    around: Vec<Around>,
}

impl FieldTargets {
    /// Finds a target for each vertex.
    ///
    /// # Errors
    /// [`ExtractError::Threads`], [`ExtractError::NoMemoryForMesh`].
    pub(crate) fn find(
        &mut self,
        level: &Level,
        bounds: &Bounds,
        placement: Placement,
        threads: Threads,
        positions: &[Vec3],
        triangles: &[[u32; 3]],
    ) -> Result<&[Vec3], ExtractError> {
        let Self { targets, around } = self;
        match placement {
            Placement::Relaxed => relax(positions, triangles, around, targets)?,
            _ => refilled(targets, positions.iter().copied())?,
        }
        project(level, bounds, threads, positions, targets)?;
        Ok(targets)
    }
}

/// Takes each target to the isosurface; where there is no way, the vertex's position becomes the target.
fn project(
    level: &Level,
    bounds: &Bounds,
    threads: Threads,
    positions: &[Vec3],
    targets: &mut [Vec3],
) -> Result<(), ExtractError> {
    let longest = LONGEST_STEP * level.spacing;
    for_each_on_threads(threads, targets, |v, target| {
        let near = |p: &Vec3| p.distance(positions[v]) <= longest;
        let there = level.newton(*target, longest).map(|p| p.clamp(bounds.min, bounds.max)).filter(near);
        *target = there.unwrap_or(positions[v]);
    })
}

/// Moves the vertices of a mesh to where a placement that calls the field wants them.
///
/// # Errors
/// As [`FieldTargets::find`].
pub(crate) fn move_vertices(
    level: &Level,
    lattice: &Lattice,
    placement: Placement,
    threads: Threads,
    positions: &mut [Vec3],
    triangles: &[[u32; 3]],
) -> Result<(), ExtractError> {
    let bounds = lattice.bounds();
    let mut found = FieldTargets::default();
    let targets = found.find(level, &bounds, placement, threads, positions, triangles)?;
    Ok(Moves::start(positions)?.advance(positions, targets, triangles, &bounds)?)
}
