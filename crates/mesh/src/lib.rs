//! Triangle meshes: what a mesh is, what every triangle is worth, and what is wrong with the topology.
//!
//! A [`TriangleMesh`] is plain data. [`quality`] measures its triangles, [`topology`] its connections, [`repair`]
//! closes holes, [`normals`] gives it vertex normals, and [`read_obj`], [`read_ply`] and their writers move it in
//! and out of files. Everything is deterministic and single-threaded.

mod closest_point;
mod connectivity;
mod corner_fans;
pub mod distribution;
mod nearest;
pub mod normals;
mod obj;
mod ply;
pub mod quality;
pub mod repair;
pub mod topology;
mod triangle_mesh;

pub use glam;
pub use nearest::{NearestPoint, NearestTriangles};
pub use obj::{ObjError, read_obj, write_obj};
pub use ply::{PlyError, read_ply, write_ply};
pub use triangle_mesh::{Bounds, TriangleMesh};
