//! Points spread over triangles evenly by area.

use std::ops::Range;

use glam::{DVec3, Vec3};

/// `count` points on triangles, spread over their area without clusters or gaps.
///
/// Point `i` lies `(i + u) / count` of the way through the area, triangle after triangle, so a triangle with the share
/// `s` of the area has `count * s` points, rounded up or down; its place in the triangle follows a low-discrepancy
/// sequence (Roberts 2018: the fractional parts of multiples of `1/g` and `1/g^2`, where `g^3 = g + 1`) from a start of
/// its own. `u` and the start follow from the seed and are uniform over seeds: a mean over the points is an unbiased
/// estimate of the mean over the area.
#[derive(Debug, Clone)]
pub struct AreaSamples<'a> {
    triangles: &'a [[Vec3; 3]],
    /// How much of the area there is up to each triangle's end.
    ends: Vec<f64>,
    count: u64,
    offset: f64,
    start: [f64; 2],
}

const SEQUENCE: [f64; 2] = [0.754_877_666_246_692_7, 0.569_840_290_998_053_2];

impl<'a> AreaSamples<'a> {
    /// The points for a seed; none if the triangles have no area, or not a finite one.
    pub fn new(triangles: &'a [[Vec3; 3]], count: u64, seed: u64) -> Self {
        let mut sum = 0.0;
        let ends: Vec<f64> = triangles
            .iter()
            .map(|t| {
                sum += area(t);
                sum
            })
            .collect();
        let count = if sum > 0.0 && sum.is_finite() { count } else { 0 };
        let mut state = seed;
        let [offset, u, v] = std::array::from_fn(|_| unit(&mut state));
        Self { triangles, ends, count, offset, start: [u, v] }
    }

    /// How many points there are.
    pub fn count(&self) -> u64 {
        self.count
    }

    /// The area of all triangles.
    pub fn area(&self) -> f64 {
        self.ends.last().copied().unwrap_or(0.0)
    }

    /// Some of the points, in order.
    pub fn points(&self, range: Range<u64>) -> impl Iterator<Item = DVec3> + '_ {
        let place = |i: u64| (i as f64 + self.offset) / self.count as f64 * self.area();
        let last = self.ends.len().saturating_sub(1);
        let mut t = self.ends.partition_point(|&end| end <= place(range.start)).min(last);
        (range.start..range.end.min(self.count)).map(move |i| {
            while t < last && self.ends[t] <= place(i) {
                t += 1;
            }
            let [a, b, c] = self.triangles[t].map(|corner| corner.as_dvec3());
            let [mut u, mut v] = std::array::from_fn(|k| (self.start[k] + i as f64 * SEQUENCE[k]).fract());
            // The far half of the parallelogram is the triangle mirrored.
            if u + v > 1.0 {
                (u, v) = (1.0 - u, 1.0 - v);
            }
            a + (b - a) * u + (c - a) * v
        })
    }
}

fn area(triangle: &[Vec3; 3]) -> f64 {
    let [a, b, c] = triangle.map(|corner| corner.as_dvec3());
    0.5 * (b - a).cross(c - a).length()
}

/// The next number in 0..1 of the generator splitmix64 (Steele, Lea & Flood 2014).
fn unit(state: &mut u64) -> f64 {
    *state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let mut z = *state;
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::vec3;
    use proptest::prelude::*;

    #[test]
    fn the_generator_is_splitmix64() {
        // The first outputs for the seed 1234567, as listed with Vigna's reference implementation in C
        // (prng.di.unimi.it/splitmix64.c): 6457827717110365317 and 3203168211198807973.
        let mut state = 1_234_567;
        for output in [6_457_827_717_110_365_317u64, 3_203_168_211_198_807_973] {
            assert_eq!(unit(&mut state), (output >> 11) as f64 / 9_007_199_254_740_992.0);
        }
    }

    /// A square of side 1 in the plane z = 0, of two triangles with the areas 3/8 and 1/8 and a third with 1/2.
    const SQUARE: [[Vec3; 3]; 3] = [
        [vec3(0.0, 0.0, 0.0), vec3(1.0, 0.0, 0.0), vec3(1.0, 0.75, 0.0)],
        [vec3(0.0, 0.0, 0.0), vec3(1.0, 0.75, 0.0), vec3(1.0, 1.0, 0.0)],
        [vec3(0.0, 0.0, 0.0), vec3(1.0, 1.0, 0.0), vec3(0.0, 1.0, 0.0)],
    ];

    #[test]
    fn sums_over_a_square_converge_as_for_an_even_sequence() {
        for seed in 0..20 {
            let samples = AreaSamples::new(&SQUARE, 4_000, seed);
            assert_eq!((samples.count(), samples.area()), (4_000, 1.0));
            let points: Vec<DVec3> = samples.points(0..4_000).collect();
            let mean = |f: fn(DVec3) -> f64| points.iter().map(|&p| f(p)).sum::<f64>() / 4_000.0;
            // Independent points would be off by 1 / sqrt(12 * 4000) = 0.0046.
            for (found, want) in [
                (mean(|p| p.x), 1.0 / 2.0),
                (mean(|p| p.y), 1.0 / 2.0),
                (mean(|p| p.x * p.x), 1.0 / 3.0),
                (mean(|p| p.x * p.y), 1.0 / 4.0),
            ] {
                assert!((found - want).abs() < 0.002, "seed {seed}: {found} is not {want}");
            }
        }
    }

    #[test]
    fn a_mean_over_seeds_has_no_bias() {
        // Three points a seed see little of the square; their mean over many seeds must still be that over the area.
        let seeds = 40_000;
        let sum: DVec3 = (0..seeds)
            .flat_map(|seed| AreaSamples::new(&SQUARE, 3, seed).points(0..3).collect::<Vec<_>>())
            .map(|p| DVec3::new(p.x, p.x * p.y, p.y * p.y))
            .sum();
        let mean = sum / (3.0 * seeds as f64);
        // Five standard errors of independent points at most.
        assert!((mean - DVec3::new(0.5, 0.25, 1.0 / 3.0)).abs().max_element() < 0.0043, "{mean}");
    }

    proptest! {
        /// Every triangle has its share, up to one point; and any part of the sequence is the same part.
        #[test]
        fn shares_and_parts(heights in prop::collection::vec(0.0..1.0f32, 1..30), count in 1..500u64, seed: u64, cut in 0..500u64) {
            prop_assume!(heights.iter().any(|&h| h > 0.0));
            let triangles: Vec<[Vec3; 3]> = heights.iter().enumerate().map(|(i, &h)| {
                let x = 2.0 * i as f32;
                [vec3(x, 0.0, 0.0), vec3(x + 1.0, 0.0, 0.0), vec3(x, h, 0.0)]
            }).collect();
            let samples = AreaSamples::new(&triangles, count, seed);
            let points: Vec<DVec3> = samples.points(0..count).collect();
            prop_assert_eq!(points.len() as u64, count);
            for (i, &h) in heights.iter().enumerate() {
                let found = points.iter().filter(|p| (p.x / 2.0) as usize == i).count() as f64;
                let share = count as f64 * f64::from(h) * 0.5 / samples.area();
                prop_assert!((found - share).abs() < 1.0 + 1e-9, "{} of {}", found, share);
            }
            let cut = cut.min(count);
            let parts: Vec<DVec3> = samples.points(0..cut).chain(samples.points(cut..count)).collect();
            prop_assert_eq!(parts, points);
        }
    }
}
