//! Hills with overhangs and no end, and the holes that were dug into them.

use isostudy_extract::{Aabb, Bound, ScalarField};

/// Values farther from the surface than this are cut off, in metres: a hole changes the field near by and nowhere else.
const DEEPEST: f32 = 4.0;
/// No hill is higher, and no valley deeper.
const HIGHEST: f32 = 26.0;
/// The value changes by no more per metre: hills 1.21, ripples 1.35, height 1.
const STEEPEST: f32 = 3.6;

/// A ball that was dug.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hole {
    /// In metres.
    pub centre: [f32; 3],
    /// In metres.
    pub radius: f32,
}

impl Hole {
    /// Positive outside.
    fn distance(&self, p: [f32; 3]) -> f32 {
        let away = |axis: usize| (p[axis] - self.centre[axis]).powi(2);
        (away(0) + away(1) + away(2)).sqrt() - self.radius
    }

    /// Beyond this box, digging it changes no value.
    pub(crate) fn reach(&self) -> Aabb {
        Aabb::around(self.centre, (self.radius + DEEPEST) * 1.001)
    }
}

/// The ground.
#[derive(Debug, Clone, Default)]
pub struct Ground {
    /// In any order.
    pub(crate) holes: Vec<Hole>,
}

impl Ground {
    /// Where the ground begins, from above.
    pub fn height(&self, x: f32, y: f32) -> f32 {
        let mut z = HIGHEST;
        while self.sample([x, y, z]) <= 0.0 && z > -2.0 * HIGHEST {
            z -= 0.25;
        }
        z
    }
}

impl ScalarField for Ground {
    /// Positive in the ground.
    fn sample(&self, p: [f32; 3]) -> f32 {
        let [x, y, z] = p;
        let hills =
            18.0 * (0.021 * x).sin() * (0.017 * y).cos() + 5.0 * (0.11 * x + 1.0).sin() * (0.093 * y).sin();
        let ripples = 2.5 * (0.31 * x).sin() * (0.29 * y).sin() * (0.33 * z).sin();
        let ground = (hills + ripples - z).clamp(-DEEPEST, DEEPEST);
        self.holes.iter().fold(ground, |value, hole| value.min(hole.distance(p)))
    }

    fn bound(&self, b: Aabb) -> Bound {
        let mut least = (-HIGHEST - b.max[2]).clamp(-DEEPEST, DEEPEST);
        let greatest = (HIGHEST - b.min[2]).clamp(-DEEPEST, DEEPEST);
        for hole in &self.holes {
            // The nearest point of the box to the middle of the hole.
            let near = std::array::from_fn(|axis| hole.centre[axis].clamp(b.min[axis], b.max[axis]));
            least = least.min(hole.distance(near) - 1e-3);
        }
        Bound::range(least, greatest).with_slope(STEEPEST)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use isostudy_extract::check_field;

    #[test]
    fn the_ground_keeps_what_it_promises() {
        let world = Aabb { min: [-300.0, -300.0, -60.0], max: [300.0, 300.0, 60.0] };
        let mut ground = Ground::default();
        check_field(&ground, world, 2000).unwrap();
        ground.holes.push(Hole { centre: [3.0, 4.0, ground.height(3.0, 4.0)], radius: 5.0 });
        check_field(&ground, world, 2000).unwrap();
        check_field(&ground, Aabb::around([3.0, 4.0, 5.0], 20.0), 2000).unwrap();
    }
}
