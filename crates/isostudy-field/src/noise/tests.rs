//! Bounds proven on a grid, reached by chosen gradients, and neared by a search; values by another program.

use glam::DVec3;

use super::*;

/// The most that a gradient can make of a vector: its two largest components.
fn most(v: DVec3) -> f64 {
    let v = v.abs();
    v.element_sum() - v.min_element()
}

/// What the sums over the corners, of noise and its first and second derivative along `u`, can be at most.
fn suprema(t: DVec3, u: DVec3) -> [f64; 3] {
    let second = |t: f64| 60.0 * t * (t - 1.0) * (2.0 * t - 1.0);
    let mut sums = [0.0; 3];
    for corner in 0..8 {
        let mut step = t;
        // Value, first and second derivative of the corner's weight along each axis.
        let mut axes = [[0.0; 3]; 3];
        for axis in 0..3 {
            let sign: f64 = if corner >> axis & 1 == 1 { 1.0 } else { -1.0 };
            step[axis] -= sign.max(0.0);
            let weight = if sign > 0.0 { fade(t[axis]) } else { 1.0 - fade(t[axis]) };
            axes[axis] =
                [weight, sign * fade_slope(t[axis]) * u[axis], sign * second(t[axis]) * u[axis] * u[axis]];
        }
        let [x, y, z] = axes;
        let weight = x[0] * y[0] * z[0];
        let first = x[1] * y[0] * z[0] + x[0] * y[1] * z[0] + x[0] * y[0] * z[1];
        let mixed = x[1] * y[1] * z[0] + x[1] * y[0] * z[1] + x[0] * y[1] * z[1];
        let second = x[2] * y[0] * z[0] + x[0] * y[2] * z[0] + x[0] * y[0] * z[2] + 2.0 * mixed;
        sums[0] += most(step * weight);
        sums[1] += most(u * weight + step * first);
        sums[2] += most(u * 2.0 * first + step * second);
    }
    sums
}

/// Directions on one of three faces of a cube, `n` by `n`; opposite ones give the same. None is more than `sqrt(2) / (n - 1)`
/// off the nearest, since a step on the face turns the direction by no more than its length.
fn directions(n: usize) -> Vec<DVec3> {
    let at = |i: usize| 2.0 * i as f64 / (n - 1) as f64 - 1.0;
    let face = (0..n * n).map(|i| DVec3::new(1.0, at(i % n), at(i / n)).normalize());
    face.flat_map(|v| [v, v.zxy(), v.yzx()]).collect()
}

trait Turned {
    fn zxy(self) -> Self;
    fn yzx(self) -> Self;
}

impl Turned for DVec3 {
    fn zxy(self) -> Self {
        DVec3::new(self.z, self.x, self.y)
    }
    fn yzx(self) -> Self {
        DVec3::new(self.y, self.z, self.x)
    }
}

/// Points of a grid over an eighth of the cell with `n` steps a side, of each group that turns and mirrors one another one.
fn grid(n: usize) -> impl Iterator<Item = DVec3> {
    let at = move |i: usize| 0.5 * i as f64 / n as f64;
    (0..=n)
        .flat_map(move |x| (x..=n).flat_map(move |y| (y..=n).map(move |z| DVec3::new(at(x), at(y), at(z)))))
}

