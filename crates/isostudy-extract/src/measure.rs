//! How near meshes are to the isosurface, and to each other.

mod accuracy;
mod cells_with_surface;
mod crossings;
mod distances;
mod isosurface;
mod lines;
mod normal_errors;
mod sharp_edges;
mod triangle_distances;

pub use accuracy::{Accuracy, IsosurfacePoints, accuracy, accuracy_beside};
pub use distances::{DistanceError, distances};
pub use normal_errors::normal_errors_deg;
pub use triangle_distances::triangle_distances;
