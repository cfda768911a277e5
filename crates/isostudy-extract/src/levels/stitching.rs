//! Seams of marching cubes: the cells of a chunk at finer neighbours, made anew with what these have on their common sides.
//!
//! Such a cell is a cube whose sides at finer cells are four squares, and whose edges at finer cells are two. Each of these has the
//! crossings and the arcs of the finer cells beyond it, by the same rule; the cell's other sides are those of its coarse neighbours. So
//! arcs join to loops, and triangles fill the loops within the cell. Nothing lies between the levels.
//!
//! It is closed: each arc is in two cells, run in opposite directions. It is a manifold: what is no arc is a side of two triangles of one
//! loop, since no diagonal joins two crossings of one face or of one divided edge.

use std::collections::{HashMap, TryReserveError};

use glam::{DVec3, Vec3};
use isostudy_cells::{Loops, Step};

use super::divided::{self, Divided, Division, Divisions};
use super::filling::{Corner, Filling, On};
use super::layer::point;
use super::windows::Values;
use crate::chunks::{Chunk, Normals};
use crate::cubes::{Faces, joins};
use crate::lattice::Arrangement;
use crate::lattice::endless::Grid;
use crate::memory::push;
use crate::placement::spot::linear_ratio;
use crate::sampling::level::Level;
use crate::surface::trace::{IN_CELL, VertexKey};

const NONE: u32 = u32::MAX;
/// More edges than a divided cell has.
const MOST_EDGES: usize = 48;
/// Numbers of vertices in a cell come after those of the edges at its lowest corner, and before those in sides.
const INNER: usize = IN_CELL;
/// The point in the middle of a cell.
const MIDDLE: u8 = 13;

/// A vertex on an edge of a divided cell.
#[derive(Debug, Clone, Copy)]
struct Crossing {
    /// Its number in the chunk.
    cell: u32,
    /// Where the edge begins.
    point: u8,
    along: u8,
    /// Whether it is an edge of the fine grid.
    is_part: bool,
    vertex: u32,
}

/// What seams are made of the field with.
pub(super) struct Decision<'a> {
    pub(super) faces: Faces,
    /// Those of the fine grid.
    pub(super) values: Values<'a>,
    pub(super) isovalue: f32,
    pub(super) normals: Normals,
    /// The fine one.
    pub(super) grid: &'a Grid,
}

/// The divided cells of a chunk, and buffers.
#[derive(Debug, Default)]
pub(super) struct Stitching {
    crossings: Vec<Crossing>,
    /// Vertices of the finer level that the chunk has, by key.
    added: HashMap<VertexKey, u32>,
    kinds: HashMap<Division, Divided>,
    loops: Loops,
    filling: Filling,
}

impl Stitching {
    /// Takes the triangles of divided cells away from a chunk of one level.
    pub(super) fn begin(&mut self, divisions: &Divisions, chunk: &mut Chunk) -> Result<(), TryReserveError> {
        self.crossings.clear();
        self.added.clear();
        let (mut kept, mut last) = (0, (NONE, false));
        for t in 0..chunk.triangles.len() {
            let (triangle, number) = (chunk.triangles[t], chunk.triangle_cells[t]);
            if number != last.0 {
                last = (number, divisions.of(chunk.cells.cell(number)).is_some());
            }
            if !last.1 {
                (chunk.triangles[kept], chunk.triangle_cells[kept]) = (triangle, number);
                kept += 1;
                continue;
            }
            let cell = chunk.cells.cell(number).map(i64::from);
            for vertex in triangle {
                let key = chunk.keys[vertex as usize];
                let from = key.stored();
                if key.direction() < INNER {
                    let point = divided::point([0, 1, 2].map(|axis| 2 * (from[axis] - cell[axis]))) as u8;
                    let along = key.direction() as u8;
                    push(
                        &mut self.crossings,
                        Crossing { cell: number, point, along, is_part: false, vertex },
                    )?;
                }
            }
        }
        chunk.triangles.truncate(kept);
        chunk.triangle_cells.truncate(kept);
        Ok(())
    }

