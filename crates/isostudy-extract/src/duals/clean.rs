//! Nets that do not pass through themselves: each quadrilateral stays in the envelope of its edge (Ju & Udeshi 2006).
//!
//! **Envelopes.** Take a vertex strictly within the region of its loop ([`Region`](super::region::Region)), and a point strictly within
//! each face that the loop crosses, in the region's part of it. Of a cell, an edge of a face, the point in that face and the vertex are the
//! corners of a tetrahedron. All such tetrahedra of a lattice have nothing but faces, edges and corners in common: those of one loop are
//! cones over triangles in the rim of a convex region, from a point within; regions of a cell are apart; and so are cells. The *envelope* of a
//! crossed edge is what has that edge: two tetrahedra in each of the four cells round it. Envelopes of different edges have no more in
//! common than their rims, and each polygon round an edge, from vertex to point in a face to vertex, lies in the rim of its own envelope
//! alone. So surfaces that are spanned within envelopes never pass through each other.
//!
//! **Faces.** Where the segment between two vertices passes through the inside of their face, in both regions' parts of it, that point serves,
//! and needs no vertex. Elsewhere the face gets a vertex.
//!
//! **Edges.** Let `a` and `b` be the ends of the edge. The envelope is the union of the tetrahedra `a b p q` for each side `p q` of the polygon.
//! Some triangles with the polygon as their rim lie in it if each of them has `a` strictly on one side and `b` strictly on the other, as the
//! surface should: the tetrahedra from `a` to the triangles, and from `b`, then are all of positive volume and have together the
//! envelope's rim as theirs, so they cover each point as often as that rim winds round it, which is once within and never beyond. The two
//! diagonals of a quadrilateral are tried, and where there are vertices in faces, fans from these. If none passes, a vertex on
//! the edge has a fan of triangles to the polygon: each of these is in one of the tetrahedra.
//!
//! All of it is decided by signs of determinants that are exact (`robust`), from the four vertices round an edge and their loops. So it does not
//! matter what is decided first, threads and chunks give the same, and it ends.
//!
//! **At the box** edges have no quadrilateral, and a loop can be cut into runs of quadrilaterals that have nothing but its vertex in common.
//! There the fan is filled up: triangles from the vertex to the open edges in between, in the tetrahedra of these edges.

use std::collections::{HashMap, TryReserveError};

use glam::{DVec3, Vec3};
use robust::Coord3D;

use super::octree::{self, Standing};
use super::plan::{Loop, Plans, Table, VertexPer};
use super::quads::{Quadrilateral, is_other_better};
use super::region::margin;
use super::sharp::Sharp;
use super::tangents::tangent;
use crate::clock::Moment;
use crate::cubes::grid::CubeGrid;
use crate::execution::threads::for_each_on_threads;
use crate::extraction::{ExtractError, Extraction};
use crate::lattice::Part;
use crate::memory::{collected, copied, filled, push, with_room};
use crate::sampling::level::Level;
use crate::source::{NormalsOf, Request};
use crate::surface::trace::{Trace, VertexKey};

/// Numbers of keys: vertices on the edges that begin at a point, by axis, and in the faces that begin there, by the axis across.
const ON_EDGE: usize = 4;
const IN_FACE: usize = ON_EDGE + 3;
/// Shares of a face's edges by which a point is certain to be in it, whatever was rounded: `f32` has 2²⁴ steps, and a share is known to a few
/// times 2⁻⁵² of them.
const SURE: f64 = 1e-6;
/// Of the planes in a face, as for dual contouring.
const TRUNCATION: f32 = 1e-3;

