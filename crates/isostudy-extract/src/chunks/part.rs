//! A chunk's own part of the mesh of its window.

use std::collections::TryReserveError;

use glam::Vec3;
use isostudy_mesh::TriangleMesh;

use super::chunk::Chunk;
use super::settings::{ChunkSettings, Normals};
use crate::lattice::Lattice;
use crate::memory::{push, refill};
use crate::surface::trace::Trace;

/// The number of a vertex that is not in the chunk, and of one that is, before it has one.
const NOWHERE: u32 = u32::MAX;
const SOMEWHERE: u32 = 0;

/// Cuts the chunk's cells out of the mesh of a window: their triangles, with the vertices that they use and those of the
/// chunk's own points. Without a trace the mesh has nothing else. `numbers` is room to work in.
pub(super) fn cut_out(
    mesh: &TriangleMesh,
    trace: Option<&Trace>,
    window: &Lattice,
    numbers: &mut Vec<u32>,
    &ChunkSettings { normals, keys, .. }: &ChunkSettings,
    chunk: &mut Chunk,
) -> Result<(), TryReserveError> {
    let has_normals = normals != Normals::None;
    let Some(trace) = trace else { return copied(mesh, has_normals, chunk) };
    let seen = match trace.part {
        Some(part) => window.cells_of(part),
        None => window.cell_box(),
    };
    if seen == chunk.cells && trace.part.is_some() && !trace.has_spare {
        if keys {
            append(&mut chunk.triangle_cells, &trace.cells)?;
            append(&mut chunk.keys, &trace.keys)?;
        }
        return copied(mesh, has_normals, chunk);
    }
    numbers.clear();
    refill(numbers, mesh.positions.len(), NOWHERE)?;
    for (number, key) in numbers.iter_mut().zip(&trace.keys) {
        if chunk.cells.contains(window.cell_of_point(key.stored())) {
            *number = SOMEWHERE;
        }
    }
    for (triangle, &number) in mesh.triangles.iter().zip(&trace.cells) {
        let cell = seen.cell(number);
        if chunk.cells.contains(cell) {
            push(&mut chunk.triangles, *triangle)?;
            if keys {
                push(&mut chunk.triangle_cells, chunk.cells.number(cell))?;
            }
            triangle.iter().for_each(|&v| numbers[v as usize] = SOMEWHERE);
        }
    }
    for (v, number) in numbers.iter_mut().enumerate().filter(|(_, number)| **number != NOWHERE) {
        *number = chunk.positions.len() as u32;
        push(&mut chunk.positions, mesh.positions[v].to_array())?;
        if keys {
            push(&mut chunk.keys, trace.keys[v])?;
        }
        if has_normals {
            push(&mut chunk.normals, mesh.normals[v].to_array())?;
        }
    }
    chunk.triangles.iter_mut().flatten().for_each(|v| *v = numbers[*v as usize]);
    Ok(())
}

/// All vertices and triangles of a mesh that is the chunk's.
fn copied(mesh: &TriangleMesh, has_normals: bool, chunk: &mut Chunk) -> Result<(), TryReserveError> {
    append(&mut chunk.triangles, &mesh.triangles)?;
    let as_array = |point: &Vec3| point.to_array();
    chunk.positions.try_reserve(mesh.positions.len())?;
    chunk.positions.extend(mesh.positions.iter().map(as_array));
    if has_normals {
        chunk.normals.try_reserve(mesh.normals.len())?;
        chunk.normals.extend(mesh.normals.iter().map(as_array));
    }
    Ok(())
}

fn append<T: Copy>(to: &mut Vec<T>, items: &[T]) -> Result<(), TryReserveError> {
    to.try_reserve(items.len())?;
    to.extend_from_slice(items);
    Ok(())
}
