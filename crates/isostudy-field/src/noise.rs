//! Gradient noise that is the same on every machine, and bounds on it.

use glam::DVec3;

/// A bound on the change of [`noise`] a unit of length.
pub const NOISE_SLOPE: f64 = 3.77;
/// A bound on the second derivative of [`noise`] along any line.
pub const NOISE_CURVATURE: f64 = 15.5;

/// What the sum is multiplied by, so that it stays in [-1, 1].
const SCALE: f64 = 0.9647;
/// From here on every number is whole, so that the noise is 0.
const WHOLE: f64 = 4_503_599_627_370_496.0;

/// 2^64 over the powers of the root of x^4 = x + 1, made odd: no short step between lattice points is a multiple of 2^64.
const STEPS: [u64; 3] = [0xd1b5_4a32_d192_ed03, 0xabc9_8388_fb8f_ac03, 0x8cb9_2ba7_2f3d_8dd7];
/// 2^64 over the golden ratio.
const GOLDEN: u64 = 0x9e37_79b9_7f4a_7c15;

/// From the middle of a cube to the middles of its edges.
const GRADIENTS: [[f64; 3]; 12] = [
    [1.0, 1.0, 0.0],
    [-1.0, 1.0, 0.0],
    [1.0, -1.0, 0.0],
    [-1.0, -1.0, 0.0],
    [1.0, 0.0, 1.0],
    [-1.0, 0.0, 1.0],
    [1.0, 0.0, -1.0],
    [-1.0, 0.0, -1.0],
    [0.0, 1.0, 1.0],
    [0.0, -1.0, 1.0],
    [0.0, 1.0, -1.0],
    [0.0, -1.0, -1.0],
];

/// Gradient noise at `p`: 0 at whole-number points, features of about one unit, twice differentiable everywhere.
///
/// Each whole-number point `i` has one of twelve gradients `g`, drawn by `i` and `seed`: with whole numbers modulo 2^64,
/// `h = G (seed + 1) + A ix + B iy + C iz`, `h = G (h xor h >> 32)`, `h = A (h xor h >> 29)`, the `12 (h >> 32) >> 32`-th of
/// the private constants, where `G` and `A`, `B`, `C` are too. The value is
/// `0.9647 sum w(p - i) g . (p - i)` over the eight corners of the unit cell, where `w` is the product over the axes of
/// `1 - s(|t|)`, `s(t) = 6 t^5 - 15 t^4 + 10 t^3`. Only sums, products and comparisons in `f64` are taken, in a fixed
/// order: the result is the same to the bit on every machine. Beyond 2^52 it is 0; at what is not finite it is `NaN`.
///
/// # Bounds
/// The value lies in [-1, 1], changes by at most [`NOISE_SLOPE`] a unit, and has second derivatives of at most
/// [`NOISE_CURVATURE`]. Derivation: let `n` be the sum before scaling, `u` a unit vector, and `D` derivatives along it.
/// Corners have gradients of their own, so at a place `t` of a cell the greatest values over all gradients are
///
/// - of `n`: the sum over the corners of `M(w d)`,
/// - of `D n`: of `M(w u + Dw d)`,
/// - of `D^2 n`: of `M(2 Dw u + D^2w d)`,
///
/// with `d` the step from the corner and `M(v) = max g . v`, which is `|v|_1` less the least component. Each is reached by some
/// cell. On a grid of step `h` over the cell, `n`, `D n` and `D^2 n` exceed their values at the grid's points by at most `3 h^2 / 8`
/// times `sup |D^2 n|`, `sup |D^3 n|` and `sup |D^4 n|`, since an interpolation in three axes is off by no more. The last two are below
/// 1,000 and 9,000 by the triangle inequality. A vector no more than an angle `a` off the directions tried is longer by at most
/// `1 / cos a`, a quadratic form larger by `1 / cos 2a`. The test `bounds_are_proven` does this sum: 1.0365, 3.90 and 16.0.
///
/// Source: K. Perlin, Improving noise, SIGGRAPH 2002 (gradients and `s`); the hash is another.
pub fn noise(p: DVec3, seed: u32) -> f64 {
    let Some(place) = Place::of(p, seed) else { return beyond(p) };
    let gradient = |corner: usize| &GRADIENTS[place.gradient(corner)];
    let [x, y, z] = place.t;
    SCALE * if z == 0.0 { flat_value(gradient, [x, y]) } else { full_value(gradient, [x, y, z]) }
}

/// [`noise`] and its gradient.
pub fn noise_and_gradient(p: DVec3, seed: u32) -> (f64, DVec3) {
    let Some(place) = Place::of(p, seed) else { return (beyond(p), DVec3::splat(beyond(p))) };
    let (value, gradient) = Cell::round(&place).value_and_gradient(place.t);
    (SCALE * value, SCALE * gradient)
}

