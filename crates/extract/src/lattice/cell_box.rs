//! Boxes of cells.

/// A box of cells of a lattice: from `start` up to, without, `end` along x, y and z.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct CellBox {
    /// The first cell.
    pub start: [u32; 3],
    /// One past the last cell.
    pub end: [u32; 3],
}

impl CellBox {
    /// Whether a cell lies in the box.
    pub fn contains(&self, cell: [u32; 3]) -> bool {
        (0..3).all(|axis| (self.start[axis]..self.end[axis]).contains(&cell[axis]))
    }

    /// Whether the box has no cell.
    pub fn is_empty(&self) -> bool {
        (0..3).any(|axis| self.start[axis] >= self.end[axis])
    }

    /// The box with `cells` more on every side, as far as `within` reaches.
    pub(crate) fn grown(&self, cells: u32, within: &Self) -> Self {
        let axes = [0, 1, 2];
        Self {
            start: axes.map(|axis| self.start[axis].saturating_sub(cells).max(within.start[axis])),
            end: axes.map(|axis| self.end[axis].saturating_add(cells).min(within.end[axis])),
        }
    }

    /// The box with `cells` less on every side that is not a side of `whole`.
    pub(crate) fn shrunk(&self, cells: u32, whole: &Self) -> Self {
        let axes = [0, 1, 2];
        Self {
            start: axes.map(|axis| {
                let start = self.start[axis];
                if start == whole.start[axis] { start } else { start + cells }
            }),
            end: axes.map(|axis| {
                let end = self.end[axis];
                if end == whole.end[axis] { end } else { end.saturating_sub(cells) }
            }),
        }
    }
}
