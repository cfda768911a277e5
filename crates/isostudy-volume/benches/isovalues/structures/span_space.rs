//! Rows of span space.

use super::memory::{collected, with_room};
use super::spans::{Spanned, spanned_cells};
use isostudy_extract::active::{ActiveCells, ActiveError, GridSamples};

/// The most rows.
const ROWS: usize = 256;

/// Cells as points of the plane of least and greatest sample, in rows of least samples (after the lattice of Shen, Hansen, Livnat &
/// Johnson 1996). In rows below the isovalue's, those with a greatest sample above it stand first in line. Only in its own row must
/// each be asked for its least.
///
/// The published lattice divides rows by greatest samples as well. Here a row is sorted by them, which does the same for all its
/// elements. Rows have about as many cells each, by quantiles of least samples. Cells with equal samples are in none.
#[derive(Debug, Clone)]
pub(crate) struct SpanSpace {
    /// Row `i` has the least samples from `bounds[i - 1]` up to `bounds[i]`, itself left out.
    bounds: Vec<f32>,
    /// Where each row starts, and where the last ends.
    starts: Vec<usize>,
    /// Of each row, by falling greatest sample.
    cells: Vec<Spanned>,
}

impl SpanSpace {
    /// Reads all samples, and sorts the cells.
    ///
    /// # Errors
    /// [`ActiveError::OutOfMemory`].
    pub(crate) fn try_new(samples: GridSamples) -> Result<Self, ActiveError> {
        let mut cells = spanned_cells(samples)?;
        let least = |cell: &Spanned| cell.span[0];
        cells.sort_unstable_by(|a, b| least(a).total_cmp(&least(b)).then(a.cell.cmp(&b.cell)));
        let mut bounds = collected((1..ROWS).map(|row| row * cells.len() / ROWS))?
            .into_iter()
            .filter_map(|at: usize| cells.get(at).map(least))
            .collect::<Vec<f32>>();
        bounds.dedup();
        let mut starts = with_room(bounds.len() + 2)?;
        starts.push(0);
        starts.extend(bounds.iter().map(|&bound| cells.partition_point(|cell| least(cell) < bound)));
        starts.push(cells.len());
        for row in starts.windows(2) {
            let by_greatest =
                |a: &Spanned, b: &Spanned| b.span[1].total_cmp(&a.span[1]).then(a.cell.cmp(&b.cell));
            cells[row[0]..row[1]].sort_unstable_by(by_greatest);
        }
        Ok(Self { bounds, starts, cells })
    }
}

impl ActiveCells for SpanSpace {
    fn find(&self, isovalue: f32, cells: &mut Vec<u32>) {
        cells.clear();
        let own = self.bounds.partition_point(|&bound| bound <= isovalue);
        for row in 0..=own {
            let all = &self.cells[self.starts[row]..self.starts[row + 1]];
            let above = all.iter().take_while(|cell| cell.span[1] > isovalue);
            if row < own {
                cells.extend(above.map(|cell| cell.cell));
            } else {
                cells.extend(above.filter(|cell| cell.span[0] <= isovalue).map(|cell| cell.cell));
            }
        }
    }

    fn bytes(&self) -> usize {
        size_of::<Spanned>() * self.cells.capacity()
            + size_of::<f32>() * self.bounds.capacity()
            + size_of::<usize>() * self.starts.capacity()
    }
}
