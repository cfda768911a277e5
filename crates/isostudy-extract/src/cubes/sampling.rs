//! Sampling pass: the sides of a layer, then the samples that no side needed and cells do.

use std::collections::TryReserveError;

use super::grid::CubeGrid;
use super::rows::{Rows, before, next};
use crate::memory::reset;
use crate::sampling::bits::{between, set_above, set_range};
use crate::sampling::in_sight::{State, Values};
use crate::sampling::line::{All, Gaps, Line};
use crate::sampling::tiles::{Span, Tile, Tiles};
use crate::source::Sampler;
use isostudy_field::StudyField;

/// What is sampled, and where.
#[derive(Clone, Copy)]
pub(crate) struct Sampling<'a> {
    pub(crate) grid: &'a CubeGrid<'a>,
    pub(crate) source: Sampler<'a>,
    pub(crate) isovalue: f32,
    /// Whether all corners of a crossed cell have samples, or the ends of crossed edges alone.
    pub(crate) all_corners: bool,
}

/// A few layers of samples and sides.
#[derive(Default)]
pub(crate) struct Samples {
    /// Of a field that is called; without room where samples are given.
    called: Called,
    /// 1 inside.
    pub(crate) sides: Rows,
    states: Vec<State>,
    /// Layers in sight.
    slots: usize,
}

/// A ring of layers of samples, and a bit for each that was taken.
#[derive(Default)]
struct Called {
    values: Vec<f32>,
    taken: Rows,
    tiles: Tiles,
    gaps: Gaps,
    wanted: Vec<u64>,
    slots: usize,
}

impl Samples {
    /// Makes room for so many layers in sight.
    pub(crate) fn fit(
        &mut self,
        grid: &CubeGrid,
        source: Sampler,
        slots: usize,
    ) -> Result<(), TryReserveError> {
        self.slots = slots;
        if matches!(source, Sampler::Field(_)) {
            self.called.fit(grid, slots)?;
        }
        reset(&mut self.states, grid.size[1] * slots, State::Outside)?;
        self.sides.fit(grid, slots)
    }

    pub(crate) fn values<'a>(&'a self, grid: &CubeGrid, source: Sampler<'a>) -> Values<'a> {
        let size = grid.size;
        match source {
            Sampler::Given { values, .. } => Values::new(values, size, size[2]),
            Sampler::Field(_) => Values::new(&self.called.values, size, self.slots),
        }
    }

    /// Where the points of each row of a layer are.
    pub(crate) fn states(&self, layer: usize) -> &[State] {
        let rows = self.states.len() / self.slots;
        &self.states[layer % self.slots * rows..][..rows]
    }

    /// Whether all points of some rows are on one side.
    #[inline]
    pub(crate) fn is_uniform(&self, grid: &CubeGrid, rows: &[[usize; 2]]) -> bool {
        let state = |[y, z]: [usize; 2]| self.states[z % self.slots * grid.size[1] + y];
        let first = state(rows[0]);
        first != State::Mixed && rows.iter().all(|&row| state(row) == first)
    }

    /// Finds the sides of a layer, with as few samples as may be.
    pub(crate) fn find_sides(&mut self, sampling: Sampling, layer: usize) {
        let Sampling { grid, source, isovalue, .. } = sampling;
        let [nx, ny, _] = grid.size;
        let called = &mut self.called;
        if let Sampler::Field(field) = source {
            called.tiles.turn_to(layer, grid, field, isovalue);
        }
        for row in 0..ny {
            let sides = self.sides.row_mut(row, layer);
            sides.fill(0);
            let mut state = State::Mixed;
            match source {
                Sampler::Given { bricks: Some(bricks), .. } => {
                    state = bricks.set_above([row, layer], isovalue, sides);
                }
                Sampler::Given { values, bricks: None } => {
                    let values = &values[(layer * ny + row) * nx..][..nx];
                    set_above(values, isovalue, sides);
                }
                Sampler::Field(field) => {
                    called.taken.row_mut(row, layer).fill(0);
                    match called.tiles.row(row).0 {
                        [Span { tile: Tile::Outside, .. }] => state = State::Outside,
                        [Span { tile: Tile::Inside, .. }] => {
                            state = State::Inside;
                            set_range(sides, 0, nx);
                        }
                        _ => called.sample(sampling, field, [row, layer], sides),
                    }
                }
            }
            if state == State::Mixed {
                state = State::of(sides, !0, nx);
            }
            self.states[layer % self.slots * ny + row] = state;
        }
    }

