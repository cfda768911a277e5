//! Hills with overhangs and no end, and the holes that were dug into them: a field of a game.

use glam::{DVec3, Vec3};
use isostudy_extract::{Aabb, Bound, ScalarField};
use isostudy_field::{NOISE_SLOPE, noise, noise_range};

/// Values farther from the surface than this are cut off, in units: an edit changes the field near by and nowhere else.
const DEEPEST: f32 = 4.0;
/// Height of a wave of the ground, its length, and the seed of its noise.
const WAVES: [(f64, f64, u32); 2] = [(22.0, 80.0, 7), (5.0, 21.0, 11)];

/// A hole, once it is dug.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Hole {
    /// In units of the world.
    pub(crate) centre: [f32; 3],
    /// In the same.
    pub(crate) radius: f32,
}

impl Hole {
    /// Positive outside.
    fn distance(&self, p: [f32; 3]) -> f32 {
        Vec3::from(p).distance(Vec3::from(self.centre)) - self.radius
    }

    /// Beyond this box, digging it changes no value: outside, a hole is cut off as the ground is.
    pub(crate) fn reach(&self) -> Aabb {
        Aabb::around(self.centre, (self.radius + DEEPEST) * 1.001)
    }
}

/// The ground with some holes: of all that were dug, those that can matter where it is sampled.
#[derive(Debug, Default)]
pub(crate) struct Ground {
    /// In any order.
    pub(crate) holes: Vec<Hole>,
}

impl Ground {
    /// Before anything was dug. Positive inside.
    fn undug(p: [f32; 3]) -> f32 {
        let at = Vec3::from(p).as_dvec3();
        let height: f64 = WAVES.iter().map(|&(height, length, seed)| height * noise(at / length, seed)).sum();
        (height - at.z) as f32
    }

    /// Where the ground begins, from above.
    pub(crate) fn height(&self, x: f32, y: f32) -> f32 {
        let mut z = 40.0;
        while self.sample([x, y, z]) <= 0.0 && z > -60.0 {
            z -= 0.25;
        }
        z
    }
}

impl ScalarField for Ground {
    fn sample(&self, p: [f32; 3]) -> f32 {
        let value = Self::undug(p).clamp(-DEEPEST, DEEPEST);
        self.holes.iter().fold(value, |value, hole| value.min(hole.distance(p)))
    }

    /// A distance changes as fast as one walks, and the ground no faster than its waves together.
    fn bound(&self, bounds: Aabb) -> Bound {
        let slope: f64 = WAVES.iter().map(|(height, length, _)| height * NOISE_SLOPE / length).sum();
        let [low, high] = [bounds.min, bounds.max].map(|p| Vec3::from(p).as_dvec3());
        let mut range = (-high.z, -low.z);
        for (height, length, seed) in WAVES {
            let (least, greatest) = noise_range(low / length, high / length, seed);
            range = (range.0 + height * least, range.1 + height * greatest);
        }
        // A hole takes away, and no more than down to its middle.
        let deepest = f64::from(DEEPEST);
        let mut least = range.0.clamp(-deepest, deepest);
        let mut greatest = range.1.clamp(-deepest, deepest);
        for hole in &self.holes {
            let centre = Vec3::from(hole.centre).as_dvec3();
            let radius = f64::from(hole.radius);
            let near = centre.clamp(low, high).distance(centre) - radius;
            let far = (centre - low).abs().max((centre - high).abs()).length() - radius;
            least = least.min(near - 1e-4);
            greatest = greatest.min(far + 1e-4);
        }
        let slack = DVec3::splat(1e-4).x;
        Bound::range((least - slack) as f32, (greatest + slack) as f32).with_slope(1.0 + slope as f32)
    }
}
