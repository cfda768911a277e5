//! Rows of bits, 64 points a word, for the few layers in sight.

use std::collections::TryReserveError;

use super::grid::CubeGrid;
use crate::memory::reset;

/// A ring of layers of rows. Each row has a word of zeros at its end, so that the bit after each can be asked for.
#[derive(Default)]
pub(crate) struct Rows {
    words: Vec<u64>,
    stride: usize,
    rows: usize,
    /// Of a layer's number, the bits that say where in the ring it is: asked for often, and a division takes longer.
    ring: usize,
}

impl Rows {
    /// Makes room for so many layers at a time, all zeros.
    pub(crate) fn fit(&mut self, grid: &CubeGrid, slots: usize) -> Result<(), TryReserveError> {
        let slots = slots.next_power_of_two();
        (self.stride, self.rows, self.ring) = (grid.words + 1, grid.size[1], slots - 1);
        reset(&mut self.words, self.stride * self.rows * slots, 0)
    }

    fn start(&self, row: usize, layer: usize) -> usize {
        ((layer & self.ring) * self.rows + row) * self.stride
    }

    /// The words of a row, with the one after it.
    #[inline]
    pub(crate) fn row(&self, row: usize, layer: usize) -> &[u64] {
        &self.words[self.start(row, layer)..][..self.stride]
    }

    /// The words of a row alone.
    pub(crate) fn row_mut(&mut self, row: usize, layer: usize) -> &mut [u64] {
        let start = self.start(row, layer);
        &mut self.words[start..start + self.stride - 1]
    }
}

/// The bits one column farther on. `row` has a word more at its end.
#[inline(always)]
pub(crate) fn next(row: &[u64], word: usize) -> u64 {
    row[word] >> 1 | row[word + 1] << 63
}

/// The bits one column back; the first column has its own.
#[inline(always)]
pub(crate) fn before(row: &[u64], word: usize) -> u64 {
    row[word] << 1 | if word == 0 { row[0] & 1 } else { row[word - 1] >> 63 }
}
