//! Sampling pass: the sides of a layer, then which of its points have a crossing, and the samples there that no side
//! needed.
//!
//! A field is called where its bounds leave the side of a point open ([`ScalarField::range`], [`ScalarField::slope`]),
//! and at points with a crossing. All other points have no sample.

use std::collections::TryReserveError;

use glam::Vec3;

use super::grid::{Grid, LINES};
use super::rows::{BitRows, shifted};
use super::tiles::Tiles;
use crate::memory::{filled, with_room};
use crate::sweep::{Known, Source, Span, Tile};
use field::ScalarField;

/// Samples taken together near the surface.
const BATCH: usize = 4;

/// Where all points of a row are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
enum State {
    #[default]
    Outside,
    Inside,
    Mixed,
}

/// A few layers of samples and sides.
pub(super) struct Samples {
    /// Of a field that is called.
    called: Option<Called>,
    /// 1 inside. Columns without a point have any.
    pub(super) sides: BitRows,
    states: Vec<State>,
    /// Points with a crossing.
    pub(super) active: BitRows,
    slots: usize,
}

/// A ring of layers of samples, and a bit for each that was taken.
struct Called {
    values: Vec<f32>,
    taken: BitRows,
    tiles: Tiles,
    /// Columns whose samples are to be taken, and what goes with them.
    columns: Vec<usize>,
    x: Vec<f32>,
    found: Vec<f32>,
}

/// What is sampled, and where.
#[derive(Clone, Copy)]
pub(super) struct Sampling<'a> {
    pub(super) grid: &'a Grid<'a>,
    pub(super) source: Source<'a>,
    pub(super) isovalue: f32,
}

/// Samples by row: given ones, or those in sight.
#[derive(Clone, Copy)]
pub(super) struct Values<'a> {
    values: &'a [f32],
    size: [usize; 3],
    slots: usize,
}

impl Values<'_> {
    /// The sample of a point that has a crossing.
    pub(super) fn at(&self, [x, y, z]: [usize; 3]) -> f32 {
        self.values[(z % self.slots * self.size[1] + y) * self.size[0] + x]
    }
}

impl Samples {
    pub(super) fn new(grid: &Grid, source: Source) -> Result<Self, TryReserveError> {
        let slots = grid.slots();
        let called = match source {
            Source::Field(_) => Some(Called::new(grid, slots)?),
            Source::Samples(_) => None,
        };
        let sides = BitRows::new(grid, slots)?;
        let states = filled(grid.size[1] * slots, State::Outside)?;
        Ok(Self { called, sides, states, active: BitRows::new(grid, slots)?, slots })
    }

    pub(super) fn values<'a>(&'a self, grid: &Grid, source: Source<'a>) -> Values<'a> {
        let size = grid.size;
        match (source, &self.called) {
            (Source::Samples(values), _) => Values { values, size, slots: size[2] },
            (Source::Field(_), Some(called)) => Values { values: &called.values, size, slots: self.slots },
            (Source::Field(_), None) => unreachable!("made for a field"),
        }
    }

    /// Finds the sides of a layer, with as few samples as may be.
    pub(super) fn find_sides(&mut self, sampling: Sampling, layer: usize) {
        let Sampling { grid, source, isovalue } = sampling;
        let [nx, ny, _] = grid.size;
        if let (Source::Field(field), Some(called)) = (source, &mut self.called) {
            called.tiles.turn_to(layer, grid, field, isovalue);
        }
        for row in 0..ny {
            let sides = self.sides.row_mut(row, layer);
            sides.fill(0);
            let mut state = State::Mixed;
            match (source, &mut self.called) {
                (Source::Samples(values), _) => {
                    let values = &values[(layer * ny + row) * nx..][..nx];
                    for (word, values) in sides.iter_mut().zip(values.chunks(64)) {
                        let bits = values.iter().enumerate();
                        *word = bits.fold(0, |word, (i, &value)| word | u64::from(value > isovalue) << i);
                    }
                }
                (Source::Field(field), Some(called)) => {
                    called.taken.row_mut(row, layer).fill(0);
                    let (spans, _) = called.tiles.row(row);
                    match spans {
                        [Span { tile: Tile::Outside, .. }] => state = State::Outside,
                        [Span { tile: Tile::Inside, .. }] => {
                            state = State::Inside;
                            set_range(sides, 0, nx);
                        }
                        _ => called.sample(sampling, field, [row, layer], sides, self.slots),
                    }
                }
                (Source::Field(_), None) => unreachable!("made for a field"),
            }
            if state == State::Mixed {
                state = state_of(sides, grid.kind(row, layer).used, nx);
            }
            self.states[layer % self.slots * ny + row] = state;
        }
    }

