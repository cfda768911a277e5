//! A mesh in the making: its triangles, where in the lattice they come from, and normals.

pub(crate) mod normals;
pub(crate) mod space;
pub(crate) mod trace;
pub(crate) mod triangulation;
