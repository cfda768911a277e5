//! Chunks to one mesh.

use std::collections::{HashMap, TryReserveError};

use glam::Vec3;
use isostudy_mesh::TriangleMesh;

use super::chunk::Chunk;
use super::world::World;
use crate::lattice::CellBox;
use crate::memory::{push, with_room};
use crate::surface::trace::VertexKey;
use crate::wording::in_words;

/// Why chunks do not weld.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum WeldError {
    /// Two chunks are not of one grid, method and settings.
    Worlds {
        /// What they are chunks of.
        worlds: Box<[World; 2]>,
    },
    /// Positions are relative to each chunk: see [`ChunkSettings::relative`](crate::ChunkSettings::relative).
    Relative,
    /// Chunks have no keys: see [`ChunkSettings::keys`](crate::ChunkSettings::keys).
    NoKeys,
    /// Two chunks of one level have triangles of one cell.
    Overlap {
        /// The cell.
        cell: [i32; 3],
    },
    /// Two chunks have one vertex in two places, or with two normals: they are not of the same field, or one of them has
    /// not been extracted again since it changed.
    Mismatch(Box<Mismatch>),
    /// More vertices than a 32-bit index can name.
    TooManyVertices,
    /// The mesh outgrew the memory that is left.
    NoMemory,
}

in_words! {
    WeldError {
        Self::Worlds { worlds } => "chunks of two worlds: {}; and {}", worlds[0], worlds[1];
        Self::Relative => "the positions are relative to each chunk, and no positions of one mesh";
        Self::NoKeys => "the chunks have no keys, by which they weld: ChunkSettings::keys must be true";
        Self::Overlap { cell } => "cell {cell:?} is in two of the chunks";
        Self::Mismatch(error) => "{error}";
        Self::TooManyVertices => "the chunks have more than {} vertices", u32::MAX;
        Self::NoMemory => "no memory for a mesh this large";
    }
}

/// One vertex, as two chunks have it.
#[derive(Debug, Clone, PartialEq)]
pub struct Mismatch {
    /// Which vertex.
    pub key: VertexKey,
    /// The cells of the two chunks.
    pub chunks: [CellBox; 2],
    /// Where it is in each.
    pub positions: [[f32; 3]; 2],
    /// Its normal in each; zero where there are none.
    pub normals: [[f32; 3]; 2],
}

in_words! {
    Mismatch {
        Self { key, chunks, positions, normals } =>
            "the chunks do not fit at vertex {:#x}: that of cells {:?} has it at {:?} with normal {:?}, that \
             of cells {:?} at {:?} with normal {:?}",
            key.number(), chunks[0].start, positions[0], normals[0], chunks[1].start, positions[1], normals[1];
    }
}

impl From<TryReserveError> for WeldError {
    fn from(_: TryReserveError) -> Self {
        Self::NoMemory
    }
}

