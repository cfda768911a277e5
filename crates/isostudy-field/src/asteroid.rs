//! The asteroid of the evaluation: a flattened ball with value noise on its directions.

use glam::{DVec3, Vec3};

use crate::sine::sin;

mod field;
mod table;

/// A lumpy ball: `f(p) = radius - |p/k| + amplitude * fbm(frequency * ((p/|p|)/k))`, `/k` by component.
///
/// The noise depends on the direction alone, so every ray from the origin leaves the solid once. It is a sum of
/// octaves of value noise, smoothly blended between hashed whole-number points, scaled to [-1, 1]. All arithmetic
/// is in `f32`, operation by operation, with a sine of the crate's own: the field is the same on every machine. The
/// hash multiplies that sine by 43758.5, so another library's last bit moves it by up to 0.003.
///
/// Source: Costen (2026), evaluation object "asteroid"; [`Default`] gives its parameters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Asteroid {
    /// Radius without noise; also the value at the origin, where the formula is 0/0.
    pub radius: f32,
    /// Stretch `k` of each axis.
    pub stretch: Vec3,
    /// Largest change of the radius by the noise.
    pub amplitude: f32,
    /// Noise frequency of the first octave, in features a unit direction.
    pub frequency: f32,
    /// How many octaves are summed; those whose amplitude `gain` brings to 0 in single precision are left out. Each
    /// costs time at every sample.
    pub octaves: u32,
    /// Frequency ratio of an octave to the one before.
    pub lacunarity: f32,
    /// Amplitude ratio of an octave to the one before.
    pub gain: f32,
}

impl Default for Asteroid {
    fn default() -> Self {
        Self {
            radius: 0.65,
            stretch: Vec3::new(0.9, 1.0, 0.9),
            amplitude: 0.35,
            frequency: 1.5,
            octaves: 3,
            lacunarity: 3.0,
            gain: 0.15,
        }
    }
}

impl Asteroid {
    /// The formula at `p`.
    fn value(&self, p: Vec3) -> f32 {
        let distance = p.length();
        if distance == 0.0 {
            return self.radius;
        }
        let direction = (p / distance) / self.stretch;
        (self.radius - (p / self.stretch).length()) + self.amplitude * self.noise(direction * self.frequency)
    }

    /// By the chain rule, in double precision but for the hashes.
    fn gradient_at(&self, p: Vec3) -> Option<Vec3> {
        let (p, stretch) = (p.as_dvec3(), self.stretch.as_dvec3());
        let distance = p.length();
        let direction = p / distance;
        let frequency = f64::from(self.frequency);
        let of_noise = self.noise_gradient((direction / stretch * frequency).as_vec3()) * frequency / stretch;
        let across = (of_noise - direction * direction.dot(of_noise)) / distance;
        let ball = p / (stretch * stretch) / (p / stretch).length();
        // At the origin it is not a number, and there is none.
        Some((across * f64::from(self.amplitude) - ball).as_vec3()).filter(|gradient| gradient.is_finite())
    }

    /// Octaves of value noise at `q`, as their weighted mean: within [-1, 1].
    fn noise(&self, q: Vec3) -> f32 {
        let (mut sum, mut weights) = (0.0, 0.0);
        let (mut weight, mut frequency) = (1.0, 1.0);
        for _ in 0..self.octaves {
            if weight == 0.0 {
                break;
            }
            sum += value_noise(q * frequency) * weight;
            weights += weight;
            frequency *= self.lacunarity;
            weight *= self.gain;
        }
        if weights == 0.0 { 0.0 } else { sum / weights }
    }

    fn noise_gradient(&self, q: Vec3) -> DVec3 {
        let (mut sum, mut weights) = (DVec3::ZERO, 0.0);
        let (mut weight, mut frequency) = (1.0, 1.0);
        for _ in 0..self.octaves {
            if weight == 0.0 {
                break;
            }
            sum += value_noise_gradient(q * frequency) * f64::from(frequency * weight);
            weights += f64::from(weight);
            frequency *= self.lacunarity;
            weight *= self.gain;
        }
        if weights == 0.0 { DVec3::ZERO } else { sum / weights }
    }
}

