//! Boxes of cells.

/// A box of cells: from `start` up to, without, `end` along x, y and z.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub struct CellBox {
    /// The first cell.
    pub start: [i32; 3],
    /// One past the last cell.
    pub end: [i32; 3],
}

impl CellBox {
    /// Whether a cell lies in the box.
    pub fn contains(&self, cell: [i32; 3]) -> bool {
        (0..3).all(|axis| (self.start[axis]..self.end[axis]).contains(&cell[axis]))
    }

    /// Whether all cells of the other box lie in this one.
    pub fn contains_box(&self, other: &Self) -> bool {
        (0..3).all(|axis| self.start[axis] <= other.start[axis] && other.end[axis] <= self.end[axis])
    }

    /// Whether the box has no cell.
    pub fn is_empty(&self) -> bool {
        (0..3).any(|axis| self.start[axis] >= self.end[axis])
    }

    /// Cells along x, y and z; 0 where the end is not beyond the start.
    pub fn size(&self) -> [u32; 3] {
        [0, 1, 2].map(|axis| {
            let cells = i64::from(self.end[axis]) - i64::from(self.start[axis]);
            cells.max(0) as u32
        })
    }

    /// The number of a cell of the box, x fastest; of no use for others, or in boxes of more than 2³² cells.
    pub(crate) fn number(&self, cell: [i32; 3]) -> u32 {
        let [nx, ny, _] = self.size();
        let [x, y, z] = [0, 1, 2].map(|axis| cell[axis].wrapping_sub(self.start[axis]) as u32);
        z.wrapping_mul(ny).wrapping_add(y).wrapping_mul(nx).wrapping_add(x)
    }

    /// The cell with a number.
    pub(crate) fn cell(&self, number: u32) -> [i32; 3] {
        let [nx, ny, _] = self.size();
        let place = [number % nx, number / nx % ny, number / nx / ny];
        [0, 1, 2].map(|axis| self.start[axis].wrapping_add_unsigned(place[axis]))
    }

    /// The box with `cells` more on every side, as far as `within` reaches.
    pub(crate) fn grown(&self, cells: u32, within: &Self) -> Self {
        let axes = [0, 1, 2];
        Self {
            start: axes.map(|axis| self.start[axis].saturating_sub_unsigned(cells).max(within.start[axis])),
            end: axes.map(|axis| self.end[axis].saturating_add_unsigned(cells).min(within.end[axis])),
        }
    }

    /// The box with `cells` less on every side that is not a side of `whole`.
    pub(crate) fn shrunk(&self, cells: u32, whole: &Self) -> Self {
        let axes = [0, 1, 2];
        Self {
            start: axes.map(|axis| {
                let start = self.start[axis];
                if start == whole.start[axis] { start } else { start.saturating_add_unsigned(cells) }
            }),
            end: axes.map(|axis| {
                let end = self.end[axis];
                if end == whole.end[axis] { end } else { end.saturating_sub_unsigned(cells) }
            }),
        }
    }
}
