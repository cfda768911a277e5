//! Chunks of several levels of detail, with seams between those that differ by one.
//!
//! The grid of a level has cubes twice as large as the one before. Where chunks of two levels meet, the surface of each ends in other
//! points of the side between them. Something must fill the gap:
//!
//! - Of marching cubes, the coarser chunk makes the cells there anew, each with what the finer ones have on its sides: see [`stitching`].
//! - Of surface nets and dual contouring, a polygon stands round each crossed *minimal edge*, the shortest that the cells at it have
//!   (Ju, Losasso, Schaefer & Warren 2002): see [`duals`].
//!
//! Vertices of the neighbour's level are not computed anew: a [`ChunkExtractor`](crate::ChunkExtractor) of that level makes them, so
//! they are the neighbour's own to the bit, and so are their normals.

mod divided;
mod duals;
mod error;
mod extractor;
mod filling;
mod layer;
mod neighbours;
mod stitching;
mod windows;

pub use error::LevelError;
pub use extractor::LevelExtractor;
pub use neighbours::Neighbours;
pub use windows::LevelWindow;
