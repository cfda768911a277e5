//! Some cells of a lattice.

use super::{CellBox, Lattice};

/// The cells of a lattice whose triangles are wanted, counted from its first cell: from `start` up to, without, `end`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct Part {
    pub(crate) start: [usize; 3],
    pub(crate) end: [usize; 3],
}

impl Part {
    /// All cells.
    pub(crate) fn whole(lattice: &Lattice) -> Self {
        Self { start: [0; 3], end: lattice.cells().map(|n| n as usize) }
    }

    /// Those of a box of cells of the whole lattice, which lie in this one.
    pub(crate) fn of(lattice: &Lattice, cells: CellBox) -> Self {
        let origin = lattice.origin();
        let [start, end] = [cells.start, cells.end]
            .map(|corner| [0, 1, 2].map(|axis| corner[axis].wrapping_sub(origin[axis]) as usize));
        Self { start, end }
    }

    /// Whether the part has cells with a coordinate along an axis.
    #[inline]
    pub(crate) fn has(&self, axis: usize, i: usize) -> bool {
        (self.start[axis]..self.end[axis]).contains(&i)
    }

    /// Whether a cell is one of them.
    #[inline]
    pub(crate) fn contains(&self, cell: [usize; 3]) -> bool {
        (0..3).all(|axis| self.has(axis, cell[axis]))
    }

    /// The number of a cell among them, x fastest; of no use in parts that are too large for a chunk, which ask for none.
    #[inline]
    pub(crate) fn number(&self, [x, y, z]: [usize; 3]) -> u32 {
        let [nx, ny] = [0, 1].map(|axis| (self.end[axis] - self.start[axis]) as u32);
        let [x, y, z] = [x - self.start[0], y - self.start[1], z - self.start[2]].map(|i| i as u32);
        z.wrapping_mul(ny).wrapping_add(y).wrapping_mul(nx).wrapping_add(x)
    }
}
