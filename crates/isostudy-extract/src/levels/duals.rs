//! Seams of duals: a polygon round each minimal edge that the surface crosses, with a corner in each cell at the edge.
//!
//! An edge is minimal if it is one of the finest cells at it (Ju, Losasso, Schaefer & Warren 2002). Four cells are round it; where two of
//! them are the same coarse one, the polygon is a triangle. The chunk on the upper side of an edge along both other axes has the polygon,
//! so each is made once.
//!
//! Round the side that two cells have in common, signs change an even number of times, so an even number of polygons has the line
//! between their vertices: nothing is open, if every cell at a crossed minimal edge has a vertex. A coarse cell whose own corners are on
//! one side may lack it. It then gets one at the mean of what the fine grid crosses round it.

use std::collections::{HashMap, TryReserveError};

use glam::Vec3;

use super::error::LevelError;
use super::layer::point;
use super::neighbours::Neighbours;
use super::windows::Values;
use crate::chunks::{Chunk, Normals};
use crate::duals::{ROUND, is_other_better};
use crate::lattice::endless::Grid;
use crate::lattice::{Arrangement, CellBox};
use crate::memory::push;
use crate::placement::spot::linear_ratio;
use crate::sampling::level::Level;
use crate::surface::trace::VertexKey;

/// The vertex of a cell has this number; that of a cell without a crossed edge of its own the next.
const OF_CELL: usize = 0;
const OF_SIDES: usize = 1;

/// The chunk that seams are made of.
pub(super) struct Seams<'a> {
    /// Of the finer level, the own one and the coarser one.
    pub(super) values: [Values<'a>; 3],
    pub(super) isovalue: f32,
    pub(super) normals: Normals,
    /// Whether diagonals look at the field.
    pub(super) is_sharp: bool,
    pub(super) level: u32,
    pub(super) cells: CellBox,
    pub(super) neighbours: &'a Neighbours,
    /// Of the finer level, the own one and the coarser one; `None` where there is none.
    pub(super) grids: [Option<Grid>; 3],
}

/// Cells of a neighbour's level whose vertices seams need.
#[derive(Debug, Clone, Copy)]
pub(super) struct Needed {
    pub(super) step: i32,
    pub(super) cells: CellBox,
}

/// The edges along an axis that lie on lower sides of the chunk: on one, or on two of them.
#[derive(Debug, Clone, Copy)]
struct Edges {
    along: usize,
    /// Whether they lie on the lower sides across the two next axes, in cyclic order.
    on: [bool; 2],
}

