//! Fields that are hard on a surface extractor: small volumes of samples, one family a way of being hard.

use std::f32::consts::TAU;

use glam::Vec3;
use isostudy_extract::Arrangement;
use isostudy_extract::by_lattice::Lattice;
use isostudy_field::StudyField;
use isostudy_mesh::Bounds;

/// Samples at every point of a lattice with cubes of edge 1. Places are in half cells.
#[derive(Debug, Clone)]
pub(crate) struct Volume {
    pub(crate) arrangement: Arrangement,
    /// Cells along each axis.
    pub(crate) cells: usize,
    values: Vec<f32>,
}

/// What the samples are like.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Family {
    White,
    /// Multiples of a half: ties and exact zeros.
    FiveLevels,
    Binary,
    LowPassOnce,
    LowPassThrice,
    ThinShell,
    Checkerboard,
    Gyroid,
    CoarseGyroid,
    FbmAsteroid,
    Spheres,
    SparsePoints,
    Threads,
    /// The side of a smooth field, magnitudes of noise.
    NoisyMagnitudes,
    /// Any of the others with values that are not numbers, infinite, huge or tiny among them.
    Odd,
}

pub(crate) const FAMILIES: [Family; 15] = [
    Family::White,
    Family::FiveLevels,
    Family::Binary,
    Family::LowPassOnce,
    Family::LowPassThrice,
    Family::ThinShell,
    Family::Checkerboard,
    Family::Gyroid,
    Family::CoarseGyroid,
    Family::FbmAsteroid,
    Family::Spheres,
    Family::SparsePoints,
    Family::Threads,
    Family::NoisyMagnitudes,
    Family::Odd,
];

/// Steps to the seven neighbours in positive directions, in half cells.
pub(crate) fn positive_steps(arrangement: Arrangement) -> [[i32; 3]; 7] {
    match arrangement {
        Arrangement::BodyCentred => SIMPLE_STEPS.map(|step| image(arrangement, step)),
        _ => [[2, 0, 0], [0, 2, 0], [0, 0, 2], [2, 2, 0], [2, 0, 2], [0, 2, 2], [2, 2, 2]],
    }
}

const SIMPLE_STEPS: [[i32; 3]; 7] =
    [[1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 0], [1, 0, 1], [0, 1, 1], [1, 1, 1]];

/// Where the point `[i, j, k]` of the simple cubic lattice lies, in half cells, on either lattice: the linear map
/// that makes the two one.
pub(crate) fn image(arrangement: Arrangement, [i, j, k]: [i32; 3]) -> [i32; 3] {
    match arrangement {
        Arrangement::BodyCentred => [j + k - i, i + k - j, i + j - k],
        _ => [2 * i, 2 * j, 2 * k],
    }
}

impl Volume {
    /// All samples `value`.
    pub(crate) fn filled(arrangement: Arrangement, cells: usize, value: f32) -> Self {
        Self { arrangement, cells, values: vec![value; (2 * cells + 3).pow(3)] }
    }

    /// A volume of a family.
    pub(crate) fn random(arrangement: Arrangement, cells: usize, family: Family, seed: u64) -> Self {
        let mut numbers = Numbers::new(seed);
        let mut volume = Self::filled(arrangement, cells, -1.0);
        volume.fill(family, &mut numbers);
        volume
    }

    /// The same with all samples on the outermost lattice points and beyond outside: the surface is closed.
    pub(crate) fn closed(mut self) -> Self {
        let last = 2 * self.cells as i32;
        for place in self.places() {
            if place.iter().any(|&c| c <= 0 || c >= last) {
                self.set(place, -1.0);
            }
        }
        self
    }

    pub(crate) fn lattice(&self) -> Lattice {
        let bounds = Bounds { min: Vec3::ZERO, max: Vec3::splat(self.cells as f32) };
        Lattice::try_new(self.arrangement, bounds, 1.0).unwrap()
    }

    /// Every lattice point.
    pub(crate) fn places(&self) -> Vec<[i32; 3]> {
        let range = || -1..=2 * self.cells as i32 + 1;
        let all = range().flat_map(|x| range().flat_map(move |y| range().map(move |z| [x, y, z])));
        all.filter(|place| {
            let odd = place.iter().filter(|&c| c % 2 != 0).count();
            odd == 0 && self.index(*place).is_some()
                || odd == 3 && matches!(self.arrangement, Arrangement::BodyCentred | Arrangement::FaceCentred)
                || odd == 2 && self.arrangement == Arrangement::FaceCentred
        })
        .collect()
    }

    /// Sets a sample; those outside the volume are ignored.
    pub(crate) fn set(&mut self, place: [i32; 3], value: f32) {
        if let Some(index) = self.index(place) {
            self.values[index] = value;
        }
    }

