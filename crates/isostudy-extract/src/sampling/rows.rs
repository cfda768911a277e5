//! Rows of bits, 64 points a word, for the few layers in sight.

use std::collections::TryReserveError;

use crate::memory::reset;

/// A ring of layers of rows. Each row has a word of zeros after it, and so many `BEFORE` it, so that bits beyond it can be asked for.
#[derive(Debug, Default)]
pub(crate) struct Rows<const BEFORE: usize = 0> {
    words: Vec<u64>,
    stride: usize,
    rows: usize,
    /// Of a layer's number, the bits that say where in the ring it is: asked for often, and a division takes longer.
    ring: usize,
}

impl<const BEFORE: usize> Rows<BEFORE> {
    /// Makes room for so many layers of rows of so many words, all zeros.
    pub(crate) fn fit(&mut self, words: usize, rows: usize, slots: usize) -> Result<(), TryReserveError> {
        let slots = slots.next_power_of_two();
        (self.stride, self.rows, self.ring) = (BEFORE + words + 1, rows, slots - 1);
        reset(&mut self.words, self.stride * self.rows * slots, 0)
    }

    fn start(&self, row: usize, layer: usize) -> usize {
        ((layer & self.ring) * self.rows + row) * self.stride
    }

    /// The words of a row, with those before it and the one after it.
    #[inline]
    pub(crate) fn row(&self, row: usize, layer: usize) -> &[u64] {
        &self.words[self.start(row, layer)..][..self.stride]
    }

    /// The words of a row alone.
    pub(crate) fn row_mut(&mut self, row: usize, layer: usize) -> &mut [u64] {
        let start = self.start(row, layer);
        &mut self.words[start + BEFORE..start + self.stride - 1]
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

/// The bits `by` columns farther on, `by` at most 63 either way. `row` has a word more at either end.
pub(crate) fn shifted(row: &[u64], word: usize, by: isize) -> u64 {
    let [before, here, after] = [row[word], row[word + 1], row[word + 2]];
    match by {
        0 => here,
        1.. => here >> by | after << (64 - by),
        _ => here << -by | before >> (64 + by),
    }
}

/// Whether the bit of a column is set. `row` has a word more at either end.
pub(crate) fn is_set(row: &[u64], column: usize) -> bool {
    row[column / 64 + 1] >> (column % 64) & 1 != 0
}
