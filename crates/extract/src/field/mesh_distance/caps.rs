//! What closes an open surface: a cone over each ring of edges that triangles run more often one way than the other.
//!
//! Such edges always form closed chains, whatever the surface is like, so a cone from any point over all of them closes
//! it. The winding number of the open surface is that of the closed one less the cones' share, their solid angle over
//! 4 pi (Jacobson, Kavan & Sorkine-Hornung 2013, section 4.2).

use std::f64::consts::PI;

use glam::{DVec3, Vec3};
use mesh::{Bounds, TriangleMesh};

use super::MeshFieldError;

/// The cones of all rings.
#[derive(Debug, Clone, Default)]
pub(super) struct Caps {
    rings: Vec<Ring>,
    /// The scale of the holes: the square root of the cones' area.
    pub(super) size: f32,
}

/// A ring of open edges, connected, and the cone that closes it.
#[derive(Debug, Clone)]
struct Ring {
    edges: usize,
    triangles: Vec<[Vec3; 3]>,
    /// A ball round the cone.
    centre: DVec3,
    radius: f64,
    area: f64,
}

impl Caps {
    pub(super) fn of(mesh: &TriangleMesh) -> Self {
        let edges = open_edges(&mesh.triangles);
        let rings: Vec<Ring> =
            connected(edges).iter().map(|edges| Ring::over(edges, &mesh.positions)).collect();
        let area: f64 = rings.iter().map(|ring| ring.area).sum();
        Self { rings, size: area.sqrt().max(f64::MIN_POSITIVE) as f32 }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.rings.is_empty()
    }

    pub(super) fn triangles(&self) -> impl Iterator<Item = [Vec3; 3]> {
        self.rings.iter().flat_map(|ring| ring.triangles.iter().copied())
    }

    /// What is wrong, if there are holes.
    pub(super) fn open(&self) -> Option<MeshFieldError> {
        // `max_by_key` keeps the last of equals, hence the reversal.
        let longest = self.rings.iter().rev().max_by_key(|ring| ring.edges)?;
        Some(MeshFieldError::Open {
            edges: self.rings.iter().map(|ring| ring.edges).sum(),
            rings: self.rings.len(),
            longest: longest.edges,
            centre: longest.centre.as_vec3(),
            radius: longest.radius as f32,
        })
    }

    /// The cones' part of the enclosed volume.
    pub(super) fn volume(&self) -> f64 {
        let corners = self.triangles().map(|t| t.map(|p| p.as_dvec3()));
        corners.map(|[a, b, c]| a.dot(b.cross(c)) / 6.0).sum()
    }

    /// The part of the winding number round `p` that is the cones'.
    pub(super) fn share(&self, p: Vec3) -> f64 {
        self.triangles().map(|triangle| solid_angle(&triangle, p)).sum::<f64>() / (4.0 * PI)
    }

    /// A place beside `p`, a millionth of the holes' size away. On a cone itself the count along the ray and the solid angle
    /// may each be taken for that of either side, and people's holes are level with their lattices.
    pub(super) fn beside(&self, p: Vec3) -> Vec3 {
        let step = Vec3::splat(1e-6 * self.size).max(p.abs() * 2.5e-7);
        p + step * Vec3::new(1.31, 1.83, 2.27)
    }

    /// Whether the cones are so far from `p` that their share is surely below 1/4.
    pub(super) fn cannot_tell(&self, p: Vec3) -> bool {
        self.share_at_most(|centre| p.as_dvec3().distance(centre)) < 0.25
    }

    /// Whether that holds all over a box.
    pub(super) fn cannot_tell_in(&self, bounds: Bounds) -> bool {
        let (min, max) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
        self.share_at_most(|centre| centre.clamp(min, max).distance(centre)) < 0.25
    }

    /// A surface of area A, nowhere nearer than d, covers at most A / d^2 of the unit sphere round a point.
    fn share_at_most(&self, distance: impl Fn(DVec3) -> f64) -> f64 {
        let of_ring = |ring: &Ring| {
            let clear = (distance(ring.centre) - ring.radius).max(0.0);
            if ring.area == 0.0 { 0.0 } else { ring.area / (4.0 * PI * clear * clear) }
        };
        self.rings.iter().map(of_ring).sum()
    }
}

impl Ring {
    fn over(edges: &[[u32; 2]], positions: &[Vec3]) -> Self {
        let at = |v: u32| positions[v as usize];
        let sum: DVec3 = edges.iter().map(|&[from, _]| at(from).as_dvec3()).sum();
        let tip = (sum / edges.len() as f64).as_vec3();
        let triangles: Vec<_> = edges.iter().map(|&[from, to]| [at(to), at(from), tip]).collect();
        let centre = tip.as_dvec3();
        let farthest = edges.iter().map(|&[from, _]| at(from).as_dvec3().distance(centre));
        let area = |t: &[Vec3; 3]| {
            let [a, b, c] = t.map(|p| p.as_dvec3());
            0.5 * (b - a).cross(c - a).length()
        };
        Self {
            edges: edges.len(),
            radius: farthest.fold(0.0, f64::max) * (1.0 + 1e-9),
            area: triangles.iter().map(area).sum(),
            triangles,
            centre,
        }
    }
}

/// The edges that triangles run more often one way than the other, in that direction, as often as that is so.
fn open_edges(triangles: &[[u32; 3]]) -> Vec<[u32; 2]> {
    let sides = triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
    let mut edges: Vec<(u32, u32, bool)> = sides.map(|[a, b]| (a.min(b), a.max(b), a < b)).collect();
    edges.sort_unstable();
    let mut open = Vec::new();
    for same in edges.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
        let forward = same.iter().filter(|edge| edge.2).count();
        let backward = same.len() - forward;
        let (low, high, _) = same[0];
        let edge = if forward > backward { [low, high] } else { [high, low] };
        open.extend(std::iter::repeat_n(edge, forward.abs_diff(backward)));
    }
    open
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

/// The solid angle of a triangle seen from `p`, positive from behind (Van Oosterom & Strackee 1983).
fn solid_angle(triangle: &[Vec3; 3], p: Vec3) -> f64 {
    let [a, b, c] = triangle.map(|corner| corner.as_dvec3() - p.as_dvec3());
    let (la, lb, lc) = (a.length(), b.length(), c.length());
    let spread = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
    2.0 * a.dot(b.cross(c)).atan2(spread)
}
