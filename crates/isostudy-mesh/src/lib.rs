//! Triangle meshes: what a mesh is, what every triangle is worth, and what is wrong with the topology.
//!
//! A [`TriangleMesh`] is plain data. [`quality`] measures its triangles, [`topology`] its connections, [`repair`]
//! closes holes, [`self_intersections`] counts triangles that pass through each other, [`normals`] gives it vertex normals, and [`corner_normals`] keeps creases sharp, [`metro`] says how far it is from another, and a [`MeshFormat`]
//! moves it in and out of files: OBJ, PLY and STL both ways, binary glTF out, plainly or in few bytes. A [`LabelledMesh`] lies between labels. [`NearestTriangles`] finds the nearest
//! triangle to a point. Everything is deterministic; only [`metro`] uses threads.
//!
//! ```
//! use isostudy_mesh::glam::Vec3;
//! use isostudy_mesh::{TriangleMesh, quality, read_ply, topology, write_ply};
//!
//! // A tetrahedron, counter-clockwise seen from outside.
//! let positions = vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
//! let triangles = vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
//! let mesh = TriangleMesh { positions, triangles, ..TriangleMesh::default() };
//! assert!(topology::topology(&mesh).is_closed_manifold());
//! assert!((mesh.volume() - 1.0 / 6.0).abs() < 1e-6);
//! assert!(quality::quality(&mesh).radius_ratio.mean > 0.8);
//! let mut file = Vec::new();
//! write_ply(&mesh, &mut file)?;
//! assert_eq!(read_ply(file.as_slice())?.triangles, mesh.triangles);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Guaranteed
//!
//! - Indices decide what is joined, coordinates do not, unless a function says so.
//! - The same mesh gives the same numbers, on any number of threads.
//! - Readers return an error that says where, whatever the bytes; they ask for no more memory than the file's size
//!   warrants, and an index that they let through has a vertex.
//!
//! # Not guaranteed
//!
//! - A [`TriangleMesh`] is plain data: an index out of range, a number that is not one, a triangle without area are the
//!   caller's affair. Functions that panic on the first of them say so.
//! - Self-intersections go unseen, but for [`self_intersections`].
//!
//! # Sources
//!
//! Each measure names its own: [`quality`] for the shapes of triangles, [`topology`] for the counts, [`repair`] for closed
//! loops.

mod closest_point;
mod connectivity;
mod corner_fans;
#[cfg(feature = "creases")]
mod creases;
pub mod distribution;
#[cfg(feature = "files")]
mod files;
mod labelled;
pub mod metro;
mod nearest;
pub mod normals;
mod numbers;
pub mod quality;
pub mod repair;
mod self_intersections;
pub mod topology;
mod triangle_mesh;
mod weld;

#[cfg(feature = "creases")]
pub use creases::{CornerNormals, corner_normals};
#[cfg(feature = "files")]
pub use files::{
    CompactNumbers, MeshFormat, ObjError, Per, PlyError, ReadError, StlError, read_obj, read_ply, read_stl,
    write_compact_glb, write_glb, write_obj, write_ply, write_stl,
};
pub use glam;
pub use labelled::LabelledMesh;
pub use nearest::{NearestPoint, NearestTriangles};
pub use numbers::{COORDINATE_LIMIT, MeshError, is_sound, used_vertices};
pub use self_intersections::{MOST_INTERSECTIONS, self_intersections};
pub use triangle_mesh::{Bounds, TriangleMesh};
pub use weld::weld;
