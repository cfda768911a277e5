//! Warp clustering: lattice points that the surface passes close to are moved onto it (Labelle & Shewchuk 2007, isosurface stuffing).
//!
//! A point of the body-centred lattice is *warped* if a crossing on one of its fourteen edges is nearer to it than a share of the edge.
//! The nearest such crossing, in shares of its edge, is where it goes. All crossings on its edges, the far ones too, become that one
//! vertex, since the surface passes through the point now. Whether a point is warped depends on its own edges alone, not on what became
//! of its neighbours: so the order of points does not matter, and chunks agree.
//!
//! A crossing between two warped points is the inside end's. Then triangles are the boundary of the tetrahedra with a point inside that was
//! not warped, as published, and of those whose four points all were inside, which as published are left out where all four are warped.
//! Two such tetrahedra may share a face of three warped points: its triangle would be there twice, back to back, and both are dropped, as
//! the face is inside the solid. So every side is used as often one way as the other.

use std::collections::TryReserveError;

use glam::{I64Vec3, Vec3};
use isostudy_mesh::TriangleMesh;

use crate::extraction::Extraction;
use crate::lattice::{Arrangement, Border, Directions, Lattice, Layout, PointKind};
use crate::memory::{collected, filled, push, with_room};
use crate::surface::normals::vertex_normals;
use crate::surface::trace::{Trace, VertexKey};

/// How near a crossing must be, in shares of an edge between two centres or two corners.
const ALPHA_LONG: f32 = 0.24999;
/// The same of an edge between a centre and a corner. With this pair, angles of the surface's triangles are from 13.0 to 145.2 degrees, and
/// those between faces of tetrahedra without a quadrilateral from 11.3 to 155.8: driven to the worst in `tests/it/warp_angles.rs`, and once
/// more in `scripts/warp-angles.py`. Off the box, where the lattice is not thinner.
const ALPHA_SHORT: f32 = 0.359;

/// Of a vertex that nothing uses any more.
const NOWHERE: u32 = u32::MAX;

/// Warps the unclustered mesh of a body-centred lattice, and its trace. Vertices and triangles that are left keep their order.
///
/// # Errors
/// If there is no memory.
pub(crate) fn warp(
    lattice: &Lattice,
    trace: &mut Trace,
    extraction: &mut Extraction,
) -> Result<(), TryReserveError> {
    let mesh = &mut extraction.mesh;
    let points = Points::find(lattice, &trace.keys, &mesh.positions)?;
    let inside = points.insides(&mesh.triangles)?;
    let into: Vec<u32> = collected((0..mesh.positions.len()).map(|v| points.becomes(v, inside[v])))?;
    let before = mesh.triangles.len();
    let is_warped = points.is_warp;
    keep(mesh, trace, &into, &is_warped)?;
    let (vertices, triangles) = (mesh.positions.len() as u64, mesh.triangles.len() as u64);
    mesh.normals = vertex_normals(&mesh.positions, &mesh.triangles)?;
    let counts = &mut extraction.counts;
    let discarded = before as u64 - triangles;
    counts.discarded_triangles += discarded;
    if let Some(tetrahedra) = &mut counts.tetrahedra {
        tetrahedra.discarded_as_published += discarded;
    }
    (counts.vertices, counts.triangles) = (vertices, triangles);
    (counts.vertex_bytes, counts.index_bytes) = (24 * vertices, 12 * triangles);
    Ok(())
}

/// The sample points that have vertices, as the vertices' keys name them.
struct Points<'a> {
    directions: &'static Directions,
    layout: Layout,
    keys: &'a [VertexKey],
    /// Of each vertex, whether it is the one that its point is warped to.
    is_warp: Vec<bool>,
    /// Of each vertex, the one that its point is warped to.
    warped: Vec<Option<u32>>,
}

impl<'a> Points<'a> {
    /// Finds out which points are warped, and where to. Keys ascend, so the vertices of a point are in a row.
    fn find(lattice: &Lattice, keys: &'a [VertexKey], positions: &[Vec3]) -> Result<Self, TryReserveError> {
        let (is_warp, warped) = (filled(keys.len(), false)?, filled(keys.len(), None)?);
        let directions = lattice.arrangement().directions();
        let mut points = Self { directions, layout: Layout::new(lattice), keys, is_warp, warped };
        let mut first = 0;
        while first < keys.len() {
            let place = keys[first].stored();
            let count = keys[first..].iter().take_while(|key| key.stored() == place).count();
            let mut nearest = (f32::INFINITY, None);
            for v in first..first + count {
                let direction = keys[v].direction();
                let [here, there] =
                    [place, points.neighbour(place, direction)].map(|place| position(lattice, place));
                let way = there - here;
                let share = (positions[v] - here).dot(way) / way.length_squared();
                // A share that is not a number is near to nothing.
                if share < alpha(directions, direction) && share < nearest.0 {
                    nearest = (share, Some(v as u32));
                }
            }
            if let Some(v) = nearest.1 {
                points.is_warp[v as usize] = true;
                points.warped[first..first + count].fill(nearest.1);
            }
            first += count;
        }
        Ok(points)
    }

    fn neighbour(&self, place: [i64; 3], direction: usize) -> [i64; 3] {
        let hop = self.layout.hop(kind(place), self.directions.offsets[direction]);
        [0, 1, 2].map(|axis| place[axis] + hop[axis] as i64)
    }

