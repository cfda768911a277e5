//! Cubical marching squares: polygons of marching cubes with vertices on creases, in faces of cubes and within cubes (Ho, Wu, Chen, Chuang &
//! Ouhyoung 2005).
//!
//! A polygon goes from crossing to crossing across the faces of its cube. Where the tangents of two crossings in their face meet at an
//! angle, they meet in a vertex there, which both cubes have. A cube with a crease has one more vertex within, where the tangent planes
//! meet, and a fan of triangles round it. A point strictly within a convex cell sees its whole boundary, so no two triangles of a fan
//! pass through each other, and none leaves its cube.
//!
//! Faces are decided by signs, not by the tangents as published. A cube that the surface crosses in two sheets keeps the triangles of
//! marching cubes, and so do both sides of a face that is crossed twice.

use std::collections::{HashMap, TryReserveError};

use glam::{DVec2, DVec3, Vec3};

use super::grid::CubeGrid;
use super::vertices::within;
use crate::clock::Moment;
use crate::duals::{Sharp, Tangent, tangent};
use crate::execution::threads::for_each_on_threads;
use crate::extraction::{ExtractError, Extraction};
use crate::memory::{collected, filled, push, with_room};
use crate::sampling::level::Level;
use crate::source::Request;
use crate::surface::trace::Trace;

/// How far vertices stay within their face or cube, in its edges.
const MARGIN: f64 = 1.0 / 1024.0;
/// A normal that is nearer to that of the face says nothing of the direction within it.
const LEAST_IN_FACE: f64 = 0.1;
/// As for dual contouring.
const TRUNCATION: f32 = 1e-3;

/// What counts as a crease.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Creases {
    /// Normals that are farther apart have a crease between them, in degrees.
    pub(crate) crease_deg: f32,
}

impl Creases {
    /// Adds the vertices on creases to an extraction of marching cubes, whose trace is given. Crossings become roots of the field.
    ///
    /// # Errors
    /// [`ExtractError::NoMemoryForMesh`], [`ExtractError::Threads`], [`ExtractError::Cancelled`], [`ExtractError::TooManyVertices`].
    pub(crate) fn apply(
        self,
        request: &Request,
        trace: &Trace,
        extraction: &mut Extraction,
    ) -> Result<(), ExtractError> {
        let Some(level) = request.level() else { return Ok(()) };
        let start = Moment::now();
        let grid = &CubeGrid::new(request.lattice)?;
        let origin = request.lattice.origin();
        let edges = collected(trace.keys.iter().map(|key| {
            let from = key.cell();
            Edge { from: [0, 1, 2].map(|axis| (from[axis] - origin[axis]) as usize), axis: key.direction() }
        }))?;
        let tangents = tangents(request, level, grid, &edges)?;
        let mesh = &mut extraction.mesh;
        for ((position, edge), (crossing, _)) in mesh.positions.iter_mut().zip(&edges).zip(&tangents) {
            let ends = [0, 1].map(|end| grid.at[edge.axis][edge.from[edge.axis] + end]);
            let way = f64::from(ends[1]) - f64::from(ends[0]);
            position[edge.axis] = within(ends[0], ends[1], (crossing[edge.axis] - f64::from(ends[0])) / way);
        }
        let least_cosine = f64::from(self.crease_deg).to_radians().cos();
        let mut pass = Pass { grid, edges: &edges, tangents: &tangents, least_cosine, faces: HashMap::new() };
        // A crossing lies in four faces, of which each has two crossings or four.
        pass.faces.try_reserve(2 * edges.len())?;
        let mut polygons = Polygons::with_room()?;
        let cells = cells(&trace.cells)?;
        for cell in &cells {
            request.control.check()?;
            pass.find_faces(&mesh.triangles[cell.clone()], &mut polygons);
        }
        let mut triangles = Vec::new();
        for cell in cells {
            pass.write(&mesh.triangles[cell], &mut polygons, &mut mesh.positions, &mut triangles)?;
        }
        if mesh.positions.len() as u64 > u64::from(request.most_vertices) {
            return Err(ExtractError::TooManyVertices { limit: request.most_vertices });
        }
        mesh.triangles = triangles;
        extraction.renew()?;
        extraction.times.vertex += start.elapsed();
        Ok(())
    }
}

/// A crossed edge: the point that it begins at, and its axis.
#[derive(Debug, Clone, Copy)]
struct Edge {
    from: [usize; 3],
    axis: usize,
}

fn tangents(
    request: &Request,
    level: Level,
    grid: &CubeGrid,
    edges: &[Edge],
) -> Result<Vec<Tangent>, ExtractError> {
    let mut found = filled(edges.len(), (DVec3::ZERO, None))?;
    request.control.check()?;
    for_each_on_threads(request.control.threads, &mut found, |v, found| {
        let Edge { from, axis } = edges[v];
        let mut to = from;
        to[axis] += 1;
        let ends = [from, to].map(|end| level.field.sample(grid.position(end)));
        *found = tangent(level, grid, from, axis, ends);
    })?;
    Ok(found)
}

