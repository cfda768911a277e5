//! Merging vertices: near a sample point while they are made, or by collapsing edges and warping the lattice afterwards.

pub(crate) mod clusters;
pub(crate) mod collapse;
pub(crate) mod guard;
pub(crate) mod warp;
