//! Rows of bits, 64 points a word, for the few layers in sight.

use std::collections::TryReserveError;

use super::grid::Grid;
use crate::memory::filled;

/// A ring of layers of rows. Each row has a word of zeros at its end, so that the bit after each can be asked for.
pub(super) struct Rows {
    words: Vec<u64>,
    stride: usize,
    rows: usize,
    /// Of a layer's number, the bits that say where in the ring it is: asked for often, and a division takes longer.
    ring: usize,
}

impl Rows {
    /// For so many layers at a time.
    pub(super) fn new(grid: &Grid, slots: usize) -> Result<Self, TryReserveError> {
        let (stride, rows, slots) = (grid.words + 1, grid.size[1], slots.next_power_of_two());
        Ok(Self { words: filled(stride * rows * slots, 0)?, stride, rows, ring: slots - 1 })
    }

    fn start(&self, row: usize, layer: usize) -> usize {
        ((layer & self.ring) * self.rows + row) * self.stride
    }

    /// The words of a row, with the one after it.
    #[inline]
    pub(super) fn row(&self, row: usize, layer: usize) -> &[u64] {
        &self.words[self.start(row, layer)..][..self.stride]
    }

    /// The words of a row alone.
    pub(super) fn row_mut(&mut self, row: usize, layer: usize) -> &mut [u64] {
        let start = self.start(row, layer);
        &mut self.words[start..start + self.stride - 1]
    }
}

/// The bits one column farther on. `row` has a word more at its end.
#[inline(always)]
pub(super) fn next(row: &[u64], word: usize) -> u64 {
    row[word] >> 1 | row[word + 1] << 63
}

/// The bits one column back; the first column has its own.
#[inline(always)]
pub(super) fn before(row: &[u64], word: usize) -> u64 {
    row[word] << 1 | if word == 0 { row[0] & 1 } else { row[word - 1] >> 63 }
}
