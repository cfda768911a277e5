//! The asteroid with its hashes in tables: no sines, and bounds on how steep its noise is.

use glam::{Vec3, Vec3A, Vec4};
use isostudy_mesh::Bounds;

use super::{Asteroid, blend, hash};
use crate::{SAFE, StudyField, has_sound_lengths};

/// The most whole-number points of all octaves together: 8 MiB of hashes and slopes.
const MOST_POINTS: usize = 1 << 20;
/// The most noise cells that a bound looks at.
const MOST_CELLS: i32 = 64;

/// An asteroid ready for many samples; the same values to the bit.
#[derive(Debug)]
pub(super) struct AsteroidTable {
    asteroid: Asteroid,
    stretch: Vec3A,
    octaves: Vec<Octave>,
    weights: f32,
}

/// The hashed points that an octave can reach.
#[derive(Debug)]
struct Octave {
    weight: f32,
    frequency: f32,
    low: [i32; 3],
    size: [i32; 3],
    hashes: Vec<f32>,
    /// By cell: the steepest that the noise can be, a unit of its own coordinates.
    slopes: Vec<f32>,
    steepest: f32,
}

impl AsteroidTable {
    /// `None` if the tables would be too large to be worth it.
    pub(super) fn new(asteroid: &Asteroid) -> Option<Self> {
        let mut octaves = Vec::new();
        let (mut weight, mut frequency, mut weights) = (1.0, 1.0, 0.0);
        let mut room = MOST_POINTS;
        for _ in 0..asteroid.octaves {
            if weight == 0.0 {
                break;
            }
            let octave = Octave::new(asteroid, weight, frequency, room)?;
            room -= octave.hashes.len();
            octaves.push(octave);
            weights += weight;
            frequency *= asteroid.lacunarity;
            weight *= asteroid.gain;
        }
        let is_sound = weights > 0.0
            && asteroid.stretch.min_element() > 0.0
            && asteroid.gain >= 0.0
            && asteroid.radius.is_finite()
            && asteroid.amplitude.is_finite();
        is_sound.then_some(Self { asteroid: *asteroid, stretch: asteroid.stretch.into(), octaves, weights })
    }

    pub(super) fn is_of(&self, asteroid: &Asteroid) -> bool {
        self.asteroid == *asteroid
    }

    /// The noise in a direction already stretched; `None` beyond the tables.
    #[inline]
    fn noise(&self, q: Vec3A) -> Option<f32> {
        let mut sum = 0.0;
        for octave in &self.octaves {
            sum += octave.value(q * octave.frequency)? * octave.weight;
        }
        Some(sum / self.weights)
    }

    #[inline]
    fn direction(&self, p: Vec3, distance: f32) -> Vec3A {
        (Vec3A::from(p) / distance) / self.stretch * self.asteroid.frequency
    }

    /// Four points of a row, a lane each: the same operations in the same order. `None` where a point is the origin or
    /// beyond the tables.
    #[inline]
    fn four(&self, x: Vec4, y: f32, z: f32) -> Option<[f32; 4]> {
        let asteroid = &self.asteroid;
        let (y, z) = (Vec4::splat(y), Vec4::splat(z));
        let length = |x: Vec4, y: Vec4, z: Vec4| (x * x + y * y + z * z).sqrt();
        let distance = length(x, y, z);
        if distance.cmpeq(Vec4::ZERO).any() {
            return None;
        }
        let Vec3 { x: kx, y: ky, z: kz } = asteroid.stretch;
        let [qx, qy, qz] =
            [x / distance / kx, y / distance / ky, z / distance / kz].map(|q| q * asteroid.frequency);
        let mut sum = Vec4::ZERO;
        for octave in &self.octaves {
            sum += octave.four([qx, qy, qz].map(|q| q * octave.frequency))? * octave.weight;
        }
        let noise = sum / self.weights;
        let value =
            (Vec4::splat(asteroid.radius) - length(x / kx, y / ky, z / kz)) + asteroid.amplitude * noise;
        Some(value.to_array())
    }

