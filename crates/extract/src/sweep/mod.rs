//! The streaming extractor: the lattice is swept from the bottom up with only a few layers in memory.
//!
//! Memory grows with a layer and with the mesh, not with the volume. Slabs of layers are independent up to a halo of
//! two steps, and vertices are numbered by prefix sums over slabs, so any number of threads gives the same bytes.
//!
//! The mesh is that of the stored extractor ([`crate::stored`]) with the same rule, vertex by vertex and triangle by
//! triangle, in the same order: vertices in storage order of their points, triangles cell by cell.

mod crossings;
mod extractor;
mod faces;
mod grid;
#[cfg(test)]
mod limits;
mod points;
mod records;
mod rule;
mod sampling;
mod signs;
mod slab;
mod source;
#[cfg(test)]
mod tests;
mod tiles;

use std::collections::TryReserveError;

pub use extractor::Extractor;
pub(crate) use extractor::{join, make_normals, shares, threads_and_slabs};
pub(crate) use slab::Piece;
pub use source::Source;
pub(crate) use tiles::{Known, Span, Tile};

/// Makes a vector `len` long. What it held stays if it is long enough; new room is asked for, not taken.
fn refill<T: Copy>(vector: &mut Vec<T>, len: usize, value: T) -> Result<(), TryReserveError> {
    vector.try_reserve_exact(len.saturating_sub(vector.len()))?;
    vector.resize(len, value);
    Ok(())
}
