//! Scalar fields: what is sampled.
//!
//! A [`ScalarField`] is a real function of space in plain numbers, and says what values a box can have: what a game
//! implements. A [`StudyField`] says more of itself: where its isosurface is, and how many samples at once are made
//! cheaper. Solids are above the isovalue.
//!
//! | field | value |
//! |---|---|
//! | [`Sphere`], [`Asteroid`], [`Gyroid`] | formulas |
//! | [`Terrain`] | ground with hills, cliffs and caves, from [`noise()`] and [`Fractal`] |
//! | [`MeshDistance`] | the distance to a triangle mesh, positive inside |
//! | [`VolumeField`] | samples of a regular grid, interpolated; in memory, or read where they are wanted ([`StoredSamples`]) |
//! | [`Negated`], [`Walled`] | another field, turned round or ended at walls |
//! | [`Counted`] | another field, and how often it was called |
//!
//! No field uses the platform's mathematics: values are the same on every machine.

mod aabb;
#[cfg(feature = "shapes")]
mod asteroid;
#[cfg(feature = "shapes")]
mod asteroid_table;
mod check;
mod counted;
mod fractal;
#[cfg(feature = "shapes")]
mod gyroid;
#[cfg(feature = "shapes")]
mod mesh_distance;
mod negated;
mod noise;
mod scalar_field;
#[cfg(feature = "shapes")]
mod sine;
mod sphere;
mod terrain;
mod volume;
mod walled;

pub use aabb::Aabb;
#[cfg(feature = "shapes")]
pub use asteroid::Asteroid;
pub use check::{FieldFault, Watched, check_field};
pub use counted::Counted;
pub use fractal::{Fractal, MOST_OCTAVES, NoiseShape};
#[cfg(feature = "shapes")]
pub use gyroid::Gyroid;
#[cfg(feature = "shapes")]
pub use mesh_distance::{Holes, InwardPart, MeshDistance, MeshFieldError};
pub use negated::Negated;
pub use noise::{NOISE_CURVATURE, NOISE_SLOPE, noise, noise_and_gradient, noise_range};
pub use scalar_field::{Bound, FromFn, Plain, ScalarField, from_fn};
pub use sphere::Sphere;
pub use terrain::{Terrain, TerrainCharacter, TerrainError, TerrainSettings};
pub use volume::{Beyond, StoredSamples, UnreadSamples, VolumeField, VolumeFieldError, VolumeGrid};
pub use walled::Walled;

use std::any::Any;

use glam::{DVec3, Vec3};
use isostudy_mesh::Bounds;
use isostudy_mesh::metro::Foot;

/// A real function of space, with all that a study measures by. A point is inside the solid where the value is above the
/// isovalue. A game is served better by a [`ScalarField`].
///
/// A field must give the same value for the same point every time; then the mesh is the same every time.
/// `NaN` is allowed and counts as outside.
pub trait StudyField: Sync {
    /// The value at `p`.
    fn sample(&self, p: Vec3) -> f32;

    /// The values at `(x[i], y, z)` into `values[i]`, for a row of the lattice.
    ///
    /// Must agree with [`sample`](Self::sample) to the bit; override it only to share work along the row.
    /// The two slices have the same length.
    fn sample_row(&self, x: &[f32], y: f32, z: f32, values: &mut [f32]) {
        for (value, &x) in values.iter_mut().zip(x) {
            *value = self.sample(Vec3::new(x, y, z));
        }
    }

    /// The value at `p`, where the value at a point nearby may be known already.
    ///
    /// Must agree with [`sample`](Self::sample) to the bit; override it where the known value saves work.
    fn sample_after(&self, p: Vec3, _before: Option<(Vec3, f32)>) -> f32 {
        self.sample(p)
    }

    /// The values of a part of a row, as [`sample_row`](Self::sample_row), where the value at a point nearby may be
    /// known already.
    fn sample_row_after(&self, x: &[f32], y: f32, z: f32, values: &mut [f32], _before: Option<(Vec3, f32)>) {
        self.sample_row(x, y, z, values);
    }

    /// The values at some points near each other into `values`, where the value at a point nearby may be known already.
    ///
    /// Must agree with [`sample`](Self::sample) to the bit; override it only to share work between the points. The two slices have the
    /// same length.
    fn sample_near(&self, points: &[Vec3], values: &mut [f32], before: Option<(Vec3, f32)>) {
        for (value, &p) in values.iter_mut().zip(points) {
            *value = self.sample_after(p, before);
        }
    }

    /// How many values of a row to ask for at once near the surface. More take less time each where a row shares work, and some of
    /// them turn out not to be needed.
    fn values_at_once(&self) -> usize {
        4
    }

