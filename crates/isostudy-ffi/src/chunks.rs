//! Chunks of an endless world.

use std::ffi::c_char;

use isostudy_extract::{Aabb, Chunk, ChunkExtractor, ChunkSettings, Control, Grid, Method, Normals, Source};

use crate::field::{Called, IsostudyField};
use crate::mesh::{IsostudyCells, IsostudyMesh};
use crate::pointers::{method, numbers, object, value};
use crate::status::{Failure, IsostudyStatus, status_of};

/// Where normals come from.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum IsostudyNormals {
    /// There are none.
    None = 0,
    /// From the triangles round the vertex.
    Triangles = 1,
    /// From the field's values round the vertex. Needs a field.
    Field = 2,
    /// From the samples round the vertex, for less time than those of triangles. Needs samples, chunks of one level, and marching cubes or
    /// surface nets.
    Samples = 3,
}

/// Makes chunks of an endless world.
pub struct IsostudyChunks {
    grid: Grid,
    method: Method,
    extractor: ChunkExtractor,
    chunk: Chunk,
}

/// Settings from a number, since C checks none.
pub(crate) fn settings(isovalue: f32, normals: u32) -> Result<ChunkSettings, Failure> {
    let normals = match normals {
        0 => Normals::None,
        1 => Normals::Triangles,
        2 => Normals::Field,
        3 => Normals::Samples,
        other => return Err(Failure::argument(format!("normals = {other}: there are 0, 1, 2 and 3"))),
    };
    Ok(ChunkSettings::default().with_isovalue(isovalue).with_normals(normals))
}

/// Makes an object for chunks of a method, such as `"mc33"`, on a grid with a corner at `origin`, three numbers, and cubes of edge `spacing`.
/// Inside is above the isovalue. `normals` is one of `isostudy_normals`. It is written to `chunks`, and freed by `isostudy_chunks_free`.
///
/// # Safety
/// Each pointer is null, which is an error, or leads to what the text says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isostudy_chunks_new(
    method_name: *const c_char,
    origin: *const f64,
    spacing: f64,
    isovalue: f32,
    normals: u32,
    chunks: *mut *mut IsostudyChunks,
) -> IsostudyStatus {
    status_of(|| {
        // SAFETY: the caller's promise.
        let (method, origin, chunks) = unsafe {
            (method(method_name)?, *value(origin.cast::<[f64; 3]>(), "origin")?, object(chunks, "chunks")?)
        };
        let grid = Grid::try_new(origin, spacing)?;
        // Nothing here shows keys, and without them a chunk takes less time.
        let settings = settings(isovalue, normals)?.with_keys(false);
        let extractor = ChunkExtractor::try_new(&grid, &method, &settings)?;
        *chunks =
            Box::into_raw(Box::new(IsostudyChunks { grid, method, extractor, chunk: Chunk::default() }));
        Ok(())
    })
}

/// Frees the object with its buffers. Null is nothing.
///
/// # Safety
/// `chunks` is null or came from `isostudy_chunks_new`, and is not used afterwards.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isostudy_chunks_free(chunks: *mut IsostudyChunks) {
    if !chunks.is_null() {
        // SAFETY: it came from `Box::into_raw`, and nobody has it any more.
        drop(unsafe { Box::from_raw(chunks) });
    }
}

/// Makes room for so many vertices, so that no chunk with fewer allocates.
///
/// # Safety
/// `chunks` came from `isostudy_chunks_new`, and no other thread uses it.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isostudy_chunks_reserve(
    chunks: *mut IsostudyChunks,
    vertices: usize,
) -> IsostudyStatus {
    status_of(|| {
        // SAFETY: the caller's promise.
        let chunks = unsafe { object(chunks, "chunks")? };
        chunks.extractor.reserve(vertices)?;
        chunks.chunk.reserve(vertices);
        Ok(())
    })
}

/// Writes the cells whose corners have the samples that a chunk needs: a box round its cells.
///
/// # Safety
/// `chunks` came from `isostudy_chunks_new`, and no other thread uses it. `window` leads to room for the answer.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isostudy_chunks_window(
    chunks: *mut IsostudyChunks,
    cells: IsostudyCells,
    window: *mut IsostudyCells,
) -> IsostudyStatus {
    status_of(|| {
        // SAFETY: the caller's promise.
        let (chunks, window) = unsafe { (object(chunks, "chunks")?, object(window, "window")?) };
        let found = chunks.extractor.window(cells.into())?;
        *window = found.ok_or_else(|| Failure::argument("the method has no window of a fixed size"))?.into();
        Ok(())
    })
}

