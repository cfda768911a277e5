//! Marching tetrahedra. Uniform lattices, whose points all have the same edges, are [`streamed`]; those that are cut cube by cube
//! have an extractor of their own ([`by_cell`]). With accumulated positions all samples are stored ([`dense`]).

pub(crate) mod by_cell;
pub(crate) mod dense;
pub(crate) mod streamed;
mod ties;
