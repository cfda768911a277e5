//! Bricks: the least and the greatest sample of each 8 x 8 x 8 cells.

use std::ops::Range;

use super::spans::{NONE, Span, holds, union, with};
use super::{ActiveCells, ActiveError, GridSamples};
use crate::memory::filled;
use crate::sampling::bits::{set_above, set_range};
use crate::sampling::in_sight::State;

/// Cells along the edge of a brick.
const BRICK: usize = 8;

/// The range of the samples of each brick of 8 x 8 x 8 cells: little more than 8 bytes for 512 cells.
///
/// An extraction from these samples ([`Source::Bricks`](crate::Source::Bricks)) does not read rows whose bricks are all on one side of
/// the isovalue, to find out where its samples are. The mesh is the same, to the byte.
#[derive(Debug, Clone)]
pub struct Bricks<'a> {
    samples: GridSamples<'a>,
    /// Along each axis.
    counts: [usize; 3],
    spans: Vec<Span>,
    /// Of each row of bricks, all of them.
    rows: Vec<Span>,
}

impl<'a> Bricks<'a> {
    /// Reads all samples once.
    ///
    /// # Errors
    /// [`ActiveError::OutOfMemory`].
    pub fn try_new(samples: GridSamples<'a>) -> Result<Self, ActiveError> {
        let counts = samples.cells().map(|n| n.div_ceil(BRICK));
        let [bx, by, bz] = counts;
        let mut spans = filled(bx * by * bz, NONE)?;
        let mut line = filled(bx, NONE)?;
        let [_, ny, nz] = samples.counts();
        for z in 0..nz {
            for y in 0..ny {
                let row = samples.row(y, z);
                for (x, span) in line.iter_mut().enumerate() {
                    // Bricks side by side share the samples between them.
                    let own = &row[BRICK * x..row.len().min(BRICK * (x + 1) + 1)];
                    *span = own.iter().fold(NONE, |span, &value| with(span, value));
                }
                for bz in bricks_of(z, bz) {
                    for by_row in bricks_of(y, by) {
                        let bricks = &mut spans[(bz * by + by_row) * bx..][..bx];
                        bricks.iter_mut().zip(&line).for_each(|(all, &own)| *all = union(*all, own));
                    }
                }
            }
        }
        let mut rows = filled(by * bz, NONE)?;
        for (row, bricks) in rows.iter_mut().zip(spans.chunks_exact(bx)) {
            *row = bricks.iter().fold(NONE, |all, &span| union(all, span));
        }
        Ok(Self { samples, counts, spans, rows })
    }

    /// Bytes that those of so many samples along the axes take.
    pub fn bytes_of(counts: [usize; 3]) -> u64 {
        let [bx, by, bz] = counts.map(|n| n.saturating_sub(1).div_ceil(BRICK) as u64);
        size_of::<Span>() as u64 * (bx + 1) * by * bz
    }

    /// The samples that they are of.
    pub fn samples(&self) -> GridSamples<'a> {
        self.samples
    }

    /// Sets the bits of the samples of a row that are above the isovalue, all of which are zero; says where they are, but for rows in
    /// bricks on both sides.
    ///
    /// Of those rows all samples are read. Leaving out bricks in a row, or words of 64 samples, took twice as long as reading them:
    /// memory is read ahead.
    pub(crate) fn set_above(&self, [y, z]: [usize; 2], isovalue: f32, words: &mut [u64]) -> State {
        let [_, by, bz] = self.counts;
        let at = (z / BRICK).min(bz - 1) * by + (y / BRICK).min(by - 1);
        let row = self.samples.row(y, z);
        let [least, greatest] = self.rows[at];
        if isovalue >= greatest {
            return State::Outside;
        }
        if isovalue < least {
            set_range(words, 0, row.len());
            return State::Inside;
        }
        set_above(row, isovalue, words);
        State::Mixed
    }
}

/// The bricks along an axis that a sample is in.
fn bricks_of(sample: usize, bricks: usize) -> std::ops::Range<usize> {
    sample.saturating_sub(1) / BRICK..(sample / BRICK + 1).min(bricks)
}

impl ActiveCells for Bricks<'_> {
    fn find(&self, isovalue: f32, cells: &mut Vec<u32>) {
        cells.clear();
        let [bx, by, _] = self.counts;
        for (row, bricks) in
            self.spans.chunks_exact(bx).enumerate().filter(|(row, _)| holds(self.rows[*row], isovalue))
        {
            for (x, _) in bricks.iter().enumerate().filter(|(_, span)| holds(**span, isovalue)) {
                let (first, all) = ([x, row % by, row / by].map(|i| BRICK * i), self.samples.cells());
                let own = [0, 1, 2].map(|k| first[k]..all[k].min(first[k] + BRICK));
                add_active(self.samples, isovalue, own, cells);
            }
        }
    }

    fn bytes(&self) -> usize {
        size_of::<Span>() * (self.spans.capacity() + self.rows.capacity())
    }
}

/// Adds the active cells of a box, in storage order.
fn add_active(
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
