//! What changes a chunk beside the method.

/// Settings of chunks. Those that weld have the same.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct ChunkSettings {
    /// Points with a value above this are inside; 0 if nothing else is said.
    pub isovalue: f32,
    /// Where normals come from.
    pub normals: Normals,
    /// Whether positions, and the box of [`Chunk::bounds`](crate::Chunk::bounds), are relative to the lowest corner of the chunk's own cells,
    /// [`Chunk::origin`](crate::Chunk::origin). They are as fine then as near the origin, however far away the chunk is. Positions of
    /// neighbours, put into one place, may differ by two units in the last place of such positions; their keys do not. Such chunks do not
    /// [weld](crate::weld_chunks). A field is asked in single precision, and is no finer than that: samples are. Needs a
    /// [`Grid`](crate::Grid) without an end.
    pub relative: bool,
    /// Whether chunks have [`Chunk::keys`](crate::Chunk::keys) and [`Chunk::triangle_cells`](crate::Chunk::triangle_cells); they do if
    /// nothing else is said. Without, both are empty, and a chunk takes less time. Such chunks do not [weld](crate::weld_chunks), have no
    /// [`payload`](crate::Chunk::payload), and are of one level.
    pub keys: bool,
}

impl Default for ChunkSettings {
    fn default() -> Self {
        Self { isovalue: 0.0, normals: Normals::default(), relative: false, keys: true }
    }
}

impl ChunkSettings {
    /// The same with an isovalue.
    pub fn with_isovalue(self, isovalue: f32) -> Self {
        Self { isovalue, ..self }
    }

    /// The same with positions relative to the chunk's corner, or not.
    pub fn with_relative_positions(self, relative: bool) -> Self {
        Self { relative, ..self }
    }

    /// The same with keys of vertices and cells of triangles, or without.
    pub fn with_keys(self, keys: bool) -> Self {
        Self { keys, ..self }
    }

    /// The same with other normals.
    pub fn with_normals(self, normals: Normals) -> Self {
        Self { normals, ..self }
    }
}

/// Where the normals of vertices come from. All of them point outward, and are the same in all chunks that have the vertex.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[non_exhaustive]
pub enum Normals {
    /// The area-weighted mean over the triangles of the whole mesh round the vertex.
    #[default]
    Triangles,
    /// Against the field's gradient at the vertex: smoother, and dearer by a call of
    /// [`ScalarField::gradient`](crate::ScalarField::gradient) a vertex, or of seven samples where there is none. Where there
    /// is no direction, that of the triangles. Needs a field.
    Field,
    /// Against the gradient of the samples round the vertex: as smooth, and cheaper than those of triangles, since nothing but the
    /// chunk's own triangles is made. In a cell it is that of the trilinear interpolant. On an edge it is interpolated between central
    /// differences at both ends. Zero where samples have no direction. Needs samples, and [`Cubes`](crate::Cubes) whose vertices are not
    /// placed otherwise, or [`SurfaceNets`](crate::SurfaceNets) without smoothing.
    Samples,
    /// There are none: [`Chunk::normals`](crate::Chunk) is empty.
    None,
}
