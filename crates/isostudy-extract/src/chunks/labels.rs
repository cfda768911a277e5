//! Boundaries of labels in boxes of cells, which fit together.

use isostudy_mesh::{LabelledMesh, TriangleMesh};

use super::weld::{Mismatch, WeldError};
use crate::duals::{LabelError, LabelSettings, LabelVolume, Placed};
use crate::extraction::ExtractError;
use crate::lattice::{Arrangement, CellBox};
use crate::memory::{filled, with_room};
use crate::surface::trace::VertexKey;

/// Of a vertex that no triangle has.
const NONE: u32 = u32::MAX;

/// The boundaries of labels in a box of cells: the triangles round the edges between labels that begin at the lowest corners of its cells.
/// Vertices on the lower sides are those of cells beside the box, and are there in the chunks of those, too, with the same bits.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct LabelChunk {
    /// The cells. Cell `(i, j, k)` has its lowest corner at label `(i, j, k)`.
    pub cells: CellBox,
    /// The triangles, and the labels on their sides.
    pub labelled: LabelledMesh,
    /// Of each vertex the cell, which no other vertex has: by it chunks know their common vertices.
    pub vertex_cells: Vec<[i32; 3]>,
    /// Of each two triangles the number of their edge in the volume.
    edges: Vec<u64>,
}

impl LabelVolume<'_> {
    /// Extracts the boundaries in a box of cells, on the calling thread. Chunks of boxes that fill the volume weld to the mesh of
    /// [`extract`](Self::extract), to the byte, smoothed or not. No label is read that is farther than one cell and a cell for each
    /// step of smoothing. The settings' labels are not looked for: a chunk may have none of them.
    ///
    /// # Errors
    /// [`LabelError`].
    pub fn extract_chunk(&self, settings: &LabelSettings, cells: CellBox) -> Result<LabelChunk, LabelError> {
        let Placed { mut labelled, cells: of_all, edges, .. } = self.net_of(settings, cells)?;
        let mesh = &mut labelled.mesh;
        let mut numbers = filled(mesh.positions.len(), NONE).map_err(ExtractError::from)?;
        mesh.triangles.iter().flatten().for_each(|&v| numbers[v as usize] = 0);
        // Numbers go up with cells, as they did.
        let mut vertex_cells = Vec::new();
        for (v, number) in numbers.iter_mut().enumerate() {
            if *number != NONE {
                *number = vertex_cells.len() as u32;
                mesh.positions[vertex_cells.len()] = mesh.positions[v];
                vertex_cells.push(of_all[v]);
            }
        }
        mesh.positions.truncate(vertex_cells.len());
        mesh.triangles.iter_mut().flatten().for_each(|v| *v = numbers[*v as usize]);
        Ok(LabelChunk { cells, labelled, vertex_cells, edges })
    }
}

/// Joins chunks of one volume and settings at their common vertices. Of boxes that fill the volume this makes the mesh of the whole, to the
/// byte; of others that part of it, in the same order. The order of the chunks does not matter.
///
/// # Errors
/// [`WeldError::Overlap`], [`WeldError::Mismatch`] where a chunk was not extracted again since labels beside it changed,
/// [`WeldError::TooManyVertices`] and [`WeldError::NoMemory`].
pub fn weld_label_chunks(chunks: &[LabelChunk]) -> Result<LabelledMesh, WeldError> {
    for (i, a) in chunks.iter().enumerate() {
        for b in &chunks[..i] {
            let start = [0, 1, 2].map(|axis| a.cells.start[axis].max(b.cells.start[axis]));
            let end = [0, 1, 2].map(|axis| a.cells.end[axis].min(b.cells.end[axis]));
            if !(CellBox { start, end }).is_empty() {
                return Err(WeldError::Overlap { cell: start });
            }
        }
    }
    // By cell as vertices are numbered, z first.
    let mut vertices = with_room(chunks.iter().map(|chunk| chunk.vertex_cells.len()).sum())?;
    for (c, chunk) in chunks.iter().enumerate() {
        vertices.extend(chunk.vertex_cells.iter().enumerate().map(|(v, &[x, y, z])| ([z, y, x], c, v)));
    }
    vertices.sort_unstable();
    let mut numbers: Vec<Vec<u32>> = chunks.iter().map(|chunk| vec![0; chunk.vertex_cells.len()]).collect();
    let mut mesh = TriangleMesh::default();
    let position = |c: usize, v: usize| chunks[c].labelled.mesh.positions[v];
    for same in vertices.chunk_by(|a, b| a.0 == b.0) {
        let ([z, y, x], first, v) = same[0];
        let number = u32::try_from(mesh.positions.len()).ok().filter(|&number| number != NONE);
        let number = number.ok_or(WeldError::TooManyVertices)?;
        mesh.positions.push(position(first, v));
        for &(_, c, w) in same {
            numbers[c][w] = number;
            if position(c, w) != position(first, v) {
                return Err(WeldError::Mismatch(Box::new(Mismatch {
                    key: VertexKey::new(Arrangement::SimpleCubic, [x, y, z].map(i64::from), 0),
                    chunks: [chunks[first].cells, chunks[c].cells],
                    positions: [position(first, v), position(c, w)].map(|p| p.to_array()),
                    normals: [[0.0; 3]; 2],
                })));
            }
        }
    }
    let mut quadrilaterals = with_room(chunks.iter().map(|chunk| chunk.edges.len()).sum())?;
    for (c, chunk) in chunks.iter().enumerate() {
        quadrilaterals.extend(chunk.edges.iter().enumerate().map(|(i, &edge)| (edge, c, i)));
    }
    quadrilaterals.sort_unstable();
    let mut sides = Vec::with_capacity(2 * quadrilaterals.len());
    for (_, c, i) in quadrilaterals {
        let LabelledMesh { mesh: own, sides: of_own } = &chunks[c].labelled;
        mesh.triangles
            .extend(own.triangles[2 * i..2 * i + 2].iter().map(|t| t.map(|v| numbers[c][v as usize])));
        sides.extend_from_slice(&of_own[2 * i..2 * i + 2]);
    }
    Ok(LabelledMesh { mesh, sides })
}
