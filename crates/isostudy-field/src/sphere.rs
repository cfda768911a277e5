//! The sphere of the evaluation.

use glam::{DVec3, Vec3};
use isostudy_mesh::Bounds;
use isostudy_mesh::metro::Foot;

use super::{StudyField, has_sound_lengths};

/// A ball round the origin: `f(p) = radius - |p|`, the exact signed distance, positive inside.
///
/// Source: Costen (2026), evaluation object "sphere", with radius 1 in the box from -1 to 1. There the surface
/// touches the box at six points, and rounding decides each of them; see `isostudy_extract::Positions`.
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

impl StudyField for Sphere {
    fn sample(&self, p: Vec3) -> f32 {
        self.radius - p.length()
    }

    fn slope(&self, bounds: Bounds) -> Option<f32> {
        has_sound_lengths(bounds).then_some(1.0)
    }

    fn gradient(&self, p: Vec3) -> Option<Vec3> {
        Some(-p.normalize_or_zero())
    }

    /// Known while the isosurface is a sphere: where `isovalue` is below the radius.
    fn nearest_on_isosurface(&self, p: DVec3, isovalue: f32) -> Option<Foot> {
        let radius = f64::from(self.radius) - f64::from(isovalue);
        let position = p.normalize_or(DVec3::X) * radius;
        let distance = (p.length() - radius).abs();
        (radius > 0.0 && distance.is_finite()).then_some(Foot { position, distance })
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

    #[test]
    fn the_isosurface_is_a_sphere_with_the_isovalue_less() {
        let near = |p, isovalue| Sphere { radius: 2.0 }.nearest_on_isosurface(p, isovalue);
        let p = DVec3::new(3.0, 0.0, 4.0);
        let foot = near(p, 0.5).unwrap();
        assert!((foot.distance - 3.5).abs() < 1e-15);
        assert!(foot.position.distance(p * 0.3) < 1e-15);
        assert_eq!(near(DVec3::ZERO, 0.0).unwrap().distance, 2.0);
        assert!(near(p, 2.0).is_none() && near(DVec3::splat(f64::NAN), 0.0).is_none());
    }
}