    /// Finds the points of a layer that have a crossing, and takes their samples. The sides of all neighbours are known.
    pub(super) fn find_crossings(&mut self, sampling: Sampling, layer: usize) {
        let Sampling { grid, source, .. } = sampling;
        for row in 0..grid.size[1] {
            let (sides, active) = (&self.sides, self.active.row_mut(row, layer));
            active.fill(0);
            let kind = grid.kind(row, layer);
            let state = |[y, z]: [usize; 2]| self.states[z % self.slots * grid.size[1] + y];
            let here = state([row, layer]);
            let mut lines = [None; LINES];
            let mut is_uniform = here != State::Mixed;
            for i in (0..grid.lines.len()).filter(|i| kind.lines >> i & 1 != 0) {
                let line = grid.line(i, row, layer);
                is_uniform &= line.is_none_or(|line| state(line) == here);
                lines[i] = line.map(|[y, z]| sides.row(y, z));
            }
            if is_uniform {
                continue;
            }
            mark_crossings(grid, [row, layer], sides.row(row, layer), &lines, active);
            if let (Source::Field(field), Some(called)) = (source, &mut self.called) {
                called.fill(grid, field, [row, layer], active, self.slots);
            }
        }
    }
}

/// Sets the bits of points with a neighbour on the other side.
fn mark_crossings(
    grid: &Grid,
    [row, layer]: [usize; 2],
    here: &[u64],
    lines: &[Option<&[u64]>; LINES],
    active: &mut [u64],
) {
    let kind = grid.kind(row, layer);
    let nx = grid.size[0];
    for (direction, &[dx, _, _]) in grid.cut.steps.iter().enumerate() {
        let edges = kind.edges[direction];
        let Some(there) = lines[grid.line[direction]].filter(|_| edges != 0) else { continue };
        let dx = isize::from(dx);
        // The columns whose neighbours are there.
        let (first, end) = ((-dx).max(0) as usize, nx.saturating_sub(dx.max(0) as usize));
        for (word, active) in active.iter_mut().enumerate() {
            *active |= (here[word + 1] ^ shifted(there, word, dx)) & edges & Grid::bits(word, first, end);
        }
    }
}

impl Called {
    fn new(grid: &Grid, slots: usize) -> Result<Self, TryReserveError> {
        let [nx, ny, _] = grid.size;
        Ok(Self {
            values: filled(nx * ny * slots, 0.0)?,
            taken: BitRows::new(grid, slots)?,
            tiles: Tiles::new(grid)?,
            columns: with_room(nx)?,
            x: filled(nx, 0.0)?,
            found: filled(nx, 0.0)?,
        })
    }

    /// Finds the sides of a row that is not known to lie on one.
    fn sample(
        &mut self,
        sampling: Sampling,
        field: &dyn ScalarField,
        [row, layer]: [usize; 2],
        sides: &mut [u64],
        slots: usize,
    ) {
        let grid = sampling.grid;
        let [nx, ny, _] = grid.size;
        let (spans, known) = self.tiles.row(row);
        let mut line = Line {
            grid,
            field,
            isovalue: sampling.isovalue,
            columns: grid.kind(row, layer).columns,
            y: grid.coordinates.y[row],
            z: grid.coordinates.z[layer],
            values: &mut self.values[(layer % slots * ny + row) * nx..][..nx],
            taken: self.taken.row_mut(row, layer),
            sides,
            found: &mut self.found,
        };
        line.sample(spans, known, self.tiles.side);
    }

    /// Takes the samples of a row at points with a crossing that have none yet.
    fn fill(
        &mut self,
        grid: &Grid,
        field: &dyn ScalarField,
        [row, layer]: [usize; 2],
        active: &[u64],
        slots: usize,
    ) {
        let [nx, ny, _] = grid.size;
        let places = &grid.coordinates;
        let (y, z) = (places.y[row], places.z[layer]);
        let values = &mut self.values[(layer % slots * ny + row) * nx..][..nx];
        self.columns.clear();
        let mut hint = None;
        for (word, (taken, active)) in self.taken.row_mut(row, layer).iter_mut().zip(active).enumerate() {
            let mut left = active & !*taken;
            if left != 0 && hint.is_none() {
                hint = taken_near(*taken, left.trailing_zeros()).map(|bit| 64 * word + bit as usize);
            }
            *taken |= left;
            while left != 0 {
                self.columns.push(64 * word + left.trailing_zeros() as usize);
                left &= left - 1;
            }
        }
        let count = self.columns.len();
        if count == 0 {
            return;
        }
        for (place, &column) in self.x.iter_mut().zip(&self.columns) {
            *place = places.x[column];
        }
        let found = &mut self.found[..count];
        let hint = hint.map(|column| (Vec3::new(places.x[column], y, z), values[column]));
        field.sample_row_after(&self.x[..count], y, z, found, hint);
        for (&column, &value) in self.columns.iter().zip(&*found) {
            values[column] = value;
        }
    }
}

