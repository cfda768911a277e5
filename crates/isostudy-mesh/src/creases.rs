//! Normals of corners: averaged over smooth parts of a fan alone, so that creases stay sharp.

use std::collections::HashMap;

use glam::{DVec3, Vec3};

use crate::TriangleMesh;
use crate::connectivity::{Connectivity, HalfEdge};
use crate::corner_fans::DisjointSets;
use crate::normals::area_weighted_normals;

/// A triangle has a direction if it is higher than so many roundings of its largest coordinate. A lower one points
/// where rounding turned it, by up to a tenth of a radian or more.
const ROUNDINGS: f64 = 16.0;
/// Half-edges that lead across no smooth edge.
const NONE: u32 = u32::MAX;

/// Which normal each corner of a mesh has.
#[derive(Debug, Clone, PartialEq)]
pub struct CornerNormals {
    /// One per vertex, as the mesh has them; then one per copy.
    pub normals: Vec<Vec3>,
    /// The vertex that each copy is of. Copies of one vertex stand together, and vertices are in their order.
    pub copies: Vec<u32>,
    /// The place in `normals` of the three corners of each triangle: the vertex, or one of its copies.
    pub corners: Vec<[u32; 3]>,
}

/// The normals of all corners, given the angle in degrees from which on an edge is a crease.
///
/// Two triangles turn at their common edge by the angle between their normals: 0 in a plane, 90 degrees at the edge of a
/// cube. At each vertex, corners are one group if a way around the vertex leads from one to the other over edges that
/// turn by less than `crease_deg`. A vertex with one group, or without a crease, keeps the mesh's normal, to the bit.
/// Each group of any other vertex has a normal of its own, as a copy: the mean of its triangles' unit normals, weighted by
/// area and by the angle at the vertex. That mean is not tilted by how a flat side is cut into triangles: a corner's angles
/// add up to the side's own (Thürmer and Wüthrich 1998 for the angle; the area keeps slivers from turning it).
///
/// An edge with one triangle is no crease. One whose two triangles run it in the same direction is. Of more than two
/// triangles at an edge, those pairs go together that run it in opposite directions and turn least. A triangle too low
/// for single precision to say where it points belongs to the triangles beside it, which are compared in its place.
///
/// Mesh normals that are not one per vertex are computed as [`area_weighted_normals`]. With 0 every edge that turns is a
/// crease, and with 180 none is that does not fold back on itself.
///
/// # Panics
/// If an index is out of range.
pub fn corner_normals(mesh: &TriangleMesh, crease_deg: f32) -> CornerNormals {
    let mut normals = match mesh.normals.len() == mesh.positions.len() {
        true => mesh.normals.clone(),
        false => area_weighted_normals(&mesh.positions, &mesh.triangles),
    };
    let faces: Vec<Option<Face>> = (0..mesh.triangles.len()).map(|t| Face::of(mesh.corners(t))).collect();
    let fans = Fans::of(mesh, &faces);
    let (mut groups, has_crease) = fans.groups(mesh, &faces, libm::cos(f64::from(crease_deg).to_radians()));

    // The corners of each vertex that has a crease, vertex by vertex.
    let mut at_creases: Vec<[u32; 2]> = (0..3 * mesh.triangles.len() as u32)
        .map(|corner| [mesh.triangles.as_flattened()[corner as usize], corner])
        .filter(|[vertex, _]| has_crease[*vertex as usize])
        .collect();
    at_creases.sort_unstable();
    let (mut copies, mut corners) = (Vec::new(), mesh.triangles.clone());
    let mut numbers: HashMap<u32, u32> = HashMap::new();
    for fan in at_creases.chunk_by(|a, b| a[0] == b[0]) {
        let vertex = fan[0][0];
        let roots: Vec<u32> = fan.iter().map(|&[_, corner]| groups.root(corner)).collect();
        if roots.iter().all(|root| *root == roots[0]) {
            continue;
        }
        numbers.clear();
        let mut sums: Vec<DVec3> = Vec::new();
        let first = normals.len() as u32;
        for (&[_, corner], &root) in fan.iter().zip(&roots) {
            let next = sums.len() as u32;
            let number = *numbers.entry(root).or_insert(next);
            if number == next {
                sums.push(DVec3::ZERO);
            }
            sums[number as usize] += weighted(mesh, &faces, corner);
            corners.as_flattened_mut()[corner as usize] = first + number;
        }
        let own = normals[vertex as usize];
        copies.extend(sums.iter().map(|_| vertex));
        normals.extend(sums.iter().map(|sum| sum.try_normalize().map_or(own, DVec3::as_vec3)));
    }
    CornerNormals { normals, copies, corners }
}