    /// How much the noise changes at most a unit of direction, in the directions of a box; and the box's distance
    /// from the origin.
    fn noise_slope(&self, bounds: Bounds) -> Option<(f32, f32)> {
        let nearest = Vec3::ZERO.clamp(bounds.min, bounds.max).length();
        let centre = (bounds.min + bounds.max) * 0.5;
        let distance = centre.length();
        let radius = bounds.size().length() * 0.5 * SAFE;
        if !(nearest > 0.0 && distance.is_finite()) {
            return None;
        }
        let per_direction = self.asteroid.frequency.abs() / self.asteroid.stretch.min_element();
        // Directions of the box differ from the centre's by at most this much.
        let spread = (radius / nearest).min(2.0) * per_direction * SAFE;
        let q = self.direction(centre, distance);
        let slope = |octave: &Octave| {
            octave.slope(q * octave.frequency, spread * octave.frequency.abs())
                * octave.frequency.abs()
                * octave.weight
        };
        let slope = self.octaves.iter().map(slope).sum::<f32>() / self.weights * per_direction;
        Some((slope * SAFE, nearest))
    }
}

impl AsteroidTable {
    /// The least and the greatest noise in the directions of a box.
    fn noise_range(&self, bounds: Bounds) -> (f32, f32) {
        let Some((low, high)) = directions(bounds) else { return (-1.0, 1.0) };
        let scale = Vec3A::splat(self.asteroid.frequency) / self.stretch;
        let (a, b) = (low * scale, high * scale);
        let (low, high) = (a.min(b), a.max(b));
        let (mut least, mut greatest) = (0.0, 0.0);
        for octave in &self.octaves {
            let (a, b) = (low * octave.frequency, high * octave.frequency);
            let range = octave.range(a.min(b), a.max(b));
            least += range.0 * octave.weight;
            greatest += range.1 * octave.weight;
        }
        (least / self.weights, greatest / self.weights)
    }
}

/// A box of all directions `p / |p|` of a box of points, or `None` where they go all ways.
///
/// To first order a step `v` from the middle `c` turns the direction `d` by `(v - d (d . v)) / |c|`, of which each
/// component is at most the sum over the axes of the absolute coefficient times half the box. What is left is at most
/// half the greatest second derivative: `1.155 |v|^2 / n^2` with `n` the box's distance from the origin, since along
/// a unit vector that is `b` off `d` and `a` along it the second derivative of `p / |p|` is `b sqrt(4 a^2 + b^2) / |p|^2`
/// long.
fn directions(bounds: Bounds) -> Option<(Vec3A, Vec3A)> {
    let nearest = Vec3::ZERO.clamp(bounds.min, bounds.max).length();
    let (centre, half) = ((bounds.min + bounds.max) * 0.5, bounds.size() * 0.5);
    let distance = centre.length();
    let turn = half.length() / nearest;
    if !(nearest > 0.0 && distance.is_finite() && turn < 0.5) {
        return None;
    }
    let direction = centre / distance;
    let along = direction.abs().dot(half);
    // |e - d_e d| . half: the axis itself counts 1 - d_e^2, the others |d_e d_i|.
    let across = half + direction.abs() * (along - 2.0 * direction.abs() * half);
    let spread = across / distance * SAFE + Vec3::splat(0.6 * turn * turn + 1e-6);
    Some(((direction - spread).into(), (direction + spread).into()))
}

impl StudyField for AsteroidTable {
    #[inline]
    fn sample(&self, p: Vec3) -> f32 {
        let asteroid = &self.asteroid;
        let distance = p.length();
        if distance == 0.0 {
            return asteroid.radius;
        }
        match self.noise(self.direction(p, distance)) {
            Some(noise) => {
                (asteroid.radius - Vec3::from(Vec3A::from(p) / self.stretch).length())
                    + asteroid.amplitude * noise
            }
            None => asteroid.value(p),
        }
    }

    fn sample_row(&self, x: &[f32], y: f32, z: f32, values: &mut [f32]) {
        let (fours, rest) = x.as_chunks::<4>();
        let (values_in_fours, values_left) = values.as_chunks_mut::<4>();
        for (values, &x) in values_in_fours.iter_mut().zip(fours) {
            *values = self
                .four(Vec4::from_array(x), y, z)
                .unwrap_or_else(|| x.map(|x| self.sample(Vec3::new(x, y, z))));
        }
        for (value, &x) in values_left.iter_mut().zip(rest) {
            *value = self.sample(Vec3::new(x, y, z));
        }
    }