    /// Learns the vertices that a box of fine cells has in the sides and edges of the chunk that are divided.
    pub(super) fn learn(
        &mut self,
        layer: &Chunk,
        level: u32,
        divisions: &Divisions,
        chunk: &mut Chunk,
    ) -> Result<(), TryReserveError> {
        for (v, key) in layer.keys.iter().enumerate() {
            let (from, along) = (key.stored(), key.direction());
            if along >= INNER {
                continue;
            }
            // The cells at the edge, by the lower and the upper one along each axis.
            let ends = [0, 1].map(|upper| {
                [0, 1, 2].map(|axis| {
                    let is_between = axis != along && from[axis] & 1 == 0;
                    (from[axis] >> 1) - i64::from(is_between && upper == 0)
                })
            });
            let mut number = None;
            for choice in 0..8 {
                let cell = [0, 1, 2].map(|axis| ends[choice >> axis & 1][axis]);
                let is_again = (0..3).any(|axis| choice >> axis & 1 != 0 && ends[0][axis] == ends[1][axis]);
                let cell = cell.map(|i| i as i32);
                if is_again || !chunk.cells.contains(cell) {
                    continue;
                }
                let offset = [0, 1, 2].map(|axis| from[axis] - 2 * i64::from(cell[axis]));
                let point = divided::point(offset);
                let Some(division) = divisions.of(cell) else { continue };
                if self.kind(division).edge(point, along, true).is_none() {
                    continue;
                }
                let vertex = match number {
                    Some(number) => number,
                    None => *number.insert(self.add(chunk, layer, v, level)?),
                };
                let cell = chunk.cells.number(cell);
                let (point, along) = (point as u8, along as u8);
                push(&mut self.crossings, Crossing { cell, point, along, is_part: true, vertex })?;
            }
        }
        Ok(())
    }

    /// Makes what is to be known of cells at one to three finer sides, and at one finer edge.
    pub(super) fn make_kinds(&mut self) {
        // By axis: no side, the lower or the upper one.
        for sides in (1..27_u32).map(|of| [of % 3, of / 3 % 3, of / 9]) {
            let set = (0..3)
                .filter(|&axis| sides[axis] > 0)
                .fold(0, |set, axis| set | 1_u8 << (2 * axis as u32 + sides[axis] - 1));
            self.kind((set, 0));
        }
        for edge in 0..12 {
            self.kind((0, 1 << edge));
        }
    }

    fn kind(&mut self, division: Division) -> &Divided {
        self.kinds.entry(division).or_insert_with(|| Divided::new(division))
    }

    /// The number that a vertex of a layer of another level has in a chunk; the next one, if it is new.
    fn add(
        &mut self,
        chunk: &mut Chunk,
        layer: &Chunk,
        v: usize,
        level: u32,
    ) -> Result<u32, TryReserveError> {
        let key = layer.keys[v].at_level(level);
        if let Some(&number) = self.added.get(&key) {
            return Ok(number);
        }
        let number = add(chunk, key, layer.positions[v], layer.normals.get(v).copied())?;
        self.added.try_reserve(1)?;
        self.added.insert(key, number);
        Ok(number)
    }

    /// Adds the triangles of all divided cells, whose crossings are known.
    pub(super) fn fill(
        &mut self,
        decision: &Decision,
        divisions: &Divisions,
        chunk: &mut Chunk,
    ) -> Result<(), TryReserveError> {
        let Self { crossings, added, kinds, loops, filling } = self;
        crossings.sort_unstable_by_key(|crossing| crossing.cell);
        for of_cell in crossings.chunk_by(|a, b| a.cell == b.cell) {
            let number = of_cell[0].cell;
            let cell = chunk.cells.cell(number);
            let Some(division) = divisions.of(cell) else { continue };
            let kind = kinds.entry(division).or_insert_with(|| Divided::new(division));
            let mut vertices = [NONE; MOST_EDGES];
            for crossing in of_cell {
                let (point, along) = (usize::from(crossing.point), usize::from(crossing.along));
                if let Some(edge) = kind.edge(point, along, crossing.is_part) {
                    vertices[usize::from(edge)] = crossing.vertex;
                }
            }
            let here = Here { decision, kind, cell, vertices: &vertices };
            here.find_loops(loops);
            here.fill(loops, added, filling, chunk)?;
        }
        Ok(())
    }
}

/// A divided cell of a chunk.
struct Here<'a> {
    decision: &'a Decision<'a>,
    kind: &'a Divided,
    cell: [i32; 3],
    /// On its edges.
    vertices: &'a [u32; MOST_EDGES],
}

