//! Whether a field keeps what it promises.

use std::error::Error;
use std::fmt;
use std::sync::atomic::{AtomicU64, Ordering};

use glam::Vec3;
use isostudy_mesh::Bounds;

use crate::{Aabb, Bound, Plain, ScalarField, StudyField};

/// A promise that a field has broken, with the place.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum FieldFault {
    /// Two values for one point.
    NotRepeatable {
        /// The point.
        p: [f32; 3],
        /// One value.
        first: f32,
        /// Another.
        second: f32,
    },
    /// A row that is not the samples of its points.
    Row {
        /// The point.
        p: [f32; 3],
        /// What `sample_row` says.
        row: f32,
        /// What `sample` says.
        sample: f32,
    },
    /// A value beyond the range, or none, where a bound says that there is one.
    Range {
        /// The point.
        p: [f32; 3],
        /// The value there.
        value: f32,
        /// The box.
        bounds: Aabb,
        /// What the bound says.
        range: (f32, f32),
    },
    /// Two values that are farther apart than the slope allows.
    Slope {
        /// One point.
        p: [f32; 3],
        /// Another.
        q: [f32; 3],
        /// The value at the first.
        value: f32,
        /// The value at the second.
        other: f32,
        /// How fast it changes between them.
        steepness: f32,
        /// What the bound says.
        slope: f32,
    },
    /// A range with its ends exchanged, or a slope below zero or not a number.
    Bound {
        /// The box.
        bounds: Aabb,
        /// What it says there.
        bound: Bound,
    },
}

impl fmt::Display for FieldFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotRepeatable { p, first, second } => {
                write!(f, "at {p:?} the field is {first} and then {second}")
            }
            Self::Row { p, row, sample } => write!(f, "at {p:?} sample_row says {row} and sample {sample}"),
            Self::Range { p, value, bounds, range } => write!(
                f,
                "at {p:?} the field is {value}, in the box {:?} to {:?}, where it says {} to {}",
                bounds.min, bounds.max, range.0, range.1
            ),
            Self::Slope { p, q, value, other, steepness, slope } => write!(
                f,
                "from {value} at {p:?} to {other} at {q:?} the field changes by {steepness} per unit, where it says at most {slope}"
            ),
            Self::Bound { bounds, bound } => write!(
                f,
                "in the box {:?} to {:?} the field says {bound:?}, which nothing can be",
                bounds.min, bounds.max
            ),
        }
    }
}

impl Error for FieldFault {}

/// Looks for a broken promise of a field in a box: `probes` times, in boxes of all sizes at places that depend on nothing
/// but the number, whether values come again, whether rows agree with single samples, and whether the bound holds.
/// For tests: what it does not find may still be there.
///
/// Costs some 40 samples a probe.
///
/// # Errors
/// The first [`FieldFault`] that is found.
///
/// ```
/// use isostudy_field::{Aabb, Bound, FieldFault, ScalarField, check_field};
///
/// struct Hills;
///
/// impl ScalarField for Hills {
///     fn sample(&self, [x, _, z]: [f32; 3]) -> f32 {
///         10.0 * (0.1 * x).sin() - z
///     }
///     fn bound(&self, _: Aabb) -> Bound {
///         Bound::slope(0.3)
///     }
/// }
///
/// let world = Aabb { min: [-100.0, -100.0, -20.0], max: [100.0, 100.0, 20.0] };
/// // The slope is up to the square root of two.
/// assert!(matches!(check_field(&Hills, world, 100), Err(FieldFault::Slope { .. })));
/// ```
pub fn check_field(field: &dyn ScalarField, bounds: Aabb, probes: u32) -> Result<(), FieldFault> {
    let mut numbers = Numbers(0x9e37_79b9_7f4a_7c15);
    let whole = Bounds::from(bounds);
    (0..probes).try_for_each(|probe| {
        // From the whole box down to a thousandth of it.
        let size = whole.size() * 0.5f32.powi((probe % 11) as i32);
        let corner = |t: [f32; 3]| whole.min + (whole.size() - size) * Vec3::from(t);
        let min = corner([(); 3].map(|()| numbers.next()));
        probe_box(field, Aabb::from(Bounds { min, max: min + size }), &mut numbers)
    })
}

/// Points of a row.
const ROW: usize = 12;

