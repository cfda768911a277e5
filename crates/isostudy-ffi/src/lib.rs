//! The extractor for C: functions by name, and buffers that stay with the object that made them.
//!
//! `include/isostudy.h` is made from these sources by cbindgen. It is the only crate of the library that has `unsafe`: for pointers that
//! come from another language, and for the names of functions. What a pointer must be stands with each function.
//!
//! - [`isostudy_chunks_new`]: chunks of an endless world, from a field that is called or from samples.
//! - [`isostudy_levels_new`]: the same in levels of detail.
//! - [`isostudy_volume_new`]: the surface in a whole volume of samples.
//!
//! A function that can fail returns a [`IsostudyStatus`], and [`isostudy_last_error`] says in words what was wrong. A panic does not leave
//! the library.

mod chunks;
mod field;
mod levels;
mod mesh;
mod pointers;
mod status;
mod volume;

pub use chunks::{
    IsostudyChunks, IsostudyNormals, isostudy_chunks_extract, isostudy_chunks_extract_samples,
    isostudy_chunks_free, isostudy_chunks_new, isostudy_chunks_reserve, isostudy_chunks_touched,
    isostudy_chunks_window,
};
pub use field::IsostudyField;
pub use levels::{IsostudyLevels, isostudy_levels_extract, isostudy_levels_free, isostudy_levels_new};
pub use mesh::{IsostudyCells, IsostudyMesh};
pub use status::{IsostudyStatus, isostudy_last_error, isostudy_version};
pub use volume::{
    IsostudySamples, IsostudyVolume, isostudy_volume_extract, isostudy_volume_free, isostudy_volume_new,
};
