//! Sampling pass: the sides of a layer, then which of its points have a crossing, and the samples there that no side
//! needed.
//!
//! A field is called where its bounds leave the side of a point open ([`StudyField::range`], [`StudyField::slope`]),
//! and at points with a crossing. All other points have no sample.

use std::collections::TryReserveError;

use super::grid::{CutGrid, LINES};
use super::rows::{BitRows, shifted};
use crate::memory::refill;
use crate::sampling::bits::{between, set_above, set_range};
use crate::sampling::in_sight::{State, Values};
use crate::sampling::line::{Columns, Every, Gaps, Line};
use crate::sampling::tiles::{Points, Span, Tile, Tiles};
use crate::source::Sampler;
use isostudy_field::StudyField;

/// A few layers of samples and sides.
#[derive(Debug, Default)]
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
#[derive(Debug, Default)]
struct Called {
    values: Vec<f32>,
    taken: BitRows,
    tiles: Tiles,
    gaps: Gaps,
}

/// What is sampled, and where.
#[derive(Clone, Copy)]
pub(super) struct Sampling<'a> {
    pub(super) grid: &'a CutGrid,
    pub(super) source: Sampler<'a>,
    pub(super) isovalue: f32,
}

impl Samples {
    /// Makes room; keeps what is large enough.
    pub(super) fn fit(&mut self, grid: &CutGrid, source: Sampler) -> Result<(), TryReserveError> {
        self.slots = grid.slots();
        if matches!(source, Sampler::Field(_)) {
            self.called.get_or_insert_default().fit(grid, self.slots)?;
        }
        self.sides.fit(grid, self.slots)?;
        self.active.fit(grid, self.slots)?;
        refill(&mut self.states, grid.size[1] * self.slots, State::Outside)
    }

    pub(super) fn values<'a>(&'a self, grid: &CutGrid, source: Sampler<'a>) -> Values<'a> {
        let size = grid.size;
        match (source, &self.called) {
            (Sampler::Given { values, .. }, _) => Values::new(values, size, size[2]),
            (Sampler::Field(_), Some(called)) => Values::new(&called.values, size, self.slots),
            (Sampler::Field(_), None) => unreachable!("made for a field"),
        }
    }

    /// Finds the sides of a layer, with as few samples as may be.
    pub(super) fn find_sides(&mut self, sampling: Sampling, layer: usize) {
        let Sampling { grid, source, isovalue } = sampling;
        let [nx, ny, _] = grid.size;
        if let (Sampler::Field(field), Some(called)) = (source, &mut self.called) {
            called.tiles.turn_to(layer, grid, field, isovalue);
        }
        for row in 0..ny {
            let sides = self.sides.row_mut(row, layer);
            sides.fill(0);
            let mut state = State::Mixed;
            match (source, &mut self.called) {
                (Sampler::Given { values, .. }, _) => {
                    let values = &values[(layer * ny + row) * nx..][..nx];
                    set_above(values, isovalue, sides);
                }
                (Sampler::Field(field), Some(called)) => {
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
                (Sampler::Field(_), None) => unreachable!("made for a field"),
            }
            if state == State::Mixed {
                state = State::of(sides, grid.kind(row, layer).used, nx);
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
            if let (Sampler::Field(field), Some(called)) = (source, &mut self.called) {
                called.fill(grid, field, [row, layer], active, self.slots);
            }
        }
    }
}

/// Sets the bits of points with a neighbour on the other side.
fn mark_crossings(
    grid: &CutGrid,
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
            *active |= (here[word + 1] ^ shifted(there, word, dx)) & edges & between(word, first, end);
        }
    }
}

impl Called {
    fn fit(&mut self, grid: &CutGrid, slots: usize) -> Result<(), TryReserveError> {
        let [nx, ny, _] = grid.size;
        self.tiles.fit(grid)?;
        self.gaps.fit(nx)?;
        self.taken.fit(grid, slots)?;
        refill(&mut self.values, nx * ny * slots, 0.0)
    }

    /// Finds the sides of a row that is not known to lie on one.
    fn sample(
        &mut self,
        sampling: Sampling,
        field: &dyn StudyField,
        [row, layer]: [usize; 2],
        sides: &mut [u64],
        slots: usize,
    ) {
        let grid = sampling.grid;
        let [nx, ny, _] = grid.size;
        let (spans, known) = self.tiles.row(row);
        let [offset, step] = grid.kind(row, layer).columns;
        let mut line = Line {
            field,
            isovalue: sampling.isovalue,
            columns: Every { offset, step },
            x: &grid.coordinates.x,
            y: grid.coordinates.y[row],
            z: grid.coordinates.z[layer],
            values: &mut self.values[(layer % slots * ny + row) * nx..][..nx],
            taken: self.taken.row_mut(row, layer),
            sides,
        };
        // Columns with a point, as if there were no others.
        let x = if step == 1 { &grid.coordinates.x } else { &grid.columns[offset] };
        let found = self.gaps.room();
        line.sample(spans, known, grid.side(), |line, first, end| take_all(line, first, end, x, found));
    }

    /// Takes the samples of a row at points with a crossing that have none yet.
    fn fill(
        &mut self,
        grid: &CutGrid,
        field: &dyn StudyField,
        [row, layer]: [usize; 2],
        active: &[u64],
        slots: usize,
    ) {
        let [nx, ny, _] = grid.size;
        let places = &grid.coordinates;
        let (y, z) = (places.y[row], places.z[layer]);
        let values = &mut self.values[(layer % slots * ny + row) * nx..][..nx];
        self.gaps.clear();
        for (word, (taken, &active)) in self.taken.row_mut(row, layer).iter_mut().zip(active).enumerate() {
            self.gaps.note(word, active, taken);
        }
        self.gaps.fill(field, &places.x, y, z, values);
    }
}

/// Takes the samples of the columns with a point from `first` up to `end`. `x` has those with a point only.
fn take_all(line: &mut Line<Every>, first: usize, end: usize, x: &[f32], found: &mut [f32]) {
    let Every { offset, step } = line.columns;
    let count = line.columns.points(first, end).count();
    let start = first.saturating_sub(offset).div_ceil(step);
    let found = &mut found[..count];
    line.field.sample_row(&x[start..start + count], line.y, line.z, found);
    for (i, &value) in line.columns.points(first, end).zip(&*found) {
        line.keep(i, value);
    }
}
