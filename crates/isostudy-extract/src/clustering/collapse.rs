//! Edge collapse: short mesh edges shrink to a point after the mesh is made.

mod guarded;
mod published;

use std::collections::TryReserveError;

use glam::Vec3;

use crate::memory::{collected, filled, push, with_room};
use crate::settings::{Clustering, ExtractSettings, Topology};
use crate::surface::triangulation::Triangulation;

/// Collapses short edges by the rules of the settings, if they ask for it. Returns whether they do.
pub(crate) fn collapse(
    settings: &ExtractSettings,
    spacing: f32,
    positions: &mut Vec<Vec3>,
    surface: &mut Triangulation,
) -> Result<bool, TryReserveError> {
    match settings.clustering {
        Clustering::None | Clustering::Integrated | Clustering::Warp => return Ok(false),
        Clustering::EdgeCollapse | Clustering::IntegratedCollapse => {}
    }
    let before = surface.triangles.len();
    let after = collapse_traced(settings.topology, spacing, std::mem::take(positions), &surface.triangles)?;
    (*positions, surface.triangles) = (after.positions, after.triangles);
    let dropped = (before - surface.triangles.len()) as u64;
    surface.discarded += dropped;
    surface.discarded_as_published += dropped;
    Ok(true)
}

/// A mesh whose short edges were collapsed, and what it was before.
#[derive(Debug, Default)]
pub(crate) struct Collapsed {
    pub(crate) positions: Vec<Vec3>,
    pub(crate) triangles: Vec<[u32; 3]>,
    /// The number of each vertex before: of those that became one, the one that the others went into.
    pub(crate) vertices_before: Vec<u32>,
    pub(crate) triangles_before: Vec<u32>,
}

/// Collapses short edges by the rule of a topology, and says what has become of what.
pub(crate) fn collapse_traced(
    topology: Topology,
    spacing: f32,
    positions: Vec<Vec3>,
    triangles: &[[u32; 3]],
) -> Result<Collapsed, TryReserveError> {
    let merge = match topology {
        Topology::Guarded => guarded::guarded,
        Topology::Published => published::published,
    };
    let (positions, mut merged) = merge(positions, triangles, spacing)?;
    rebuild(&positions, triangles, &mut merged)
}

/// Which vertex each vertex was merged into, directly or through others.
pub(crate) struct Merged {
    pub(crate) into: Vec<u32>,
}

impl Merged {
    /// Each of so many into itself.
    pub(crate) fn none(vertices: usize) -> Result<Self, TryReserveError> {
        Ok(Self { into: collected(0..vertices as u32)? })
    }

    /// Follows the chain to its end and shortens it on the way.
    pub(crate) fn survivor(&mut self, vertex: u32) -> u32 {
        let mut vertex = vertex as usize;
        while self.into[vertex] as usize != vertex {
            self.into[vertex] = self.into[self.into[vertex] as usize];
            vertex = self.into[vertex] as usize;
        }
        vertex as u32
    }
}

/// Every edge of the triangles that have three corners, once, the smaller vertex first, in order.
fn unique_edges(triangles: &[[u32; 3]]) -> Result<Vec<(u32, u32)>, TryReserveError> {
    let ordered = |a: u32, b: u32| (a.min(b), a.max(b));
    let mut edges = with_room(3 * triangles.len())?;
    for &triangle in triangles.iter().filter(|&&triangle| is_proper(triangle)) {
        let [a, b, c] = triangle;
        edges.extend([ordered(a, b), ordered(b, c), ordered(c, a)]);
    }
    edges.sort_unstable();
    edges.dedup();
    Ok(edges)
}

fn is_proper([a, b, c]: [u32; 3]) -> bool {
    a != b && b != c && c != a
}

/// Drops triangles that lost a corner, then vertices that no triangle uses, and numbers the rest by first use.
fn rebuild(
    positions: &[Vec3],
    triangles: &[[u32; 3]],
    merged: &mut Merged,
) -> Result<Collapsed, TryReserveError> {
    const UNSEEN: u32 = u32::MAX;
    let mut numbers = filled(positions.len(), UNSEEN)?;
    let mut after = Collapsed::default();
    for (t, triangle) in triangles.iter().enumerate() {
        let triangle = triangle.map(|vertex| merged.survivor(vertex));
        if !is_proper(triangle) {
            continue;
        }
        for vertex in triangle {
            let number = &mut numbers[vertex as usize];
            if *number == UNSEEN {
                *number = after.positions.len() as u32;
                push(&mut after.positions, positions[vertex as usize])?;
                push(&mut after.vertices_before, vertex)?;
            }
        }
        push(&mut after.triangles, triangle.map(|vertex| numbers[vertex as usize]))?;
        push(&mut after.triangles_before, t as u32)?;
    }
    Ok(after)
}
