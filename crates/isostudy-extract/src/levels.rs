//! Chunks of several levels of detail, with seams between those that differ by one.
//!
//! The grid of a level has cubes twice as large as the one before. Where chunks of two levels meet, the surface of each ends in other
//! points of the side between them. Something must fill the gap:
//!
//! - Of marching cubes, the coarser chunk has a *transition cell* at each square of its side (Lengyel 2010): a flat cell with nine
//!   samples of the fine grid on one face and four of them on the other. [`patterns`] makes its triangles by rule.
//! - Of surface nets and dual contouring, a polygon stands round each crossed *minimal edge*, the shortest that the cells at it have
//!   (Ju, Losasso, Schaefer & Warren 2002): see [`duals`].
//!
//! Vertices of the neighbour's level are not computed anew: a [`ChunkExtractor`](crate::ChunkExtractor) of that level makes them, so
//! they are the neighbour's own to the bit, and so are their normals.

mod duals;
mod error;
mod extractor;
mod layer;
mod neighbours;
mod patterns;
mod shift;
mod transitions;

pub use error::LevelError;
pub use extractor::{LevelExtractor, LevelSettings};
pub use neighbours::Neighbours;
