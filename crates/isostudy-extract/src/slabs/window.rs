//! The layers in sight of the extractors of cubes, cut or not: sides of all points, and samples where they were taken.
//!
//! A field is called where its bounds leave the side of a point open ([`StudyField::range`], [`StudyField::slope`]), and later where
//! an extractor wants more. All other points have no sample. Stored samples are read layer by layer, all of them.

use std::collections::TryReserveError;

use isostudy_field::StudyField;

use crate::extraction::ExtractError;
use crate::memory::reset;
use crate::sampling::bits::{set_above, set_range};
use crate::sampling::in_sight::{State, Values};
use crate::sampling::line::{Columns, Gaps, Line};
use crate::sampling::rows::Rows;
use crate::sampling::tiles::{Points, Span, Tile, Tiles};
use crate::source::{Sampler, read_layer};

/// Points in rows, as many in one as in the next, some columns of which may have none.
pub(crate) trait PointRows: Points {
    /// Which columns of a row have points.
    type Columns: Columns;

    /// Words of bits a row.
    fn words(&self) -> usize;

    /// The coordinates of all columns, rows or layers.
    fn at(&self, axis: usize) -> &[f32];

    /// Of a row: its columns with points, where those are one after the other, and which bits of a word they have.
    fn columns(&self, row: usize, layer: usize) -> (Self::Columns, &[f32], u64);
}

/// A few layers of samples and sides.
#[derive(Debug, Default)]
pub(crate) struct Window<const BEFORE: usize = 0> {
    /// A ring of layers of samples; without room where they are given.
    values: Vec<f32>,
    /// Of a field that is called; without room where it is not.
    called: Called<BEFORE>,
    /// 1 inside. Columns without a point have any.
    pub(crate) sides: Rows<BEFORE>,
    states: Vec<State>,
    /// Room for the bits of a row.
    pub(crate) wanted: Vec<u64>,
    rows: usize,
    /// Layers in sight.
    slots: usize,
}

/// What is known of samples that are asked for one by one: a bit for each that was taken, in a ring of layers.
#[derive(Debug, Default)]
struct Called<const BEFORE: usize> {
    taken: Rows<BEFORE>,
    tiles: Tiles,
    gaps: Gaps,
}

impl<const BEFORE: usize> Window<BEFORE> {
    /// Makes room for so many layers in sight; keeps what is large enough.
    pub(crate) fn fit(
        &mut self,
        grid: &impl PointRows,
        source: Sampler,
        slots: usize,
    ) -> Result<(), TryReserveError> {
        let [nx, ny, _] = grid.size();
        (self.rows, self.slots) = (ny, slots);
        match source {
            Sampler::Given { .. } => {}
            Sampler::Field(_) => {
                self.called.fit(grid, slots)?;
                reset(&mut self.values, nx * ny * slots, 0.0)?;
            }
            Sampler::Stored(_) => reset(&mut self.values, nx * ny * slots, 0.0)?,
        }
        reset(&mut self.states, ny * slots, State::Outside)?;
        reset(&mut self.wanted, grid.words(), 0)?;
        self.sides.fit(grid.words(), ny, slots)
    }

    pub(crate) fn values<'a>(&'a self, grid: &impl PointRows, source: Sampler<'a>) -> Values<'a> {
        let size = grid.size();
        match source {
            Sampler::Given { values, .. } => Values::new(values, size, size[2]),
            Sampler::Field(_) | Sampler::Stored(_) => Values::new(&self.values, size, self.slots),
        }
    }

    /// Where the points of a row are.
    #[inline]
    pub(crate) fn state(&self, [row, layer]: [usize; 2]) -> State {
        self.states[layer % self.slots * self.rows + row]
    }

    /// Where the points of each row of a layer are.
    pub(crate) fn states(&self, layer: usize) -> &[State] {
        &self.states[layer % self.slots * self.rows..][..self.rows]
    }