    fn get(&self, place: [i32; 3]) -> f32 {
        self.index(place).map_or(-1.0, |index| self.values[index])
    }

    fn index(&self, place: [i32; 3]) -> Option<usize> {
        let n = 2 * self.cells + 3;
        let inside = place.iter().all(|&c| (-1..n as i32 - 1).contains(&c));
        inside.then(|| place.iter().fold(0, |index, &c| index * n + (c + 1) as usize))
    }

    fn fill(&mut self, family: Family, numbers: &mut Numbers) {
        let places = self.places();
        let size = self.cells as f32;
        let point = |place: [i32; 3]| Vec3::from_array(place.map(|c| c as f32 / 2.0));
        match family {
            Family::White => self.each(&places, |_| numbers.signed()),
            Family::FiveLevels => self.each(&places, |_| (numbers.below(5) as f32 - 2.0) / 2.0),
            Family::Binary => {
                let share = numbers.between(0.15, 0.85);
                self.each(&places, |_| if numbers.unit() < share { 1.0 } else { -1.0 });
            }
            Family::LowPassOnce | Family::LowPassThrice => {
                self.each(&places, |_| numbers.signed());
                for _ in 0..if family == Family::LowPassOnce { 1 } else { 3 } {
                    self.smooth(&places);
                }
            }
            Family::ThinShell => {
                let shape = numbers.below(3);
                let (centre, normal) = (numbers.point(size), numbers.direction());
                let (radius, period) = (numbers.between(0.2, 0.5) * size, numbers.between(3.0, 8.0));
                let thickness = numbers.between(0.1, 0.8);
                self.each(&places, |place| {
                    let p = point(place);
                    let distance = match shape {
                        0 => p.distance(centre) - radius,
                        1 => (p - centre).dot(normal),
                        _ => gyroid((p - centre) * (TAU / period)) * period / TAU,
                    };
                    thickness - distance.abs()
                });
            }
            Family::Checkerboard => {
                let (block, flips) = (1 + numbers.below(3) as i32, numbers.between(0.0, 0.2));
                self.each(&places, |place| {
                    let black = place.iter().map(|c| (c + 8) / (2 * block)).sum::<i32>() % 2 == 0;
                    let magnitude = numbers.between(0.1, 1.0);
                    if black ^ (numbers.unit() < flips) { magnitude } else { -magnitude }
                });
            }
            Family::Gyroid | Family::CoarseGyroid => {
                let coarse = family == Family::CoarseGyroid;
                let period = if coarse { numbers.between(1.6, 3.0) } else { numbers.between(3.0, 8.0) };
                let (shift, level) = (numbers.point(9.0), numbers.between(-0.5, 0.5));
                self.each(&places, |place| gyroid((point(place) + shift) * (TAU / period)) - level);
            }
            Family::FbmAsteroid => {
                let (salt, gain) = (numbers.next(), numbers.between(0.3, 0.7));
                let (amplitude, radius) = (numbers.between(0.2, 0.9), numbers.between(0.25, 0.45));
                self.each(&places, |place| {
                    let p = (point(place) - size / 2.0) / size;
                    radius - p.length() + amplitude * radius * fbm(p * 3.0, gain, salt)
                });
            }
            Family::Spheres => {
                let balls: Vec<(Vec3, f32)> = (0..2 + numbers.below(5))
                    .map(|_| (numbers.point(size), numbers.between(0.4, 0.35 * size)))
                    .collect();
                self.each(&places, |place| {
                    let depth = |(centre, radius): &(Vec3, f32)| radius - point(place).distance(*centre);
                    balls.iter().map(depth).fold(f32::MIN, f32::max)
                });
            }
            Family::SparsePoints => {
                let share = numbers.between(0.01, 0.12);
                let sign = if numbers.below(2) == 0 { 1.0 } else { -1.0 };
                self.each(&places, |_| {
                    let magnitude = numbers.between(0.1, 1.0);
                    if numbers.unit() < share { sign * magnitude } else { -sign * magnitude }
                });
            }
            Family::Threads => {
                let sign = if numbers.below(2) == 0 { 1.0 } else { -1.0 };
                self.each(&places, |_| -sign * numbers.between(0.1, 1.0));
                let steps = positive_steps(self.arrangement);
                for _ in 0..2 + numbers.below(4) {
                    let mut at = places[numbers.below(places.len() as u64) as usize];
                    for _ in 0..4 + numbers.below(12) {
                        self.set(at, sign * numbers.between(0.1, 1.0));
                        let (step, way) = (steps[numbers.below(7) as usize], 2 * numbers.below(2) as i32 - 1);
                        at = [0, 1, 2].map(|axis| at[axis] + way * step[axis]);
                    }
                }
            }
            Family::NoisyMagnitudes => {
                let salt = numbers.next();
                self.each(&places, |place| {
                    fbm(point(place) / 3.0, 0.5, salt).signum() * numbers.between(0.01, 1.0)
                });
            }
            Family::Odd => {
                let base = FAMILIES[numbers.below(14) as usize];
                self.fill(base, numbers);
                let share = numbers.between(0.01, 0.3);
                let odd = [
                    f32::NAN,
                    f32::INFINITY,
                    f32::NEG_INFINITY,
                    f32::MAX,
                    f32::MIN,
                    0.0,
                    -0.0,
                    f32::MIN_POSITIVE,
                    1e-45,
                    -1e-45,
                ];
                for place in places {
                    if numbers.unit() < share {
                        self.set(place, odd[numbers.below(odd.len() as u64) as usize]);
                    }
                }
            }
        }
    }