    fn gradient(&self, p: Vec3) -> Option<Vec3> {
        self.asteroid.gradient_at(p)
    }

    fn slope(&self, bounds: Bounds) -> Option<f32> {
        let (noise, nearest) = self.noise_slope(bounds).filter(|_| has_sound_lengths(bounds))?;
        let ball = 1.0 / self.asteroid.stretch.min_element();
        Some((ball + self.asteroid.amplitude.abs() * noise / nearest) * SAFE)
    }

    /// The ball's part from the nearest and farthest point of the box, the noise's from all directions in it. No value
    /// is needed.
    fn range(&self, bounds: Bounds, _value: f32) -> Option<(f32, f32)> {
        if !has_sound_lengths(bounds) {
            return None;
        }
        let Asteroid { radius, stretch, amplitude, .. } = self.asteroid;
        let near = (Vec3::ZERO.clamp(bounds.min, bounds.max) / stretch).length();
        let far = (bounds.min.abs().max(bounds.max.abs()) / stretch).length();
        let (low, high) = self.noise_range(bounds);
        let (low, high) = (amplitude * low, amplitude * high);
        let slack = (radius.abs() + far + amplitude.abs()) * (SAFE - 1.0);
        let range = (radius - far + low.min(high) - slack, radius - near + low.max(high) + slack);
        (!range.0.is_nan() && !range.1.is_nan()).then_some(range)
    }
}

impl Octave {
    /// `None` with more points than `most`.
    fn new(asteroid: &Asteroid, weight: f32, frequency: f32, most: usize) -> Option<Self> {
        let reach = (Vec3::ONE / asteroid.stretch * (asteroid.frequency * frequency)).abs().to_array();
        if reach.iter().any(|r| r.is_nan() || *r >= 1000.0) || !weight.is_finite() {
            return None;
        }
        let low = reach.map(|r| -(r.ceil() as i32) - 1);
        let size = low.map(|low| 1 - 2 * low);
        let points = size.iter().map(|&n| n as usize).product::<usize>();
        if points > most {
            return None;
        }
        let mut hashes = Vec::with_capacity(points);
        for z in 0..size[2] {
            for y in 0..size[1] {
                for x in 0..size[0] {
                    let at = [x + low[0], y + low[1], z + low[2]].map(|i| i as f32);
                    hashes.push(hash(Vec3::from_array(at)));
                }
            }
        }
        let mut octave = Self { weight, frequency, low, size, hashes, slopes: Vec::new(), steepest: 0.0 };
        octave.slopes = (0..points).map(|i| octave.cell_slope(i)).collect();
        octave.steepest = octave.slopes.iter().fold(0.0, |a: f32, &b| a.max(b));
        Some(octave)
    }

    /// Steps to the next point along x, y and z.
    fn steps(&self) -> [usize; 3] {
        [1, self.size[0] as usize, (self.size[0] * self.size[1]) as usize]
    }

    /// The blend is no steeper along an axis than 1.5 times the cell's largest difference along it, and the noise is
    /// twice the blend. Points of the last rows have no cell, and none is asked for.
    fn cell_slope(&self, at: usize) -> f32 {
        let steps = self.steps();
        let hash = |i: usize| self.hashes.get(i).copied().unwrap_or(0.0);
        let along = |axis: usize| {
            let (a, b) = (steps[(axis + 1) % 3], steps[(axis + 2) % 3]);
            [0, a, b, a + b]
                .map(|corner| (hash(at + corner + steps[axis]) - hash(at + corner)).abs())
                .into_iter()
                .fold(0.0, f32::max)
        };
        3.0 * Vec3::new(along(0), along(1), along(2)).length()
    }

    #[inline]
    fn place(&self, [x, y, z]: [i32; 3]) -> usize {
        ((z * self.size[1] + y) * self.size[0] + x) as usize
    }

