//! Sampling pass: the signs of a layer, and the samples at crossings that no sign needed.
//!
//! Given samples only have their signs taken. A field is called where its bounds leave the side of a point open; when
//! the signs of all neighbours are known, it is called again at the points with a crossing whose side did not need
//! their sample. All other points have none.

use std::collections::TryReserveError;
use std::convert::Infallible;

use glam::Vec3;

use super::crossings::{Crossings, Lines};
use super::grid::Grid;
use super::points::Samples;
use super::signs::Signs;
use super::tiles::{Known, Span, TILE, Tile, Tiles};
use field::ScalarField;

/// Samples taken together near the surface.
const BATCH: usize = 4;

/// What is called, and where.
#[derive(Clone, Copy)]
pub(super) struct FieldPass<'a> {
    pub(super) field: &'a dyn ScalarField,
    pub(super) grid: &'a Grid,
    pub(super) isovalue: f32,
    /// Whether samples are wanted at points without a crossing as well: then all are taken.
    pub(super) everywhere: bool,
}

/// A ring of layers of samples, and a bit for each that was taken.
#[derive(Debug, Default)]
pub(super) struct FieldSamples {
    values: Vec<f32>,
    taken: Vec<u64>,
    tiles: Tiles,
    slots: usize,
    /// Columns whose samples are to be taken, and what goes with them.
    columns: Vec<usize>,
    x: Vec<f32>,
    found: Vec<f32>,
}

/// The signs of a layer of given samples.
pub(super) fn signs_of(grid: &Grid, values: &[f32], isovalue: f32, layer: usize, signs: &mut Signs) {
    let [points, rows] = grid.layout.used(grid.layout.kind(layer));
    let [stride, all_rows, _] = grid.size;
    for row in 0..rows {
        let start = (layer * all_rows + row) * stride;
        signs.fill(row, layer, &values[start..start + points], isovalue);
    }
}

impl FieldSamples {
    pub(super) fn fit(&mut self, grid: &Grid, slots: usize) -> Result<(), TryReserveError> {
        self.slots = slots;
        super::refill(&mut self.values, grid.layer_len() * slots, 0.0)?;
        super::refill(&mut self.taken, grid.words * grid.size[1] * slots, 0)?;
        for buffer in [&mut self.x, &mut self.found] {
            super::refill(buffer, grid.size[0], 0.0)?;
        }
        self.columns.clear();
        self.columns.try_reserve_exact(grid.size[0])?;
        self.tiles.fit(grid)
    }

    pub(super) fn samples(&self) -> Samples<'_> {
        Samples { values: &self.values, slots: self.slots }
    }

    /// Finds the signs of a layer, with as few samples as may be.
    pub(super) fn find_signs(&mut self, pass: FieldPass, layer: usize, signs: &mut Signs) {
        let FieldPass { field, grid, isovalue, everywhere } = pass;
        let kind = grid.layout.kind(layer);
        let [points, rows] = grid.layout.used(kind);
        let (x, y, z) = (grid.coordinates.x(kind), grid.coordinates.y(kind), grid.coordinates.z()[layer]);
        if !everywhere {
            self.tiles.turn_to(layer, grid, field, isovalue);
        }
        for (row, &y) in y[..rows].iter().enumerate() {
            let place = layer % self.slots * grid.size[1] + row;
            let values = &mut self.values[place * grid.size[0]..][..points];
            let taken = &mut self.taken[place * grid.words..][..grid.words];
            if everywhere {
                field.sample_row(&x[..points], y, z, values);
                taken.fill(!0);
                signs.fill(row, layer, values, isovalue);
                continue;
            }
            let (spans, known) = self.tiles.row(row);
            match spans {
                [Span { tile: Tile::Unknown, .. }] => {
                    field.sample_row(&x[..points], y, z, values);
                    taken.fill(!0);
                    signs.fill(row, layer, values, isovalue);
                }
                [Span { tile: side @ (Tile::Outside | Tile::Inside), .. }] => {
                    taken.fill(0);
                    signs.set_all(row, layer, *side == Tile::Inside, points);
                }
                _ => {
                    taken.fill(0);
                    let mut line =
                        Line { pass, x: &x[..points], y, z, values, taken, bits: signs.open(row, layer) };
                    line.sample(spans, known);
                    signs.close(row, layer, points);
                }
            }
        }
    }

    /// Takes the samples of a layer at points with a crossing that have none yet.
    pub(super) fn fill(&mut self, pass: FieldPass, layer: usize, signs: &Signs) {
        let FieldPass { field, grid, .. } = pass;
        let kind = grid.layout.kind(layer);
        let [points, rows] = grid.layout.used(kind);
        let (x, y, z) = (grid.coordinates.x(kind), grid.coordinates.y(kind), grid.coordinates.z()[layer]);
        let layers = grid.layers(kind, layer);
        let around = grid.neighbourhood(kind);
        let places = layers.map(|layer| layer % signs.slots * grid.size[1]);
        for (row, &y) in y[..rows].iter().enumerate() {
            let rows = grid.rows(kind, row, layer, &layers);
            let Some(lines) = Lines::new(signs, around, &rows, &places, points) else { continue };
            let place = layer % self.slots * grid.size[1] + row;
            let taken = &mut self.taken[place * grid.words..][..grid.words];
            let values = &mut self.values[place * grid.size[0]..][..points];
            self.columns.clear();
            let mut hint = None;
            let Ok::<(), Infallible>(()) = lines.visit(grid, |Crossings { word, active, .. }| {
                let mut left = active & !taken[word];
                if left != 0 && hint.is_none() {
                    hint = taken_near(taken[word], left.trailing_zeros()).map(|bit| 64 * word + bit as usize);
                }
                taken[word] |= left;
                while left != 0 {
                    self.columns.push(64 * word + left.trailing_zeros() as usize);
                    left &= left - 1;
                }
                Ok(())
            });
            let count = self.columns.len();
            if count == 0 {
                continue;
            }
            for (place, &column) in self.x.iter_mut().zip(&self.columns) {
                *place = x[column];
            }
            let found = &mut self.found[..count];
            let hint = hint.map(|column| (Vec3::new(x[column], y, z), values[column]));
            field.sample_row_after(&self.x[..count], y, z, found, hint);
            for (&column, &value) in self.columns.iter().zip(&*found) {
                values[column] = value;
            }
        }
    }
}