    /// Takes the samples of a layer that cells need and sides did not. The sides of the layers next to it are known.
    pub(crate) fn fill(&mut self, sampling: Sampling, layer: usize) {
        let Sampling { grid, source, all_corners, .. } = sampling;
        let Sampler::Field(field) = source else { return };
        for row in 0..grid.size[1] {
            let near = Near::new(grid, [row, layer], all_corners);
            if self.is_uniform(grid, near.rows()) {
                continue;
            }
            let called = &mut self.called;
            near.for_each_word(grid, &self.sides, |word, wanted| called.wanted[word] = wanted);
            called.fill(grid, field, [row, layer]);
        }
    }
}

/// The rows at a row whose sides say which of its samples cells need.
pub(crate) struct Near {
    around: [[usize; 2]; 9],
    count: usize,
    all_corners: bool,
}

impl Near {
    /// Of a row in a layer.
    pub(crate) fn new(grid: &CubeGrid, [row, layer]: [usize; 2], all_corners: bool) -> Self {
        let [_, ny, nz] = grid.size;
        let (rows, layers) =
            (row.saturating_sub(1)..ny.min(row + 2), layer.saturating_sub(1)..nz.min(layer + 2));
        let mut near = Self { around: [[row, layer]; 9], count: 1, all_corners };
        for [y, z] in layers.flat_map(|z| rows.clone().map(move |y| [y, z])) {
            let is_self = [y, z] == [row, layer];
            if !is_self && (all_corners || y == row || z == layer) {
                near.around[near.count] = [y, z];
                near.count += 1;
            }
        }
        near
    }

    pub(crate) fn rows(&self) -> &[[usize; 2]] {
        &self.around[..self.count]
    }

    /// Calls `visit` with each word of the row and the points of it that cells need: ends of crossed edges, or all corners of
    /// crossed cells.
    pub(crate) fn for_each_word(&self, grid: &CubeGrid, sides: &Rows, mut visit: impl FnMut(usize, u64)) {
        let lines = self.around.map(|[y, z]| sides.row(y, z));
        for word in 0..grid.words {
            let [mut any, mut all] = [lines[0][word]; 2];
            for (i, line) in lines[..self.count].iter().enumerate() {
                (any, all) = (any | line[word], all & line[word]);
                if i == 0 || self.all_corners {
                    let (next, before) = (next(line, word), before(line, word));
                    any |= next & grid.with_next(word) | before;
                    all &= (next | !grid.with_next(word)) & before;
                }
            }
            visit(word, any & !all & between(word, 0, grid.size[0]));
        }
    }
}

impl Called {
    fn fit(&mut self, grid: &CubeGrid, slots: usize) -> Result<(), TryReserveError> {
        let [nx, ny, _] = grid.size;
        self.slots = slots;
        self.tiles.fit(grid)?;
        self.gaps.fit(nx)?;
        reset(&mut self.values, nx * ny * slots, 0.0)?;
        self.taken.fit(grid, slots)?;
        reset(&mut self.wanted, grid.words, 0)
    }

    /// Finds the sides of a row that is not known to lie on one.
    fn sample(
        &mut self,
        sampling: Sampling,
        field: &dyn StudyField,
        [row, layer]: [usize; 2],
        sides: &mut [u64],
    ) {
        let grid = sampling.grid;
        let [nx, ny, _] = grid.size;
        let (spans, known) = self.tiles.row(row);
        let mut line = Line {
            field,
            isovalue: sampling.isovalue,
            columns: All,
            x: &grid.at[0],
            y: grid.at[1][row],
            z: grid.at[2][layer],
            values: &mut self.values[(layer % self.slots * ny + row) * nx..][..nx],
            taken: self.taken.row_mut(row, layer),
            sides,
        };
        let found = self.gaps.room();
        line.sample(spans, known, crate::sampling::tiles::Points::side(grid), |line, first, end| {
            let found = &mut found[..end - first];
            line.field.sample_row(&line.x[first..end], line.y, line.z, found);
            for (i, &value) in (first..end).zip(&*found) {
                line.keep(i, value);
            }
        });
    }

    /// Takes the samples of a row that are wanted and not there yet.
    fn fill(&mut self, grid: &CubeGrid, field: &dyn StudyField, [row, layer]: [usize; 2]) {
        let [nx, ny, _] = grid.size;
        let (y, z) = (grid.at[1][row], grid.at[2][layer]);
        let values = &mut self.values[(layer % self.slots * ny + row) * nx..][..nx];
        self.gaps.clear();
        for (word, (taken, &wanted)) in
            self.taken.row_mut(row, layer).iter_mut().zip(&self.wanted).enumerate()
        {
            self.gaps.note(word, wanted, taken);
        }
        self.gaps.fill(field, &grid.at[0], y, z, values);
    }
}
