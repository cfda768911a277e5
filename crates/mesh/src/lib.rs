//! Triangle meshes: what a mesh is, what every triangle is worth, and what is wrong with the topology.
//!
//! A [`TriangleMesh`] is plain data. [`quality`] measures its triangles, [`topology`] its connections, [`repair`]
//! closes holes, [`normals`] gives it vertex normals, [`metro`] says how far it is from another, and a [`MeshFormat`]
//! moves it in and out of files: OBJ, PLY and STL both ways, binary glTF out. [`NearestTriangles`] finds the nearest
//! triangle to a point. Everything is deterministic; only [`metro`] uses threads.

mod closest_point;
mod connectivity;
mod corner_fans;
pub mod distribution;
mod format;
mod glb;
pub mod metro;
mod nearest;
pub mod normals;
mod obj;
mod ply;
pub mod quality;
pub mod repair;
mod stl;
pub mod topology;
mod triangle_mesh;

pub use format::{MeshFormat, ReadError};
pub use glam;
pub use glb::write_glb;
pub use nearest::{NearestPoint, NearestTriangles};
pub use obj::{ObjError, read_obj, write_obj};
pub use ply::{PlyError, read_ply, write_ply};
pub use stl::{StlError, read_stl, weld, write_stl};
pub use triangle_mesh::{Bounds, TriangleMesh};
