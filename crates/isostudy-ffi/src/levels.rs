//! Chunks in levels of detail.

use std::ffi::c_char;

use isostudy_extract::{Chunk, Control, Grid, LevelExtractor, Neighbours};

use crate::chunks::settings;
use crate::field::{Called, IsostudyField};
use crate::mesh::{IsostudyCells, IsostudyMesh};
use crate::pointers::{method, object, value};
use crate::status::{Failure, IsostudyStatus, status_of};

/// Makes chunks of several levels of detail, with the seams between them.
pub struct IsostudyLevels {
    extractor: LevelExtractor,
    chunk: Chunk,
}

/// Makes an object for chunks of all levels, as `isostudy_chunks_new` does for one. The grid is that of level 0, the finest; each further level has
/// cells twice as large.
///
/// # Safety
/// Each pointer is null, which is an error, or leads to what the text says.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isostudy_levels_new(
    method_name: *const c_char,
    origin: *const f64,
    spacing: f64,
    isovalue: f32,
    normals: u32,
    levels: *mut *mut IsostudyLevels,
) -> IsostudyStatus {
    status_of(|| {
        // SAFETY: the caller's promise.
        let (method, origin, levels) = unsafe {
            (method(method_name)?, *value(origin.cast::<[f64; 3]>(), "origin")?, object(levels, "levels")?)
        };
        let grid = Grid::try_new(origin, spacing)?;
        let extractor = LevelExtractor::try_new(&grid, &method, &settings(isovalue, normals)?)?;
        *levels = Box::into_raw(Box::new(IsostudyLevels { extractor, chunk: Chunk::default() }));
        Ok(())
    })
}

/// Frees the object with its buffers. Null is nothing.
///
/// # Safety
/// `levels` is null or came from `isostudy_levels_new`, and is not used afterwards.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isostudy_levels_free(levels: *mut IsostudyLevels) {
    if !levels.is_null() {
        // SAFETY: it came from `Box::into_raw`, and nobody has it any more.
        drop(unsafe { Box::from_raw(levels) });
    }
}

/// Extracts the surface of a field in a box of cells of a level, with the seams to its neighbours. `around` has the levels of what touches the
/// chunk: 27 numbers, x fastest, for the directions from (-1, -1, -1) to (1, 1, 1). The one in the middle does not matter.
///
/// # Safety
/// `levels` came from `isostudy_levels_new`, and no other thread uses it. `field` leads to functions that keep their promises. `around` leads to 27
/// numbers, and `mesh` to room for the answer.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn isostudy_levels_extract(
    levels: *mut IsostudyLevels,
    field: *const IsostudyField,
    level: u32,
    cells: IsostudyCells,
    around: *const u32,
    mesh: *mut IsostudyMesh,
) -> IsostudyStatus {
    status_of(|| {
        // SAFETY: the caller's promise.
        let (levels, field, around, mesh) = unsafe {
            let around = value(around.cast::<[u32; 27]>(), "around")?;
            (object(levels, "levels")?, value(field, "field")?, around, object(mesh, "mesh")?)
        };
        let field = Called::new(field).ok_or_else(|| Failure::argument("field.sample is null"))?;
        let place = |[x, y, z]: [i32; 3]| (x + 1 + 3 * (y + 1) + 9 * (z + 1)) as usize;
        let neighbours = Neighbours::try_new(level, |direction| around[place(direction)])?;
        let IsostudyLevels { extractor, chunk } = levels;
        extractor.extract_into(&field, level, cells.into(), &neighbours, Control::default(), chunk)?;
        *mesh = IsostudyMesh::of_chunk(chunk);
        Ok(())
    })
}