    fn each(&mut self, places: &[[i32; 3]], mut value: impl FnMut([i32; 3]) -> f32) {
        for &place in places {
            self.set(place, value(place));
        }
    }

    /// The mean of each point and its neighbours.
    fn smooth(&mut self, places: &[[i32; 3]]) {
        let before = self.clone();
        let steps = positive_steps(self.arrangement);
        for &place in places {
            let around =
                steps.iter().flat_map(|step| [1, -1].map(|way| [0, 1, 2].map(|i| place[i] + way * step[i])));
            let values: Vec<f32> = around
                .filter(|&at| before.index(at).is_some())
                .map(|at| before.get(at))
                .chain([before.get(place)])
                .collect();
            self.set(place, values.iter().sum::<f32>() / values.len() as f32);
        }
    }
}

impl StudyField for Volume {
    fn sample(&self, p: Vec3) -> f32 {
        let mut place = (p * 2.0).to_array().map(|c| c as i32);
        // A centre that lies on the box instead of half a cell beyond it.
        if self.arrangement == Arrangement::BodyCentred && place.iter().any(|c| c % 2 != 0) {
            let last = 2 * self.cells as i32;
            place = place.map(|c| {
                if c == 0 {
                    -1
                } else if c == last {
                    last + 1
                } else {
                    c
                }
            });
        }
        self.get(place)
    }
}

fn gyroid(p: Vec3) -> f32 {
    p.x.sin() * p.y.cos() + p.y.sin() * p.z.cos() + p.z.sin() * p.x.cos()
}

/// Three octaves of trilinear value noise, in -1..1.
fn fbm(p: Vec3, gain: f32, salt: u64) -> f32 {
    let (mut sum, mut total, mut weight, mut q) = (0.0, 0.0, 1.0, p);
    for _ in 0..3 {
        sum += weight * noise(q, salt);
        total += weight;
        weight *= gain;
        q *= 2.1;
    }
    sum / total
}

fn noise(p: Vec3, salt: u64) -> f32 {
    let cell = p.floor();
    let t = p - cell;
    let w = t * t * (3.0 - 2.0 * t);
    (0..8).fold(0.0, |sum, corner| {
        let at = [0, 1, 2].map(|axis| corner >> axis & 1);
        let weight: f32 = (0..3).map(|axis| if at[axis] == 1 { w[axis] } else { 1.0 - w[axis] }).product();
        let place = [0, 1, 2].map(|axis| (cell[axis] as i64 + i64::from(at[axis])) as u64);
        let salt =
            place.iter().fold(salt, |h, &c| (h ^ c).wrapping_mul(0x9e37_79b9_7f4a_7c15).rotate_left(29));
        sum + weight * Numbers::new(salt).signed()
    })
}

/// Random numbers (splitmix64): the same from the same seed on every machine.
pub(crate) struct Numbers(u64);

impl Numbers {
    pub(crate) fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0xd134_2543_de82_ef95))
    }

    pub(crate) fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ self.0 >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ z >> 31
    }

    pub(crate) fn below(&mut self, n: u64) -> u64 {
        self.next() % n
    }

    fn unit(&mut self) -> f32 {
        (self.next() >> 40) as f32 / (1u32 << 24) as f32
    }

    fn signed(&mut self) -> f32 {
        2.0 * self.unit() - 1.0
    }

    fn between(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * self.unit()
    }

    fn point(&mut self, size: f32) -> Vec3 {
        Vec3::new(self.unit(), self.unit(), self.unit()) * size
    }

    fn direction(&mut self) -> Vec3 {
        Vec3::new(self.signed(), self.signed(), self.signed()).normalize_or(Vec3::X)
    }
}