impl CornerNormals {
    /// The mesh with its vertices as they are, those without a corner included, and the copies after them.
    ///
    /// # Panics
    /// If `mesh` has fewer vertices than the mesh whose normals these are.
    pub fn with_copies(&self, mesh: &TriangleMesh) -> TriangleMesh {
        let mut positions = mesh.positions.clone();
        positions.extend(self.copies.iter().map(|&vertex| mesh.positions[vertex as usize]));
        TriangleMesh { positions, normals: self.normals.clone(), triangles: self.corners.clone() }
    }

    /// The mesh with a vertex for each normal, for formats and graphics cards in which a vertex has one. The first copy of
    /// a vertex takes its place, and the others come last. [`weld`](crate::weld()) undoes it.
    ///
    /// # Panics
    /// As [`with_copies`](Self::with_copies).
    pub fn split(&self, mesh: &TriangleMesh) -> TriangleMesh {
        let mut split = TriangleMesh { normals: self.normals.clone(), ..mesh.clone() };
        let own = mesh.positions.len();
        split.normals.truncate(own);
        let mut places: Vec<u32> = (0..own as u32).collect();
        for (i, (&vertex, &normal)) in self.copies.iter().zip(&self.normals[own..]).enumerate() {
            if i == 0 || self.copies[i - 1] != vertex {
                split.normals[vertex as usize] = normal;
                places.push(vertex);
            } else {
                places.push(split.positions.len() as u32);
                split.positions.push(mesh.positions[vertex as usize]);
                split.normals.push(normal);
            }
        }
        split.triangles = self.corners.iter().map(|t| t.map(|place| places[place as usize])).collect();
        split
    }
}

/// A triangle that has a direction.
#[derive(Debug, Clone, Copy)]
struct Face {
    /// Of unit length.
    normal: DVec3,
    double_area: f64,
}

impl Face {
    fn of(corners: [Vec3; 3]) -> Option<Face> {
        let [a, b, c] = corners.map(|p| p.as_dvec3());
        let across = (b - a).cross(c - a);
        let double_area = across.length();
        let longest = (b - a).length().max((c - b).length()).max((a - c).length());
        let largest = corners.into_iter().fold(0.0f32, |most, p| most.max(p.abs().max_element()));
        let rounding = f64::from(largest) * f64::from(f32::EPSILON);
        // Written so that NaN fails.
        (double_area > longest * ROUNDINGS * rounding)
            .then(|| Face { normal: across / double_area, double_area })
    }
}

/// What a corner adds to its group's normal.
fn weighted(mesh: &TriangleMesh, faces: &[Option<Face>], corner: u32) -> DVec3 {
    let (triangle, k) = (corner as usize / 3, corner as usize % 3);
    let Some(Face { normal, double_area }) = faces[triangle] else { return DVec3::ZERO };
    let corners = mesh.corners(triangle).map(|p| p.as_dvec3());
    let (out, back) = (corners[(k + 1) % 3] - corners[k], corners[(k + 2) % 3] - corners[k]);
    normal * (double_area * libm::atan2(double_area, out.dot(back)))
}

