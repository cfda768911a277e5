//! A few cells from which all others are reached.

use super::IntervalTree;
use super::OfCells;
use super::memory::push;
use super::spans::{NONE, Span, Spanned, spanned_cells, with};
use isostudy_extract::active::{ActiveCells, ActiveError, GridSamples};

/// A set of seeds (after Bajaj, Pascucci & Schikore 1996): cells, each with isovalues that it answers for, in an [`IntervalTree`]. From
/// there the active cells are found by going through faces whose samples are not all on one side.
///
/// A cell answers for the isovalues at which it is active and none of its faces to the next cell along x, y or z is crossed. At any
/// isovalue, take the active cells that hang together by crossed faces. The one with the greatest number has no crossed face to a
/// next cell, since that would be active, of the same piece, and of greater number. So every piece has a seed, on plateaus, at the border
/// and between samples that are no numbers too.
#[derive(Debug, Clone)]
pub(crate) struct SeedSet<'a> {
    samples: GridSamples<'a>,
    tree: IntervalTree,
    seeds: usize,
}

/// The corners of a cell's lower and upper faces along each axis, as bits; corner `x + 2 y + 4 z`.
const FACES: [[u8; 2]; 3] = [[0x55, 0xaa], [0x33, 0xcc], [0x0f, 0xf0]];

impl<'a> SeedSet<'a> {
    /// Reads all samples.
    ///
    /// # Errors
    /// [`ActiveError::OutOfMemory`].
    pub(crate) fn try_new(samples: GridSamples<'a>) -> Result<Self, ActiveError> {
        let all = samples.cells();
        let mut seeds = Vec::new();
        for Spanned { span, cell } in spanned_cells(samples)? {
            let place = samples.place(cell);
            let corners = corners(samples, place);
            let mut passed = [NONE; 3];
            for axis in (0..3).filter(|&axis| place[axis] + 1 < all[axis]) {
                let own = (0..8).filter(|corner| FACES[axis][1] >> corner & 1 != 0);
                passed[axis] = own.fold(NONE, |span, corner| with(span, corners[corner]));
            }
            for span in without(span, passed) {
                push(&mut seeds, Spanned { span, cell })?;
            }
        }
        Ok(Self { samples, tree: IntervalTree::of(&seeds)?, seeds: seeds.len() })
    }

    /// How many there are; a cell may be more than one.
    pub(crate) fn seeds(&self) -> usize {
        self.seeds
    }
}

/// What is left of an interval without three others.
fn without(span: Span, mut others: [Span; 3]) -> impl Iterator<Item = Span> {
    others.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let [mut from, end] = span;
    let mut left = [NONE; 4];
    for (piece, [least, greatest]) in left.iter_mut().zip(others) {
        // One that is empty takes nothing away.
        if least < greatest {
            *piece = [from, least.min(end)];
            from = from.max(greatest);
        }
    }
    left[3] = [from, end];
    left.into_iter().filter(|piece| piece[0] < piece[1])
}

fn corners(samples: GridSamples, [x, y, z]: [usize; 3]) -> [f32; 8] {
    let rows = samples.rows_of_cells(y, z);
    std::array::from_fn(|corner| rows[corner >> 1][x + (corner & 1)])
}

impl ActiveCells for SeedSet<'_> {
    fn find(&self, isovalue: f32, cells: &mut Vec<u32>) {
        cells.clear();
        self.tree.add(isovalue, cells);
        let all = self.samples.cells();
        let strides = [1, all[0] as u32, (all[0] * all[1]) as u32];
        let mut visited = vec![0u64; all.iter().product::<usize>().div_ceil(64)];
        let mut is_new = |cell: u32| {
            let (word, bit) = (&mut visited[cell as usize / 64], 1 << (cell % 64));
            let is_new = *word & bit == 0;
            *word |= bit;
            is_new
        };
        cells.iter().for_each(|&cell| {
            is_new(cell);
        });
        let mut next = 0;
        while let Some(&cell) = cells.get(next) {
            next += 1;
            let place = self.samples.place(cell);
            let values = corners(self.samples, place);
            let inside = (0..8).fold(0u8, |set, c| set | u8::from(values[c] > isovalue) << c);
            for (axis, sides) in FACES.iter().enumerate() {
                for (side, &face) in sides.iter().enumerate() {
                    let is_there = if side == 0 { place[axis] > 0 } else { place[axis] + 1 < all[axis] };
                    if !is_there || matches!(inside & face, 0) || inside & face == face {
                        continue;
                    }
                    let other = if side == 0 { cell - strides[axis] } else { cell + strides[axis] };
                    if is_new(other) {
                        cells.push(other);
                    }
                }
            }
        }
    }

    fn bytes(&self) -> usize {
        self.tree.bytes()
    }
}