/// Checks one box, by a row through it and some points.
fn probe_box(field: &dyn ScalarField, bounds: Aabb, numbers: &mut Numbers) -> Result<(), FieldFault> {
    let bound = field.bound(bounds);
    let inverted = bound.range.is_some_and(|(least, greatest)| least > greatest);
    if inverted || bound.slope.is_some_and(|slope| slope < 0.0 || slope.is_nan()) {
        return Err(FieldFault::Bound { bounds, bound });
    }
    let within = |axis: usize, t: f32| {
        (bounds.min[axis] + (bounds.max[axis] - bounds.min[axis]) * t)
            .clamp(bounds.min[axis], bounds.max[axis])
    };
    let (y, z) = (within(1, numbers.next()), within(2, numbers.next()));
    let mut x: [f32; ROW] = std::array::from_fn(|_| within(0, numbers.next()));
    x.sort_unstable_by(f32::total_cmp);
    let mut row = [0.0; ROW];
    field.sample_row(&x, y, z, &mut row);
    let mut points = Vec::with_capacity(2 * ROW);
    for (&x, row) in x.iter().zip(row) {
        let p = [x, y, z];
        let (sample, again) = (field.sample(p), field.sample(p));
        if !same(sample, again) {
            return Err(FieldFault::NotRepeatable { p, first: sample, second: again });
        }
        if !same(row, sample) {
            return Err(FieldFault::Row { p, row, sample });
        }
        points.push((p, sample));
    }
    points.extend((0..ROW).map(|_| {
        let p = [0, 1, 2].map(|axis| within(axis, numbers.next()));
        (p, field.sample(p))
    }));
    points.iter().try_for_each(|&(p, value)| check_range(&bound, bounds, p, value))?;
    points.windows(2).try_for_each(|pair| check_slope(&bound, pair[0], pair[1]))
}

fn same(a: f32, b: f32) -> bool {
    a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan())
}

fn check_range(bound: &Bound, bounds: Aabb, p: [f32; 3], value: f32) -> Result<(), FieldFault> {
    if bound.slope.is_none() && bound.range.is_none() {
        return Ok(());
    }
    let range = bound.range.unwrap_or((f32::NEG_INFINITY, f32::INFINITY));
    let slack = 1e-5 * value.abs();
    // Not a number fails either.
    if value >= range.0 - slack && value <= range.1 + slack {
        return Ok(());
    }
    Err(FieldFault::Range { p, value, bounds, range })
}

fn check_slope(
    bound: &Bound,
    (p, value): ([f32; 3], f32),
    (q, other): ([f32; 3], f32),
) -> Result<(), FieldFault> {
    let Some(slope) = bound.slope else { return Ok(()) };
    let (from, to) = (Vec3::from(p), Vec3::from(q));
    let way = from.distance(to);
    let astray = 2e-6 * from.abs().max(to.abs()).max_element();
    let change = (value - other).abs();
    if change <= slope * (way + astray) + 1e-5 * (value.abs() + other.abs()) {
        return Ok(());
    }
    Err(FieldFault::Slope { p, q, value, other, steepness: change / way, slope })
}

/// A field that is checked while it is called: about one answer in a thousand.
pub struct Watched<'a> {
    field: &'a dyn ScalarField,
    calls: AtomicU64,
}

/// One call in so many is looked at.
const EVERY: u64 = 1000;

impl<'a> Watched<'a> {
    /// The field, to be watched.
    pub fn new(field: &'a dyn ScalarField) -> Self {
        Self { field, calls: AtomicU64::new(0) }
    }

    /// Looks at a box if it is its turn, which comes sooner for a call that says more.
    fn look(&self, bounds: Bounds, weight: u64) {
        let before = self.calls.fetch_add(weight, Ordering::Relaxed);
        if before % EVERY >= weight {
            return;
        }
        if let Err(fault) = probe_box(self.field, bounds.into(), &mut Numbers(before)) {
            panic!("the field breaks a promise: {fault}");
        }
    }
}