/// Joins chunks at their common vertices, by key: no coordinates are compared but to see that they are the same.
///
/// Of all chunks of a lattice this makes the mesh of the whole, to the byte: positions, normals, triangles and their
/// order. Of some of them it makes that part of it, in the same order. The order of the chunks does not matter. Chunks that
/// were never extracted are left out. Of chunks of [several levels](crate::LevelExtractor) it makes one mesh, finer levels first.
///
/// # Errors
/// [`WeldError::Worlds`], [`WeldError::Relative`], [`WeldError::NoKeys`], [`WeldError::Overlap`] and [`WeldError::Mismatch`] if the chunks are not of one extraction. Two
/// fields that agree wherever their chunks meet cannot be told from one.
pub fn weld_chunks<'a>(chunks: impl IntoIterator<Item = &'a Chunk>) -> Result<TriangleMesh, WeldError> {
    let mut in_order: Vec<&Chunk> = chunks.into_iter().filter(|chunk| chunk.world.is_some()).collect();
    for pair in in_order.windows(2) {
        if let (Some(first), Some(second)) = (pair[0].world, pair[1].world)
            && first.of_finest() != second.of_finest()
        {
            return Err(WeldError::Worlds { worlds: Box::new([first, second]) });
        }
    }
    if in_order.iter().any(|chunk| chunk.world.is_some_and(|world| world.settings.relative)) {
        return Err(WeldError::Relative);
    }
    if in_order.iter().any(|chunk| chunk.world.is_some_and(|world| !world.settings.keys)) {
        return Err(WeldError::NoKeys);
    }
    let from_below = |[x, y, z]: [i32; 3]| [z, y, x];
    in_order.sort_by_key(|chunk| from_below(chunk.cells.start));
    let mut triangles = with_room(in_order.iter().map(|chunk| chunk.triangle_cells.len()).sum())?;
    for (c, chunk) in in_order.iter().enumerate() {
        triangles.extend(
            (0..chunk.triangle_cells.len())
                .map(|t| ((chunk.level, from_below(chunk.cell_of(t))), c as u32, t as u32)),
        );
    }
    triangles.sort_unstable();
    let overlap = triangles.windows(2).find(|pair| pair[0].0 == pair[1].0 && pair[0].1 != pair[1].1);
    if let Some(pair) = overlap {
        return Err(WeldError::Overlap { cell: from_below(pair[0].0.1) });
    }

    let mut welded = Welded::default();
    // A lattice has one way of numbering; without any chunk it does not matter.
    if !in_order.iter().any(|chunk| chunk.numbered_by_use) {
        let mut vertices = with_room(in_order.iter().map(|chunk| chunk.keys.len()).sum())?;
        for (c, chunk) in in_order.iter().enumerate() {
            vertices.extend(chunk.keys.iter().enumerate().map(|(v, &key)| (key, c as u32, v as u32)));
        }
        vertices.sort_unstable();
        for (_, c, v) in vertices {
            welded.add(&in_order, c, v)?;
        }
    }
    for (_, c, t) in triangles {
        let mut corners = [0; 3];
        for (corner, &v) in corners.iter_mut().zip(&in_order[c as usize].triangles[t as usize]) {
            *corner = welded.add(&in_order, c, v)?;
        }
        push(&mut welded.mesh.triangles, corners)?;
    }
    // Vertices that no triangle uses, where edges were collapsed, are gone already.
    Ok(welded.mesh)
}

#[derive(Default)]
struct Welded {
    mesh: TriangleMesh,
    /// Of each key the vertex's number, and the chunk that had it first.
    numbers: HashMap<VertexKey, (u32, u32)>,
}

impl Welded {
    /// The number of a chunk's vertex: the next one, if it is new.
    fn add(&mut self, chunks: &[&Chunk], c: u32, v: u32) -> Result<u32, WeldError> {
        let (chunk, v) = (chunks[c as usize], v as usize);
        let (key, position) = (chunk.keys[v], chunk.positions[v]);
        let normal = chunk.normals.get(v).copied();
        let mesh = &mut self.mesh;
        if let Some(&(number, first)) = self.numbers.get(&key) {
            let there = number as usize;
            let was = (mesh.positions[there].to_array(), mesh.normals.get(there).map(|n| n.to_array()));
            let bits = |p: [f32; 3]| p.map(f32::to_bits);
            if (bits(was.0), was.1.map(bits)) != (bits(position), normal.map(bits)) {
                return Err(WeldError::Mismatch(Box::new(Mismatch {
                    key,
                    chunks: [chunks[first as usize].cells, chunk.cells],
                    positions: [was.0, position],
                    normals: [was.1.unwrap_or_default(), normal.unwrap_or_default()],
                })));
            }
            return Ok(number);
        }
        let number = u32::try_from(mesh.positions.len()).map_err(|_| WeldError::TooManyVertices)?;
        self.numbers.try_reserve(1)?;
        self.numbers.insert(key, (number, c));
        push(&mut mesh.positions, Vec3::from(position))?;
        if let Some(normal) = normal {
            push(&mut mesh.normals, Vec3::from(normal))?;
        }
        Ok(number)
    }
}