#[test]
fn bounds_are_proven() {
    // By the triangle inequality, from the greatest derivatives of the fade, 1.875, 5.7736, 60 and 360, each for two
    // corners; a gradient is sqrt(2) long and a step at most sqrt(3). Greatest where u is a diagonal, or an axis.
    let weights = |u: DVec3| {
        let [s1, s2, s3, s4] = [3.75, 11.5472, 120.0, 720.0];
        let [a, b, c] = u.abs().to_array();
        let pairs = |p: i32, q: i32| {
            [(a, b), (b, c), (c, a)]
                .map(|(v, w)| v.powi(p) * w.powi(q) + v.powi(q) * w.powi(p))
                .iter()
                .sum::<f64>()
        };
        let second = s2 + s1 * s1 * pairs(1, 1);
        let third = s3 * (a.powi(3) + b.powi(3) + c.powi(3))
            + 3.0 * s2 * s1 * pairs(2, 1)
            + 6.0 * s1.powi(3) * a * b * c;
        let fourth = s4 * (a.powi(4) + b.powi(4) + c.powi(4))
            + 4.0 * s3 * s1 * pairs(3, 1)
            + 3.0 * s2 * s2 * pairs(2, 2)
            + 12.0 * s2 * s1 * s1 * a * b * c * (a + b + c);
        [second, third, fourth]
    };
    let directions = directions(17);
    let (mut third, mut fourth) = (0.0f64, 0.0f64);
    for &u in &directions {
        let [w2, w3, w4] = weights(u);
        third = third.max(6f64.sqrt() * w3 + 3.0 * 2f64.sqrt() * w2);
        fourth = fourth.max(6f64.sqrt() * w4 + 4.0 * 2f64.sqrt() * w3);
    }
    // These polynomials change by little between directions: 1,000 and 9,000 leave a tenth.
    assert!(third < 900.0 && fourth < 8_200.0, "{third} {fourth}");
    let (third, fourth) = (1_000.0, 9_000.0);

    let [h, n] = [1.0 / 64.0, 32.0];
    let mut found = [0.0f64; 3];
    for t in grid(n as usize) {
        for &u in &directions {
            let sums = suprema(t, u);
            found = std::array::from_fn(|i| found[i].max(sums[i]));
        }
    }
    let angle = 2f64.sqrt() / 16.0;
    let between = 3.0 / 8.0 * h * h;
    let curvature = (found[2] + between * fourth) / (2.0 * angle).cos();
    let slope = (found[1] + between * third) / angle.cos();
    assert!(curvature < 16.0, "{curvature}");
    assert!(slope < 3.9, "{slope}");
    assert!(curvature * SCALE <= NOISE_CURVATURE && slope * SCALE <= NOISE_SLOPE, "{slope} {curvature}");
    // The value on a finer grid: no direction is needed.
    let finer = grid(128).map(|t| suprema(t, DVec3::X)[0]).fold(0.0, f64::max);
    let value = finer + between / 16.0 * curvature;
    assert!(value < 1.0365 && value * SCALE <= 1.0, "{value}");
}

/// The gradient that makes most of a vector.
fn best(v: DVec3) -> [f64; 3] {
    let made = |g: &[f64; 3]| DVec3::from_array(*g).dot(v);
    GRADIENTS.into_iter().max_by(|a, b| made(a).total_cmp(&made(b))).unwrap()
}

/// Were the hash to choose them, some gradients would reach the bound of the value to 0.05 %, and that of the slope to 4 %.
#[test]
fn no_bound_is_much_too_large() {
    let greatest = DVec3::new(0.35, 0.475, 0.5);
    let step =
        |t: DVec3, corner: usize| t - DVec3::from_array([0, 1, 2].map(|axis| (corner >> axis & 1) as f64));
    let lowest = [0.0; 3];
    let gradients: [_; 8] = std::array::from_fn(|c| best(step(greatest, c)));
    let value = full_value(|corner| &gradients[corner], greatest.to_array());
    assert!((0.9995..=1.0).contains(&(value * SCALE)), "{value}");

    let (t, u) = (DVec3::splat(0.5), DVec3::X);
    let gradients = std::array::from_fn(|corner| {
        let sign = if corner & 1 == 1 { 1.0 } else { -1.0 };
        best(u / 8.0 + step(t, corner) * (sign * 1.875 / 4.0))
    });
    let (_, gradient) = Cell { lowest, gradients }.value_and_gradient(t.to_array());
    let share = gradient.length() * SCALE / NOISE_SLOPE;
    assert!((0.95..=1.0).contains(&share), "{share}");
}

/// Numbers between 0 and 1, the same every time.
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / 9_007_199_254_740_992.0
    }

    fn point(&mut self, size: f64) -> DVec3 {
        DVec3::new(self.next() - 0.5, self.next() - 0.5, self.next() - 0.5) * size
    }
}