/// Has the quadrilaterals of an extraction stay in the envelopes of their edges. The trace says which loops its vertices stand for.
///
/// # Errors
/// [`ExtractError::NoMemoryForMesh`], [`ExtractError::Threads`], [`ExtractError::Cancelled`], [`ExtractError::TooManyVertices`].
pub(super) fn clean(
    request: &Request,
    (sharp, tolerance): (Sharp, f32),
    trace: &mut Trace,
    extraction: &mut Extraction,
) -> Result<(), ExtractError> {
    let Some(level) = request.level() else { return Ok(()) };
    let start = Moment::now();
    let grid = &CubeGrid::new(request.lattice)?;
    let mesh = &mut extraction.mesh;
    let triangles_before = mesh.triangles.len();
    let Standing { stands_for, mut positions, cells } = match tolerance > 0.0 {
        true => octree::merged(request, level, grid, (sharp, tolerance), trace, mesh)?,
        false => as_they_are(request.lattice.origin(), trace, &mesh.positions)?,
    };
    let mut plans = Plans::new(Table::get(VertexPer::Loop));
    let numbers = collected(trace.patterns.iter().map(|pattern| {
        let (inside, joined, at_box) = pattern.cell();
        (plans.number(inside, joined, at_box), pattern.vertex())
    }))?;
    let whole = &Loop::whole();
    let mut loops = collected(numbers.iter().map(|&(plan, vertex)| &plans.at(plan).loops[vertex]))?;
    for (v, &(low, size)) in cells.iter().enumerate().filter(|(_, (_, size))| *size > 1) {
        loops[v] = whole;
        let [low, high] = [low, low.map(|i| i + size)].map(|corner| grid.position(corner).as_dvec3());
        let margin = (high - low) * margin(low, high, size);
        positions[v] = positions[v].as_dvec3().clamp(low + margin, high - margin).as_vec3();
    }
    let origin = request.lattice.origin();
    let leaves = collected(trace.keys.iter().map(|key| {
        let cell = key.cell();
        [0, 1, 2].map(|axis| cell[axis].wrapping_sub(origin[axis]) as usize)
    }))?;
    let net = Net {
        level,
        grid,
        stands_for: &stands_for,
        positions: &positions,
        cells: &cells,
        leaves: &leaves,
        loops: &loops,
    };

    request.control.check()?;
    let pairs = mesh.triangles.as_chunks::<2>().0;
    let mut judged = filled(pairs.len(), Judged::default())?;
    for_each_on_threads(request.control.threads, &mut judged, |q, judged| *judged = net.judge(pairs[q]))?;

    request.control.check()?;
    let numbers = trace.cells.as_chunks::<2>().0;
    let mut triangles = with_room(mesh.triangles.len() + mesh.triangles.len() / 8)?;
    let mut of_cells = with_room(triangles.capacity())?;
    let mut added = Added { net: &net, known: HashMap::new(), all: Vec::new() };
    for (q, judged) in judged.iter().enumerate() {
        match judged.cut {
            Cut::Nothing => {}
            Cut::Triangle(of) => push(&mut triangles, of)?,
            Cut::Two(of) => of.into_iter().try_for_each(|of| push(&mut triangles, of))?,
            Cut::Polygon => added.polygon(judged, &mut triangles)?,
        }
        // Mostly two.
        while of_cells.len() < triangles.len() {
            push(&mut of_cells, numbers[q][0])?;
        }
    }
    let part = request.part.unwrap_or_else(|| Part::whole(request.lattice));
    let is_filled = added.fill(part, &mut triangles, &mut of_cells)?;
    let Added { all, .. } = added;
    if (trace.keys.len() + all.len()) as u64 > u64::from(request.most_vertices) {
        return Err(ExtractError::TooManyVertices { limit: request.most_vertices });
    }
    if is_filled {
        // What fills a cell comes after its quadrilaterals.
        let mut order: Vec<u32> = collected(0..triangles.len() as u32)?;
        order.sort_by_key(|&t| of_cells[t as usize]);
        triangles = collected(order.iter().map(|&t| triangles[t as usize]))?;
        of_cells = collected(order.iter().map(|&t| of_cells[t as usize]))?;
    }
    mesh.positions = positions;
    if !all.is_empty() || tolerance > 0.0 {
        put_in_order(all, &stands_for, &mut trace.keys, &mut mesh.positions, &mut triangles)?;
    }
    (mesh.triangles, trace.cells) = (triangles, of_cells);
    trace.patterns.clear();
    match request.normals {
        NormalsOf::Nothing => extraction.count(),
        _ => extraction.renew()?,
    }
    if tolerance > 0.0 {
        extraction.counts.discarded_triangles =
            (triangles_before as u64).saturating_sub(extraction.counts.triangles);
    }
    extraction.times.geometry += start.elapsed();
    Ok(())
}