/// The corners of each vertex, in their order around it.
struct Fans {
    /// For the side of a triangle, from corner `3 t + k` to the next, the side of the triangle beyond; or [`NONE`].
    across: Vec<u32>,
    /// Whether an edge ends at a vertex over which not all triangles can share a normal.
    is_cut: Vec<bool>,
}

impl Fans {
    fn of(mesh: &TriangleMesh, faces: &[Option<Face>]) -> Fans {
        let mut across = vec![NONE; 3 * mesh.triangles.len()];
        let mut is_cut = vec![false; mesh.positions.len()];
        for edge in Connectivity::of(&mesh.triangles).edges() {
            for [a, b] in pairs(edge, faces) {
                across[a as usize] = b;
                across[b as usize] = a;
            }
            if edge.len() > 2 || edge.len() == 2 && across[edge[0].corners()[0] as usize] == NONE {
                edge[0].ends().into_iter().for_each(|vertex| is_cut[vertex as usize] = true);
            }
        }
        Fans { across, is_cut }
    }

    /// The next corner around the vertex of `corner`, over the side that begins there.
    fn next(&self, corner: u32) -> Option<u32> {
        let beyond = self.across[corner as usize];
        (beyond != NONE).then(|| beyond / 3 * 3 + (beyond % 3 + 1) % 3)
    }

    /// Corners in groups, and which vertices have a crease.
    fn groups(
        self,
        mesh: &TriangleMesh,
        faces: &[Option<Face>],
        cos_crease: f64,
    ) -> (DisjointSets, Vec<bool>) {
        let corners = 3 * mesh.triangles.len() as u32;
        let face = |corner: u32| faces[corner as usize / 3];
        let mut groups = DisjointSets::new(corners as usize);
        let mut has_crease = self.is_cut.clone();
        let mut is_passed = vec![false; corners as usize];
        for corner in 0..corners {
            let Some(here) = face(corner) else { continue };
            let mut beside = self.next(corner);
            // What has no direction is passed over; it goes with the corner before it.
            while let Some(at) = beside.filter(|at| face(*at).is_none()) {
                groups.join(corner, at);
                is_passed[at as usize] = true;
                beside = self.next(at);
            }
            if let Some((at, there)) = beside.and_then(|at| Some((at, face(at)?))) {
                match here.normal.dot(there.normal) > cos_crease {
                    true => groups.join(corner, at),
                    false => has_crease[mesh.triangles.as_flattened()[corner as usize] as usize] = true,
                }
            }
        }
        // At the start of an open fan no corner is before it.
        for corner in (0..corners).filter(|c| face(*c).is_none() && !is_passed[*c as usize]) {
            if let Some(next) = self.next(corner) {
                groups.join(corner, next);
            }
        }
        (groups, has_crease)
    }
}

/// The sides at an edge that go together, two and two.
fn pairs(edge: &[HalfEdge], faces: &[Option<Face>]) -> Vec<[u32; 2]> {
    let side = |of: &HalfEdge| of.corners()[0];
    if let [a, b] = edge {
        return if a.forward == b.forward { Vec::new() } else { vec![[side(a), side(b)]] };
    }
    let mut candidates = Vec::new();
    for (i, a) in edge.iter().enumerate() {
        for b in edge[i + 1..].iter().filter(|b| b.forward != a.forward) {
            let [one, other] = [a, b].map(|of| faces[side(of) as usize / 3]);
            if let (Some(one), Some(other)) = (one, other) {
                candidates.push((one.normal.dot(other.normal), [side(a), side(b)]));
            }
        }
    }
    // Those that turn least first; of equals those that come first.
    candidates.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    let mut taken: Vec<[u32; 2]> = Vec::new();
    for (_, pair) in candidates {
        if !taken.as_flattened().iter().any(|side| pair.contains(side)) {
            taken.push(pair);
        }
    }
    taken
}

#[cfg(test)]
mod tests;
