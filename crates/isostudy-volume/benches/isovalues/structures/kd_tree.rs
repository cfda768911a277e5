//! NOISE: a k-d tree over span space.

use std::cmp::Ordering;

use super::spans::{Spanned, spanned_cells};
use isostudy_extract::active::{ActiveCells, ActiveError, GridSamples};

/// Cells as points of the plane of least and greatest sample, in a balanced tree that is halved by both in turns (Livnat, Shen & Johnson
/// 1996). It lies in one list without pointers: the middle of a part is its root, what is before it the lower half. What a part's place
/// says of its cells is not asked again. Cells with equal samples are not in it.
#[derive(Debug, Clone)]
pub(crate) struct KdTree {
    cells: Vec<Spanned>,
}

/// What the way to a part says of the cells in it.
#[derive(Debug, Clone, Copy)]
struct Known {
    /// All least samples are at most the isovalue.
    least: bool,
    /// All greatest samples are above it.
    greatest: bool,
}

impl KdTree {
    /// Reads all samples, and halves the cells until there are none left to halve.
    ///
    /// # Errors
    /// [`ActiveError::OutOfMemory`].
    pub(crate) fn try_new(samples: GridSamples) -> Result<Self, ActiveError> {
        let mut cells = spanned_cells(samples)?;
        halve(&mut cells, 0);
        Ok(Self { cells })
    }
}

/// Puts the middle of a part in its place, by `axis`: 0 for least samples, 1 for greatest.
fn halve(part: &mut [Spanned], axis: usize) {
    if part.len() < 2 {
        return;
    }
    let order = |a: &Spanned, b: &Spanned| -> Ordering {
        a.span[axis].total_cmp(&b.span[axis]).then(a.cell.cmp(&b.cell))
    };
    let (lower, _, upper) = part.select_nth_unstable_by(part.len() / 2, order);
    halve(lower, 1 - axis);
    halve(upper, 1 - axis);
}

fn visit(part: &[Spanned], axis: usize, known: Known, isovalue: f32, cells: &mut Vec<u32>) {
    if known.least && known.greatest {
        cells.extend(part.iter().map(|cell| cell.cell));
        return;
    }
    let middle = part.len() / 2;
    let Some(&Spanned { span: [least, greatest], cell }) = part.get(middle) else { return };
    let (lower, upper) = (&part[..middle], &part[middle + 1..]);
    let is_below = known.least || least <= isovalue;
    let is_above = known.greatest || greatest > isovalue;
    let mut go = |part, known| visit(part, 1 - axis, known, isovalue, cells);
    // Lower halves have at most the middle's value, upper ones at least.
    if axis == 0 {
        go(lower, Known { least: is_below, ..known });
        if is_below {
            go(upper, known);
        }
    } else {
        if is_above {
            go(lower, known);
        }
        go(upper, Known { greatest: is_above, ..known });
    }
    if is_below && is_above {
        cells.push(cell);
    }
}

impl ActiveCells for KdTree {
    fn find(&self, isovalue: f32, cells: &mut Vec<u32>) {
        cells.clear();
        visit(&self.cells, 0, Known { least: false, greatest: false }, isovalue, cells);
    }

    fn bytes(&self) -> usize {
        size_of::<Spanned>() * self.cells.capacity()
    }
}