/// Each vertex in the cell that it was made in.
fn as_they_are(origin: [i32; 3], trace: &Trace, positions: &[Vec3]) -> Result<Standing, TryReserveError> {
    let cells = trace.keys.iter().map(|key| {
        let cell = key.cell();
        ([0, 1, 2].map(|axis| cell[axis].wrapping_sub(origin[axis]) as usize), 1)
    });
    Ok(Standing {
        stands_for: collected(0..positions.len() as u32)?,
        positions: copied(positions)?,
        cells: collected(cells)?,
    })
}

/// Adds vertices, whose numbers follow those that there are, so that all are in the order of their keys. Those for which others stand go.
fn put_in_order(
    added: Vec<(VertexKey, Vec3)>,
    stands_for: &[u32],
    keys: &mut Vec<VertexKey>,
    positions: &mut Vec<Vec3>,
    triangles: &mut [[u32; 3]],
) -> Result<(), TryReserveError> {
    let old = keys.len();
    let mut order: Vec<u32> = collected(0..added.len() as u32)?;
    order.sort_unstable_by_key(|&v| added[v as usize].0);
    let mut numbers = filled(old + added.len(), 0u32)?;
    let (mut all_keys, mut all_positions) = (with_room(numbers.len())?, with_room(numbers.len())?);
    let mut next = order.into_iter().peekable();
    for v in 0..=old {
        while let Some(new) = next.next_if(|&new| v == old || added[new as usize].0 < keys[v]) {
            let (key, position) = added[new as usize];
            numbers[old + new as usize] = all_keys.len() as u32;
            all_keys.push(key);
            all_positions.push(position);
        }
        if v < old && stands_for[v] as usize == v {
            numbers[v] = all_keys.len() as u32;
            all_keys.push(keys[v]);
            all_positions.push(positions[v]);
        }
    }
    (*keys, *positions) = (all_keys, all_positions);
    triangles.iter_mut().for_each(|triangle| *triangle = triangle.map(|v| numbers[v as usize]));
    Ok(())
}

/// A net as it was extracted, with cells of it merged.
struct Net<'a> {
    level: Level<'a>,
    grid: &'a CubeGrid<'a>,
    /// By vertex, the one that stands for it.
    stands_for: &'a [u32],
    positions: &'a [Vec3],
    /// The cell that each vertex is in: its lowest point, and its size in leaves.
    cells: &'a [([usize; 3], usize)],
    /// The leaf of each.
    leaves: &'a [[usize; 3]],
    loops: &'a [&'a Loop],
}

/// A quadrilateral, and what it needs.
#[derive(Debug, Clone, Copy)]
struct Judged {
    quad: Quadrilateral,
    /// The sides that need a vertex in their face, one bit each. The first goes from the first corner to the second.
    sides: u8,
    cut: Cut,
}

/// What becomes of a quadrilateral.
#[derive(Debug, Clone, Copy)]
enum Cut {
    /// Its edge lies within a merged cell, or in one face of two.
    Nothing,
    Triangle([u32; 3]),
    Two([[u32; 3]; 2]),
    /// It needs vertices.
    Polygon,
}

impl Default for Judged {
    fn default() -> Self {
        let quad = Quadrilateral { corners: [0; 4], leads_out: false };
        Self { quad, sides: 0, cut: Cut::Nothing }
    }
}

/// An edge of the lattice: the point that it begins at, and its axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Edge {
    from: [usize; 3],
    axis: usize,
}

