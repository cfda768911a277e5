//! Isosurfaces by an advancing front: triangles grown over the surface, one edge length after the other.
//!
//! [`grow`] takes any [`StudyField`](isostudy_field::StudyField), a box and a [`Front`], and gives a closed manifold, or an
//! error with the place. There is no lattice: vertices lie on the surface by Newton's method.
//!
//! ```
//! use isostudy_field::Sphere;
//! use isostudy_front::{Front, grow};
//! use isostudy_mesh::glam::Vec3;
//! use isostudy_mesh::{Bounds, topology::topology};
//!
//! let bounds = Bounds { min: Vec3::splat(-1.1), max: Vec3::splat(1.1) };
//! let grown = grow(&Sphere { radius: 1.0 }, bounds, 0.0, &Front::of_edge(0.1))?;
//! let report = topology(&grown.mesh);
//! assert!(report.is_closed_manifold());
//! assert_eq!(report.euler_characteristic, 2);
//! # Ok::<(), isostudy_front::FrontError>(())
//! ```
//!
//! # How
//!
//! 1. Marching squares on the box's faces finds the closed curves in which the surface leaves the box. They are the first
//!    fronts, and the mesh is open there alone.
//! 2. Each edge of the front gets a triangle: with a new point where there is room, or else with the vertex of the front under
//!    which the edge is seen at the largest angle. That vertex may lie on any part of the front. So fronts split and merge
//!    without a list of cases, and the genus is no matter.
//! 3. A part that is clear of the box's faces is begun at a seed.
//! 4. Where nothing fits, the triangles round the place are taken away, and grown again with half the length, up to four times.
//!    A border that is too coarse makes all begin again. Loops that are left at the end are closed with triangles of least area.
//!
//! # Guaranteed
//!
//! - The mesh is an oriented manifold. Its open edges lie on the box's faces, with both ends.
//! - Vertices are roots along the field's gradient, known to about a millionth of an edge where the field is smooth.
//! - The same field, box, isovalue and settings give the same mesh, to the byte. All is done on one thread.
//! - Steps, repairs and triangles are bounded. An error names the place.
//!
//! # Not guaranteed
//!
//! - A part is missing if no seed meets it: with [`Seeds::Sampled`] such as no edge of the coarse grid crosses, on the box's faces such
//!   as are smaller than half an edge.
//! - A neck that is narrower than an edge may be cut off, and nothing says so.
//! - Edges of the surface, as of a building, get no edges of triangles. Triangles there may be thin, and a surface with many of them
//!   is often refused ([`FrontError::Unclosed`]).
//! - There is no bound for angles. Triangles may intersect each other where sheets are nearer than the edges are long.
//!
//! # Sources
//!
//! - E. Hartmann: A marching method for the triangulation of surfaces. The Visual Computer 14 (1998), 95-108: the front, the
//!   angle that is shared by triangles of about 60 degrees, Newton's method.
//! - T. Karkanis, A. J. Stewart: Curvature-dependent triangulation of implicit surfaces. IEEE Computer Graphics and
//!   Applications 21 (2001), 60-69: lengths by curvature.
//! - J. Schreiner, C. Scheidegger, C. Silva: High-quality extraction of isosurfaces from regular and irregular grids. IEEE
//!   Transactions on Visualization and Computer Graphics 12 (2006), 1205-1212: the guidance field, whose lengths grow slowly.

mod border;
mod error;
mod grow;
mod holes;
mod near;
mod patch;
mod probe;
mod samples;
mod settings;
mod sizes;
mod step;

pub use error::FrontError;
pub use grow::{Grown, grow};
pub use settings::{Counts, Front, Seeds, Sizing};
