//! What is done to a mesh after its triangles are made: vertices are moved, edges collapsed.

use std::collections::TryReserveError;
use std::time::Duration;

use glam::Vec3;

use crate::clock::Moment;
#[cfg(feature = "tetrahedra")]
use crate::clustering::collapse::collapse;
use crate::execution::control::Threads;
use crate::extraction::ExtractError;
use crate::lattice::Lattice;
use crate::placement::{FieldTargets, Moves};
use crate::sampling::level::Level;
use crate::settings::ExtractSettings;
use crate::surface::triangulation::Triangulation;

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
    let moves_here =
        cfg!(any(feature = "tetrahedra", feature = "cubes")) && settings.placement.calls_the_field();
    let level = level.filter(|_| moves_here);
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

/// Collapses edges if the settings say so, and says how long that took.
fn timed_collapse(
    settings: &ExtractSettings,
    spacing: f32,
    positions: &mut Vec<Vec3>,
    surface: &mut Triangulation,
) -> Result<Option<Duration>, TryReserveError> {
    #[cfg(feature = "tetrahedra")]
    {
        let start = Moment::now();
        Ok(collapse(settings, spacing, positions, surface)?.then(|| start.elapsed()))
    }
    #[cfg(not(feature = "tetrahedra"))]
    {
        let _ = (settings, spacing, positions, surface);
        Ok(None)
    }
}
