//! All cells, one after another: what the others are held against.

use std::ops::Range;

use super::OfCells;
use isostudy_extract::active::{ActiveCells, GridSamples};

/// Looks at every cell. It decides by the rule itself, value by value above the isovalue or not, and knows no ranges.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Scan<'a> {
    samples: GridSamples<'a>,
}

impl<'a> Scan<'a> {
    /// Nothing is made ready.
    pub(crate) fn new(samples: GridSamples<'a>) -> Self {
        Self { samples }
    }
}

impl ActiveCells for Scan<'_> {
    fn find(&self, isovalue: f32, cells: &mut Vec<u32>) {
        cells.clear();
        add_active(self.samples, isovalue, self.samples.cells().map(|n| 0..n), cells);
    }

    fn bytes(&self) -> usize {
        0
    }
}

/// Adds the active cells of a box, in storage order.
pub(super) fn add_active(
    samples: GridSamples,
    isovalue: f32,
    [columns, rows, layers]: [Range<usize>; 3],
    cells: &mut Vec<u32>,
) {
    for z in layers {
        for y in rows.clone() {
            let lines = samples.rows_of_cells(y, z).map(|row| &row[columns.start..=columns.end]);
            let first = samples.cell([columns.start, y, z]);
            let inside = |x: usize| lines.iter().fold(0, |count, line| count + u8::from(line[x] > isovalue));
            let mut before = inside(0);
            for x in 0..columns.len() {
                let after = inside(x + 1);
                if !matches!(before + after, 0 | 8) {
                    cells.push(first + x as u32);
                }
                before = after;
            }
        }
    }
}
