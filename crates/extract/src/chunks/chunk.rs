//! What is extracted of a box of cells.

use mesh::{Bounds, TriangleMesh};

use crate::lattice::CellBox;
use crate::trace::VertexKey;

/// The surface in a box of cells of a larger lattice: a [`ChunkExtractor`](crate::ChunkExtractor) makes it.
///
/// A triangle belongs to the cell whose tetrahedron it lies in, and a cell to one chunk. A vertex on the seam is in all
/// chunks that have a triangle at it, everywhere with the same key, position and normal, to the bit.
#[derive(Debug, Clone, PartialEq)]
pub struct Chunk {
    /// The cells whose triangles these are.
    pub cells: CellBox,
    /// The triangles, in the order of the whole mesh, and their vertices. Normals are those of the whole mesh.
    pub mesh: TriangleMesh,
    /// The key of each vertex. Ascending, unless edges were collapsed: then vertices are numbered by first use.
    pub keys: Vec<VertexKey>,
    /// The cell of each triangle by its number in the whole lattice, x fastest. Ascending.
    pub triangle_cells: Vec<u32>,
    /// The cells whose samples were looked at.
    pub window: CellBox,
    /// The box of those samples.
    pub(super) sampled: Bounds,
    /// Whether vertices of the whole are numbered by first use, not by key.
    pub(super) numbered_by_use: bool,
}

impl Chunk {
    /// Whether the chunk can be another one when the field has changed in this box, and nowhere else. If not, it is the
    /// same to the bit: nothing in the box was looked at.
    ///
    /// A bound that is not a number is a change everywhere.
    pub fn is_touched_by(&self, changed: Bounds) -> bool {
        let apart = changed.min.cmpgt(self.sampled.max) | changed.max.cmplt(self.sampled.min);
        !apart.any()
    }
}