    /// A bound on how fast the value changes in a box: `|sample(p) - sample(q)| <= slope * |p - q|` for all `p` and
    /// `q` in it, up to rounding of 1e-5 of the values, and as if `p` and `q` were off by 1e-6 of their largest
    /// coordinates; and no value in it is `NaN`. `None` where nothing is known.
    ///
    /// With a bound, samples that cannot lie next to the surface are never taken. The mesh is the same, to the byte,
    /// as long as the promise holds.
    fn slope(&self, _bounds: Bounds) -> Option<f32> {
        None
    }

    /// The least and the greatest value that a point of the box can have, or more; none of them is `NaN`. `None` where
    /// nothing is known.
    ///
    /// `value` is the one in the middle, `(min + max) / 2`, or `NaN` as long as nobody has asked for it: the range is
    /// then `NaN` if it takes a value to tell. By default what [`slope`](Self::slope) says; override it where more is
    /// known.
    fn range(&self, bounds: Bounds, value: f32) -> Option<(f32, f32)> {
        Some(scalar_field::range_by_slope(self.slope(bounds)?, bounds, value))
    }

    /// How the value changes along x, y and z, where the field knows it.
    fn gradient(&self, _p: Vec3) -> Option<Vec3> {
        None
    }

    /// The nearest point to `p` of the isosurface, where the field knows it to the rounding of its coordinates. `None`
    /// where it does not; then it has to be searched for, and what is found may be farther.
    fn nearest_on_isosurface(&self, _p: DVec3, _isovalue: f32) -> Option<Foot> {
        None
    }

    /// The triangles that the isosurface consists of, where it does. Some may lie inside it, where a solid overlaps
    /// itself.
    fn isosurface_triangles(&self, _isovalue: f32) -> Option<&[[Vec3; 3]]> {
        None
    }

    /// The same field, value by value to the bit, made ready for very many samples, where that is worth while. What it
    /// takes lies in `kept`, which may hold what another field, or this one before, left there.
    fn prepared<'a>(&self, _kept: &'a mut FieldCache) -> Option<&'a dyn StudyField> {
        None
    }
}

impl<F: StudyField + ?Sized> StudyField for Box<F>
where
    Box<F>: Sync,
{
    fn sample(&self, p: Vec3) -> f32 {
        (**self).sample(p)
    }

    fn sample_row(&self, x: &[f32], y: f32, z: f32, values: &mut [f32]) {
        (**self).sample_row(x, y, z, values);
    }

    fn sample_after(&self, p: Vec3, before: Option<(Vec3, f32)>) -> f32 {
        (**self).sample_after(p, before)
    }

    fn sample_row_after(&self, x: &[f32], y: f32, z: f32, values: &mut [f32], before: Option<(Vec3, f32)>) {
        (**self).sample_row_after(x, y, z, values, before);
    }

    fn sample_near(&self, points: &[Vec3], values: &mut [f32], before: Option<(Vec3, f32)>) {
        (**self).sample_near(points, values, before);
    }

    fn values_at_once(&self) -> usize {
        (**self).values_at_once()
    }

    fn slope(&self, bounds: Bounds) -> Option<f32> {
        (**self).slope(bounds)
    }

    fn range(&self, bounds: Bounds, value: f32) -> Option<(f32, f32)> {
        (**self).range(bounds, value)
    }

    fn gradient(&self, p: Vec3) -> Option<Vec3> {
        (**self).gradient(p)
    }

    fn nearest_on_isosurface(&self, p: DVec3, isovalue: f32) -> Option<Foot> {
        (**self).nearest_on_isosurface(p, isovalue)
    }

    fn isosurface_triangles(&self, isovalue: f32) -> Option<&[[Vec3; 3]]> {
        (**self).isosurface_triangles(isovalue)
    }

    fn prepared<'a>(&self, kept: &'a mut FieldCache) -> Option<&'a dyn StudyField> {
        (**self).prepared(kept)
    }
}

/// What a field keeps from one extraction to the next, so that it need not be made again.
#[derive(Debug, Default)]
pub struct FieldCache(Option<Box<dyn Any + Send + Sync>>);

impl FieldCache {
    /// What is kept, if it is a `T` and `fits`; otherwise what `make` gives, which is kept from now on.
    pub fn get_or_make<T: Any + Send + Sync>(
        &mut self,
        fits: impl FnOnce(&T) -> bool,
        make: impl FnOnce() -> Option<T>,
    ) -> Option<&T> {
        let has = self.0.as_ref().and_then(|kept| kept.downcast_ref()).is_some_and(fits);
        if !has {
            self.0 = make().map(|made| Box::new(made) as _);
        }
        self.0.as_ref()?.downcast_ref()
    }
}

/// Whether lengths of points of a box are what they should be: nowhere do squares of coordinates overflow, nor are all
/// so small that they lose digits.
pub(crate) fn has_sound_lengths(bounds: Bounds) -> bool {
    (1e-15..=1e18).contains(&bounds.min.abs().max(bounds.max.abs()).max_element())
}

/// More than one, by more than the rounding of a sample and of a bound: what a bound is multiplied by before a sample is left
/// out on its account.
pub const SAFE: f32 = 1.0 + 2e-5;