impl Edge {
    /// The points at its ends: in the solid, and outside.
    fn ends(self, leads_out: bool) -> [[usize; 3]; 2] {
        let mut to = self.from;
        to[self.axis] += 1;
        if leads_out { [self.from, to] } else { [to, self.from] }
    }
}

/// A face between two cells, or a part of one: its lowest point, its size, the axis across it, and the corner round which it is halved.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Face {
    lowest: [usize; 3],
    size: usize,
    across: usize,
    half: Option<[bool; 2]>,
}

impl Face {
    /// The axes along it.
    fn axes(self) -> [usize; 2] {
        [(self.across + 1) % 3, (self.across + 2) % 3]
    }

    /// A corner, by whether it is the higher one along each axis.
    fn corner(self, [a, b]: [bool; 2]) -> [usize; 3] {
        let mut corner = self.lowest;
        let axes = self.axes();
        corner[axes[0]] += self.size * usize::from(a);
        corner[axes[1]] += self.size * usize::from(b);
        corner
    }

    /// The corners of the part, in order.
    fn rim(self) -> ([[usize; 3]; 4], usize) {
        match self.half {
            None => {
                ([[false, false], [true, false], [true, true], [false, true]].map(|of| self.corner(of)), 4)
            }
            Some([a, b]) => {
                let [at, first, second] = [[a, b], [!a, b], [a, !b]].map(|of| self.corner(of));
                // Counter-clockwise as above.
                if a == b { ([at, first, second, at], 3) } else { ([at, second, first, at], 3) }
            }
        }
    }

    /// The edges of the rim that the part has, each as long as the face.
    fn edges(self) -> impl Iterator<Item = Edge> {
        let axes = self.axes();
        let edge = move |(along, is_high): (usize, bool)| {
            let mut from = self.lowest;
            from[axes[1 - along]] += self.size * usize::from(is_high);
            Edge { from, axis: axes[along] }
        };
        let is_of_part =
            move |&(along, is_high): &(usize, bool)| self.half.is_none_or(|of| of[1 - along] == is_high);
        [(0, false), (0, true), (1, false), (1, true)].into_iter().filter(is_of_part).map(edge)
    }
}

/// Positive where the last point is below the plane of the others, which are counter-clockwise seen from above; exact.
fn orientation(of: [Vec3; 4]) -> f64 {
    let [a, b, c, d] = of.map(|p| {
        let [x, y, z] = p.to_array().map(f64::from);
        Coord3D { x, y, z }
    });
    robust::orient3d(a, b, c, d)
}

