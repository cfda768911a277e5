//! Surfaces in four dimensions: a series of volumes is one grid, and its isosurface is a solid of tetrahedra in space-time.
//!
//! ```
//! use isostudy_four::{Placement, Series};
//!
//! // A ball that grows and shrinks: a sphere in four dimensions.
//! let frame = |time: f32| -> Vec<f32> {
//!     let square = |i: usize| (i as f32 - 4.0).powi(2);
//!     let value = |n: usize| 9.0 - square(n % 9) - square(n / 9 % 9) - square(n / 81) - (time - 4.0).powi(2);
//!     (0..729).map(value).collect()
//! };
//! let series = Series::try_new(Placement::unit([9; 3]), (0..9).map(|n| frame(n as f32)).collect())?;
//!
//! let space_time = series.extract(0.0)?;
//! assert!(!space_time.tetrahedra.is_empty());
//! // The surface at a time between frames 4 and 5.
//! let mesh = space_time.slice(4.25)?;
//! assert_eq!(mesh, series.slice(0.0, 4.25)?);
//! assert!(isostudy_mesh::topology::topology(&mesh).is_closed_manifold());
//! // At a whole frame it is the mesh of that frame.
//! assert_eq!(series.slice(0.0, 4.0)?, isostudy_four::surface(series.placement(), &series.frames()[4], 0.0)?);
//! # Ok::<(), isostudy_four::FourError>(())
//! ```
//!
//! [`interval_volume`] is the solid between two isovalues of one volume, made in the same way: the two isovalues are two frames.
//!
//! # Guaranteed
//!
//! - Inside is above the isovalue. A sample that equals it is outside.
//! - The surface in space-time is a 3-manifold, and each slice is a manifold of triangles that face the lower values. They are closed
//!   but for the sides of the lattice.
//! - Orders of vertices and triangles do not depend on the number of threads.
//! - A NaN, an infinite sample, or frames of different sizes are an error that says where.
//!
//! # Not guaranteed
//!
//! - The topology of an interpolant. Where inside and outside samples alternate in a cell, the hull joins those inside.
//! - Simplices with content. A sample that equals the isovalue has several vertices in its place.
//! - Memory: a series is held in memory, and [`Series::extract_bytes`] says what the surface takes.
//!
//! # Sources
//!
//! - P. Bhaniramka, R. Wenger, R. Crawfis: Isosurfacing in higher dimensions. IEEE Visualization (2000).
//! - P. Bhaniramka, R. Wenger, R. Crawfis: Isosurface construction in any dimension using convex hulls. IEEE TVCG 10 (2004). The rule,
//!   its proof, and solids between two isovalues.

mod cells;
mod crossings;
mod cube;
mod error;
mod hull;
mod interval;
mod placement;
mod pulling;
mod series;
mod slicing;
mod space_time;
mod surface;
mod table;
mod vtk;

pub use cube::{Cube, Edge};
pub use error::FourError;
pub use interval::{Solid, interval_bytes, interval_volume};
pub use placement::Placement;
pub use series::Series;
pub use space_time::SpaceTime;
pub use surface::surface;
pub use table::Table;
