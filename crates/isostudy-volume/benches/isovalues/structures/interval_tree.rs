//! A tree of intervals.

use super::memory::{collected, copied, filled};
use super::spans::{Spanned, spanned_cells};
use isostudy_extract::active::{ActiveCells, ActiveError, GridSamples};

/// A balanced tree over the least samples of cells (Cignoni, Marino, Montani, Puppo & Scopigno 1997). A cell is with the first node from the
/// root on whose value it is active at. Each node has its cells in two lists, by rising least and by falling greatest sample: of
/// each node on the way down, the beginning of one list is active, and nothing else is looked at. Cells with equal samples are in none.
#[derive(Debug, Clone)]
pub(crate) struct IntervalTree {
    /// The values of the nodes, rising. The middle of a part is its root.
    values: Vec<f32>,
    /// Where the lists of each node start, and where the last end.
    starts: Vec<u32>,
    by_least: Vec<End>,
    by_greatest: Vec<End>,
}

/// An end of an interval.
#[derive(Debug, Clone, Copy)]
struct End {
    value: f32,
    cell: u32,
}

impl IntervalTree {
    /// Reads all samples, and sorts the cells twice.
    ///
    /// # Errors
    /// [`ActiveError::OutOfMemory`].
    pub(crate) fn try_new(samples: GridSamples) -> Result<Self, ActiveError> {
        Self::of(&spanned_cells(samples)?)
    }

    /// Of intervals that are not empty.
    pub(super) fn of(intervals: &[Spanned]) -> Result<Self, ActiveError> {
        let mut sorted = copied(intervals)?;
        sorted.sort_unstable_by(|a, b| a.span[0].total_cmp(&b.span[0]).then(a.cell.cmp(&b.cell)));
        let mut values = collected(sorted.iter().map(|interval| interval.span[0]))?;
        values.dedup();
        values.shrink_to_fit();
        let mut starts = filled(values.len() + 1, 0u32)?;
        sorted.iter().for_each(|interval| starts[node_of(&values, interval.span) + 1] += 1);
        for node in 0..values.len() {
            starts[node + 1] += starts[node];
        }
        let by_node = |sorted: &[Spanned], end: usize| -> Result<Vec<End>, ActiveError> {
            let mut next = copied(&starts)?;
            let mut ends = filled(sorted.len(), End { value: 0.0, cell: 0 })?;
            for interval in sorted {
                let place = &mut next[node_of(&values, interval.span)];
                ends[*place as usize] = End { value: interval.span[end], cell: interval.cell };
                *place += 1;
            }
            Ok(ends)
        };
        let by_least = by_node(&sorted, 0)?;
        sorted.sort_unstable_by(|a, b| b.span[1].total_cmp(&a.span[1]).then(a.cell.cmp(&b.cell)));
        let by_greatest = by_node(&sorted, 1)?;
        Ok(Self { values, starts, by_least, by_greatest })
    }

    /// As [`ActiveCells::find`].
    pub(super) fn add(&self, isovalue: f32, cells: &mut Vec<u32>) {
        let (mut low, mut high) = (0, self.values.len());
        while low < high {
            let node = (low + high) / 2;
            let own = self.starts[node] as usize..self.starts[node + 1] as usize;
            if isovalue < self.values[node] {
                // All of them go beyond the node's value.
                let below = self.by_least[own].iter().take_while(|end| end.value <= isovalue);
                cells.extend(below.map(|end| end.cell));
                high = node;
            } else {
                let above = self.by_greatest[own].iter().take_while(|end| end.value > isovalue);
                cells.extend(above.map(|end| end.cell));
                low = node + 1;
            }
        }
    }
}

/// The first node from the root on whose value an interval holds; its own least value is one.
fn node_of(values: &[f32], [least, greatest]: [f32; 2]) -> usize {
    let (mut low, mut high) = (0, values.len());
    loop {
        let node = (low + high) / 2;
        if greatest <= values[node] {
            high = node;
        } else if least > values[node] {
            low = node + 1;
        } else {
            return node;
        }
    }
}

impl ActiveCells for IntervalTree {
    fn find(&self, isovalue: f32, cells: &mut Vec<u32>) {
        cells.clear();
        self.add(isovalue, cells);
    }

    fn bytes(&self) -> usize {
        let ends = self.by_least.capacity() + self.by_greatest.capacity();
        size_of::<f32>() * self.values.capacity()
            + size_of::<u32>() * self.starts.capacity()
            + size_of::<End>() * ends
    }
}