/// A range that holds every [`noise`] in the box from `low` to `high`, which are finite.
///
/// At a distance `r` from the middle the value differs from that there by at most [`NOISE_SLOPE`] `r`, and by at most
/// the gradient's part and half of [`NOISE_CURVATURE`] `r^2`. Small boxes so have ranges little larger than needed.
pub fn noise_range(low: DVec3, high: DVec3, seed: u32) -> (f64, f64) {
    match Near::of(low, high, seed) {
        Some(near) => {
            let off = near.gradient.abs().dot((high - low) * 0.5) + near.off;
            ((near.value - off).max(-1.0), (near.value + off).min(1.0))
        }
        None => (-1.0, 1.0),
    }
}

/// What noise is like in a box: at each point of it no more than `off` from `value + gradient . step from the middle`.
pub(super) struct Near {
    pub(super) value: f64,
    /// Zero where it tells less than the bound of the slope.
    pub(super) gradient: DVec3,
    pub(super) off: f64,
}

impl Near {
    /// `None` where the box is so large that nothing is known.
    pub(super) fn of(low: DVec3, high: DVec3, seed: u32) -> Option<Self> {
        let (centre, half) = ((low + high) * 0.5, (high - low) * 0.5);
        let radius = half.length();
        let by_slope = NOISE_SLOPE * radius;
        // The greatest possible value less the least.
        if by_slope.is_nan() || by_slope >= 2.0 {
            return None;
        }
        let (value, gradient) = noise_and_gradient(centre, seed);
        let by_curvature = 0.5 * NOISE_CURVATURE * radius * radius;
        // What double precision leaves out of places and sums.
        let rounding = 1e-12 + 1e-14 * centre.abs().max_element();
        let is_curved = gradient.abs().dot(half) + by_curvature < by_slope;
        let (gradient, off) = if is_curved { (gradient, by_curvature) } else { (DVec3::ZERO, by_slope) };
        Some(Self { value, gradient, off: off + rounding })
    }
}

/// Where there are no cells.
fn beyond(p: DVec3) -> f64 {
    if p.is_finite() { 0.0 } else { f64::NAN }
}

/// [`noise`] at `(x[i], y[i], z[i])` into `values[i]`, to the bit. All slices have the same length.
///
/// Places that follow each other in one cell share its gradients, which are most of the work.
pub(crate) fn noise_row([x, y, z]: [&[f64]; 3], seed: u32, values: &mut [f64]) {
    let mut first = 0;
    while first < values.len() {
        let Some(place) = Place::of(DVec3::new(x[first], y[first], z[first]), seed) else {
            values[first] = beyond(DVec3::new(x[first], y[first], z[first]));
            first += 1;
            continue;
        };
        let cell = Cell::round(&place);
        let [low_x, low_y, low_z] = cell.lowest;
        let is_flat = z[first] == low_z;
        let is_within = |i: usize| {
            let along = |v: f64, low: f64| v >= low && v < low + 1.0;
            along(x[i], low_x) && along(y[i], low_y) && along(z[i], low_z) && (z[i] == low_z) == is_flat
        };
        let end = (first + 1..values.len()).find(|&i| !is_within(i)).unwrap_or(values.len());
        let gradient = |corner: usize| &cell.gradients[corner];
        let run = first..end;
        let places = x[run.clone()].iter().zip(&y[run.clone()]).zip(&z[run.clone()]);
        if is_flat {
            for (value, ((x, y), _)) in values[run].iter_mut().zip(places) {
                *value = SCALE * flat_value(gradient, [x - low_x, y - low_y]);
            }
        } else {
            for (value, ((x, y), z)) in values[run].iter_mut().zip(places) {
                *value = SCALE * full_value(gradient, [x - low_x, y - low_y, z - low_z]);
            }
        }
        first = end;
    }
}

/// A point in its unit cell.
struct Place {
    lowest: [f64; 3],
    t: [f64; 3],
    /// Of the lowest corner, in the order of the steps.
    first: u64,
}

impl Place {
    #[inline]
    fn of(p: DVec3, seed: u32) -> Option<Self> {
        if !(p.x.abs() < WHOLE && p.y.abs() < WHOLE && p.z.abs() < WHOLE) {
            return None;
        }
        let (mut lowest, mut t) = ([0.0; 3], [0.0; 3]);
        let mut first = GOLDEN.wrapping_mul(u64::from(seed) + 1);
        for (axis, v) in p.to_array().into_iter().enumerate() {
            let towards_zero = v as i64;
            let whole = if towards_zero as f64 > v { towards_zero - 1 } else { towards_zero };
            lowest[axis] = whole as f64;
            t[axis] = v - lowest[axis];
            first = first.wrapping_add(STEPS[axis].wrapping_mul(whole as u64));
        }
        Some(Self { lowest, t, first })
    }

