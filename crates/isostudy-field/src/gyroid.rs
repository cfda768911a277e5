//! A surface that fills space.

use glam::Vec3;
use isostudy_mesh::Bounds;

use super::StudyField;

/// Schoen's gyroid in the usual trigonometric form: `sin x cos y + sin y cos z + sin z cos x`, all coordinates times
/// `frequency`. Two labyrinths of equal size; one of them is inside.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gyroid {
    /// Radians a unit of length: a period is 2 pi of them.
    pub frequency: f32,
}

impl Default for Gyroid {
    /// Three periods in a box of side 2.
    fn default() -> Self {
        Self { frequency: 3.0 * std::f32::consts::PI }
    }
}

impl StudyField for Gyroid {
    fn sample(&self, p: Vec3) -> f32 {
        let mut value = [0.0];
        self.sample_row(&[p.x], p.y, p.z, &mut value);
        value[0]
    }

    fn sample_row(&self, x: &[f32], y: f32, z: f32, values: &mut [f32]) {
        let sine_and_cosine = |v: f32| (libm::sinf(v * self.frequency), libm::cosf(v * self.frequency));
        let ((sy, cy), (sz, cz)) = (sine_and_cosine(y), sine_and_cosine(z));
        for (value, &x) in values.iter_mut().zip(x) {
            let (sx, cx) = sine_and_cosine(x);
            *value = sx * cy + sy * cz + sz * cx;
        }
    }

    fn gradient(&self, p: Vec3) -> Option<Vec3> {
        let [(sx, cx), (sy, cy), (sz, cz)] =
            p.to_array().map(|v| (libm::sinf(v * self.frequency), libm::cosf(v * self.frequency)));
        Some(Vec3::new(cx * cy - sz * sx, cy * cz - sx * sy, cz * cx - sy * sz) * self.frequency)
    }

    /// Each partial derivative lies between -1 and 1 times the frequency.
    fn slope(&self, bounds: Bounds) -> Option<f32> {
        let is_sound = bounds.min.is_finite() && bounds.max.is_finite() && self.frequency.is_finite();
        let farthest = bounds.min.abs().max(bounds.max.abs()).max_element() * self.frequency.abs();
        // Far out the rounding of the argument would show.
        (is_sound && farthest < 50.0).then_some(1.7321 * self.frequency.abs())
    }
}
