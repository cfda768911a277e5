//! The streaming extractor: the lattice is gone through from the bottom up with only a few layers in memory.
//!
//! Memory grows with a layer and with the mesh, not with the volume. Slabs of layers are independent up to a halo of
//! two steps, and vertices are numbered by prefix sums over slabs, so any number of threads gives the same bytes.
//!
//! The mesh is that of the dense extractor ([`crate::tetrahedra::dense`]) with the same rule, vertex by vertex and triangle by
//! triangle, in the same order: vertices in storage order of their points, triangles cell by cell.

mod crossings;
mod driver;
mod faces;
mod grid;
mod points;
mod records;
mod rule;
mod sampling;
mod signs;
mod slab;
#[cfg(test)]
mod tests;

pub(crate) use driver::Streamer;
