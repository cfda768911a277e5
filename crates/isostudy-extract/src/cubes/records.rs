//! What is remembered of points or cells, two layers at a time.

use std::collections::TryReserveError;

use super::grid::CubeGrid;
use crate::memory::reset;

/// The records of two layers, written and read only where there is something to know.
#[derive(Default)]
pub(crate) struct Records<R> {
    records: Vec<R>,
    size: [usize; 2],
}

impl<R: Copy + Default> Records<R> {
    /// Makes room, with nothing in it.
    pub(crate) fn fit(&mut self, grid: &CubeGrid) -> Result<(), TryReserveError> {
        let [nx, ny, _] = grid.size;
        self.size = [nx, ny];
        reset(&mut self.records, 2 * nx * ny, R::default())
    }

    /// Where the records of a row start.
    #[inline]
    pub(crate) fn start(&self, row: usize, layer: usize) -> usize {
        (layer % 2 * self.size[1] + row) * self.size[0]
    }

    #[inline]
    pub(crate) fn at(&self, place: usize) -> R {
        self.records[place]
    }

    #[inline]
    pub(crate) fn set(&mut self, place: usize, record: R) {
        self.records[place] = record;
    }
}