    /// Whether all points of some rows are on one side.
    #[inline]
    pub(crate) fn is_uniform(&self, rows: &[[usize; 2]]) -> bool {
        let first = self.state(rows[0]);
        first != State::Mixed && rows.iter().all(|&row| self.state(row) == first)
    }

    /// Finds the sides of a layer, with as few samples as may be.
    ///
    /// # Errors
    /// [`ExtractError::Unread`].
    pub(crate) fn find_sides(
        &mut self,
        grid: &impl PointRows,
        source: Sampler,
        isovalue: f32,
        layer: usize,
    ) -> Result<(), ExtractError> {
        let [nx, ny, _] = grid.size();
        let called = &mut self.called;
        let slot = layer % self.slots * ny;
        match source {
            Sampler::Given { .. } => {}
            Sampler::Field(field) => called.tiles.turn_to(layer, grid, field, isovalue),
            Sampler::Stored(samples) => {
                read_layer(samples, layer, &mut self.values[slot * nx..][..nx * ny])?;
            }
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
                Sampler::Stored(_) => set_above(&self.values[(slot + row) * nx..][..nx], isovalue, sides),
                Sampler::Field(field) => {
                    called.taken.row_mut(row, layer).fill(0);
                    match called.tiles.row(row).0 {
                        [Span { tile: Tile::Outside, .. }] => state = State::Outside,
                        [Span { tile: Tile::Inside, .. }] => {
                            state = State::Inside;
                            set_range(sides, 0, nx);
                        }
                        _ => {
                            let values = &mut self.values[(slot + row) * nx..][..nx];
                            called.sample(grid, field, isovalue, [row, layer], values, sides);
                        }
                    }
                }
            }
            if state == State::Mixed {
                state = State::of(sides, grid.columns(row, layer).2, nx);
            }
            self.states[slot + row] = state;
        }
        Ok(())
    }

    /// Takes the samples of a row that are wanted and not there yet.
    pub(crate) fn take(
        &mut self,
        grid: &impl PointRows,
        field: &dyn StudyField,
        [row, layer]: [usize; 2],
        wanted: &[u64],
    ) {
        let Called { taken, gaps, .. } = &mut self.called;
        let [nx, ny, _] = grid.size();
        let values = &mut self.values[(layer % self.slots * ny + row) * nx..][..nx];
        gaps.clear();
        for (word, (taken, &wanted)) in taken.row_mut(row, layer).iter_mut().zip(wanted).enumerate() {
            gaps.note(word, wanted, taken);
        }
        gaps.fill(field, grid.at(0), grid.at(1)[row], grid.at(2)[layer], values);
    }
}

impl<const BEFORE: usize> Called<BEFORE> {
    fn fit(&mut self, grid: &impl PointRows, slots: usize) -> Result<(), TryReserveError> {
        let [nx, ny, _] = grid.size();
        self.tiles.fit(grid)?;
        self.gaps.fit(nx)?;
        self.taken.fit(grid.words(), ny, slots)
    }

    /// Finds the sides of a row that is not known to lie on one.
    fn sample(
        &mut self,
        grid: &impl PointRows,
        field: &dyn StudyField,
        isovalue: f32,
        [row, layer]: [usize; 2],
        values: &mut [f32],
        sides: &mut [u64],
    ) {
        let (spans, known) = self.tiles.row(row);
        let (columns, with_points, _) = grid.columns(row, layer);
        let mut line = Line {
            field,
            isovalue,
            columns,
            x: grid.at(0),
            y: grid.at(1)[row],
            z: grid.at(2)[layer],
            values,
            taken: self.taken.row_mut(row, layer),
            sides,
        };
        let found = self.gaps.room();
        line.sample(spans, known, grid.side(), |line, first, end| {
            // Columns with a point, as if there were no others.
            let places = line.columns.places(first, end);
            let found = &mut found[..places.len()];
            line.field.sample_row(&with_points[places], line.y, line.z, found);
            for (i, &value) in line.columns.points(first, end).zip(&*found) {
                line.keep(i, value);
            }
        });
    }
}
