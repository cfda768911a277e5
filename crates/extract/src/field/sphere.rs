//! The sphere of the evaluation.

use glam::Vec3;
use mesh::Bounds;

use super::{ScalarField, has_sound_lengths};

/// A ball round the origin: `f(p) = radius - |p|`, the exact signed distance, positive inside.
///
/// Source: Costen (2026), evaluation object "sphere", with radius 1 in the box from -1 to 1. There the surface
/// touches the box at six points, and rounding decides each of them; see [`crate::Positions`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sphere {
    /// Radius in the unit of the coordinates.
    pub radius: f32,
}

impl Default for Sphere {
    /// The unit sphere of the evaluation.
    fn default() -> Self {
        Self { radius: 1.0 }
    }
}

impl ScalarField for Sphere {
    fn sample(&self, p: Vec3) -> f32 {
        self.radius - p.length()
    }

    fn slope(&self, bounds: Bounds) -> Option<f32> {
        has_sound_lengths(bounds).then_some(1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn value_is_the_signed_distance() {
        let sphere = Sphere { radius: 2.0 };
        assert_eq!(sphere.sample(Vec3::ZERO), 2.0);
        assert_eq!(sphere.sample(Vec3::new(0.0, -2.0, 0.0)), 0.0);
        assert_eq!(sphere.sample(Vec3::new(3.0, 0.0, 4.0)), -3.0);
    }
}
