//! Scalar fields from scattered data: points with normals, and triangles that need not hang together.
//!
//! | field | of | value |
//! |---|---|---|
//! | [`PointField`] | a [`PointCloud`] with normals | a polyharmonic spline, 0 at the points, positive inside |
//! | [`SoupField`] | the triangles of a mesh, whatever their topology | the mean of signed distances to their planes, by nearness; positive inside |
//!
//! [`Polyharmonic`] is the spline alone, of any values at points. [`read_points`] reads points, [`estimate_normals`] makes normals
//! where there are none.
//!
//! # Guaranteed
//!
//! - Values are computed in double precision, from scratch: the value at a point is the same on any thread and after any
//!   other point, and a row has those of its points, to the bit. Nothing uses the platform's mathematics.
//! - Gradients are those of the formula, not differences of values.
//! - Readers return an error that says where, whatever the bytes.
//!
//! # Not guaranteed
//!
//! - Nothing is said of the values in a box: neither field has a slope or a range. So an extractor takes every sample.
//!   The sum of a spline's weights bounds its slope, but weights on and beside the surface have opposite signs, and most of them
//!   cancel: too high a bound to save any.
//! - The surface spans holes smoothly, and may leave the data where there is none.

mod estimated_normals;
mod nearest_points;
mod point_field;
mod points;
mod polyharmonic;
mod soup;

pub use estimated_normals::estimate_normals;
pub use point_field::{PointField, PointFieldError, PointSettings};
pub use points::{PointCloud, PointFormat, PointsError, read_points};
pub use polyharmonic::{FitError, FitReport, FitSettings, Kernel, MOST_CENTRES, Polyharmonic};
pub use soup::{FlatTriangles, SoupError, SoupField};
