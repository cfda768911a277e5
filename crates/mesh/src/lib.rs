//! Triangle meshes: what a mesh is, what every triangle is worth, and what is wrong with the topology.

mod triangle_mesh;

pub use glam;
pub use triangle_mesh::{Bounds, TriangleMesh};
