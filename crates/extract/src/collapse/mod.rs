//! Edge collapse: short mesh edges shrink to a point after the mesh is made.

mod guarded;
mod published;

use glam::Vec3;

use crate::settings::{Clustering, ExtractSettings, Topology};
use crate::triangles::Triangulation;

/// Collapses short edges by the rules of the settings, if they ask for it. Returns whether they do.
pub(crate) fn collapse(
    settings: &ExtractSettings,
    spacing: f32,
    positions: &mut Vec<Vec3>,
    surface: &mut Triangulation,
) -> bool {
    match settings.clustering {
        Clustering::None | Clustering::Integrated => return false,
        Clustering::EdgeCollapse | Clustering::IntegratedCollapse => {}
    }
    let rule = match settings.topology {
        Topology::Guarded => guarded::guarded,
        Topology::Published => published::published,
    };
    let before = surface.triangles.len();
    (*positions, surface.triangles) = rule(std::mem::take(positions), &surface.triangles, spacing);
    let dropped = (before - surface.triangles.len()) as u64;
    surface.discarded += dropped;
    surface.discarded_as_published += dropped;
    true
}

/// Which vertex each vertex was merged into, directly or through others.
struct Merged {
    into: Vec<u32>,
}

impl Merged {
    /// Follows the chain to its end and shortens it on the way.
    fn survivor(&mut self, vertex: u32) -> u32 {
        let mut vertex = vertex as usize;
        while self.into[vertex] as usize != vertex {
            self.into[vertex] = self.into[self.into[vertex] as usize];
            vertex = self.into[vertex] as usize;
        }
        vertex as u32
    }
}

/// Every edge once, the smaller vertex first, in order.
fn unique_edges(triangles: &[[u32; 3]]) -> Vec<(u32, u32)> {
    let ordered = |a: u32, b: u32| (a.min(b), a.max(b));
    let mut edges: Vec<_> =
        triangles.iter().flat_map(|&[a, b, c]| [ordered(a, b), ordered(b, c), ordered(c, a)]).collect();
    edges.sort_unstable();
    edges.dedup();
    edges
}

/// Drops triangles that lost a corner, then vertices that no triangle uses, and numbers the rest by first use.
fn rebuild(positions: &[Vec3], triangles: &[[u32; 3]], merged: &mut Merged) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    const UNSEEN: u32 = u32::MAX;
    let mut numbers = vec![UNSEEN; positions.len()];
    let mut kept_positions = Vec::new();
    let mut kept_triangles = Vec::new();
    for triangle in triangles {
        let triangle @ [a, b, c] = triangle.map(|vertex| merged.survivor(vertex));
        if a == b || b == c || c == a {
            continue;
        }
        kept_triangles.push(triangle.map(|vertex| {
            let number = &mut numbers[vertex as usize];
            if *number == UNSEEN {
                *number = kept_positions.len() as u32;
                kept_positions.push(positions[vertex as usize]);
            }
            *number
        }));
    }
    (kept_positions, kept_triangles)
}