impl Seams<'_> {
    fn kinds(&self) -> impl Iterator<Item = Edges> + use<'_> {
        let all = (0..3)
            .flat_map(|along| [[true, false], [false, true], [true, true]].map(|on| Edges { along, on }));
        all.filter(|edges| self.steps(*edges).iter().any(|&step| step != 0))
    }

    /// Which way the chunk is of a cell round an edge: `back` as in [`ROUND`].
    fn direction(edges: Edges, back: [usize; 2]) -> [i32; 3] {
        let mut direction = [0; 3];
        for i in 0..2 {
            if edges.on[i] && back[i] != 0 {
                direction[(edges.along + 1 + i) % 3] = -1;
            }
        }
        direction
    }

    fn steps(&self, edges: Edges) -> [i32; 4] {
        ROUND.map(|back| self.neighbours.step(Self::direction(edges, back)))
    }

    /// The cells of neighbours at the edges that seams are along.
    ///
    /// # Errors
    /// [`LevelError::Odd`].
    pub(super) fn needed(&self) -> Result<Vec<Needed>, LevelError> {
        let mut needed: Vec<Needed> = Vec::new();
        for edges in self.kinds() {
            for direction in ROUND.map(|back| Self::direction(edges, back)) {
                let is_line = edges.on == [true, true];
                if direction == [0; 3] {
                    continue;
                }
                let step = self.neighbours.step(direction);
                let mut cells = self.scaled(step)?;
                for (axis, way) in direction.into_iter().enumerate() {
                    let is_on = (0..2).any(|i| edges.on[i] && axis == (edges.along + 1 + i) % 3);
                    if way < 0 {
                        cells.end[axis] = cells.start[axis];
                        cells.start[axis] = cells.start[axis].saturating_sub(1);
                    } else if is_line && is_on {
                        cells.end[axis] = cells.start[axis].saturating_add(1);
                    }
                }
                if !needed.iter().any(|other| other.step == step && other.cells.contains_box(&cells)) {
                    needed.push(Needed { step, cells });
                }
            }
        }
        Ok(needed)
    }

    /// The chunk's box in cells of another level.
    fn scaled(&self, step: i32) -> Result<CellBox, LevelError> {
        let CellBox { start, end } = self.cells;
        let of = |corner: [i32; 3]| match step {
            ..0 => corner.map(|i| i.saturating_mul(2)),
            0 => corner,
            1.. => corner.map(|i| i >> 1),
        };
        if step > 0 && start.iter().chain(&end).any(|i| i % 2 != 0) {
            return Err(LevelError::Odd { cells: self.cells });
        }
        Ok(CellBox { start: of(start), end: of(end) })
    }

    /// Takes away the triangles of a chunk of one level that lie round edges where a neighbour has another level: they come in pairs.
    pub(super) fn remove(&self, chunk: &mut Chunk) {
        let is_kept = |keys: &[VertexKey], pair: &[[u32; 3]]| {
            pair.iter().flatten().all(|&v| {
                let cell = keys[v as usize].cell();
                let direction = [0, 1, 2].map(|axis| -i32::from(cell[axis] < self.cells.start[axis]));
                self.neighbours.step(direction) == 0
            })
        };
        let mut kept = 0;
        for i in (0..chunk.triangles.len()).step_by(2) {
            if is_kept(&chunk.keys, &chunk.triangles[i..i + 2]) {
                chunk.triangles.copy_within(i..i + 2, kept);
                chunk.triangle_cells.copy_within(i..i + 2, kept);
                kept += 2;
            }
        }
        chunk.triangles.truncate(kept);
        chunk.triangle_cells.truncate(kept);
    }

    /// Adds the polygons of all minimal edges on lower sides with a neighbour of another level. `known` has the vertices of the cells
    /// that are [needed](Self::needed); keys of the chunk are in order.
    pub(super) fn add(&self, known: &Known, chunk: &mut Chunk) -> Result<(), LevelError> {
        let mut corners = Corners { seams: self, known, own: chunk.keys.len(), added: HashMap::new() };
        for edges in self.kinds() {
            let steps = self.steps(edges);
            let finest = steps.into_iter().min().unwrap_or(0).min(0);
            let grid = self.grid(finest)?;
            let cells = self.scaled(finest)?;
            self.along(edges, finest, grid, cells, &mut corners, chunk)?;
        }
        Ok(())
    }

    /// Adds the polygons of the edges of a kind, which are those of the grid that is so many levels finer.
    fn along(
        &self,
        edges: Edges,
        finest: i32,
        grid: &Grid,
        cells: CellBox,
        corners: &mut Corners,
        chunk: &mut Chunk,
    ) -> Result<(), LevelError> {
        let across = [(edges.along + 1) % 3, (edges.along + 2) % 3];
        let ranges = [0, 1].map(|i| {
            let (start, end) = (cells.start[across[i]], cells.end[across[i]]);
            if edges.on[i] { start..start + 1 } else { start + 1..end }
        });
        let level = self.is_sharp.then(|| Level {
            field: self.values_of(finest).field(),
            isovalue: self.isovalue,
            spacing: grid.spacing() as f32,
        });
        let is_inside = |corner: [i32; 3]| self.values_of(finest).at(grid, corner) > self.isovalue;
        for second in ranges[1].clone() {
            for first in ranges[0].clone() {
                let mut from = [0; 3];
                (from[across[0]], from[across[1]]) = (first, second);
                from[edges.along] = cells.start[edges.along];
                let mut here = is_inside(from);
                while from[edges.along] < cells.end[edges.along] {
                    let mut to = from;
                    to[edges.along] += 1;
                    let there = is_inside(to);
                    if here != there {
                        let mut polygon = [0; 4];
                        for (corner, back) in polygon.iter_mut().zip(ROUND) {
                            let mut cell = from;
                            (0..2).for_each(|i| cell[across[i]] -= back[i] as i32);
                            let step = self.neighbours.step(Self::direction(edges, back));
                            let cell = cell.map(|i| i >> (step - finest));
                            *corner = corners.vertex(step, cell, chunk)?;
                        }
                        let cell = from.map(|i| i >> -finest);
                        self.polygon(polygon, here, level, cell, chunk)?;
                    }
                    (here, from) = (there, to);
                }
            }
        }
        Ok(())
    }

    fn polygon(
        &self,
        mut corners: [u32; 4],
        leads_out: bool,
        level: Option<Level>,
        cell: [i32; 3],
        chunk: &mut Chunk,
    ) -> Result<(), TryReserveError> {
        if is_other_better(level, corners.map(|v| Vec3::from(chunk.positions[v as usize]))) {
            corners.rotate_left(1);
        }
        let [a, b, c, d] = corners;
        for [a, b, c] in [[a, b, c], [a, c, d]] {
            if a != b && b != c && c != a {
                push(&mut chunk.triangles, if leads_out { [a, b, c] } else { [a, c, b] })?;
                push(&mut chunk.triangle_cells, chunk.cells.number(cell))?;
                chunk.seam += 1;
            }
        }
        Ok(())
    }

    fn values_of(&self, step: i32) -> Values<'_> {
        self.values[(step + 1) as usize]
    }

    fn grid(&self, step: i32) -> Result<&Grid, LevelError> {
        self.grids[(step + 1) as usize].as_ref().ok_or(LevelError::Level { level: self.level })
    }
}

