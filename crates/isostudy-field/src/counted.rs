//! A field that counts how often it is called.

use std::sync::atomic::{AtomicU64, Ordering};

use glam::{DVec3, Vec3};
use isostudy_mesh::Bounds;
use isostudy_mesh::metro::Foot;

use super::{FieldCache, StudyField};

/// Another field, value by value to the bit, that counts its values and gradients. What is known without a value (slopes, ranges, nearest
/// points) is not counted. The counts are the same on any number of threads if what is asked for is.
///
/// ```
/// use isostudy_field::{Counted, FieldCache, Sphere, StudyField};
/// # use glam::Vec3;
///
/// let mut kept = FieldCache::default();
/// let counted = Counted::new(&Sphere { radius: 1.0 }, &mut kept);
/// counted.sample_row(&[0.0, 0.5, 1.0], 0.0, 0.0, &mut [0.0; 3]);
/// counted.gradient(Vec3::X);
/// assert_eq!((counted.evaluations(), counted.gradients()), (3, 1));
/// ```
pub struct Counted<'a> {
    field: &'a dyn StudyField,
    evaluations: AtomicU64,
    gradients: AtomicU64,
}

impl<'a> Counted<'a> {
    /// None yet. The field is made ready for very many samples, if that is worth while.
    pub fn new(field: &'a dyn StudyField, kept: &'a mut FieldCache) -> Self {
        let field = field.prepared(kept).unwrap_or(field);
        Self { field, evaluations: AtomicU64::new(0), gradients: AtomicU64::new(0) }
    }

    /// How many values were asked for.
    pub fn evaluations(&self) -> u64 {
        self.evaluations.load(Ordering::Relaxed)
    }

    /// How many gradients the field gave.
    pub fn gradients(&self) -> u64 {
        self.gradients.load(Ordering::Relaxed)
    }

    fn count(&self, values: usize) {
        self.evaluations.fetch_add(values as u64, Ordering::Relaxed);
    }
}

impl StudyField for Counted<'_> {
    fn sample(&self, p: Vec3) -> f32 {
        self.count(1);
        self.field.sample(p)
    }

    fn sample_row(&self, x: &[f32], y: f32, z: f32, values: &mut [f32]) {
        self.count(values.len());
        self.field.sample_row(x, y, z, values);
    }

    fn sample_after(&self, p: Vec3, before: Option<(Vec3, f32)>) -> f32 {
        self.count(1);
        self.field.sample_after(p, before)
    }

    fn sample_row_after(&self, x: &[f32], y: f32, z: f32, values: &mut [f32], before: Option<(Vec3, f32)>) {
        self.count(values.len());
        self.field.sample_row_after(x, y, z, values, before);
    }

    fn sample_near(&self, points: &[Vec3], values: &mut [f32], before: Option<(Vec3, f32)>) {
        self.count(values.len());
        self.field.sample_near(points, values, before);
    }

    fn values_at_once(&self) -> usize {
        self.field.values_at_once()
    }

    fn slope(&self, bounds: Bounds) -> Option<f32> {
        self.field.slope(bounds)
    }

    fn range(&self, bounds: Bounds, value: f32) -> Option<(f32, f32)> {
        self.field.range(bounds, value)
    }

    fn gradient(&self, p: Vec3) -> Option<Vec3> {
        let gradient = self.field.gradient(p);
        if gradient.is_some() {
            self.gradients.fetch_add(1, Ordering::Relaxed);
        }
        gradient
    }

    fn nearest_on_isosurface(&self, p: DVec3, isovalue: f32) -> Option<Foot> {
        self.field.nearest_on_isosurface(p, isovalue)
    }

    fn isosurface_triangles(&self, isovalue: f32) -> Option<&[[Vec3; 3]]> {
        self.field.isosurface_triangles(isovalue)
    }
}
