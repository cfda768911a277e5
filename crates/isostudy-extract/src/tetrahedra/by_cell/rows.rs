//! Rows of bits, 64 points a word, for the few layers in sight.

use std::collections::TryReserveError;

use super::grid::CutGrid;
use crate::memory::refill;

/// A ring of layers. Each row has a word of zeros at either end, so that a shift by a few points needs no special case.
#[derive(Debug, Default)]
pub(super) struct BitRows {
    words: Vec<u64>,
    stride: usize,
    rows: usize,
    slots: usize,
}

impl BitRows {
    /// All zero, in the room that there is if that is enough.
    pub(super) fn fit(&mut self, grid: &CutGrid, slots: usize) -> Result<(), TryReserveError> {
        (self.stride, self.rows, self.slots) = (grid.words + 2, grid.size[1], slots);
        self.words.clear();
        refill(&mut self.words, self.stride * self.rows * slots, 0)
    }

    fn start(&self, row: usize, layer: usize) -> usize {
        (layer % self.slots * self.rows + row) * self.stride
    }

    /// The words of a row, with the one before and the one after it.
    pub(super) fn row(&self, row: usize, layer: usize) -> &[u64] {
        &self.words[self.start(row, layer)..][..self.stride]
    }

    /// The words of a row alone.
    pub(super) fn row_mut(&mut self, row: usize, layer: usize) -> &mut [u64] {
        let start = self.start(row, layer);
        &mut self.words[start + 1..start + self.stride - 1]
    }
}

/// The bits `by` columns farther on, `by` at most 63 either way. `row` has a word more at either end.
pub(super) fn shifted(row: &[u64], word: usize, by: isize) -> u64 {
    let [before, here, after] = [row[word], row[word + 1], row[word + 2]];
    match by {
        0 => here,
        1.. => here >> by | after << (64 - by),
        _ => here << -by | before >> (64 + by),
    }
}

/// Whether the bit of a column is set. `row` has a word more at either end.
pub(super) fn is_set(row: &[u64], column: usize) -> bool {
    row[column / 64 + 1] >> (column % 64) & 1 != 0
}