/// Smoothly interpolated hashes of the eight whole-number points round `q`, scaled from [0, 1) to [-1, 1).
fn value_noise(q: Vec3) -> f32 {
    let base = Vec3::new(libm::floorf(q.x), libm::floorf(q.y), libm::floorf(q.z));
    let t = q - base;
    let w = t * t * (Vec3::splat(3.0) - Vec3::splat(2.0) * t);
    let along_x = |dy: f32, dz: f32| {
        let left = hash(base + Vec3::new(0.0, dy, dz));
        let right = hash(base + Vec3::new(1.0, dy, dz));
        blend(left, right, w.x)
    };
    let near = blend(along_x(0.0, 0.0), along_x(1.0, 0.0), w.y);
    let far = blend(along_x(0.0, 1.0), along_x(1.0, 1.0), w.y);
    blend(near, far, w.z) * 2.0 - 1.0
}

/// Of the interpolated hashes: on each axis the difference of two faces of the unit cell, times how fast the blend goes.
fn value_noise_gradient(q: Vec3) -> DVec3 {
    let base = Vec3::new(libm::floorf(q.x), libm::floorf(q.y), libm::floorf(q.z));
    let t = (q - base).as_dvec3();
    let high = t * t * (DVec3::splat(3.0) - 2.0 * t);
    let weights = [DVec3::ONE - high, high];
    let steepness = 6.0 * t * (DVec3::ONE - t);
    let mut gradient = DVec3::ZERO;
    for corner in 0..8 {
        let side = [corner & 1, corner >> 1 & 1, corner >> 2];
        let hash = f64::from(hash(base + Vec3::from_array(side.map(|side| side as f32))));
        for axis in 0..3 {
            let [a, b] = [(axis + 1) % 3, (axis + 2) % 3];
            let sign = if side[axis] == 1 { 1.0 } else { -1.0 };
            gradient[axis] += sign * hash * weights[side[a]][a] * weights[side[b]][b];
        }
    }
    gradient * steepness * 2.0
}

/// A fraction in [0, 1) for a whole-number point.
fn hash(point: Vec3) -> f32 {
    let scaled = sin(point.dot(Vec3::new(12.98, 78.23, 35.63))) * 43758.5;
    scaled - libm::floorf(scaled)
}

#[inline(always)]
fn blend(a: f32, b: f32, weight: f32) -> f32 {
    a + (b - a) * weight
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn origin_has_the_plain_radius() {
        assert_eq!(Asteroid::default().value(Vec3::ZERO), 0.65);
    }

    #[test]
    fn noise_is_the_hash_at_whole_numbers_and_blends_between() {
        let (a, b) = (Vec3::new(2.0, -3.0, 1.0), Vec3::new(3.0, -3.0, 1.0));
        assert_eq!(value_noise(a), hash(a) * 2.0 - 1.0);
        let middle = value_noise(a.midpoint(b));
        assert!((middle - (hash(a) + hash(b) - 1.0)).abs() < 1e-6, "{middle}");
    }

    #[test]
    fn radius_stays_within_the_amplitude() {
        let asteroid = Asteroid { stretch: Vec3::ONE, ..Asteroid::default() };
        for i in 0..500 {
            let angle = i as f32 * 0.7;
            let p = Vec3::new(angle.cos(), angle.sin(), (i as f32 - 250.0) / 100.0);
            let bump = asteroid.value(p) - (asteroid.radius - p.length());
            assert!(bump.abs() <= asteroid.amplitude + 1e-5, "{bump} at {p}");
        }
    }

    #[test]
    fn octaves_without_weight_are_left_out() {
        let asteroid = |octaves| Asteroid { octaves, lacunarity: 1.0, ..Asteroid::default() };
        let p = Vec3::new(0.3, -0.4, 0.2);
        assert_eq!(asteroid(u32::MAX).value(p), asteroid(100).value(p));
    }

    #[test]
    fn no_octaves_leave_the_plain_ball() {
        let ball = Asteroid { octaves: 0, stretch: Vec3::ONE, ..Asteroid::default() };
        assert_eq!(ball.value(Vec3::X), 0.65 - 1.0);
    }
}