impl Net<'_> {
    fn judge(&self, pair: [[u32; 3]; 2]) -> Judged {
        let quad = Quadrilateral::of(pair);
        let standing = quad.corners.map(|v| self.stands_for[v as usize]);
        let mut polygon = [0; 4];
        let (mut count, mut sides) = (0, 0);
        for (side, &v) in standing.iter().enumerate().filter(|&(i, v)| *v != standing[(i + 1) % 4]) {
            polygon[count] = v;
            count += 1;
            sides |= u8::from(self.needs_vertex(quad, side)) << side;
        }
        let cut = match count {
            _ if count < 3 => Cut::Nothing,
            _ if sides != 0 => Cut::Polygon,
            3 => {
                let [a, b, c, _] = polygon;
                let triangle = if quad.leads_out { [a, b, c] } else { [a, c, b] };
                if self.divide(quad, &[triangle]) { Cut::Triangle(triangle) } else { Cut::Polygon }
            }
            _ => {
                let merged = Quadrilateral { corners: standing, leads_out: quad.leads_out };
                let prefers_other = match standing == quad.corners {
                    true => pair != quad.cut(false),
                    false => is_other_better(Some(self.level), standing.map(|v| self.positions[v as usize])),
                };
                let cuts = [prefers_other, !prefers_other].map(|by_other| merged.cut(by_other));
                cuts.into_iter().find(|cut| self.divide(quad, cut)).map_or(Cut::Polygon, Cut::Two)
            }
        };
        Judged { quad, sides, cut }
    }

    /// Whether each of some triangles has the ends of a quadrilateral's edge strictly on its sides.
    fn divide(&self, quad: Quadrilateral, triangles: &[[u32; 3]]) -> bool {
        let ends = self.edge(quad).ends(quad.leads_out).map(|end| self.grid.position(end));
        triangles.iter().all(|of| divides(of.map(|v| self.positions[v as usize]), ends))
    }

    /// The edge that a quadrilateral goes round.
    fn edge(&self, quad: Quadrilateral) -> Edge {
        let [lowest, _, highest, _] = quad.corners.map(|v| self.leaves[v as usize]);
        // The leaves differ along both other axes, by one.
        let axis = (0..3).find(|&axis| lowest[axis] == highest[axis]).unwrap_or(0);
        Edge { from: highest, axis }
    }

    /// Whether the segment along a side of a quadrilateral leaves the face between its cells, or one of its ends is to be joined to a vertex
    /// in it.
    fn needs_vertex(&self, quad: Quadrilateral, side: usize) -> bool {
        let (face, between) = self.face(quad, side);
        if self.filled_beyond(quad, face, between).is_some() {
            return true;
        }
        !self.passes(face, between.map(|v| self.positions[v as usize]))
    }

    /// Whether the segment between points below and above a face passes through the inside of its part.
    fn passes(&self, face: Face, between: [Vec3; 2]) -> bool {
        let [low, high] = between.map(Vec3::as_dvec3);
        let [least, most] = [[false; 2], [true; 2]].map(|of| self.grid.position(face.corner(of)).as_dvec3());
        let plane = least[face.across];
        let ways = [plane - low[face.across], high[face.across] - plane];
        // Both are of positive length, but where numbers are too coarse for points within cells.
        if !(ways[0] > 0.0 && ways[1] > 0.0) {
            return false;
        }
        let at = low + (high - low) * (ways[0] / (ways[0] + ways[1]));
        let [a, b] = face.axes().map(|axis| (at[axis] - least[axis]) / (most[axis] - least[axis]));
        let room = match face.half {
            None => a.min(1.0 - a).min(b).min(1.0 - b),
            Some(half) => {
                let [a, b] = [if half[0] { 1.0 - a } else { a }, if half[1] { 1.0 - b } else { b }];
                a.min(b).min(1.0 - a - b)
            }
        };
        if room.abs() > SURE {
            return room > 0.0;
        }
        let (rim, corners) = face.rim();
        let side = |i: usize| {
            let [p, q] = [rim[i], rim[(i + 1) % corners]].map(|corner| self.grid.position(corner));
            orientation([between[0], between[1], p, q])
        };
        let first = side(0);
        first != 0.0 && (1..corners).all(|i| side(i) * first.signum() > 0.0)
    }

    /// The face that a side passes, as far as it is its loops', and the vertices on its low and its high side. Of cells of two sizes it is
    /// that of the smaller one.
    fn face(&self, quad: Quadrilateral, side: usize) -> (Face, [u32; 2]) {
        let [a, b] = [quad.corners[side], quad.corners[(side + 1) % 4]];
        let [of_a, of_b] = [a, b].map(|v| self.leaves[v as usize]);
        let across = (0..3).find(|&axis| of_a[axis] != of_b[axis]).unwrap_or(0);
        let [low, high] = if of_a[across] < of_b[across] { [a, b] } else { [b, a] };
        let half = |v: u32, is_high: bool| self.loops[v as usize].region.half(across, is_high);
        let half = half(low, true).or(half(high, false));
        let cells = [low, high].map(|v| self.cells[v as usize]);
        let (mut lowest, size) = if cells[0].1 < cells[1].1 { cells[0] } else { cells[1] };
        lowest[across] = self.leaves[high as usize][across];
        (Face { lowest, size, across, half }, [low, high].map(|v| self.stands_for[v as usize]))
    }

    /// The face that gets a vertex for a side.
    fn face_of_vertex(&self, quad: Quadrilateral, side: usize) -> Face {
        let (face, between) = self.face(quad, side);
        // What fills a loop does not know the regions beyond, and puts its vertex where it fits all that there can be.
        match self.filled_beyond(quad, face, between) {
            Some(half) => Face { half, ..face },
            None => face,
        }
    }

    /// If a loop on either side is cut, and goes on from the quadrilateral's edge across the face to an edge without one: the corner that it
    /// goes round in the face, if it is one.
    fn filled_beyond(
        &self,
        quad: Quadrilateral,
        face: Face,
        [low, high]: [u32; 2],
    ) -> Option<Option<[bool; 2]>> {
        let table = Table::get(VertexPer::Loop);
        let edge = self.edge(quad);
        [(low, true), (high, false)].into_iter().find_map(|(v, is_high)| {
            let of = self.loops[v as usize];
            if of.open == 0 || !of.is_cut() {
                return None;
            }
            let cell = self.leaves[v as usize];
            let corner = (0..3).fold(0, |set, axis| set | u8::from(edge.from[axis] > cell[axis]) << axis);
            let own = table.number(corner, edge.axis);
            let at = of.edges.iter().position(|&other| other == own)?;
            let count = of.edges.len();
            let beside = [(at + 1) % count, (at + count - 1) % count].map(|beside| of.edges[beside]);
            let next = beside.into_iter().find(|&other| is_on_face(table, other, face.across, is_high))?;
            (of.open >> next & 1 != 0).then(|| corner_between(table, [own, next], face.across))
        })
    }
}