/// Extracts the surface of a field in a box of cells.
///
/// # Safety
/// `chunks` came from `isostudy_chunks_new`, and no other thread uses it. `field` leads to functions that keep their promises. `mesh` leads to
/// room for the answer.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isostudy_chunks_extract(
    chunks: *mut IsostudyChunks,
    field: *const IsostudyField,
    cells: IsostudyCells,
    mesh: *mut IsostudyMesh,
) -> IsostudyStatus {
    status_of(|| {
        // SAFETY: the caller's promise.
        let (chunks, field, mesh) =
            unsafe { (object(chunks, "chunks")?, value(field, "field")?, object(mesh, "mesh")?) };
        let field = Called::new(field).ok_or_else(|| Failure::argument("field.sample is null"))?;
        let IsostudyChunks { extractor, chunk, .. } = chunks;
        extractor.extract_into(&field, cells.into(), Control::default(), chunk)?;
        *mesh = IsostudyMesh::of_chunk(chunk);
        Ok(())
    })
}

/// Extracts the surface between samples in a box of cells. `window` is that of `isostudy_chunks_window`, or a larger box. The samples are those of its
/// corners, x fastest, then y: one more than cells along each axis. Methods with samples elsewhere than at corners are an error, as a
/// wrong `count` is.
///
/// # Safety
/// `chunks` came from `isostudy_chunks_new`, and no other thread uses it. `samples` leads to `count` numbers. `mesh` leads to room for the answer.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isostudy_chunks_extract_samples(
    chunks: *mut IsostudyChunks,
    window: IsostudyCells,
    samples: *const f32,
    count: usize,
    cells: IsostudyCells,
    mesh: *mut IsostudyMesh,
) -> IsostudyStatus {
    status_of(|| {
        // SAFETY: the caller's promise.
        let (chunks, samples, mesh) = unsafe {
            (object(chunks, "chunks")?, numbers(samples, count, "samples")?, object(mesh, "mesh")?)
        };
        if !chunks.method.is_of_corners() {
            return Err(Failure::argument("the method needs more than samples at corners: give a field"));
        }
        let IsostudyChunks { extractor, chunk, .. } = chunks;
        let source = Source::Window { cells: window.into(), samples };
        extractor.extract_into(source, cells.into(), Control::default(), chunk)?;
        *mesh = IsostudyMesh::of_chunk(chunk);
        Ok(())
    })
}

/// Which chunks of so many cells a side can change when values change in the box from `min` to `max`, three numbers each, and nowhere else.
/// Writes up to `capacity` of their ids, three numbers each, and to `count` how many there are.
///
/// # Safety
/// `chunks` came from `isostudy_chunks_new`, and no other thread uses it. `ids` is null with a `capacity` of 0, or leads to room for
/// so many ids. The other pointers lead to what the text says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isostudy_chunks_touched(
    chunks: *mut IsostudyChunks,
    min: *const f32,
    max: *const f32,
    cells_per_side: u32,
    ids: *mut i32,
    capacity: usize,
    count: *mut usize,
) -> IsostudyStatus {
    status_of(|| {
        // SAFETY: the caller's promise.
        let (chunks, min, max, count) = unsafe {
            let corner = |pointer: *const f32, name| value(pointer.cast::<[f32; 3]>(), name);
            (object(chunks, "chunks")?, *corner(min, "min")?, *corner(max, "max")?, object(count, "count")?)
        };
        if cells_per_side == 0 {
            return Err(Failure::argument("cells_per_side = 0: must be 1 or more"));
        }
        if ids.is_null() && capacity > 0 {
            return Err(Failure::argument("ids is null"));
        }
        *count = 0;
        for id in chunks.grid.touched(Aabb { min, max }, cells_per_side, &chunks.method)? {
            if *count < capacity {
                // SAFETY: there is room for `capacity` ids.
                unsafe { ids.cast::<[i32; 3]>().add(*count).write_unaligned(id) };
            }
            *count += 1;
        }
        Ok(())
    })
}
