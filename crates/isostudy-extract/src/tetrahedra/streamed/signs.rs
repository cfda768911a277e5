//! Rows of sign bits, 64 points a word, for the few layers in sight.

use super::grid::UniformGrid;
use crate::memory::refill;
use crate::sampling::bits::{between, set_above};

/// What the points of a row have in common.
pub(super) const ALL_OUTSIDE: u8 = 0;
pub(super) const ALL_INSIDE: u8 = 1;
pub(super) const MIXED: u8 = 2;

/// A ring of layers. Each row has a word of zeros at either end, so that a shift by one point needs no special case.
#[derive(Debug, Default)]
pub(super) struct Signs {
    words: Vec<u64>,
    /// By place.
    pub(super) states: Vec<u8>,
    stride: usize,
    rows: usize,
    pub(super) slots: usize,
}

impl Signs {
    pub(super) fn fit(
        &mut self,
        grid: &UniformGrid,
        slots: usize,
    ) -> Result<(), std::collections::TryReserveError> {
        (self.stride, self.rows, self.slots) = (grid.words + 2, grid.size[1], slots);
        refill(&mut self.words, self.stride * self.rows * self.slots, 0)?;
        refill(&mut self.states, self.rows * self.slots, ALL_OUTSIDE)
    }

    #[inline]
    fn place(&self, row: usize, layer: usize) -> usize {
        layer % self.slots * self.rows + row
    }

    /// The words of a row, by its place: rows, layer after layer.
    #[inline]
    pub(super) fn row_at(&self, place: usize) -> &[u64] {
        &self.words[place * self.stride..(place + 1) * self.stride]
    }

    /// Inside is a value above the isovalue; equal is outside, and so is `NaN`.
    pub(super) fn fill(&mut self, row: usize, layer: usize, values: &[f32], isovalue: f32) {
        let place = self.place(row, layer);
        let words = &mut self.words[place * self.stride + 1..][..values.len().div_ceil(64)];
        set_above(values, isovalue, words);
        self.close(row, layer, values.len());
    }

    /// The words of a row, all outside, to be set; [`close`](Self::close) must follow.
    pub(super) fn open(&mut self, row: usize, layer: usize) -> &mut [u64] {
        let place = self.place(row, layer);
        let words = &mut self.words[place * self.stride + 1..(place + 1) * self.stride - 1];
        words.fill(0);
        words
    }

    /// Takes note of what an opened row of `used` points has become.
    pub(super) fn close(&mut self, row: usize, layer: usize, used: usize) {
        let place = self.place(row, layer);
        let words = &self.words[place * self.stride + 1..][..used.div_ceil(64)];
        let (mut any, mut all) = (0, !0);
        for (i, &word) in words.iter().enumerate() {
            any |= word;
            all &= word | !between(i, 0, used);
        }
        self.states[place] = state(any, all);
    }

    /// A row whose points are all on one side.
    pub(super) fn set_all(&mut self, row: usize, layer: usize, inside: bool, used: usize) {
        let place = self.place(row, layer);
        let words = &mut self.words[place * self.stride + 1..(place + 1) * self.stride - 1];
        for (i, word) in words.iter_mut().enumerate() {
            *word = if inside { between(i, 0, used) } else { 0 };
        }
        self.states[place] = u8::from(inside);
    }
}

fn state(any: u64, all: u64) -> u8 {
    if any == 0 {
        ALL_OUTSIDE
    } else if all == !0 {
        ALL_INSIDE
    } else {
        MIXED
    }
}