/// The corner of a face across an axis that two of its edges have in common, as [`Face::corner`] takes it.
fn corner_between(table: &Table, edges: [u8; 2], across: usize) -> Option<[bool; 2]> {
    let [(from, axis), (other, along)] = edges.map(|edge| table.edge(edge));
    if axis == along {
        return None;
    }
    // Along its own axis an edge has both ends; the other edge has one of them.
    let bit = |k: usize| (if k == usize::from(axis) { other } else { from }) >> k & 1 != 0;
    Some([(across + 1) % 3, (across + 2) % 3].map(bit))
}

/// Whether an edge of a cell lies in its low or high face across an axis.
fn is_on_face(table: &Table, edge: u8, across: usize, is_high: bool) -> bool {
    let (corner, axis) = table.edge(edge);
    usize::from(axis) != across && (corner >> across & 1 != 0) == is_high
}

/// Whether a triangle that faces out of the solid has a point of the solid and one outside strictly on its sides.
fn divides([a, b, c]: [Vec3; 3], [inside, outside]: [Vec3; 2]) -> bool {
    orientation([a, b, c, inside]) > 0.0 && orientation([a, b, c, outside]) < 0.0
}

/// The vertices that were added, in edges and faces.
struct Added<'a> {
    net: &'a Net<'a>,
    known: HashMap<VertexKey, u32>,
    all: Vec<(VertexKey, Vec3)>,
}

