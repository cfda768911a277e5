//! A chunk with edges collapsed: whole pieces of surface, and the chunk's part of what becomes of them.

use std::collections::TryReserveError;

use isostudy_mesh::TriangleMesh;

use super::chunk::Chunk;
use super::settings::Normals;
use crate::clustering::collapse::{Merged, collapse_traced};
use crate::lattice::{CellBox, Lattice};
use crate::memory::{filled, push};
use crate::settings::Topology;
use crate::surface::normals::vertex_normals;
use crate::surface::trace::Trace;

const NOWHERE: u32 = u32::MAX;

/// Collapses edges of the pieces of surface that enter the chunk, and cuts its cells out. `false` if a piece of surface in
/// the chunk leaves the part of the window that is `as_in_whole`: what happens to it beyond may matter.
///
/// A piece, connected through shared vertices, that lies in that part is a piece of the whole mesh, with the same
/// vertices and triangles in the same order. Collapses look at nothing but the piece they are in, and go in an order
/// that other pieces interleave with and do not change: by vertex numbers as published; guarded, each taken from the
/// queue is the shortest of its own piece, and a further pass over a piece in which nothing collapsed finds nothing
/// again.
pub(super) fn collapsed(
    mesh: &TriangleMesh,
    trace: &Trace,
    window: &Lattice,
    as_in_whole: CellBox,
    (topology, normals): (Topology, Normals),
    chunk: &mut Chunk,
) -> Result<bool, TryReserveError> {
    let (seen, cells) = (window.cell_box(), chunk.cells);
    let mut pieces = pieces_of(mesh)?;
    let mut root = |v: u32| pieces.survivor(v) as usize;
    // What is known of each piece, at its root.
    let mut enters = filled(mesh.positions.len(), false)?;
    let mut leaves = filled(mesh.positions.len(), false)?;
    for (triangle, &cell) in mesh.triangles.iter().zip(&trace.cells) {
        let (cell, root) = (seen.cell(cell), root(triangle[0]));
        enters[root] |= cells.contains(cell);
        leaves[root] |= !as_in_whole.contains(cell);
    }
    if enters.iter().zip(&leaves).any(|(enters, leaves)| *enters && *leaves) {
        return Ok(false);
    }

    // Those pieces as a mesh of their own.
    let mut numbers = filled(mesh.positions.len(), NOWHERE)?;
    let (mut positions, mut keys) = (Vec::new(), Vec::new());
    for v in 0..mesh.positions.len() {
        if enters[root(v as u32)] {
            numbers[v] = positions.len() as u32;
            push(&mut positions, mesh.positions[v])?;
            push(&mut keys, trace.keys[v])?;
        }
    }
    let (mut triangles, mut triangle_cells) = (Vec::new(), Vec::new());
    for (triangle, &cell) in mesh.triangles.iter().zip(&trace.cells) {
        if enters[root(triangle[0])] {
            push(&mut triangles, triangle.map(|v| numbers[v as usize]))?;
            push(&mut triangle_cells, cell)?;
        }
    }
    let after = collapse_traced(topology, window.spacing(), positions, &triangles)?;
    let of_triangles = vertex_normals(&after.positions, &after.triangles)?;

    chunk.numbered_by_use = true;
    let mut numbers = filled(after.positions.len(), NOWHERE)?;
    for (triangle, &before) in after.triangles.iter().zip(&after.triangles_before) {
        let cell = seen.cell(triangle_cells[before as usize]);
        if !cells.contains(cell) {
            continue;
        }
        for &v in triangle {
            let v = v as usize;
            if numbers[v] == NOWHERE {
                numbers[v] = chunk.keys.len() as u32;
                push(&mut chunk.keys, keys[after.vertices_before[v] as usize])?;
                push(&mut chunk.positions, after.positions[v].to_array())?;
                if normals != Normals::None {
                    push(&mut chunk.normals, of_triangles[v].to_array())?;
                }
            }
        }
        push(&mut chunk.triangles, triangle.map(|v| numbers[v as usize]))?;
        push(&mut chunk.triangle_cells, cells.number(cell))?;
    }
    Ok(true)
}

/// Which vertices are connected: those that have one survivor.
fn pieces_of(mesh: &TriangleMesh) -> Result<Merged, TryReserveError> {
    let mut pieces = Merged::none(mesh.positions.len())?;
    for &[a, b, c] in &mesh.triangles {
        for other in [b, c] {
            let (one, other) = (pieces.survivor(a), pieces.survivor(other));
            pieces.into[one.max(other) as usize] = one.min(other);
        }
    }
    Ok(pieces)
}
