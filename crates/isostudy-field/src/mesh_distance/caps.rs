//! What closes an open surface: a cap on each loop of edges that triangles run more often one way than the other.
//!
//! Such edges always form closed chains, whatever the surface is like, so caps on all of them close it. The winding number
//! of the open surface is that of the closed one less the caps' share, their solid angle over 4 pi (Jacobson, Kavan &
//! Sorkine-Hornung 2013, section 4.2). It is the same for any caps. These are made for speed: a loop is halved by a
//! chord, again and again, so that the triangles along its edges are no longer than those.

use glam::{DVec3, Vec3};
use isostudy_mesh::{Bounds, TriangleMesh};

use super::MeshFieldError;
use super::solid_angles::SolidAngles;

/// The caps of all loops.
#[derive(Debug, Clone, Default)]
pub(super) struct Caps {
    angles: SolidAngles,
    /// What is wrong, if there are holes.
    open: Option<MeshFieldError>,
    /// The scale of the holes: the square root of the caps' area.
    pub(super) size: f32,
}

impl Caps {
    pub(super) fn of(mesh: &TriangleMesh) -> Self {
        let loops = open_loops(&mesh.triangles);
        let ends = |around: &Vec<u32>| {
            let next = around.iter().cycle().skip(1);
            around.iter().zip(next).map(|(&from, &to)| [from, to]).collect::<Vec<_>>()
        };
        let open = open_error(&connected(loops.iter().flat_map(ends).collect()), &mesh.positions);
        let mut triangles = Vec::new();
        for mut around in loops {
            // Against the direction of the edges, which the triangles at them have.
            around.reverse();
            let corners: Vec<Vec3> = around.iter().map(|&v| mesh.positions[v as usize]).collect();
            halve(&corners, &mut triangles);
        }
        let angles = SolidAngles::of(triangles);
        let size = angles.area().sqrt().max(f64::MIN_POSITIVE) as f32;
        Self { angles, open, size }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.open.is_none()
    }

    pub(super) fn triangles(&self) -> &[[Vec3; 3]] {
        self.angles.triangles()
    }

    pub(super) fn open(&self) -> Option<&MeshFieldError> {
        self.open.as_ref()
    }

    /// The part of the winding number round `p` that is the caps'.
    pub(super) fn share(&self, p: Vec3) -> f64 {
        self.angles.share(p)
    }

    /// A place beside `p`, a millionth of the holes' size away. On a cap itself the count along the ray and the solid angle
    /// may each be taken for that of either side, and people's holes are level with their lattices.
    pub(super) fn beside(&self, p: Vec3) -> Vec3 {
        let step = Vec3::splat(1e-6 * self.size).max(p.abs() * 2.5e-7);
        p + step * Vec3::new(1.31, 1.83, 2.27)
    }

    /// Whether the caps are so far from `p` that their share is surely below 1/4.
    pub(super) fn cannot_tell(&self, p: Vec3) -> bool {
        self.angles.cover_less(0.25, |centre| p.as_dvec3().distance(centre))
    }

    /// Whether that holds all over a box.
    pub(super) fn cannot_tell_in(&self, bounds: Bounds) -> bool {
        let (min, max) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
        self.angles.cover_less(0.25, |centre| centre.clamp(min, max).distance(centre))
    }
}

/// Where the largest of some rings of open edges is.
fn open_error(rings: &[Vec<[u32; 2]>], positions: &[Vec3]) -> Option<MeshFieldError> {
    // `max_by_key` keeps the last of equals, hence the reversal.
    let longest = rings.iter().rev().max_by_key(|ring| ring.len())?;
    let starts = || longest.iter().map(|&[from, _]| positions[from as usize].as_dvec3());
    let centre = starts().sum::<DVec3>() / longest.len() as f64;
    let radius = starts().map(|p| p.distance(centre)).fold(0.0, f64::max);
    Some(MeshFieldError::Open {
        edges: rings.iter().map(Vec::len).sum(),
        rings: rings.len(),
        longest: longest.len(),
        centre: centre.as_vec3(),
        radius: radius as f32,
    })
}

/// Triangles that a chain and the chord from its end to its start enclose.
fn halve(chain: &[Vec3], triangles: &mut Vec<[Vec3; 3]>) {
    let last = chain.len() - 1;
    if last >= 2 {
        let middle = last / 2;
        triangles.push([chain[0], chain[middle], chain[last]]);
        halve(&chain[..=middle], triangles);
        halve(&chain[middle..], triangles);
    }
}

/// The edges that triangles run more often one way than the other, as often as that is so, in loops of vertices.
///
/// Triangles that run an edge opposite ways are neighbours, two and two. What then has no neighbour is the boundary of
/// an oriented surface, and whoever walks along it with the surface to the left comes back to where he started.
fn open_loops(triangles: &[[u32; 3]]) -> Vec<Vec<u32>> {
    const NONE: u32 = u32::MAX;
    let start = |side: u32| triangles[side as usize / 3][side as usize % 3];
    let next = |side: u32| if side % 3 == 2 { side - 2 } else { side + 1 };
    let mut sides: Vec<(u32, u32, bool, u32)> = (0..3 * triangles.len() as u32)
        .map(|side| (start(side), start(next(side)), side))
        .map(|(from, to, side)| (from.min(to), from.max(to), from < to, side))
        .collect();
    sides.sort_unstable();
    let mut opposite = vec![NONE; sides.len()];
    for same in sides.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
        let (backward, forward) = same.split_at(same.partition_point(|side| !side.2));
        for (a, b) in backward.iter().zip(forward) {
            opposite[a.3 as usize] = b.3;
            opposite[b.3 as usize] = a.3;
        }
    }
    let mut walked = vec![false; sides.len()];
    let mut loops = Vec::new();
    for first in 0..sides.len() as u32 {
        let mut around = Vec::new();
        let mut side = first;
        while opposite[side as usize] == NONE && !walked[side as usize] {
            walked[side as usize] = true;
            around.push(start(side));
            side = next(side);
            while opposite[side as usize] != NONE {
                side = next(opposite[side as usize]);
            }
        }
        if !around.is_empty() {
            loops.push(around);
        }
    }
    loops
}

/// Edges that hang together, ring by ring, in the order of their first vertices.
fn connected(edges: Vec<[u32; 2]>) -> Vec<Vec<[u32; 2]>> {
    let mut vertices: Vec<u32> = edges.as_flattened().to_vec();
    vertices.sort_unstable();
    vertices.dedup();
    let number = |v: u32| vertices.binary_search(&v).expect("an end of an edge");
    let mut parents: Vec<usize> = (0..vertices.len()).collect();
    fn root(parents: &mut [usize], mut v: usize) -> usize {
        while parents[v] != v {
            parents[v] = parents[parents[v]];
            v = parents[v];
        }
        v
    }
    for &[a, b] in &edges {
        let (a, b) = (root(&mut parents, number(a)), root(&mut parents, number(b)));
        parents[a.max(b)] = a.min(b);
    }
    let mut rings: Vec<(usize, [u32; 2])> =
        edges.iter().map(|&edge| (root(&mut parents, number(edge[0])), edge)).collect();
    rings.sort_by_key(|(root, _)| *root);
    rings.chunk_by(|a, b| a.0 == b.0).map(|ring| ring.iter().map(|(_, edge)| *edge).collect()).collect()
}
