//! A field in plain numbers, for programs with mathematics of their own.

use std::sync::Arc;

use glam::Vec3;
use isostudy_mesh::Bounds;

use crate::{Aabb, SAFE, StudyField};

/// A real function of space. A point is inside the solid where the value is above the isovalue.
///
/// What a field promises:
/// - it gives the same value for the same point every time;
/// - [`sample_row`](Self::sample_row) agrees with [`sample`](Self::sample) to the bit;
/// - [`bound`](Self::bound) holds.
///
/// If a promise is broken, extraction neither fails nor panics: surfaces are missing, walls stand where there is nothing,
/// neighbouring chunks do not fit. Debug builds test one answer in a thousand and panic with what they found;
/// [`check_field`](crate::check_field) looks harder, for a test. `NaN` is allowed and counts as outside.
///
/// ```
/// use isostudy_field::{Aabb, Bound, ScalarField, from_fn};
///
/// let closure = from_fn(|[x, y, z]: [f32; 3]| 1.0 - (x * x + y * y + z * z).sqrt());
/// assert_eq!(closure.sample([0.0, 0.0, 0.5]), 0.5);
///
/// struct Ball;
///
/// impl ScalarField for Ball {
///     fn sample(&self, [x, y, z]: [f32; 3]) -> f32 {
///         1.0 - (x * x + y * y + z * z).sqrt()
///     }
///     // A distance changes as fast as one walks.
///     fn bound(&self, _: Aabb) -> Bound {
///         Bound::slope(1.0)
///     }
/// }
/// ```
pub trait ScalarField: Sync {
    /// The value at `p`.
    fn sample(&self, p: [f32; 3]) -> f32;

    /// The values at `(x[i], y, z)` into `values[i]`, for a row of points. The two slices have the same length.
    ///
    /// Override it to share work along the row.
    fn sample_row(&self, x: &[f32], y: f32, z: f32, values: &mut [f32]) {
        for (value, &x) in values.iter_mut().zip(x) {
            *value = self.sample([x, y, z]);
        }
    }

    /// How the value changes along x, y and z, where the field knows it: towards the inside of the solid. For
    /// `Normals::Field`; without it, differences between samples a sixty-fourth of a cell away on either side are taken.
    fn gradient(&self, _p: [f32; 3]) -> Option<[f32; 3]> {
        None
    }

    /// What is known of the values in a box. It is what saves most samples: the samples of a terrain of hills fell to a half
    /// with a slope and to a third with a range, and a chunk of 32³ cells without surface took 80 ns in place of 11 ms.
    fn bound(&self, _bounds: Aabb) -> Bound {
        Bound::UNKNOWN
    }
}

/// What is known of a field's values in a box; more is better.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[non_exhaustive]
pub struct Bound {
    /// `|f(p) - f(q)| <= slope * |p - q|` for all points of the box, up to rounding of 1e-5 of the values, and as if the
    /// points were off by 1e-6 of their largest coordinates.
    pub slope: Option<f32>,
    /// The least and the greatest value of a point of the box, or more.
    pub range: Option<(f32, f32)>,
}

impl Bound {
    /// Nothing; the values may even be `NaN`. All other bounds say that none is.
    pub const UNKNOWN: Self = Self { slope: None, range: None };

    /// The value changes no faster than this.
    pub const fn slope(slope: f32) -> Self {
        Self { slope: Some(slope), range: None }
    }

    /// No value is below the first or above the second.
    pub const fn range(least: f32, greatest: f32) -> Self {
        Self { slope: None, range: Some((least, greatest)) }
    }

    /// The same with a slope.
    pub const fn with_slope(self, slope: f32) -> Self {
        Self { slope: Some(slope), ..self }
    }

    /// What it says of a box when the value in the middle is known: the range, or what the slope makes of that value.
    pub fn range_round(&self, bounds: Aabb, middle: f32) -> Option<(f32, f32)> {
        self.range.or_else(|| Some(range_by_slope(self.slope?, bounds.into(), middle)))
    }
}