    /// The vertex that a point is warped to, if it is. One that is has a vertex of its own.
    fn warped_at(&self, place: [i64; 3]) -> Option<u32> {
        let first =
            self.keys.partition_point(|key| *key < VertexKey::new(Arrangement::BodyCentred, place, 0));
        self.keys.get(first).filter(|key| key.stored() == place)?;
        self.warped[first]
    }

    /// Whether the point of each vertex is inside. Triangles face outward, and as the crossings of a tetrahedron move along their edges its
    /// triangles never pass a corner: so the middles of the edges tell it, in whole numbers.
    fn insides(&self, triangles: &[[u32; 3]]) -> Result<Vec<bool>, TryReserveError> {
        let mut inside = filled(self.keys.len(), false)?;
        let way = |v: u32| {
            let offset = self.directions.offsets[self.keys[v as usize].direction()];
            I64Vec3::from_array(offset.map(i64::from))
        };
        let middle = |v: u32| 2 * I64Vec3::from_array(halves(self.keys[v as usize].stored())) + way(v);
        for &triangle in triangles {
            let [a, b, c] = triangle.map(middle);
            let outward = (b - a).cross(c - a);
            for v in triangle {
                inside[v as usize] = outward.dot(way(v)) > 0;
            }
        }
        Ok(inside)
    }

    /// The vertex that a crossing becomes. The one that a point is warped to may itself become another's, as the crossing that it is.
    fn becomes(&self, v: usize, inside: bool) -> u32 {
        let key = self.keys[v];
        let there = self.warped_at(self.neighbour(key.stored(), key.direction()));
        match (self.warped[v], there) {
            (Some(here), Some(there)) => {
                if inside {
                    here
                } else {
                    there
                }
            }
            (here, there) => here.or(there).unwrap_or(v as u32),
        }
    }
}

fn alpha(directions: &Directions, direction: usize) -> f32 {
    if directions.offsets[direction].contains(&0) { ALPHA_LONG } else { ALPHA_SHORT }
}

fn kind([_, _, z]: [i64; 3]) -> PointKind {
    if z.rem_euclid(2) == 0 { PointKind::Centre } else { PointKind::Corner }
}

/// Where a stored point lies in half cells of the whole lattice.
fn halves(place @ [x, y, z]: [i64; 3]) -> [i64; 3] {
    match kind(place) {
        PointKind::Centre => [2 * x - 1, 2 * y - 1, z - 1],
        PointKind::Corner => [2 * x, 2 * y, z - 1],
    }
}

fn position(lattice: &Lattice, place: [i64; 3]) -> Vec3 {
    let halves = halves(place);
    Vec3::from_array([0, 1, 2].map(|axis| lattice.coordinate(axis, halves[axis], Border::OnBox)))
}

/// Keeps the triangles that have three corners still and are there once, and the vertices that they use.
fn keep(
    mesh: &mut TriangleMesh,
    trace: &mut Trace,
    into: &[u32],
    is_warped: &[bool],
) -> Result<(), TryReserveError> {
    let TriangleMesh { positions, triangles, .. } = mesh;
    let is_proper = |[a, b, c]: [u32; 3]| a != b && b != c && c != a;
    for triangle in triangles.iter_mut() {
        *triangle = triangle.map(|v| into[v as usize]);
    }
    let mut is_kept: Vec<bool> = collected(triangles.iter().map(|&triangle| is_proper(triangle)))?;
    for pair in back_to_back(triangles, &is_kept, is_warped)? {
        pair.into_iter().for_each(|t| is_kept[t] = false);
    }
    let mut numbers = filled(positions.len(), NOWHERE)?;
    for (triangle, _) in triangles.iter().zip(&is_kept).filter(|(_, is_kept)| **is_kept) {
        triangle.iter().for_each(|&v| numbers[v as usize] = v);
    }
    let mut count = 0;
    for v in 0..positions.len() {
        if numbers[v] != NOWHERE {
            numbers[v] = count as u32;
            (positions[count], trace.keys[count]) = (positions[v], trace.keys[v]);
            count += 1;
        }
    }
    positions.truncate(count);
    trace.keys.truncate(count);
    let mut count = 0;
    for t in 0..triangles.len() {
        if is_kept[t] {
            triangles[count] = triangles[t].map(|v| numbers[v as usize]);
            trace.cells[count] = trace.cells[t];
            count += 1;
        }
    }
    triangles.truncate(count);
    trace.cells.truncate(count);
    Ok(())
}

/// Pairs of triangles with the same corners, which face opposite ways: there are some of warped points alone.
fn back_to_back(
    triangles: &[[u32; 3]],
    is_kept: &[bool],
    is_warped: &[bool],
) -> Result<Vec<[usize; 2]>, TryReserveError> {
    let is_of_warped = |t: usize| is_kept[t] && triangles[t].iter().all(|&v| is_warped[v as usize]);
    let mut sorted: Vec<([u32; 3], usize)> = Vec::new();
    for t in (0..triangles.len()).filter(|&t| is_of_warped(t)) {
        let mut corners = triangles[t];
        corners.sort_unstable();
        push(&mut sorted, (corners, t))?;
    }
    sorted.sort_unstable();
    let mut pairs = with_room(sorted.len() / 2)?;
    for same in sorted.chunk_by(|a, b| a.0 == b.0) {
        if let [(_, first), (_, second)] = *same {
            pairs.push([first, second]);
        }
    }
    Ok(pairs)
}
