//! Where in the lattice a mesh comes from.

use std::collections::TryReserveError;

use crate::lattice::Lattice;

/// Which crossings of a lattice a vertex stands for: the number of the sample point that they are nearest to, and the
/// first lattice edge at that point among them.
///
/// Keys are those of the whole lattice, whatever box of it was extracted. Two vertices with one key are one vertex, with
/// the same bits. Keys are in the order in which [`extract`](crate::extract) numbers vertices, unless edges are
/// collapsed; the key of a vertex that others were collapsed into is its own.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct VertexKey(u64);

/// Bits for a direction: at most 32 of them.
const DIRECTION_BITS: u32 = 5;

impl VertexKey {
    pub(crate) fn new(point: u32, direction: usize) -> Self {
        Self(u64::from(point) << DIRECTION_BITS | direction as u64)
    }

    /// The number of the sample point in storage order (see [`Source::Samples`](crate::Source)).
    pub fn point(self) -> u32 {
        (self.0 >> DIRECTION_BITS) as u32
    }

    /// The key as a number: for a hash table of one's own, or a file.
    pub fn number(self) -> u64 {
        self.0
    }
}

/// Whence each vertex and each triangle of a mesh before edges are collapsed.
#[derive(Debug, Clone, Default)]
pub(crate) struct Trace {
    pub(crate) keys: Vec<VertexKey>,
    /// Numbers of cells in the whole lattice.
    pub(crate) cells: Vec<u32>,
}

impl Trace {
    /// Names `cell` for all triangles that have none yet.
    pub(crate) fn close_cell(
        &mut self,
        lattice: &Lattice,
        cell: [usize; 3],
        triangles: usize,
    ) -> Result<(), TryReserveError> {
        self.cells.try_reserve(triangles - self.cells.len())?;
        self.cells.resize(triangles, lattice.cell_number(cell));
        Ok(())
    }

    pub(crate) fn clear(&mut self) {
        self.keys.clear();
        self.cells.clear();
    }
}
