//! Chunks to one mesh.

use std::collections::{HashMap, TryReserveError};

use glam::Vec3;
use mesh::TriangleMesh;

use super::chunk::Chunk;
use crate::memory::{push, with_room};
use crate::trace::VertexKey;

/// Why chunks do not weld.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum WeldError {
    /// Two chunks have triangles of one cell.
    #[error("cell {cell} is in two of the chunks")]
    Overlap {
        /// The cell's number, x fastest.
        cell: u32,
    },
    /// Two chunks have one vertex in two places, or with two normals: they are not of the same field, or one of them has
    /// not been extracted again since it changed.
    #[error("the chunks do not fit at {first:?}: another one has the same vertex at {second:?}")]
    Mismatch {
        /// In one chunk.
        first: Vec3,
        /// In another.
        second: Vec3,
    },
    /// More vertices than a 32-bit index can name.
    #[error("the chunks have more than {} vertices", u32::MAX)]
    TooManyVertices,
    /// The mesh outgrew the memory that is left.
    #[error("no memory for a mesh this large")]
    NoMemory,
}

impl From<TryReserveError> for WeldError {
    fn from(_: TryReserveError) -> Self {
        Self::NoMemory
    }
}

/// Joins chunks at their common vertices, by key: no coordinates are compared but to see that they are the same.
///
/// Of all chunks of a lattice this makes the mesh of the whole, to the byte: positions, normals, triangles and their
/// order. Of some of them it makes that part of it, in the same order. The order of the chunks does not matter.
///
/// # Errors
/// [`WeldError::Overlap`] and [`WeldError::Mismatch`] if the chunks are not of one extraction.
pub fn weld_chunks<'a>(chunks: impl IntoIterator<Item = &'a Chunk>) -> Result<TriangleMesh, WeldError> {
    let mut in_order: Vec<&Chunk> = chunks.into_iter().collect();
    in_order.sort_by_key(|chunk| (chunk.cells.start[2], chunk.cells.start[1], chunk.cells.start[0]));
    let mut triangles = with_room(in_order.iter().map(|chunk| chunk.triangle_cells.len()).sum())?;
    for (c, chunk) in in_order.iter().enumerate() {
        triangles
            .extend(chunk.triangle_cells.iter().enumerate().map(|(t, &cell)| (cell, c as u32, t as u32)));
    }
    triangles.sort_unstable();
    let overlap = triangles.windows(2).find(|pair| pair[0].0 == pair[1].0 && pair[0].1 != pair[1].1);
    if let Some(pair) = overlap {
        return Err(WeldError::Overlap { cell: pair[0].0 });
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
            welded.add(in_order[c as usize], v)?;
        }
    }
    for (_, c, t) in triangles {
        let chunk = in_order[c as usize];
        let mut corners = [0; 3];
        for (corner, &v) in corners.iter_mut().zip(&chunk.mesh.triangles[t as usize]) {
            *corner = welded.add(chunk, v)?;
        }
        push(&mut welded.mesh.triangles, corners)?;
    }
    // Vertices that no triangle uses, where edges were collapsed, are gone already.
    Ok(welded.mesh)
}

#[derive(Default)]
struct Welded {
    mesh: TriangleMesh,
    numbers: HashMap<VertexKey, u32>,
}

impl Welded {
    /// The number of a chunk's vertex: the next one, if it is new.
    fn add(&mut self, chunk: &Chunk, v: u32) -> Result<u32, WeldError> {
        let v = v as usize;
        let (position, normal) = (chunk.mesh.positions[v], chunk.mesh.normals[v]);
        let mesh = &mut self.mesh;
        if let Some(&number) = self.numbers.get(&chunk.keys[v]) {
            let there = number as usize;
            let bits = |p: Vec3| p.to_array().map(f32::to_bits);
            if (bits(mesh.positions[there]), bits(mesh.normals[there])) != (bits(position), bits(normal)) {
                return Err(WeldError::Mismatch { first: mesh.positions[there], second: position });
            }
            return Ok(number);
        }
        let number = u32::try_from(mesh.positions.len()).map_err(|_| WeldError::TooManyVertices)?;
        self.numbers.try_reserve(1)?;
        self.numbers.insert(chunk.keys[v], number);
        push(&mut mesh.positions, position)?;
        push(&mut mesh.normals, normal)?;
        Ok(number)
    }
}