/// Which triangles each cell has.
fn cells(of_triangles: &[u32]) -> Result<Vec<std::ops::Range<usize>>, ExtractError> {
    let (mut cells, mut start) = (Vec::new(), 0);
    for own in of_triangles.chunk_by(|a, b| a == b) {
        push(&mut cells, start..start + own.len())?;
        start += own.len();
    }
    Ok(cells)
}

/// A face of a cube: its lowest corner, and the axis across it.
type Face = ([usize; 3], usize);

/// What is known of a face that the surface crosses.
struct Crossed {
    /// The crossings that a polygon goes between, the lower number first.
    between: [u32; 2],
    /// Whether a vertex may lie in it: it is crossed once, by cubes that are crossed once.
    is_free: bool,
    /// Its vertex, once that was looked for.
    vertex: Option<Option<u32>>,
}

struct Pass<'a> {
    grid: &'a CubeGrid<'a>,
    edges: &'a [Edge],
    tangents: &'a [Tangent],
    least_cosine: f64,
    faces: HashMap<Face, Crossed>,
}

impl Pass<'_> {
    /// Notes the faces that a cell's polygons cross.
    fn find_faces(&mut self, triangles: &[[u32; 3]], polygons: &mut Polygons) {
        polygons.find(triangles);
        for polygon in polygons.all() {
            for (i, &v) in polygon.iter().enumerate() {
                let u = polygon[(i + 1) % polygon.len()];
                let between = [v.min(u), v.max(u)];
                let (face, is_single) = (self.face([v, u]), polygons.ends.len() == 1);
                let new = || Crossed { between, is_free: true, vertex: None };
                let known = self.faces.entry(face).or_insert_with(new);
                known.is_free &= is_single && known.between == between;
            }
        }
    }

    /// The face between two crossings of it.
    fn face(&self, between: [u32; 2]) -> Face {
        let [a, b] = between.map(|v| self.edges[v as usize]);
        let is_across = |axis: &usize| *axis != a.axis && *axis != b.axis && a.from[*axis] == b.from[*axis];
        let across = (0..3).find(is_across).expect("a polygon goes across faces");
        let mut lowest = [0, 1, 2].map(|axis| a.from[axis].min(b.from[axis]));
        // Along its own axis an edge begins at the face's lowest corner; the other one may be at the end of it.
        lowest[a.axis] = a.from[a.axis];
        lowest[b.axis] = b.from[b.axis];
        (lowest, across)
    }

    /// Writes the triangles of a cell.
    fn write(
        &mut self,
        own: &[[u32; 3]],
        polygons: &mut Polygons,
        positions: &mut Vec<Vec3>,
        triangles: &mut Vec<[u32; 3]>,
    ) -> Result<(), ExtractError> {
        polygons.find(own);
        let Polygons { vertices: polygon, ends, round, tangents, .. } = polygons;
        if ends.len() != 1 {
            return extend(triangles, own);
        }
        round.clear();
        for (i, &v) in polygon.iter().enumerate() {
            round.push(v);
            round.extend(self.face_vertex([v, polygon[(i + 1) % polygon.len()]], positions)?);
        }
        if round.len() == polygon.len() && !self.has_crease(polygon) {
            return extend(triangles, own);
        }
        tangents.clear();
        tangents.extend(polygon.iter().map(|&v| self.tangents[v as usize]));
        let (low, high) = self.cell(polygon);
        let margin = MARGIN * (high - low);
        let sharp = Sharp { truncation: TRUNCATION, in_cell: true };
        let centre = positions.len() as u32;
        push(positions, sharp.vertex(tangents, low + margin, high - margin).as_vec3())?;
        for (i, &v) in round.iter().enumerate() {
            push(triangles, [v, round[(i + 1) % round.len()], centre])?;
        }
        Ok(())
    }

    /// The corners of the cell that a polygon goes round.
    fn cell(&self, polygon: &[u32]) -> (DVec3, DVec3) {
        let edges = || polygon.iter().map(|&v| self.edges[v as usize]);
        // A polygon has edges on at least three faces, one of them beginning at the lowest place along each axis.
        let lowest = [0, 1, 2].map(|axis| {
            let along = edges().filter(|edge| edge.axis == axis).map(|edge| edge.from[axis]).next();
            along.unwrap_or_else(|| edges().map(|edge| edge.from[axis]).min().unwrap_or(0))
        });
        let corner = |of: [usize; 3]| self.grid.position(of).as_dvec3();
        (corner(lowest), corner(lowest.map(|i| i + 1)))
    }

    fn has_crease(&self, polygon: &[u32]) -> bool {
        let normal = |v: u32| self.tangents[v as usize].1;
        let are_apart = |v: u32, u: u32| {
            normal(v).zip(normal(u)).is_some_and(|(one, other)| one.dot(other) < self.least_cosine)
        };
        (0..polygon.len()).any(|i| polygon[..i].iter().any(|&before| are_apart(before, polygon[i])))
    }

    /// The vertex in the face between two crossings, where it has one.
    fn face_vertex(
        &mut self,
        between: [u32; 2],
        positions: &mut Vec<Vec3>,
    ) -> Result<Option<u32>, ExtractError> {
        let face = self.face(between);
        let known = &self.faces[&face];
        if !known.is_free {
            return Ok(None);
        }
        if let Some(vertex) = known.vertex {
            return Ok(vertex);
        }
        let found = self.meeting(face, known.between);
        let vertex = found.is_some().then_some(positions.len() as u32);
        if let Some(at) = found {
            push(positions, at)?;
        }
        self.faces.entry(face).and_modify(|known| known.vertex = Some(vertex));
        Ok(vertex)
    }

    /// Where the tangents at two crossings meet in their face, if they do at an angle.
    fn meeting(&self, (lowest, across): Face, between: [u32; 2]) -> Option<Vec3> {
        let [a, b] = [(across + 1) % 3, (across + 2) % 3];
        let flat = |p: DVec3| DVec2::new(p[a], p[b]);
        let of = |v: u32| -> Option<(DVec2, DVec2)> {
            let (crossing, normal) = self.tangents[v as usize];
            let within = flat(normal?);
            (within.length() > LEAST_IN_FACE).then(|| (flat(crossing), within.normalize()))
        };
        let [(p, n), (q, m)] = [of(between[0])?, of(between[1])?];
        let area = n.perp_dot(m);
        if n.dot(m) >= self.least_cosine || area == 0.0 {
            return None;
        }
        let at = DVec2::new(n.dot(p) * m.y - m.dot(q) * n.y, m.dot(q) * n.x - n.dot(p) * m.x) / area;
        let [low, high] = [0, 1].map(|end| {
            let corner = lowest.map(|i| i + end);
            DVec2::new(f64::from(self.grid.at[a][corner[a]]), f64::from(self.grid.at[b][corner[b]]))
        });
        let margin = MARGIN * (high - low);
        if !(at.cmpge(low + margin).all() && at.cmple(high - margin).all()) {
            return None;
        }
        let mut found = Vec3::ZERO;
        (found[a], found[b]) = (at.x as f32, at.y as f32);
        found[across] = self.grid.at[across][lowest[across]];
        Some(found)
    }
}

