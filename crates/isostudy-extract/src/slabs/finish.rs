//! What is done to a mesh after its triangles are made: vertices are moved, edges collapsed.

use std::collections::TryReserveError;
use std::time::Duration;

use glam::Vec3;
use isostudy_mesh::Bounds;

use crate::ExtractError;
use crate::clock::Moment;
use crate::clustering::collapse::collapse;
use crate::execution::control::Threads;
use crate::execution::threads::for_each_on_threads;
use crate::lattice::Lattice;
use crate::memory::refilled;
use crate::placement::{Around, Moves, relax};
use crate::sampling::level::Level;
use crate::settings::{ExtractSettings, Placement};
use crate::tetrahedra::dense::triangles::Triangulation;

/// Newton's step is not followed farther than this, in spacings: it is meant for vertices next to the surface.
const LONGEST_STEP: f32 = 0.5;

/// Moves vertices, collapses edges, moves vertices, as the settings say. `targets` are those of a
/// [`CrossingPlacer`](crate::placement::CrossingPlacer),
/// none if there was none. Returns how long the edge collapse took, where there was one.
///
/// # Errors
/// [`ExtractError::Threads`], [`ExtractError::NoMemoryForMesh`].
pub(crate) fn finish(
    level: Option<Level>,
    lattice: &Lattice,
    settings: &ExtractSettings,
    threads: Threads,
    targets: &[Vec3],
    positions: &mut Vec<Vec3>,
    surface: &mut Triangulation,
) -> Result<Option<Duration>, ExtractError> {
    let (spacing, bounds) = (lattice.spacing(), lattice.bounds());
    let level = level.filter(|_| settings.placement.calls_the_field());
    if targets.is_empty() && level.is_none() {
        return Ok(timed_collapse(settings, spacing, positions, surface)?);
    }
    let mut moves = Moves::start(positions)?;
    if !targets.is_empty() {
        moves.advance(positions, targets, &surface.triangles, &bounds)?;
    }
    let collapsing = timed_collapse(settings, spacing, positions, surface)?;
    if collapsing.is_some() {
        moves = Moves::start(positions)?;
    }
    if let Some(level) = level {
        let mut found = FieldTargets::default();
        let (placement, triangles) = (settings.placement, &surface.triangles);
        let targets = found.find(&level, &bounds, placement, threads, positions, triangles)?;
        moves.advance(positions, targets, &surface.triangles, &bounds)?;
    }
    Ok(collapsing)
}

/// Moves the vertices of a mesh to where a placement that calls the field wants them.
///
/// # Errors
/// As [`finish`].
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

/// Collapses edges if the settings say so, and says how long that took.
fn timed_collapse(
    settings: &ExtractSettings,
    spacing: f32,
    positions: &mut Vec<Vec3>,
    surface: &mut Triangulation,
) -> Result<Option<Duration>, TryReserveError> {
    let start = Moment::now();
    Ok(collapse(settings, spacing, positions, surface)?.then(|| start.elapsed()))
}

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
