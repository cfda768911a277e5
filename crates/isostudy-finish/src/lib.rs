//! Finishing steps: what can be done to a mesh after it was extracted, by whatever method.
//!
//! | step | what it does | source |
//! |---|---|---|
//! | [`Step::MergeByDistance`] | makes vertices one that are close to each other | |
//! | [`Step::Coplanar`] | triangulates flat regions anew by their outlines | Eberly 2002; Lawson 1977 |
//! | [`Step::Decimate`] | collapses edges, to a budget of triangles or an error | Garland and Heckbert 1997 |
//! | [`Step::ReTile`] | spreads points over the surface and makes them its vertices | Turk 1992 |
//!
//! ```
//! use isostudy_finish::{Density, Extent, Step};
//! use isostudy_mesh::TriangleMesh;
//! use isostudy_mesh::glam::Vec3;
//!
//! // A square of four triangles round its middle.
//! let positions = [[0., 0., 0.], [2., 0., 0.], [2., 2., 0.], [0., 2., 0.], [1., 1., 0.]].map(Vec3::from).to_vec();
//! let triangles = vec![[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]];
//! let mesh = TriangleMesh { positions, triangles, ..TriangleMesh::default() };
//! let flat = Step::Coplanar { tolerance: 0.0 }.apply(&mesh, Extent::Whole)?;
//! assert_eq!(flat.mesh.triangles.len(), 2);
//! let step = Step::ReTile { points: 4, by: Density::Area, seed: 0 };
//! assert!(step.apply(&mesh, Extent::Whole).is_err(), "the four corners of its border stay");
//! # Ok::<(), isostudy_finish::FinishError>(())
//! ```
//!
//! # Guaranteed
//!
//! - The same mesh and settings give the same bytes. Steps run on the calling thread.
//! - Coplanar, decimate and re-tile leave the topology as it is: components, genus, borders and faults.
//! - Where a step cannot do what was asked it says so with a place ([`Stopped`]), and its mesh is whole.
//! - With [`Extent::Chunk`], vertices of borders stay where they are, to the bit.
//!
//! # Not guaranteed
//!
//! - Merging may join what was apart, and make edges of four triangles.
//! - No step looks for triangles that pass through each other; [`isostudy_mesh::self_intersections`] counts them.
//! - An error of decimate is a root mean square over planes. The largest distance is some multiple of it.

mod coplanar;
mod decimate;
mod error;
mod merge;
mod outcome;
mod quadric;
mod retile;
#[cfg(test)]
mod shapes;
mod step;
mod surface;
#[cfg(test)]
mod tests;

pub use error::{FinishError, SettingError};
pub use outcome::{Extent, Finished, Stopped};
pub use retile::Density;
pub use step::{MOST_POINTS, Step, finish};
