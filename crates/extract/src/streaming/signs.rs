//! Rows of sign bits, 64 points a word, for the few layers in sight.

use glam::Vec4;

use super::grid::Grid;
use crate::memory::refill;

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
    pub(super) fn fit(&mut self, grid: &Grid, slots: usize) -> Result<(), std::collections::TryReserveError> {
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
        let words = &mut self.words[place * self.stride + 1..(place + 1) * self.stride];
        let (mut any, mut all) = (0, !0);
        let whole = values.len() / 64;
        let (chunks, rest) = values.as_chunks::<64>();
        for (word, chunk) in words.iter_mut().zip(chunks) {
            *word = above(chunk, isovalue);
            any |= *word;
            all &= *word;
        }
        if !rest.is_empty() {
            let last = above_short(rest, isovalue);
            words[whole] = last;
            any |= last;
            all &= last | !0 << rest.len();
        }
        self.states[place] = state(any, all);
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
        let words = &self.words[place * self.stride + 1..(place + 1) * self.stride - 1];
        let (mut any, mut all) = (0, !0);
        for (i, &word) in words.iter().enumerate() {
            any |= word;
            all &= word | !used_bits(i, used);
        }
        self.states[place] = state(any, all);
    }

    /// A row whose points are all on one side.
    pub(super) fn set_all(&mut self, row: usize, layer: usize, inside: bool, used: usize) {
        let place = self.place(row, layer);
        let words = &mut self.words[place * self.stride + 1..(place + 1) * self.stride - 1];
        for (i, word) in words.iter_mut().enumerate() {
            *word = if inside { used_bits(i, used) } else { 0 };
        }
        self.states[place] = u8::from(inside);
    }
}

/// The bits of word `i` of a row of `used` points.
#[inline]
pub(super) fn used_bits(i: usize, used: usize) -> u64 {
    match used.saturating_sub(64 * i) {
        0 => 0,
        n if n < 64 => !(!0 << n),
        _ => !0,
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

#[inline]
fn above(values: &[f32; 64], isovalue: f32) -> u64 {
    let limit = Vec4::splat(isovalue);
    let (fours, _) = values.as_chunks::<4>();
    let mut word = 0;
    for (i, &four) in fours.iter().enumerate() {
        word |= u64::from(Vec4::from_array(four).cmpgt(limit).bitmask()) << (4 * i);
    }
    word
}

/// Bits of up to 64 values.
#[inline]
pub(super) fn above_short(values: &[f32], isovalue: f32) -> u64 {
    values.iter().enumerate().fold(0, |word, (i, &value)| word | u64::from(value > isovalue) << i)
}
