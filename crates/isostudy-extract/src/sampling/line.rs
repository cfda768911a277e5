//! The samples of one row of points: those that sides need, and later those that crossings need.

use std::collections::TryReserveError;
use std::ops::Range;

use glam::Vec3;
use isostudy_field::StudyField;

use crate::memory::refill;
use crate::sampling::bits::{set_near, set_range};
use crate::sampling::tiles::{Known, Span, Tile};

/// At most so many samples are taken together near the surface.
const BATCH: usize = 16;

/// Which columns of a row have points.
pub(crate) trait Columns: Copy {
    /// Those from `first` up to `end`.
    fn points(self, first: usize, end: usize) -> impl Iterator<Item = usize> + use<Self>;

    /// Where the same are among those with points.
    fn places(self, first: usize, end: usize) -> Range<usize>;
}

/// All of them.
#[derive(Debug, Clone, Copy)]
pub(crate) struct All;

impl Columns for All {
    fn points(self, first: usize, end: usize) -> impl Iterator<Item = usize> + use<> {
        first..end
    }

    fn places(self, first: usize, end: usize) -> Range<usize> {
        first..end
    }
}

/// The column `offset`, and from there on each `step`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Every {
    pub(crate) offset: usize,
    pub(crate) step: usize,
}

impl Columns for Every {
    fn points(self, first: usize, end: usize) -> impl Iterator<Item = usize> + use<> {
        let Self { offset, step } = self;
        (offset + first.saturating_sub(offset).next_multiple_of(step)..end).step_by(step)
    }

    fn places(self, first: usize, end: usize) -> Range<usize> {
        let start = first.saturating_sub(self.offset).div_ceil(self.step);
        start..start + self.points(first, end).count()
    }
}

/// A row of which some parts are known to be on one side.
pub(crate) struct Line<'a, C> {
    pub(crate) field: &'a dyn StudyField,
    pub(crate) isovalue: f32,
    pub(crate) columns: C,
    /// Of all columns, as many as there are values.
    pub(crate) x: &'a [f32],
    pub(crate) y: f32,
    pub(crate) z: f32,
    pub(crate) values: &'a mut [f32],
    /// A bit for each sample that was taken.
    pub(crate) taken: &'a mut [u64],
    /// 1 inside; all zero to begin with.
    pub(crate) sides: &'a mut [u64],
}

impl<C: Columns> Line<'_, C> {
    /// Finds the sides of a row that goes through `spans` of tiles `side` columns wide. Where nothing is known,
    /// `take_all` takes the samples of columns from one up to another.
    pub(crate) fn sample(
        &mut self,
        spans: &[Span],
        known: &[Known],
        side: usize,
        mut take_all: impl FnMut(&mut Self, usize, usize),
    ) {
        for span in spans {
            let (first, end) = (span.first as usize * side, self.x.len().min(span.end as usize * side));
            match span.tile {
                Tile::Outside => {}
                Tile::Inside => set_range(self.sides, first, end),
                Tile::Unknown => take_all(self, first, end),
                Tile::Mixed => self.run(first, end, known, side),
            }
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
        let most = self.field.values_at_once().clamp(1, BATCH);
        for (k, tile) in tiles.iter().enumerate() {
            let reach_of_tile = tile.squared_reach(isovalue);
            let (dy, dz) = (self.y - tile.at.y, self.z - tile.at.z);
            let across = dy * dy + dz * dz;
            let from = first + k * side;
            for i in self.columns.points(from, end.min(from + side)) {
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
                        batch = most;
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
        self.field.sample_row_after(x, self.y, self.z, found, hint);
        let mut last = Known::default();
        for ((&i, &x), &value) in columns.iter().zip(x).zip(&*found) {
            self.keep(i, value);
            last = Known { at: Vec3::new(x, self.y, self.z), value, slope };
        }
        last
    }

    /// Keeps the sample of a column, and its side.
    #[inline]
    pub(crate) fn keep(&mut self, i: usize, value: f32) {
        self.values[i] = value;
        self.taken[i / 64] |= 1 << (i % 64);
        self.set_side(i, value > self.isovalue);
    }

    #[inline]
    pub(crate) fn set_side(&mut self, i: usize, is_inside: bool) {
        self.sides[i / 64] |= u64::from(is_inside) << (i % 64);
    }
}

/// Columns to be sampled together.
struct Waiting {
    count: usize,
    columns: [usize; BATCH],
}

/// The points of a row at crossings that have no sample yet.
#[derive(Debug, Default)]
pub(crate) struct Gaps {
    columns: Vec<usize>,
    /// A column nearby that has a sample.
    near: Option<usize>,
    x: Vec<f32>,
    found: Vec<f32>,
}

impl Gaps {
    /// Makes room for a row of so many points.
    pub(crate) fn fit(&mut self, points: usize) -> Result<(), TryReserveError> {
        for buffer in [&mut self.x, &mut self.found] {
            refill(buffer, points, 0.0)?;
        }
        self.columns.clear();
        self.columns.try_reserve_exact(points)
    }

    /// Begins a row.
    pub(crate) fn clear(&mut self) {
        self.columns.clear();
        self.near = None;
    }

    /// Notes the `active` points of a word that are not `taken`, which they are from now on. Words come in order.
    pub(crate) fn note(&mut self, word: usize, active: u64, taken: &mut u64) {
        let mut left = active & !*taken;
        if left != 0 && self.near.is_none() {
            self.near = set_near(*taken, left.trailing_zeros()).map(|bit| 64 * word + bit as usize);
        }
        *taken |= left;
        while left != 0 {
            self.columns.push(64 * word + left.trailing_zeros() as usize);
            left &= left - 1;
        }
    }

    /// Takes the samples of the points noted. `x` has all columns.
    pub(crate) fn fill(&mut self, field: &dyn StudyField, x: &[f32], y: f32, z: f32, values: &mut [f32]) {
        let count = self.columns.len();
        if count == 0 {
            return;
        }
        for (place, &column) in self.x.iter_mut().zip(&self.columns) {
            *place = x[column];
        }
        let found = &mut self.found[..count];
        let hint = self.near.map(|column| (Vec3::new(x[column], y, z), values[column]));
        field.sample_row_after(&self.x[..count], y, z, found, hint);
        for (&column, &value) in self.columns.iter().zip(&*found) {
            values[column] = value;
        }
    }

    /// Room for the samples of a row.
    pub(crate) fn room(&mut self) -> &mut [f32] {
        &mut self.found
    }
}