/// A row of which some parts are known to be on one side.
struct Line<'a> {
    pass: FieldPass<'a>,
    x: &'a [f32],
    y: f32,
    z: f32,
    values: &'a mut [f32],
    taken: &'a mut [u64],
    bits: &'a mut [u64],
}

impl Line<'_> {
    fn sample(&mut self, spans: &[Span], known: &[Known]) {
        for span in spans {
            let (first, end) = (span.first as usize * TILE, self.x.len().min(span.end as usize * TILE));
            match span.tile {
                Tile::Outside => {}
                Tile::Inside => set_bits(self.bits, first, end),
                Tile::Unknown => {
                    self.pass.field.sample_row(
                        &self.x[first..end],
                        self.y,
                        self.z,
                        &mut self.values[first..end],
                    );
                    set_bits(self.taken, first, end);
                    for i in first..end {
                        self.set_side(i, self.values[i] > self.pass.isovalue);
                    }
                }
                Tile::Mixed => self.run(first, end, known),
            }
        }
    }

    /// Goes through mixed tiles. A point whose side the middle of its tile or the sample before it tells has no sample.
    fn run(&mut self, first: usize, end: usize, known: &[Known]) {
        let isovalue = self.pass.isovalue;
        let tiles = &known[first / TILE..end.div_ceil(TILE)];
        let slope = tiles.iter().fold(0.0, |steepest: f32, tile| steepest.max(tile.slope));
        let mut before = Known { value: f32::NAN, ..Known::default() };
        let mut reach = f32::NAN;
        let mut waiting = Waiting { count: 0, columns: [0; BATCH] };
        let mut batch = 1;
        for (k, tile) in tiles.iter().enumerate() {
            let reach_of_tile = tile.squared_reach(isovalue);
            let (dy, dz) = (self.y - tile.at.y, self.z - tile.at.z);
            let across = dy * dy + dz * dz;
            for i in first + k * TILE..end.min(first + (k + 1) * TILE) {
                let (from_tile, from_before) = (self.x[i] - tile.at.x, self.x[i] - before.at.x);
                if from_tile * from_tile + across < reach_of_tile {
                    self.set_side(i, tile.value > isovalue);
                } else if from_before * from_before < reach {
                    self.set_side(i, before.value > isovalue);
                    batch = 1;
                } else {
                    waiting.columns[waiting.count] = i;
                    waiting.count += 1;
                    if waiting.count == batch {
                        before = self.take(&mut waiting, before.hint().or(tile.hint()), slope);
                        reach = before.squared_reach(isovalue);
                        // Near the surface it takes them all: some at a time is quicker.
                        batch = BATCH;
                    }
                }
            }
        }
        if waiting.count > 0 {
            self.take(&mut waiting, before.hint(), slope);
        }
    }

    /// Takes the samples that wait; returns the last.
    fn take(&mut self, waiting: &mut Waiting, hint: Option<(Vec3, f32)>, slope: f32) -> Known {
        let columns = &waiting.columns[..waiting.count];
        waiting.count = 0;
        let x: [f32; BATCH] = std::array::from_fn(|k| self.x[columns[k.min(columns.len() - 1)]]);
        let mut found = [0.0; BATCH];
        let (x, found) = (&x[..columns.len()], &mut found[..columns.len()]);
        self.pass.field.sample_row_after(x, self.y, self.z, found, hint);
        let mut last = Known::default();
        for ((&i, &x), &value) in columns.iter().zip(x).zip(&*found) {
            self.values[i] = value;
            self.taken[i / 64] |= 1 << (i % 64);
            self.set_side(i, value > self.pass.isovalue);
            last = Known { at: Vec3::new(x, self.y, self.z), value, slope };
        }
        last
    }

    #[inline]
    fn set_side(&mut self, i: usize, is_inside: bool) {
        self.bits[i / 64] |= u64::from(is_inside) << (i % 64);
    }
}

/// Columns to be sampled together.
struct Waiting {
    count: usize,
    columns: [usize; BATCH],
}

fn set_bits(bits: &mut [u64], first: usize, end: usize) {
    for i in first..end {
        bits[i / 64] |= 1 << (i % 64);
    }
}

/// A set bit near another bit.
fn taken_near(taken: u64, bit: u32) -> Option<u32> {
    let (below, above) = (taken & !(!0 << bit), taken & (!0 << bit));
    below.checked_ilog2().or((above != 0).then(|| above.trailing_zeros()))
}
