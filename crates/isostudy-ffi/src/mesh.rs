//! What is read of an extraction.

use isostudy_extract::{CellBox, Chunk, TriangleMesh};

/// A box of cells: all from `start` up to, and without, `end`.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct IsostudyCells {
    /// The lowest cell.
    pub start: [i32; 3],
    /// One beyond the highest cell along each axis.
    pub end: [i32; 3],
}

impl From<IsostudyCells> for CellBox {
    fn from(cells: IsostudyCells) -> Self {
        Self { start: cells.start, end: cells.end }
    }
}

impl From<CellBox> for IsostudyCells {
    fn from(cells: CellBox) -> Self {
        Self { start: cells.start, end: cells.end }
    }
}

/// A mesh in buffers of the object that made it, valid until the next call with that object.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct IsostudyMesh {
    /// Three numbers a vertex.
    pub positions: *const f32,
    /// Three numbers a vertex, of unit length and outward; null without normals.
    pub normals: *const f32,
    /// Three numbers of vertices a triangle, counter-clockwise seen from outside.
    pub triangles: *const u32,
    /// How many vertices there are.
    pub vertex_count: usize,
    /// How many triangles there are.
    pub triangle_count: usize,
    /// How many of the triangles, the last ones, are of seams between levels.
    pub seam_count: usize,
    /// The lowest corner of a chunk's cells; 0 of a volume.
    pub origin: [f64; 3],
}

impl IsostudyMesh {
    pub(crate) fn of_chunk(chunk: &Chunk) -> Self {
        Self {
            positions: chunk.positions.as_ptr().cast(),
            normals: if chunk.normals.is_empty() { std::ptr::null() } else { chunk.normals.as_ptr().cast() },
            triangles: chunk.triangles.as_ptr().cast(),
            vertex_count: chunk.positions.len(),
            triangle_count: chunk.triangles.len(),
            seam_count: chunk.seam as usize,
            origin: chunk.origin(),
        }
    }

    /// A vector of `glam` is three numbers without a gap, by its own promise.
    pub(crate) fn of_mesh(mesh: &TriangleMesh) -> Self {
        Self {
            positions: mesh.positions.as_ptr().cast(),
            normals: if mesh.normals.is_empty() { std::ptr::null() } else { mesh.normals.as_ptr().cast() },
            triangles: mesh.triangles.as_ptr().cast(),
            vertex_count: mesh.positions.len(),
            triangle_count: mesh.triangles.len(),
            seam_count: 0,
            origin: [0.0; 3],
        }
    }
}
