//! Scalar fields: what is sampled.

mod asteroid;
mod mesh_distance;
mod sine;
mod sphere;

pub use asteroid::Asteroid;
pub use mesh_distance::{MeshDistance, MeshFieldError};
pub use sphere::Sphere;

use glam::Vec3;

/// A real function of space. A point is inside the solid where the value is above the isovalue.
///
/// A field must give the same value for the same point every time; then the mesh is the same every time.
/// `NaN` is allowed and counts as outside.
pub trait ScalarField: Sync {
    /// The value at `p`.
    fn sample(&self, p: Vec3) -> f32;

    /// The values at `(x[i], y, z)` into `values[i]`, for a row of the lattice.
    ///
    /// Must agree with [`sample`](Self::sample) to the bit; override it only to share work along the row.
    /// The two slices have the same length.
    fn sample_row(&self, x: &[f32], y: f32, z: f32, values: &mut [f32]) {
        for (value, &x) in values.iter_mut().zip(x) {
            *value = self.sample(Vec3::new(x, y, z));
        }
    }
}