    /// Which gradient a corner has.
    #[inline]
    fn gradient(&self, corner: usize) -> usize {
        let step = |axis: usize| if corner >> axis & 1 == 1 { STEPS[axis] } else { 0 };
        hash(self.first.wrapping_add(step(0)).wrapping_add(step(1)).wrapping_add(step(2)))
    }
}

/// A unit cell.
struct Cell {
    lowest: [f64; 3],
    /// Of the corners: x fastest, then y, then z.
    gradients: [[f64; 3]; 8],
}

impl Cell {
    /// The cell of a point. Corners that count for nothing there are left at zero.
    #[inline]
    fn round(place: &Place) -> Self {
        let corners = if place.t[2] == 0.0 { 4 } else { 8 };
        let mut gradients = [[0.0; 3]; 8];
        for (corner, gradient) in gradients[..corners].iter_mut().enumerate() {
            *gradient = GRADIENTS[place.gradient(corner)];
        }
        Self { lowest: place.lowest, gradients }
    }

    /// On the lower face, the upper corners count for nothing.
    fn value_and_gradient(&self, t: [f64; 3]) -> (f64, DVec3) {
        let weights = t.map(fade);
        let slopes = t.map(fade_slope);
        let corners = if t[2] == 0.0 { 4 } else { 8 };
        let mut slants = [0.0; 8];
        let mut gradient = DVec3::ZERO;
        for (corner, found) in slants[..corners].iter_mut().enumerate() {
            *found = slant(self.gradients[corner], corner, t);
            let weight = |axis: usize| {
                if corner >> axis & 1 == 1 { weights[axis] } else { 1.0 - weights[axis] }
            };
            let all = weight(0) * weight(1) * weight(2);
            for axis in 0..3 {
                let others = weight((axis + 1) % 3) * weight((axis + 2) % 3);
                let change = if corner >> axis & 1 == 1 { others } else { -others };
                gradient[axis] += self.gradients[corner][axis] * all + *found * change * slopes[axis];
            }
        }
        let layer = |first: usize| {
            let front = blend(slants[first], slants[first + 1], weights[0]);
            let back = blend(slants[first + 2], slants[first + 3], weights[0]);
            blend(front, back, weights[1])
        };
        let value = if corners == 4 { layer(0) + 0.0 } else { layer(0) + (layer(4) - layer(0)) * weights[2] };
        (value, gradient)
    }
}

/// One of the gradients, by a point's place in the order of the steps.
#[inline]
fn hash(place: u64) -> usize {
    let mixed = (place ^ place >> 32).wrapping_mul(GOLDEN);
    let mixed = (mixed ^ mixed >> 29).wrapping_mul(STEPS[0]);
    (((mixed >> 32) * GRADIENTS.len() as u64) >> 32) as usize
}

/// The value in a cell whose corners have these gradients.
#[inline]
fn full_value<'g>(gradient: impl Fn(usize) -> &'g [f64; 3], t: [f64; 3]) -> f64 {
    let weights = t.map(fade);
    let slant = |corner: usize| slant(*gradient(corner), corner, t);
    let layer = |first: usize| {
        let front = blend(slant(first), slant(first + 1), weights[0]);
        let back = blend(slant(first + 2), slant(first + 3), weights[0]);
        blend(front, back, weights[1])
    };
    let lower = layer(0);
    lower + (layer(4) - lower) * weights[2]
}

/// The same on the lower face, where the upper layer has weight zero, and the gradients' last components are times zero.
#[inline]
fn flat_value<'g>(gradient: impl Fn(usize) -> &'g [f64; 3], [x, y]: [f64; 2]) -> f64 {
    let slant = |corner: usize, x: f64, y: f64| {
        let [gx, gy, _] = *gradient(corner);
        gx * x + gy * y
    };
    let [u, v] = [x, y].map(fade);
    let front = blend(slant(0, x, y), slant(1, x - 1.0, y), u);
    let back = blend(slant(2, x, y - 1.0), slant(3, x - 1.0, y - 1.0), u);
    blend(front, back, v) + 0.0
}

/// What a corner's gradient says at a point of its cell.
#[inline]
fn slant([gx, gy, gz]: [f64; 3], corner: usize, t: [f64; 3]) -> f64 {
    let step = |axis: usize| if corner >> axis & 1 == 1 { t[axis] - 1.0 } else { t[axis] };
    gx * step(0) + gy * step(1) + gz * step(2)
}

#[inline]
fn fade(t: f64) -> f64 {
    t * t * t * (t * (t * 6.0 - 15.0) + 10.0)
}

fn fade_slope(t: f64) -> f64 {
    30.0 * t * t * (t - 1.0) * (t - 1.0)
}

#[inline]
fn blend(a: f64, b: f64, weight: f64) -> f64 {
    a + (b - a) * weight
}

#[cfg(test)]
mod tests;