/// Positions and normals of vertices of several levels.
#[derive(Debug, Default)]
pub(super) struct Known {
    vertices: HashMap<VertexKey, ([f32; 3], Option<[f32; 3]>)>,
}

impl Known {
    pub(super) fn clear(&mut self) {
        self.vertices.clear();
    }

    /// Learns the vertices of a chunk of a level.
    pub(super) fn learn(&mut self, chunk: &Chunk, level: u32) -> Result<(), TryReserveError> {
        self.vertices.try_reserve(chunk.keys.len())?;
        for (v, key) in chunk.keys.iter().enumerate() {
            self.vertices.insert(key.at_level(level), (chunk.positions[v], chunk.normals.get(v).copied()));
        }
        Ok(())
    }
}

/// The vertices of cells, as the chunk has them.
struct Corners<'a> {
    seams: &'a Seams<'a>,
    known: &'a Known,
    /// How many vertices are of the chunk's level, as it was extracted.
    own: usize,
    added: HashMap<VertexKey, u32>,
}

impl Corners<'_> {
    fn vertex(&mut self, step: i32, cell: [i32; 3], chunk: &mut Chunk) -> Result<u32, LevelError> {
        let seams = self.seams;
        let level = (seams.level as i32 + step) as u32;
        let key = |number| VertexKey::new(Arrangement::SimpleCubic, cell.map(i64::from), number);
        if step == 0
            && let Ok(v) = chunk.keys[..self.own].binary_search(&key(OF_CELL))
        {
            return Ok(v as u32);
        }
        let [of_cell, of_sides] = [OF_CELL, OF_SIDES].map(|number| key(number).at_level(level));
        if let Some(&v) = self.added.get(&of_cell).or_else(|| self.added.get(&of_sides)) {
            return Ok(v);
        }
        let (key, (position, normal)) = match self.known.vertices.get(&of_cell) {
            Some(&vertex) => (of_cell, vertex),
            None => (of_sides, seams.of_sides(step, cell)?),
        };
        let v = chunk.keys.len() as u32;
        self.added.try_reserve(1)?;
        self.added.insert(key, v);
        push(&mut chunk.keys, key)?;
        push(&mut chunk.positions, position)?;
        if let Some(normal) = normal {
            push(&mut chunk.normals, normal)?;
        }
        Ok(v)
    }
}

impl Seams<'_> {
    /// The mean of where the next finer grid is crossed on the sides of a cell, of which it has four squares each; the middle if it is not
    /// crossed. Of the field alone, so that all chunks agree.
    fn of_sides(&self, step: i32, cell: [i32; 3]) -> Result<([f32; 3], Option<[f32; 3]>), LevelError> {
        let grid_here = self.grid(step)?;
        let (Some(grid), 0..) = (self.grids.get(step as usize).and_then(Option::as_ref), step) else {
            // A finest cell has a vertex wherever its edges are crossed, unless the field breaks its promises.
            let middle =
                [0, 1, 2].map(|axis| grid_here.coordinate(axis, 2 * i64::from(cell[axis]) + 1) as f32);
            return Ok((middle, (self.normals != Normals::None).then_some([0.0, 0.0, 1.0])));
        };
        let low = cell.map(|i| i.saturating_mul(2));
        let corner = |offset: [i32; 3]| [0, 1, 2].map(|axis| low[axis] + offset[axis]);
        // The next finer level.
        let values = self.values_of(step - 1);
        let value = |offset| values.at(grid, corner(offset));
        let (mut sum, mut count) = ([0.0; 3], 0.0);
        for offset in (0..27).map(|i| [i % 3, i / 3 % 3, i / 9]) {
            for axis in (0..3).filter(|&axis| offset[axis] < 2) {
                let is_in_side = (0..3).any(|other| other != axis && offset[other] != 1);
                let mut next = offset;
                next[axis] += 1;
                let ends = [value(offset), value(next)];
                if is_in_side && (ends[0] > self.isovalue) != (ends[1] > self.isovalue) {
                    let ratio = linear_ratio(self.isovalue - ends[0], ends[0], ends[1]).clamp(0.0, 1.0);
                    let mut crossing = grid.position(corner(offset));
                    crossing[axis] += f64::from(ratio) * grid.spacing();
                    (0..3).for_each(|axis| sum[axis] += crossing[axis]);
                    count += 1.0;
                }
            }
        }
        let position =
            if count > 0.0 { sum.map(|c| (c / count) as f32) } else { point(grid, corner([1; 3])) };
        if self.normals == Normals::None {
            return Ok((position, None));
        }
        let spacing = grid.spacing() as f32;
        let level = Level { field: values.field(), isovalue: self.isovalue, spacing };
        let normal = level.normal(Vec3::from(position)).unwrap_or(Vec3::Z);
        Ok((position, Some(normal.to_array())))
    }
}
