//! Vertex pass: a vertex on every crossing, point by point, and what is remembered of the points for the cells.

use std::collections::TryReserveError;

use glam::{DVec3, Vec3};

use super::cut::{Cut, Directions};
use super::grid::{CutGrid, LINES};
use super::sampling::BitRows;
use crate::lattice::Lattice;
use crate::memory::refill;
use crate::placement::spot::{Apart, Company, linear_ratio};
use crate::placement::{clamped, crossing_ratio};
use crate::sampling::in_sight::Values;
use crate::sampling::level::Level;
use crate::sampling::rows::is_set;
use crate::settings::{ExtractSettings, Placement};
use crate::slabs::Vertices;
use crate::tetrahedra::ties::Ties;

/// The crossings that belong to a point; their vertices are numbered from `first` on, by direction.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Record {
    pub(super) first: u32,
    pub(super) near: Directions,
}

impl Record {
    /// The vertex in a direction, if it belongs to this point.
    pub(super) fn vertex(self, direction: u8) -> Option<u32> {
        let before = self.near & ((1 << direction) - 1);
        (self.near >> direction & 1 != 0).then(|| self.first.wrapping_add(before.count_ones()))
    }
}

/// A ring of layers of records, one for each point with a crossing.
#[derive(Debug, Default)]
pub(super) struct Records {
    layers: Vec<Layer>,
}

#[derive(Debug, Default)]
struct Layer {
    records: Vec<Record>,
    /// By word of points, how many records come before its own.
    starts: Vec<u32>,
}

impl Records {
    /// Makes room for the layers of a cell; keeps what is large enough.
    pub(super) fn fit(&mut self, grid: &CutGrid) -> Result<(), TryReserveError> {
        self.layers.resize_with(grid.reach() + 1, Layer::default);
        self.layers.iter_mut().try_for_each(|layer| refill(&mut layer.starts, grid.words * grid.size[1], 0))
    }

    fn layer(&self, layer: usize) -> &Layer {
        &self.layers[layer % self.layers.len()]
    }

    /// The records of a row, by whether its points are active.
    pub(super) fn row<'a>(
        &'a self,
        grid: &CutGrid,
        [row, layer]: [usize; 2],
        active: &'a BitRows,
    ) -> RecordRow<'a> {
        let of = self.layer(layer);
        let starts = &of.starts[row * grid.words..][..grid.words];
        RecordRow { records: &of.records, starts, active: active.row(row, layer) }
    }
}

/// The records of a row.
#[derive(Clone, Copy)]
pub(super) struct RecordRow<'a> {
    records: &'a [Record],
    starts: &'a [u32],
    active: &'a [u64],
}

impl RecordRow<'_> {
    /// That of the point in a column; one without vertices, if it has no crossing.
    pub(super) fn at(&self, column: usize) -> Record {
        let (word, bit) = (column / 64, column % 64);
        let active = self.active[word + 1];
        if active >> bit & 1 == 0 {
            return Record::default();
        }
        let before = (active & !(!0 << bit)).count_ones();
        self.records[(self.starts[word] + before) as usize]
    }
}

/// What the pass reads.
pub(super) struct PointPass<'a> {
    pub(super) grid: &'a CutGrid,
    pub(super) values: Values<'a>,
    pub(super) sides: &'a BitRows,
    pub(super) active: &'a BitRows,
    pub(super) isovalue: f32,
    pub(super) ties: Ties,
    pub(super) placer: &'a Placer<'a>,
}