    /// The noise at `q`.
    #[inline]
    fn value(&self, q: Vec3A) -> Option<f32> {
        let [fx, fy, fz] = q.to_array().map(floor);
        let t = q - Vec3A::new(fx, fy, fz);
        let w = t * t * (Vec3A::splat(3.0) - Vec3A::splat(2.0) * t);
        let [x, y, z] = [fx as i32 - self.low[0], fy as i32 - self.low[1], fz as i32 - self.low[2]];
        let is_in = |i: i32, n: i32| (0..n - 1).contains(&i);
        if !(is_in(x, self.size[0]) && is_in(y, self.size[1]) && is_in(z, self.size[2])) {
            return None;
        }
        let [_, up, back] = self.steps();
        let at = self.place([x, y, z]);
        let near = &self.hashes[at..at + up + 2];
        let far = &self.hashes[at + back..at + back + up + 2];
        // Blends as the asteroid does, several in the lanes of one.
        let left = Vec4::new(near[0], near[up], far[0], far[up]);
        let right = Vec4::new(near[1], near[up + 1], far[1], far[up + 1]);
        let [a, b, c, d] = (left + (right - left) * w.x).to_array();
        Some(blend(blend(a, b, w.y), blend(c, d, w.y), w.z) * 2.0 - 1.0)
    }

    /// The noise at four points.
    #[inline]
    fn four(&self, q: [Vec4; 3]) -> Option<Vec4> {
        let base = q.map(|q| q.floor());
        let weight = |axis: usize| {
            let t = q[axis] - base[axis];
            t * t * (Vec4::splat(3.0) - Vec4::splat(2.0) * t)
        };
        let mut places = [0; 4];
        for axis in [2, 1, 0] {
            let at = base[axis] - Vec4::splat(self.low[axis] as f32);
            let last = Vec4::splat((self.size[axis] - 2) as f32);
            if !(at.cmpge(Vec4::ZERO) & at.cmple(last)).all() {
                return None;
            }
            // A small whole number is in the lowest bits of its sum with 2^23, without the care that `as` takes.
            let whole = (at + Vec4::splat(8_388_608.0)).to_array().map(|v| v.to_bits() & 0x7f_ffff);
            for (place, whole) in places.iter_mut().zip(whole) {
                *place = *place * self.size[axis] as u32 + whole;
            }
        }
        let [_, up, back] = self.steps();
        let reach = back + up + 2;
        let [a, b, c, d] = places.map(|place| &self.hashes[place as usize..place as usize + reach]);
        let corner = |at: usize| Vec4::new(a[at], b[at], c[at], d[at]);
        let blend = |a: Vec4, b: Vec4, weight: Vec4| a + (b - a) * weight;
        let [wx, wy, wz] = [weight(0), weight(1), weight(2)];
        let along_x = |at: usize| blend(corner(at), corner(at + 1), wx);
        let near = blend(along_x(0), along_x(up), wy);
        let far = blend(along_x(back), along_x(back + up), wy);
        Some(blend(near, far, wz) * 2.0 - 1.0)
    }

    /// The least and the greatest noise in a box. In a cell the weights of the blend grow along each axis, and the blend is
    /// linear in each of them: its extremes are at corners of what the box has of the cell.
    fn range(&self, low: Vec3A, high: Vec3A) -> (f32, f32) {
        let everything = (-1.0, 1.0);
        let (low, high) = (low - 1e-5 * low.abs(), high + 1e-5 * high.abs());
        let [first, last] = [low, high].map(|q| q.to_array().map(|v| floor(v) as i32));
        let mut count = 1;
        for axis in 0..3 {
            let cells = last[axis].saturating_sub(first[axis]).saturating_add(1);
            let is_in = first[axis] >= self.low[axis] && last[axis] < self.low[axis] + self.size[axis] - 1;
            count *= cells.clamp(0, MOST_CELLS + 1);
            if !is_in || count > MOST_CELLS {
                return everything;
            }
        }
        let (mut least, mut greatest) = (f32::INFINITY, f32::NEG_INFINITY);
        for z in first[2]..=last[2] {
            for y in first[1]..=last[1] {
                for x in first[0]..=last[0] {
                    let base = Vec3A::new(x as f32, y as f32, z as f32);
                    let (a, b) = self.range_in_cell([x, y, z], low - base, high - base);
                    (least, greatest) = (least.min(a), greatest.max(b));
                }
            }
        }
        (least, greatest)
    }