/// The highest that a climb from `p` finds, by steps to anywhere near that shrink where none is higher.
fn climbed(numbers: &mut Numbers, mut p: DVec3, height: impl Fn(DVec3) -> f64) -> f64 {
    let (mut highest, mut reach) = (height(p), 0.5);
    while reach > 1e-3 {
        let next = p + numbers.point(reach);
        let found = height(next);
        if found > highest {
            (p, highest) = (next, found);
        } else {
            reach *= 0.93;
        }
    }
    highest
}

/// The gradients of a cell are drawn, so the worst are rare: a search comes near the bounds, not to them.
#[test]
fn no_search_passes_the_bounds_and_some_come_near() {
    let mut numbers = Numbers(1);
    let (mut value, mut slope, mut curvature) = (0.0f64, 0.0f64, 0.0f64);
    for seed in 0..6_000 {
        let start = numbers.point(200.0);
        value = value.max(climbed(&mut numbers, start, |p| noise(p, seed).abs()));
        slope = slope.max(climbed(&mut numbers, start, |p| noise_and_gradient(p, seed).1.length()));
        let u = numbers.point(1.0).normalize() * 1e-4;
        let second = |p| {
            let change = noise(p + u, seed) + noise(p - u, seed) - 2.0 * noise(p, seed);
            change.abs() / u.length_squared()
        };
        curvature = curvature.max(climbed(&mut numbers, start, second));
    }
    let shares = [value, slope / NOISE_SLOPE, curvature / NOISE_CURVATURE];
    println!("{shares:?}");
    assert!(shares.iter().all(|share| *share <= 1.0), "{shares:?}");
    assert!(shares[0] > 0.8 && shares[1] > 0.6 && shares[2] > 0.6, "{shares:?}");
}

#[test]
fn the_gradient_is_that_of_the_value() {
    let mut numbers = Numbers(2);
    for seed in 0..2_000 {
        let p = numbers.point(50.0);
        let (value, gradient) = noise_and_gradient(p, seed);
        assert_eq!(value.to_bits(), noise(p, seed).to_bits());
        for (axis, step) in [DVec3::X, DVec3::Y, DVec3::Z].into_iter().enumerate() {
            let change = (noise(p + step * 1e-5, seed) - noise(p - step * 1e-5, seed)) / 2e-5;
            assert!((change - gradient[axis]).abs() < 1e-7, "{change} {gradient} at {p}");
        }
    }
}

#[test]
fn ranges_hold_and_those_of_small_boxes_are_tight() {
    let mut numbers = Numbers(3);
    for size in [2.0, 0.5, 0.1, 0.02] {
        let (mut told, mut seen) = (0.0, 0.0);
        for seed in 0..2_000 {
            let low = numbers.point(30.0);
            let side = (numbers.point(size) + size * 0.5).abs();
            let range = noise_range(low, low + side, seed);
            let (mut least, mut greatest) = (f64::INFINITY, f64::NEG_INFINITY);
            for i in 0..27 {
                // Corners and middles first of all.
                let at = DVec3::new((i % 3) as f64, (i / 3 % 3) as f64, (i / 9) as f64) * 0.5;
                let inner = DVec3::new(numbers.next(), numbers.next(), numbers.next());
                for part in [at, inner] {
                    let value = noise(low + side * part, seed);
                    assert!(range.0 <= value && value <= range.1, "{value} not in {range:?}");
                    (least, greatest) = (least.min(value), greatest.max(value));
                }
            }
            told += range.1 - range.0;
            seen += greatest - least;
        }
        // A hundredth, a tenth and a fifth of a cell.
        let most = if size < 0.05 {
            1.1
        } else if size < 0.2 {
            1.6
        } else {
            f64::INFINITY
        };
        assert!(told < most * seen, "{size}: {told} told, {seen} seen");
    }
}