fn extend(triangles: &mut Vec<[u32; 3]>, own: &[[u32; 3]]) -> Result<(), ExtractError> {
    triangles.try_reserve(own.len())?;
    triangles.extend_from_slice(own);
    Ok(())
}

/// The polygons that a cell's triangles are made of, in the direction of theirs, and what is worked out for one. Kept from cell to cell,
/// so that nothing is allocated where memory may be short.
struct Polygons {
    /// One after the other.
    vertices: Vec<u32>,
    /// Where each ends.
    ends: Vec<usize>,
    rest: Vec<[u32; 2]>,
    round: Vec<u32>,
    tangents: Vec<Tangent>,
}

impl Polygons {
    /// More than any cell has: twelve crossings in up to four polygons, with as many vertices in faces.
    const ROOM: usize = 64;

    fn with_room() -> Result<Self, TryReserveError> {
        Ok(Self {
            vertices: with_room(Self::ROOM)?,
            ends: with_room(Self::ROOM)?,
            rest: with_room(Self::ROOM)?,
            round: with_room(Self::ROOM)?,
            tangents: with_room(Self::ROOM)?,
        })
    }

    fn find(&mut self, triangles: &[[u32; 3]]) {
        let Self { vertices, ends, rest, .. } = self;
        let sides = || triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
        vertices.clear();
        ends.clear();
        rest.clear();
        rest.extend(sides().filter(|&[a, b]| !sides().any(|side| side == [b, a])));
        while let Some([first, mut last]) = rest.pop() {
            vertices.push(first);
            while last != first {
                vertices.push(last);
                let Some(next) = rest.iter().position(|side| side[0] == last) else { break };
                last = rest.swap_remove(next)[1];
            }
            ends.push(vertices.len());
        }
    }

    fn all(&self) -> impl Iterator<Item = &[u32]> {
        let start = |i: usize| if i == 0 { 0 } else { self.ends[i - 1] };
        self.ends.iter().enumerate().map(move |(i, &end)| &self.vertices[start(i)..end])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn triangles_have_the_polygons_that_they_are_made_of() {
        let turned = |mut polygon: Vec<u32>| {
            let least = polygon.iter().enumerate().min_by_key(|(_, v)| **v).unwrap().0;
            polygon.rotate_left(least);
            polygon
        };
        let of = |triangles: &[[u32; 3]]| {
            let mut polygons = Polygons::with_room().unwrap();
            polygons.find(triangles);
            let mut all: Vec<Vec<u32>> = polygons.all().map(|of| turned(of.to_vec())).collect();
            all.sort();
            all
        };
        assert_eq!(of(&[[4, 2, 9]]), [[2, 9, 4]]);
        assert_eq!(of(&[[0, 1, 2], [0, 2, 3], [0, 3, 4]]), [[0, 1, 2, 3, 4]]);
        assert_eq!(of(&[[0, 1, 2], [5, 4, 3]]), [[0, 1, 2], [3, 5, 4]]);
    }
}