impl Here<'_> {
    /// A point of the cell on the fine grid.
    fn corner(&self, c: u8) -> [i32; 3] {
        let offset = self.kind.cell.corners()[usize::from(c)];
        [0, 1, 2].map(|axis| 2 * self.cell[axis] + offset[axis])
    }

    fn value(&self, c: u8) -> f32 {
        let Decision { values, grid, .. } = *self.decision;
        values.at(grid, self.corner(c))
    }

    fn is_inside(&self, c: u8) -> bool {
        self.value(c) > self.decision.isovalue
    }

    fn find_loops(&self, loops: &mut Loops) {
        let Divided { cell, path, .. } = self.kind;
        // One corner is asked of the field; the others follow from the crossings between.
        let mut inside = u32::from(self.is_inside(0));
        for &[from, to, edge] in path {
            let differs = self.vertices[usize::from(edge)] != NONE;
            inside |= (inside >> from & 1 ^ u32::from(differs)) << to;
        }
        let ambiguous = cell.ambiguous_faces(inside);
        let joined = (0..cell.faces().len() as u8)
            .filter(|f| ambiguous >> f & 1 != 0)
            .fold(0, |set, f| set | u32::from(self.joins(f, inside)) << f);
        cell.find_loops(inside, joined, loops);
    }

    /// Whether inside corners of a face are one region of it: as cubes on its other side decide it. Where edges of it are divided, which
    /// cubes on its other side have too, its middle decides: the surface often is near such an edge and nearly parallel to it, and crosses
    /// it twice.
    fn joins(&self, face: u8, inside: u32) -> bool {
        let Decision { faces, isovalue, .. } = *self.decision;
        if let [a, b, c, d] = self.kind.cell.faces()[usize::from(face)][..] {
            let round = if inside >> a & 1 != 0 { [a, b, c, d] } else { [b, c, d, a] };
            return joins(faces, isovalue, || round.map(|c| self.value(c)));
        }
        self.is_inside(self.kind.middle_of_side(face))
    }

    /// Reads the corners of a loop. Between two crossings of one edge comes a vertex in the side that their arc is in: the side's coarse cells
    /// see nothing of what crosses the edge there, and the arc would lie in the edge.
    fn read(
        &self,
        steps: &[Step],
        added: &mut HashMap<VertexKey, u32>,
        corners: &mut Vec<Corner>,
        chunk: &mut Chunk,
    ) -> Result<(), TryReserveError> {
        corners.clear();
        for (i, step) in steps.iter().enumerate() {
            let next = steps[(i + 1) % steps.len()];
            let vertex = self.vertices[usize::from(step.edge)];
            let corner = |vertex: u32, on| {
                let position = Vec3::from(chunk.positions[vertex as usize]).as_dvec3();
                Corner { vertex, position, on }
            };
            push(corners, corner(vertex, On::Edge(step.edge)))?;
            if let Some(middle) = self.kind.middle_between(step.edge, next.edge) {
                let ends = [vertex, self.vertices[usize::from(next.edge)]];
                let vertex = self.in_side(ends, middle, step.face, added, chunk)?;
                let position = Vec3::from(chunk.positions[vertex as usize]).as_dvec3();
                push(corners, Corner { vertex, position, on: On::Face(step.face) })?;
            }
        }
        Ok(())
    }

    /// The vertex in a side that is between two on the halves of one of its edges. All chunks that have it have the same.
    fn in_side(
        &self,
        ends: [u32; 2],
        middle: u8,
        face: u8,
        added: &mut HashMap<VertexKey, u32>,
        chunk: &mut Chunk,
    ) -> Result<u32, TryReserveError> {
        let to = self.kind.middle_of_side(face);
        let [low, high] = [middle, to].map(|c| self.corner(c));
        let along = (0..3).find(|&axis| low[axis] & 1 != 0).unwrap_or(0);
        let across = (0..3).find(|&axis| low[axis] != high[axis]).unwrap_or(0);
        let edge = low.map(|i| i64::from(i >> 1));
        let key = VertexKey::in_side(edge, along, across, high[across] > low[across]);
        let key = key.at_level(chunk.level);
        if let Some(&number) = added.get(&key) {
            return Ok(number);
        }
        let position = self.on_the_way(middle, to);
        let [one, other] = ends.map(|v| chunk.normals.get(v as usize).map_or(Vec3::ZERO, |&n| Vec3::from(n)));
        let number = self.add(chunk, key, position, one + other)?;
        added.try_reserve(1)?;
        added.insert(key, number);
        Ok(number)
    }

    /// Where the surface is between two points of the cell, or else the second one.
    fn on_the_way(&self, from: u8, to: u8) -> DVec3 {
        let Decision { isovalue, grid, .. } = *self.decision;
        let ends = [from, to].map(|c| DVec3::from_array(grid.position(self.corner(c))));
        let values = [from, to].map(|c| self.value(c));
        let ratio = match values.map(|value| value > isovalue) {
            [a, b] if a == b => 1.0,
            _ => linear_ratio(isovalue - values[0], values[0], values[1]).clamp(0.0, 1.0),
        };
        ends[0] + (ends[1] - ends[0]) * f64::from(ratio)
    }

    /// Adds the triangles of all loops.
    fn fill(
        &self,
        loops: &Loops,
        added: &mut HashMap<VertexKey, u32>,
        filling: &mut Filling,
        chunk: &mut Chunk,
    ) -> Result<(), TryReserveError> {
        // A vertex is missing only where a field breaks its promises.
        let is_whole = |steps: &&[Step]| steps.iter().all(|s| self.vertices[usize::from(s.edge)] != NONE);
        let mut number = INNER;
        if let Some([flat, other]) = self.band(loops) {
            let mut ring = Vec::new();
            self.read(flat, added, &mut ring, chunk)?;
            self.read(other, added, &mut filling.corners, chunk)?;
            let mut places = Vec::new();
            for (i, j) in (0..flat.len()).flat_map(|i| (0..other.len()).map(move |j| (i, j))) {
                if flat[i].face == other[j].face {
                    let ends = [flat[i], flat[(i + 1) % flat.len()], other[j], other[(j + 1) % other.len()]];
                    places.extend(self.in_saddle(ends, chunk));
                }
            }
            if filling.find_band(self.kind, &ring, &places) {
                return self.take(filling, &mut number, chunk);
            }
        }
        for steps in loops.iter().filter(is_whole) {
            self.read(steps, added, &mut filling.corners, chunk)?;
            if let Some(face) = self.is_flat(steps) {
                filling.take_fan(self.on_the_way(self.kind.middle_of_side(face), MIDDLE));
            } else if !filling.find(self.kind) {
                self.find_round(steps, filling, chunk);
            }
            self.take(filling, &mut number, chunk)?;
        }
        Ok(())
    }

    /// Places on the surface between two arcs in one face, by their ends: where it is like a saddle, in the middle and at both narrow ends.
    fn in_saddle(&self, ends: [Step; 4], chunk: &Chunk) -> [DVec3; 3] {
        let position = |v: u32| Vec3::from(chunk.positions[v as usize]).as_dvec3();
        let [a, b, c, d] = ends.map(|step| position(self.vertices[usize::from(step.edge)]));
        [(a + b + c + d) / 4.0, (b + c) / 2.0, (d + a) / 2.0].map(|place| self.on_the_surface(place))
    }

    /// Finds triangles of a loop with vertices within it, or finds that those without are better.
    fn find_round(&self, steps: &[Step], filling: &mut Filling, chunk: &Chunk) {
        let next = |i: usize| steps[(i + 1) % steps.len()];
        for (i, &one) in steps.iter().enumerate() {
            for (j, &two) in steps.iter().enumerate().skip(i + 1).filter(|(_, two)| two.face == one.face) {
                let [middle, end, other_end] = self.in_saddle([one, next(i), two, next(j)], chunk);
                for inner in [&[middle][..], &[end], &[other_end], &[end, other_end]] {
                    filling.find_round(self.kind, inner);
                }
            }
        }
        let mean = self.on_the_surface(filling.mean());
        filling.find_round(self.kind, &[mean]);
        if !filling.has_found() {
            filling.take_fan(mean);
        }
    }

    /// Whether a loop is round the middle of a divided side; a face of that side.
    fn is_flat(&self, steps: &[Step]) -> Option<u8> {
        let sides = |step: &Step| self.kind.sides_at_edge[usize::from(step.edge)];
        let is_closed = steps
            .iter()
            .zip(steps.iter().cycle().skip(1))
            .all(|(step, next)| self.kind.middle_between(step.edge, next.edge).is_none());
        let is_flat = is_closed && steps.iter().fold(!0, |common, step| common & sides(step)) != 0;
        is_flat.then_some(steps[0].face)
    }

    /// Two loops that are the ends of a band: one round the middle of a divided side, and another one, if nothing is between the middles
    /// of the side and of the cell. The surface is near that side and nearly parallel to it, and comes out in its middle.
    fn band<'s>(&self, loops: &'s Loops) -> Option<[&'s [Step]; 2]> {
        let mut all = loops.iter();
        let (Some(one), Some(two), None) = (all.next(), all.next(), all.next()) else { return None };
        let pairs = [[one, two], [two, one]];
        let [flat, other] = pairs.into_iter().find(|[flat, _]| self.is_flat(flat).is_some())?;
        let middle = self.kind.middle_of_side(self.is_flat(flat)?);
        let is_whole = [one, two].into_iter().flatten().all(|s| self.vertices[usize::from(s.edge)] != NONE);
        let is_band = is_whole && self.is_flat(other).is_none();
        (is_band && self.is_inside(middle) == self.is_inside(MIDDLE)).then_some([flat, other])
    }

    /// The point of the surface near a point, within the cell; the point itself where none is found.
    fn on_the_surface(&self, near: DVec3) -> DVec3 {
        let level = self.decision.level();
        let near = near.as_vec3();
        let position = level.foot(near, level.spacing).map_or(near, |foot| foot.position);
        let [low, high] = [0, 26].map(|c| Vec3::from(point(self.decision.grid, self.corner(c))));
        position.max(low).min(high).as_dvec3()
    }

    /// Adds a vertex that is of no grid. `normal` is that of the triangles round it, of any length.
    fn add(
        &self,
        chunk: &mut Chunk,
        key: VertexKey,
        position: DVec3,
        normal: Vec3,
    ) -> Result<u32, TryReserveError> {
        let position = position.as_vec3();
        let of_field = || self.decision.level().normal(position);
        let of_triangles = normal.try_normalize().unwrap_or(Vec3::Z);
        let normal = match self.decision.normals {
            Normals::None => None,
            // By samples there are none across levels.
            Normals::Triangles | Normals::Samples => Some(of_triangles),
            Normals::Field => Some(of_field().unwrap_or(of_triangles)),
        };
        add(chunk, key, position.to_array(), normal.map(|n| n.to_array()))
    }

    /// Adds the triangles that were found, and the vertices within the loop, whose numbers in the cell are the next ones.
    fn take(&self, filling: &Filling, number: &mut usize, chunk: &mut Chunk) -> Result<(), TryReserveError> {
        let mut inner = [NONE; 2];
        for (vertex, &position) in inner.iter_mut().zip(filling.inner()) {
            let key = VertexKey::new(Arrangement::SimpleCubic, self.cell.map(i64::from), *number);
            let normal = filling.facing().map_or(Vec3::Z, |facing| facing.as_vec3());
            *vertex = self.add(chunk, key.at_level(chunk.level), position, normal)?;
            *number += 1;
        }
        for triangle in filling.triangles(inner) {
            push(&mut chunk.triangles, triangle)?;
            push(&mut chunk.triangle_cells, chunk.cells.number(self.cell))?;
            chunk.seam += 1;
        }
        Ok(())
    }
}

impl Decision<'_> {
    fn level(&self) -> Level<'_> {
        let spacing = self.grid.spacing() as f32;
        Level { field: self.values.field(), isovalue: self.isovalue, spacing }
    }
}

/// Adds a vertex to a chunk.
fn add(
    chunk: &mut Chunk,
    key: VertexKey,
    position: [f32; 3],
    normal: Option<[f32; 3]>,
) -> Result<u32, TryReserveError> {
    let number = chunk.keys.len() as u32;
    push(&mut chunk.keys, key)?;
    push(&mut chunk.positions, position)?;
    if let Some(normal) = normal {
        push(&mut chunk.normals, normal)?;
    }
    Ok(number)
}