impl PointPass<'_> {
    /// Visits a layer. Of a slab's own, vertices are placed; of others, numbered.
    pub(super) fn layer(
        &self,
        layer: usize,
        is_own: bool,
        records: &mut Records,
        vertices: &mut Vertices,
    ) -> Result<(), TryReserveError> {
        let ring = records.layers.len();
        let Layer { records, starts } = &mut records.layers[layer % ring];
        records.clear();
        for row in 0..self.grid.size[1] {
            let active = self.active.row(row, layer);
            let mut lines = None;
            for word in 0..self.grid.words {
                let mut left = active[word + 1];
                if left == 0 {
                    continue;
                }
                starts[row * self.grid.words + word] = records.len() as u32;
                let lines = lines.get_or_insert_with(|| self.lines(row, layer));
                records.try_reserve(left.count_ones() as usize)?;
                while left != 0 {
                    let column = 64 * word + left.trailing_zeros() as usize;
                    left &= left - 1;
                    records.push(self.point([column, row, layer], lines, is_own, vertices)?);
                }
            }
        }
        Ok(())
    }

    /// The sides of the rows that the neighbours of a row's points lie in.
    fn lines(&self, row: usize, layer: usize) -> [Option<&[u64]>; LINES] {
        std::array::from_fn(|i| {
            let line = (i < self.grid.lines.len()).then(|| self.grid.line(i, row, layer)).flatten();
            line.map(|[y, z]| self.sides.row(y, z))
        })
    }

    fn point(
        &self,
        place: [usize; 3],
        lines: &[Option<&[u64]>; LINES],
        is_own: bool,
        vertices: &mut Vertices,
    ) -> Result<Record, TryReserveError> {
        let Self { grid, values, isovalue, .. } = *self;
        let [x, y, z] = place;
        let inside = is_set(self.sides.row(y, z), x);
        let value = values.at(place);
        let here = isovalue - value;
        let mut record = Record { first: vertices.numbered as u32, near: 0 };
        let mut left = grid.kind(y, z).edges_of[x % 2];
        while left != 0 {
            let direction = left.trailing_zeros() as usize;
            left &= left - 1;
            let step = grid.cut.steps[direction];
            let column = x.wrapping_add_signed(isize::from(step[0]));
            let Some(line) = lines[grid.line[direction]].filter(|_| column < grid.size[0]) else { continue };
            if is_set(line, column) == inside {
                continue;
            }
            vertices.crossing_ends += u64::from(is_own);
            let [_, row, layer] =
                [0, 1, 2].map(|axis| place[axis].wrapping_add_signed(isize::from(step[axis])));
            let neighbour = values.at([column, row, layer]);
            let there = isovalue - neighbour;
            if !self.ties.is_near(inside, here, there) {
                continue;
            }
            record.near |= 1 << direction;
            vertices.numbered += 1;
            if !is_own {
                continue;
            }
            let way = grid.way(place, direction, self.placer.edges[direction]);
            self.placer.place(grid.position(place), (direction, way), [value, neighbour], vertices)?;
            vertices.name(&grid.lattice, place, direction)?;
        }
        Ok(record)
    }
}

/// Where on its edge a crossing is.
pub(super) struct Placer<'a> {
    lattice: &'a Lattice,
    isovalue: f32,
    apart: Apart,
    /// How near to the ends a root may be.
    clamp: f32,
    pub(super) edges: [Vec3; Directions::BITS as usize],
    /// Whether the settings want vertices elsewhere, and to find roots with.
    refines: bool,
    level: Option<Level<'a>>,
}

impl<'a> Placer<'a> {
    pub(super) fn new(
        lattice: &'a Lattice,
        cut: &Cut,
        settings: &ExtractSettings,
        level: Option<Level<'a>>,
    ) -> Self {
        let step = lattice.spacing() / cut.steps_a_cell as f32;
        let mut edges = [Vec3::ZERO; Directions::BITS as usize];
        for (edge, to) in edges.iter_mut().zip(&cut.steps) {
            *edge = Vec3::from_array(to.map(f32::from)) * step;
        }
        Self {
            lattice,
            isovalue: settings.isovalue,
            apart: Apart::new(lattice, settings.topology).clamped(settings.edge_clamp),
            clamp: settings.edge_clamp,
            edges,
            // The weighted mean of one crossing is that crossing.
            refines: settings.refine_crossings || settings.placement == Placement::CurvatureWeighted,
            level: level.filter(|_| settings.refine_crossings),
        }
    }

    pub(super) fn place(
        &self,
        from: Vec3,
        (direction, way): (usize, Vec3),
        [here, there]: [f32; 2],
        vertices: &mut Vertices,
    ) -> Result<(), TryReserveError> {
        let bounds = self.lattice.bounds();
        let isovalue = self.isovalue;
        // Of the edge alone: a chunk need not know whether the point has other vertices.
        let ratio = self.apart.at(from).ratio(
            Company::Singles,
            direction,
            linear_ratio(isovalue - here, here, there),
        );
        let position = (way * ratio + from).min(bounds.max).max(bounds.min);
        vertices.positions.try_reserve(1)?;
        vertices.positions.push(position);
        if self.refines {
            let edge = way.as_dvec3();
            let ratio = crossing_ratio(self.level, from, edge, [here - isovalue, there - isovalue]);
            let ratio = clamped(ratio, self.clamp);
            let target: DVec3 = from.as_dvec3() + edge * ratio;
            vertices.targets.try_reserve(1)?;
            vertices.targets.push(target.as_vec3().clamp(bounds.min, bounds.max));
        }
        Ok(())
    }
}