/// A row of which some parts are known to be on one side.
struct Line<'a> {
    grid: &'a Grid<'a>,
    field: &'a dyn ScalarField,
    isovalue: f32,
    /// The first column with a point, and from one to the next.
    columns: [usize; 2],
    y: f32,
    z: f32,
    values: &'a mut [f32],
    taken: &'a mut [u64],
    sides: &'a mut [u64],
    found: &'a mut [f32],
}

impl Line<'_> {
    fn sample(&mut self, spans: &[Span], known: &[Known], side: usize) {
        for span in spans {
            let first = span.first as usize * side;
            let end = self.values.len().min(span.end as usize * side);
            match span.tile {
                Tile::Outside => {}
                Tile::Inside => set_range(self.sides, first, end),
                Tile::Unknown => self.take_all(first, end),
                Tile::Mixed => self.run(first, end, known, side),
            }
        }
    }

    /// The columns with a point from `first` up to `end`.
    fn points(&self, first: usize, end: usize) -> impl Iterator<Item = usize> + use<> {
        let [offset, step] = self.columns;
        (offset + first.saturating_sub(offset).next_multiple_of(step)..end).step_by(step)
    }

    fn take_all(&mut self, first: usize, end: usize) {
        let [offset, step] = self.columns;
        let count = self.points(first, end).count();
        let found = &mut self.found[..count];
        // Columns with a point, as if there were no others.
        let start = first.saturating_sub(offset).div_ceil(step);
        let x = if step == 1 { &self.grid.coordinates.x } else { &self.grid.columns[offset] };
        self.field.sample_row(&x[start..start + count], self.y, self.z, found);
        for (k, i) in self.points(first, end).enumerate() {
            self.values[i] = self.found[k];
            self.taken[i / 64] |= 1 << (i % 64);
            self.sides[i / 64] |= u64::from(self.found[k] > self.isovalue) << (i % 64);
        }
    }

    /// Goes through mixed tiles. A point whose side the middle of its tile or the sample before it tells has no sample.
    fn run(&mut self, first: usize, end: usize, known: &[Known], side: usize) {
        let isovalue = self.isovalue;
        let tiles = &known[first / side..end.div_ceil(side)];
        let slope = tiles.iter().fold(0.0, |steepest: f32, tile| steepest.max(tile.slope));
        let mut before = Known { value: f32::NAN, ..Known::default() };
        let mut reach = f32::NAN;
        let mut waiting = Waiting { count: 0, columns: [0; BATCH] };
        let mut batch = 1;
        for (k, tile) in tiles.iter().enumerate() {
            let reach_of_tile = tile.squared_reach(isovalue);
            let (dy, dz) = (self.y - tile.at.y, self.z - tile.at.z);
            let across = dy * dy + dz * dz;
            let from = first + k * side;
            for i in self.points(from, end.min(from + side)) {
                let x = self.grid.coordinates.x[i];
                let (from_tile, from_before) = (x - tile.at.x, x - before.at.x);
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
        let places = &self.grid.coordinates.x;
        let x: [f32; BATCH] = std::array::from_fn(|k| places[columns[k.min(columns.len() - 1)]]);
        let mut found = [0.0; BATCH];
        let (x, found) = (&x[..columns.len()], &mut found[..columns.len()]);
        self.field.sample_row_after(x, self.y, self.z, found, hint);
        let mut last = Known::default();
        for ((&i, &x), &value) in columns.iter().zip(x).zip(&*found) {
            self.values[i] = value;
            self.taken[i / 64] |= 1 << (i % 64);
            self.set_side(i, value > self.isovalue);
            last = Known { at: Vec3::new(x, self.y, self.z), value, slope };
        }
        last
    }

    fn set_side(&mut self, i: usize, is_inside: bool) {
        self.sides[i / 64] |= u64::from(is_inside) << (i % 64);
    }
}

/// Columns to be sampled together.
struct Waiting {
    count: usize,
    columns: [usize; BATCH],
}

fn set_range(bits: &mut [u64], first: usize, end: usize) {
    let words = first / 64..end.div_ceil(64);
    for (word, bits) in words.clone().zip(&mut bits[words]) {
        *bits |= Grid::bits(word, first, end);
    }
}

/// Where the points of a row of `nx` columns are.
fn state_of(sides: &[u64], used: u64, nx: usize) -> State {
    let (mut any, mut all) = (0, !0);
    for (word, &sides) in sides.iter().enumerate() {
        let used = used & Grid::bits(word, 0, nx);
        any |= sides & used;
        all &= sides | !used;
    }
    match (any, all) {
        (0, _) => State::Outside,
        (_, u64::MAX) => State::Inside,
        _ => State::Mixed,
    }
}

/// A set bit near another bit.
fn taken_near(taken: u64, bit: u32) -> Option<u32> {
    let (below, above) = (taken & !(!0 << bit), taken & (!0 << bit));
    below.checked_ilog2().or((above != 0).then(|| above.trailing_zeros()))
}