    /// The same within one cell, in coordinates of the cell.
    #[inline]
    fn range_in_cell(&self, cell: [i32; 3], low: Vec3A, high: Vec3A) -> (f32, f32) {
        let weight = |t: Vec3A| {
            let t = t.clamp(Vec3A::ZERO, Vec3A::ONE);
            t * t * (Vec3A::splat(3.0) - Vec3A::splat(2.0) * t)
        };
        let (low, high) = (weight(low), weight(high));
        let [_, up, back] = self.steps();
        let at = self.place(std::array::from_fn(|axis| cell[axis] - self.low[axis]));
        let hashes = &self.hashes[at..at + back + up + 2];
        let lanes =
            |at: usize| Vec4::new(hashes[at], hashes[at + up], hashes[at + back], hashes[at + back + up]);
        let (left, right) = (lanes(0), lanes(1));
        let blend = |a: Vec4, b: Vec4, weight: Vec4| a + (b - a) * weight;
        // Near and far, each at both ends along x.
        let [a, b] = [low.x, high.x].map(|w| blend(left, right, Vec4::splat(w)));
        let (below, above) = (Vec4::new(a.x, a.z, b.x, b.z), Vec4::new(a.y, a.w, b.y, b.w));
        let [a, b] = [low.y, high.y].map(|w| blend(below, above, Vec4::splat(w)));
        let (near, far) = (Vec4::new(a.x, a.z, b.x, b.z), Vec4::new(a.y, a.w, b.y, b.w));
        let [a, b] = [low.z, high.z].map(|w| blend(near, far, Vec4::splat(w)));
        (a.min(b).min_element() * 2.0 - 1.0 - 1e-5, a.max(b).max_element() * 2.0 - 1.0 + 1e-5)
    }

    /// The steepest within `spread` of `q` along each axis.
    fn slope(&self, q: Vec3A, spread: f32) -> f32 {
        let cell = |v: f32, axis: usize| (floor(v) as i32 - self.low[axis]).clamp(0, self.size[axis] - 2);
        let (low, high) = (q - spread * SAFE, q + spread * SAFE);
        let ranges = [0, 1, 2].map(|axis| cell(low[axis], axis)..=cell(high[axis], axis));
        let cells = |range: &std::ops::RangeInclusive<i32>| range.end() - range.start() + 1;
        if spread.is_nan() || spread >= 8.0 || ranges.iter().map(cells).product::<i32>() > MOST_CELLS {
            return self.steepest;
        }
        let [xs, ys, zs] = ranges;
        let mut steepest = 0.0f32;
        for z in zs {
            for y in ys.clone() {
                let start = self.place([*xs.start(), y, z]);
                let row = &self.slopes[start..start + cells(&xs) as usize];
                steepest = row.iter().fold(steepest, |a, &b| a.max(b));
            }
        }
        steepest
    }
}