/// The values in a box in whose middle the value is `middle`.
pub(crate) fn range_by_slope(slope: f32, bounds: Bounds, middle: f32) -> (f32, f32) {
    let centre = (bounds.min + bounds.max) * 0.5;
    let size = centre.abs().max_element() + bounds.size().max_element();
    let radius = bounds.size().length() * 0.5 * SAFE + size * (SAFE - 1.0);
    let change = slope * radius + middle.abs() * (SAFE - 1.0);
    (middle - change, middle + change)
}

macro_rules! forwarded {
    ($($pointer:ty),*) => {$(
        impl<F: ScalarField + ?Sized> ScalarField for $pointer
        where
            Self: Sync,
        {
            fn sample(&self, p: [f32; 3]) -> f32 {
                (**self).sample(p)
            }
            fn sample_row(&self, x: &[f32], y: f32, z: f32, values: &mut [f32]) {
                (**self).sample_row(x, y, z, values);
            }
            fn gradient(&self, p: [f32; 3]) -> Option<[f32; 3]> {
                (**self).gradient(p)
            }
            fn bound(&self, bounds: Aabb) -> Bound {
                (**self).bound(bounds)
            }
        }
    )*};
}

forwarded!(&F, Box<F>, Arc<F>);

/// A closure as a field.
pub fn from_fn<F: Fn([f32; 3]) -> f32 + Sync>(sample: F) -> FromFn<F> {
    FromFn(sample)
}

/// A closure as a field: [`from_fn`] makes it.
#[derive(Debug, Clone, Copy)]
pub struct FromFn<F>(F);

impl<F: Fn([f32; 3]) -> f32 + Sync> ScalarField for FromFn<F> {
    fn sample(&self, p: [f32; 3]) -> f32 {
        (self.0)(p)
    }
}

/// The fields of this crate, in plain numbers.
macro_rules! in_plain_numbers {
    ($($field:ty),*) => {$(
        impl ScalarField for $field {
            fn sample(&self, p: [f32; 3]) -> f32 {
                StudyField::sample(self, p.into())
            }
            fn sample_row(&self, x: &[f32], y: f32, z: f32, values: &mut [f32]) {
                StudyField::sample_row(self, x, y, z, values);
            }
            fn gradient(&self, p: [f32; 3]) -> Option<[f32; 3]> {
                StudyField::gradient(self, p.into()).map(Into::into)
            }
            fn bound(&self, bounds: Aabb) -> Bound {
                let range = self.range(bounds.into(), f32::NAN);
                let range = range.filter(|(least, greatest)| !(least.is_nan() || greatest.is_nan()));
                Bound { slope: StudyField::slope(self, bounds.into()), range }
            }
        }
    )*};
}

in_plain_numbers!(crate::Sphere, crate::Terrain, crate::VolumeField);
#[cfg(feature = "shapes")]
in_plain_numbers!(crate::Asteroid, crate::Gyroid, crate::MeshDistance);
/// A field in plain numbers as the extractor calls it.
#[derive(Clone, Copy)]
pub struct Plain<'a>(pub &'a dyn ScalarField);

impl StudyField for Plain<'_> {
    fn sample(&self, p: Vec3) -> f32 {
        self.0.sample(p.into())
    }

    fn sample_row(&self, x: &[f32], y: f32, z: f32, values: &mut [f32]) {
        self.0.sample_row(x, y, z, values);
    }

    fn slope(&self, bounds: Bounds) -> Option<f32> {
        self.0.bound(bounds.into()).slope
    }

    fn range(&self, bounds: Bounds, value: f32) -> Option<(f32, f32)> {
        self.0.bound(bounds.into()).range_round(bounds.into(), value)
    }

    fn gradient(&self, p: Vec3) -> Option<Vec3> {
        self.0.gradient(p.into()).map(Vec3::from)
    }
}