impl Added<'_> {
    /// Writes the triangles of a quadrilateral that needs vertices.
    fn polygon(&mut self, judged: &Judged, triangles: &mut Vec<[u32; 3]>) -> Result<(), ExtractError> {
        let (net, quad) = (self.net, judged.quad);
        let mut polygon = [0; 8];
        let (mut count, mut in_faces) = (0, 0u8);
        let standing = quad.corners.map(|v| net.stands_for[v as usize]);
        for side in (0..4).filter(|&i| standing[i] != standing[(i + 1) % 4]) {
            polygon[count] = standing[side];
            count += 1;
            if judged.sides >> side & 1 != 0 {
                polygon[count] = self.in_face(net.face_of_vertex(quad, side))?;
                in_faces |= 1 << count;
                count += 1;
            }
        }
        let polygon = &mut polygon[..count];
        if !quad.leads_out {
            // Counter-clockwise seen from outside, as triangles are.
            polygon.reverse();
            in_faces = in_faces.reverse_bits() >> (8 - count);
        }
        let edge = net.edge(quad);
        let ends = edge.ends(quad.leads_out).map(|end| net.grid.position(end));
        let fan = |apex: usize| {
            let at = move |i: usize| (apex + i) % count;
            (1..count - 1).map(move |i| [at(0), at(i), at(i + 1)])
        };
        let is_within =
            |apex: &usize| fan(*apex).all(|of| divides(of.map(|i| self.position(polygon[i])), ends));
        let apex = (0..count).filter(|&i| in_faces >> i & 1 != 0).find(is_within);
        if let Some(apex) = apex {
            return Ok(fan(apex).try_for_each(|of| push(triangles, of.map(|i| polygon[i])))?);
        }
        let centre = self.on_edge(edge)?;
        for i in 0..count {
            push(triangles, [centre, polygon[i], polygon[(i + 1) % count]])?;
        }
        Ok(())
    }

    /// Fills the gaps between the runs of cut loops of cells in a part, and says whether there are any.
    fn fill(
        &mut self,
        part: Part,
        triangles: &mut Vec<[u32; 3]>,
        of_cells: &mut Vec<u32>,
    ) -> Result<bool, ExtractError> {
        let net = self.net;
        let table = Table::get(VertexPer::Loop);
        let before = triangles.len();
        for (v, of) in net.loops.iter().enumerate() {
            let cell = net.leaves[v];
            if of.open == 0 || !of.is_cut() || !part.contains(cell) {
                continue;
            }
            for (i, &edge) in of.edges.iter().enumerate() {
                if of.open >> edge & 1 == 0 {
                    continue;
                }
                let count = of.edges.len();
                let place = |edge: u8| {
                    let (corner, axis) = table.edge(edge);
                    let from = [0, 1, 2].map(|axis| cell[axis] + usize::from(corner >> axis & 1));
                    Edge { from, axis: usize::from(axis) }
                };
                let on_edge = self.on_edge(place(edge))?;
                for (beside, is_next) in [((i + count - 1) % count, false), ((i + 1) % count, true)] {
                    let other = of.edges[beside];
                    let is_common = |face: &(usize, bool)| {
                        [edge, other].into_iter().all(|edge| is_on_face(table, edge, face.0, face.1))
                    };
                    let faces = (0..3).flat_map(|across| [(across, false), (across, true)]);
                    let Some((across, is_high)) = faces.into_iter().find(is_common) else { continue };
                    let mut lowest = cell;
                    lowest[across] += usize::from(is_high);
                    let half = corner_between(table, [edge, other], across);
                    let in_face = self.in_face(Face { lowest, size: 1, across, half })?;
                    let v = v as u32;
                    push(triangles, if is_next { [v, on_edge, in_face] } else { [v, in_face, on_edge] })?;
                    push(of_cells, part.number(cell))?;
                }
            }
        }
        Ok(triangles.len() != before)
    }

    fn position(&self, v: u32) -> Vec3 {
        let old = self.net.positions.len();
        match (v as usize).checked_sub(old) {
            Some(added) => self.all[added].1,
            None => self.net.positions[v as usize],
        }
    }

    fn add(
        &mut self,
        place: [usize; 3],
        number: usize,
        position: impl FnOnce() -> Vec3,
    ) -> Result<u32, ExtractError> {
        let lattice = self.net.grid.lattice;
        let key = VertexKey::new(lattice.arrangement(), lattice.stored(place), number);
        if let Some(&known) = self.known.get(&key) {
            return Ok(known);
        }
        let number = (self.net.positions.len() + self.all.len()) as u32;
        self.known.try_reserve(1)?;
        self.known.insert(key, number);
        push(&mut self.all, (key, position()))?;
        Ok(number)
    }

    /// The vertex on an edge: its crossing.
    fn on_edge(&mut self, edge: Edge) -> Result<u32, ExtractError> {
        let net = self.net;
        self.add(edge.from, ON_EDGE + edge.axis, || {
            let Edge { from, axis } = edge;
            let [low, high] = edge.ends(true).map(|end| net.grid.position(end).as_dvec3());
            let ends = edge.ends(true).map(|end| net.level.field.sample(net.grid.position(end)));
            let (crossing, _) = tangent(net.level, net.grid, from, axis, ends);
            let share = (crossing[axis] - low[axis]) / (high[axis] - low[axis]);
            let margin = margin(low, high, 1);
            (low + (high - low) * share.clamp(margin, 1.0 - margin)).as_vec3()
        })
    }

    /// The vertex in a face, or the loops' part of one: where the tangent planes at its two crossings meet in it.
    fn in_face(&mut self, face: Face) -> Result<u32, ExtractError> {
        let net = self.net;
        // The halves of a face that two loops cross are round opposite corners.
        let part = usize::from(face.half.is_some_and(|[a, _]| a));
        self.add(face.lowest, IN_FACE + 2 * face.across + part, || net.meeting_in_face(face))
    }
}