/// As `floorf`, for values that fit 32 bits.
#[inline]
fn floor(v: f32) -> f32 {
    let whole = v as i32 as f32;
    if whole > v { whole - 1.0 } else { whole }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn point(size: f32) -> impl Strategy<Value = Vec3> {
        prop::array::uniform3(-size..size).prop_map(Vec3::from)
    }

    fn asteroid() -> impl Strategy<Value = Asteroid> {
        let rough = Asteroid { amplitude: 0.5, frequency: 4.0, gain: 0.5, ..Asteroid::default() };
        let tall = Asteroid { stretch: Vec3::new(0.5, 2.0, 0.7), octaves: 2, ..Asteroid::default() };
        prop_oneof![Just(Asteroid::default()), Just(rough), Just(tall)]
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(200))]

        #[test]
        fn the_table_changes_no_bit(asteroid in asteroid(), p in prop_oneof![point(1.5), point(1e-3), point(1e30)]) {
            let table = AsteroidTable::new(&asteroid).unwrap();
            prop_assert_eq!(table.sample(p).to_bits(), asteroid.sample(p).to_bits());
            let x: [f32; 7] = std::array::from_fn(|i| p.x * (1.0 + i as f32 * 0.1));
            let mut values = [0.0; 7];
            table.sample_row(&x, p.y, p.z, &mut values);
            for (value, x) in values.into_iter().zip(x) {
                prop_assert_eq!(value.to_bits(), asteroid.sample(Vec3::new(x, p.y, p.z)).to_bits());
            }
        }

        #[test]
        fn values_stay_in_range_and_below_the_slope(
            asteroid in asteroid(),
            min in point(1.2),
            size in prop_oneof![point(0.005), point(0.05), point(0.5)],
            points in prop::collection::vec(prop::array::uniform3(0.0..=1.0f32), 20),
        ) {
            let table = AsteroidTable::new(&asteroid).unwrap();
            let bounds = Bounds { min, max: min + size.abs() };
            let centre = (bounds.min + bounds.max) * 0.5;
            let (low, high) = table.range(bounds, table.sample(centre)).unwrap();
            let slope = table.slope(bounds);
            let mut before: Option<Vec3> = None;
            for t in points {
                let p = (min + size.abs() * Vec3::from(t)).clamp(bounds.min, bounds.max);
                let value = table.sample(p);
                prop_assert!(low <= value && value <= high, "{low} {value} {high}");
                if let (Some(q), Some(slope)) = (before, slope) {
                    prop_assert!((table.sample(q) - value).abs() <= slope * p.distance(q) + 1e-5);
                }
                before = Some(p);
            }
        }
    }

    /// Tight as well as true: a tile of the 256^3 lattice at the surface, where the values themselves differ by 0.02.
    #[test]
    fn the_range_of_a_small_box_is_not_much_more_than_its_values() {
        let table = AsteroidTable::new(&Asteroid::default()).unwrap();
        let size = Vec3::splat(0.012);
        let (mut told, mut seen) = (0.0, 0.0);
        for i in 0..200 {
            let t = i as f32;
            let min = Vec3::new(t.sin(), (t * 1.7).cos(), (t * 0.6).sin()).normalize() * 0.6;
            let (low, high) = table.range(Bounds { min, max: min + size }, f32::NAN).unwrap();
            let corners =
                (0..8).map(|c| min + size * Vec3::new((c & 1) as f32, (c >> 1 & 1) as f32, (c >> 2) as f32));
            let values = corners
                .map(|p| table.sample(p))
                .fold((f32::INFINITY, f32::NEG_INFINITY), |(l, h), v| (v.min(l), v.max(h)));
            told += high - low;
            seen += values.1 - values.0;
        }
        assert!(told < 2.0 * seen, "{told} told, {seen} seen");
    }

    /// Each octave of these has few points, so that only their sum is a limit.
    #[test]
    fn many_octaves_have_no_table() {
        let asteroid = |octaves| Asteroid { octaves, lacunarity: 1.0, gain: 1.0, ..Asteroid::default() };
        let points = |table: AsteroidTable| table.octaves.iter().map(|o| o.hashes.len()).sum::<usize>();
        let each = points(AsteroidTable::new(&asteroid(1)).unwrap());
        let most = (MOST_POINTS / each) as u32;
        assert_eq!(points(AsteroidTable::new(&asteroid(most)).unwrap()), each * most as usize);
        assert!(AsteroidTable::new(&asteroid(most + 1)).is_none());
        assert!(AsteroidTable::new(&asteroid(u32::MAX)).is_none());
        // Most of these have no weight.
        let fading = Asteroid { gain: 0.15, ..asteroid(u32::MAX) };
        let (table, p) = (AsteroidTable::new(&fading).unwrap(), Vec3::new(0.3, -0.4, 0.2));
        assert_eq!(table.sample(p), fading.sample(p));
    }

    #[test]
    fn the_origin_and_what_is_no_number() {
        let asteroid = Asteroid::default();
        let table = AsteroidTable::new(&asteroid).unwrap();
        for p in [Vec3::ZERO, Vec3::splat(f32::NAN), Vec3::splat(f32::INFINITY), -Vec3::X, Vec3::Z] {
            let (a, b) = (table.sample(p), asteroid.sample(p));
            assert!(a.to_bits() == b.to_bits() || a.is_nan() && b.is_nan(), "{p}: {a} {b}");
        }
    }
}