#[test]
fn all_gradients_are_equally_frequent_whatever_the_neighbour_has() {
    // By the steps to a neighbour: how often which gradient stands beside which.
    for step in [[1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 0], [1, -1, 1], [8, 0, 0], [0, 0, 64]] {
        let mut counts = [[0u32; 12]; 12];
        let of = |place: [i64; 3], seed: u64| {
            let sum = (0..3).fold(GOLDEN.wrapping_mul(seed + 1), |sum: u64, axis| {
                sum.wrapping_add(STEPS[axis].wrapping_mul(place[axis] as u64))
            });
            hash(sum)
        };
        for i in 0..144_000 {
            let place = [i % 60 - 30, i / 60 % 60 - 30, i / 3_600];
            let beside = [0, 1, 2].map(|axis| place[axis] + step[axis]);
            counts[of(place, 5)][of(beside, 5)] += 1;
        }
        // Chi-square with 143 degrees of freedom: 1 in 10^6 lies above 234.
        let chi: f64 = counts.iter().flatten().map(|&n| (f64::from(n) - 1000.0).powi(2) / 1000.0).sum();
        assert!(chi < 234.0, "{step:?}: {chi}");
    }
}

/// Rows along an axis and askew, with many places in a cell and few; on lattice planes, at whole numbers, far out and at nothing.
#[test]
fn a_row_is_its_places_to_the_bit() {
    let mut numbers = Numbers(6);
    for seed in 0..3_000 {
        let start = numbers.point(if seed % 7 == 0 { 1e-6 } else { 30.0 });
        let length = [0.01, 0.3, 5.0][seed as usize % 3];
        let step = numbers.point(length) * DVec3::new(1.0, (seed % 2) as f64, (seed / 2 % 2) as f64);
        let start = if seed % 5 == 0 { DVec3::new(start.x, start.y, start.z.floor()) } else { start };
        let mut places: Vec<DVec3> = (0..seed as usize % 90).map(|i| start + step * i as f64).collect();
        for (i, p) in places.iter_mut().enumerate() {
            *p = match numbers.next() {
                ..0.02 => p.floor(),
                ..0.03 => -*p * 0.0,
                ..0.04 => DVec3::new(1e17, p.y, p.z),
                ..0.05 => DVec3::new(p.x, f64::NAN, f64::INFINITY),
                ..0.06 => *p - DVec3::splat(1e-17 * i as f64),
                _ => *p,
            };
        }
        let [x, y, z] = [0, 1, 2].map(|axis| places.iter().map(|p| p[axis]).collect::<Vec<f64>>());
        let mut values = vec![f64::NAN; places.len()];
        noise_row([&x, &y, &z], seed, &mut values);
        for (p, value) in places.iter().zip(values) {
            assert_eq!(value.to_bits(), noise(*p, seed).to_bits(), "{p} with the seed {seed}");
        }
    }
}

#[test]
fn far_out_it_is_zero_and_what_is_not_finite_has_none() {
    for p in [DVec3::ZERO, DVec3::new(-4.0, 1e9, 7.0), DVec3::splat(1e17), DVec3::new(0.5, -1e300, 0.5)] {
        assert_eq!(noise(p, 1), 0.0, "{p}");
    }
    for p in [DVec3::NAN, DVec3::new(0.0, f64::INFINITY, 0.5), DVec3::new(0.1, 0.2, f64::NAN)] {
        assert!(noise(p, 1).is_nan() && noise_and_gradient(p, 1).1.is_nan(), "{p}");
    }
}

/// `scripts/noise_values.py`, which is written from the doc comments: exact whole numbers, and Python's doubles.
#[test]
fn values_are_those_of_an_independent_program() {
    for (p, seed, bits) in [
        ([0.3, -1.7, 2.45], 0, 0x3fcb_bac7_ce76_5497u64),
        ([12.5, 0.25, -3.125], 7, 0x3fd5_6be9_3665_c91d),
        ([-1e-9, 0.5, 0.75], u32::MAX, 0xbfd4_c191_4eb2_aa14),
        ([1_234_567.875, -7_654_321.25, 0.5], 3, 0x3fdc_9fdb_9013_404f),
        ([0.1, 0.2, 0.0], 1, 0xbfc2_0939_86a0_07da),
    ] {
        let value = noise(DVec3::from_array(p), seed);
        assert_eq!(value.to_bits(), bits, "{p:?} {seed}: {value}");
    }
}