impl Net<'_> {
    fn meeting_in_face(&self, face: Face) -> Vec3 {
        let axes = face.axes();
        let [low, high] = [[false; 2], [true; 2]].map(|of| self.grid.position(face.corner(of)).as_dvec3());
        let mut crossings = [(DVec3::ZERO, None); 4];
        let mut count = 0;
        let value = |at: [usize; 3]| self.level.field.sample(self.grid.position(at));
        let is_inside = |at: [usize; 3]| value(at) > self.level.isovalue;
        for Edge { from, axis } in face.edges() {
            let at = |i: usize| {
                let mut at = from;
                at[axis] += i;
                at
            };
            let (mut low, mut high) = (0, face.size);
            let is_low_inside = is_inside(at(low));
            if is_low_inside == is_inside(at(high)) {
                continue;
            }
            // A side of a merged cell has one crossing.
            while high - low > 1 {
                let middle = low.midpoint(high);
                *(if is_inside(at(middle)) == is_low_inside { &mut low } else { &mut high }) = middle;
            }
            let (crossing, normal) =
                tangent(self.level, self.grid, at(low), axis, [low, high].map(|i| value(at(i))));
            // Within the face.
            let flat = normal.map(|mut normal| {
                normal[face.across] = 0.0;
                normal
            });
            crossings[count] = (crossing, flat);
            count += 1;
        }
        let crossings = &crossings[..count];
        let margin = margin(low, high, face.size);
        let share = |at: DVec3| [0, 1].map(|i| (at[axes[i]] - low[axes[i]]) / (high[axes[i]] - low[axes[i]]));
        let middle = face.half.map_or([0.5; 2], |of| of.map(|is_high| if is_high { 0.75 } else { 0.25 }));
        let [mut at, mut anchor] = [middle; 2];
        if !crossings.is_empty() {
            let point = Sharp { truncation: TRUNCATION, in_cell: true }.vertex(crossings, low, high);
            at = share(point).map(|share| share.clamp(margin, 1.0 - margin));
            anchor = [0, 1].map(|i| {
                let of = crossings.iter().map(|(crossing, _)| share(*crossing)[i].clamp(0.0, 1.0));
                of.sum::<f64>() / crossings.len() as f64
            });
        }
        if let Some(half) = face.half {
            // As far as the diagonal, from the middle of the crossings if that is in the half by enough.
            let way = |of: [f64; 2]| (0..2).map(|i| if half[i] { 1.0 - of[i] } else { of[i] }).sum::<f64>();
            if way(anchor) > 1.0 - 2.0 * margin {
                anchor = middle;
            }
            let (here, there) = (1.0 - margin - way(anchor), 1.0 - margin - way(at));
            if there < 0.0 {
                let of = (here / (here - there)).max(0.0);
                at = [0, 1].map(|i| anchor[i] + (at[i] - anchor[i]) * of);
            }
        }
        let mut found = low;
        for i in 0..2 {
            found[axes[i]] = low[axes[i]] + (high[axes[i]] - low[axes[i]]) * at[i];
        }
        found.as_vec3()
    }
}