/// # Panics
/// If a promise is seen to be broken.
impl StudyField for Watched<'_> {
    fn sample(&self, p: Vec3) -> f32 {
        self.look(Bounds { min: p, max: p }, 1);
        self.field.sample(p.into())
    }

    fn sample_row(&self, x: &[f32], y: f32, z: f32, values: &mut [f32]) {
        if let (Some(&first), Some(&last)) = (x.first(), x.last()) {
            self.look(Bounds { min: Vec3::new(first, y, z), max: Vec3::new(last, y, z) }, x.len() as u64);
        }
        self.field.sample_row(x, y, z, values);
    }

    fn slope(&self, bounds: Bounds) -> Option<f32> {
        self.look(bounds, 20);
        Plain(self.field).slope(bounds)
    }

    fn range(&self, bounds: Bounds, value: f32) -> Option<(f32, f32)> {
        // A large box decides much.
        self.look(bounds, 100);
        Plain(self.field).range(bounds, value)
    }

    fn gradient(&self, p: Vec3) -> Option<Vec3> {
        Plain(self.field).gradient(p)
    }
}

/// SplitMix64, from 0 up to, without, 1.
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f32 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 40) as f32 / (1u32 << 24) as f32
    }
}

#[cfg(all(test, feature = "shapes"))]
mod tests {
    use super::*;
    use crate::{Asteroid, Gyroid, Sphere, from_fn};
    use std::sync::atomic::AtomicU32;

    const BOX: Aabb = Aabb { min: [-1.0; 3], max: [1.5; 3] };

    #[test]
    fn honest_fields_pass() {
        for field in [&Sphere { radius: 0.7 } as &dyn ScalarField, &Asteroid::default(), &Gyroid::default()] {
            check_field(field, BOX, 2000).unwrap();
        }
        check_field(&from_fn(|_| f32::NAN), BOX, 10).unwrap();
    }

    /// A field of four parts.
    struct Of<S, B> {
        sample: S,
        row_is_off: f32,
        bound: B,
    }

    impl<S: Fn([f32; 3]) -> f32 + Sync, B: Fn(Aabb) -> Bound + Sync> ScalarField for Of<S, B> {
        fn sample(&self, p: [f32; 3]) -> f32 {
            (self.sample)(p)
        }
        fn sample_row(&self, x: &[f32], y: f32, z: f32, values: &mut [f32]) {
            for (value, &x) in values.iter_mut().zip(x) {
                *value = self.sample([x, y, z]) + self.row_is_off;
            }
        }
        fn bound(&self, bounds: Aabb) -> Bound {
            (self.bound)(bounds)
        }
    }

    fn fault(
        sample: impl Fn([f32; 3]) -> f32 + Sync,
        row_is_off: f32,
        bound: impl Fn(Aabb) -> Bound + Sync,
    ) -> FieldFault {
        let field = Of { sample, row_is_off, bound };
        let fault = check_field(&field, BOX, 200).expect_err("a fault");
        let watched = Watched::new(&field);
        let seen = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| {
            for _ in 0..400 {
                watched.range(BOX.into(), f32::NAN);
                watched.sample_row(&[-1.0, 0.0, 1.5], 0.0, 0.5, &mut [0.0; 3]);
            }
        }));
        assert!(seen.is_err(), "{fault}");
        fault
    }

    #[test]
    fn each_broken_promise_is_named_with_its_place() {
        let tilted = |p: [f32; 3]| 2.0 * p[0];
        let unknown = |_| Bound::UNKNOWN;
        let calls = AtomicU32::new(0);
        let drifting = |_| calls.fetch_add(1, Ordering::Relaxed) as f32;
        assert!(matches!(fault(drifting, 0.0, unknown), FieldFault::NotRepeatable { .. }));
        assert!(matches!(fault(tilted, 1e-6, unknown), FieldFault::Row { .. }));
        let FieldFault::Slope { steepness, slope, .. } = fault(tilted, 0.0, |_| Bound::slope(0.5)) else {
            panic!("another fault");
        };
        assert!(slope == 0.5 && steepness > 0.5 && steepness < 2.01, "{steepness}");
        let FieldFault::Range { p, value, .. } = fault(tilted, 0.0, |_| Bound::range(-1.0, 1.0)) else {
            panic!("another fault");
        };
        assert!(value == 2.0 * p[0] && value.abs() > 1.0);
        assert!(matches!(fault(tilted, 0.0, |_| Bound::range(1.0, -1.0)), FieldFault::Bound { .. }));
        assert!(matches!(fault(tilted, 0.0, |_| Bound::slope(f32::NAN)), FieldFault::Bound { .. }));
        let hollow = |p: [f32; 3]| if p[0] > 0.0 { f32::NAN } else { 0.0 };
        assert!(matches!(fault(hollow, 0.0, |_| Bound::range(0.0, 0.0)), FieldFault::Range { .. }));
    }
}
