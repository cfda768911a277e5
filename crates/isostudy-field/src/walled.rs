//! A field that ends at the walls of a box.

use glam::Vec3;
use isostudy_mesh::Bounds;

use super::StudyField;

/// A field whose solid is cut off by a box: on its walls and beyond them no value is above the isovalue.
///
/// On a lattice over that box, with guarded topology and indexed positions, the outermost samples lie on the walls. So
/// the surface of any field is closed there, whatever the field and the spacing are: it is that of the solid's common
/// part with the box, and lies in the wall where the solid would go on. A value that was above the isovalue becomes
/// equal to it; others stay what they are.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Walled<F> {
    field: F,
    bounds: Bounds,
    isovalue: f32,
}

impl<F: StudyField> Walled<F> {
    /// `field` with the walls of `bounds`, for surfaces at `isovalue`.
    pub fn new(field: F, bounds: Bounds, isovalue: f32) -> Self {
        Self { field, bounds, isovalue }
    }

    /// Whether a point lies off the walls, on the inner side of all of them.
    fn is_within(&self, p: Vec3) -> bool {
        (p.cmpgt(self.bounds.min) & p.cmplt(self.bounds.max)).all()
    }

    fn walled(&self, p: Vec3, value: f32) -> f32 {
        if value > self.isovalue && !self.is_within(p) { self.isovalue } else { value }
    }

    /// What the field itself says; at a wall another value stands for it.
    fn known(&self, before: Option<(Vec3, f32)>) -> Option<(Vec3, f32)> {
        before.filter(|&(p, _)| self.is_within(p))
    }

    /// Whether no point of a box lies on a wall or beyond it.
    fn is_clear(&self, bounds: Bounds) -> bool {
        self.is_within(bounds.min) && self.is_within(bounds.max)
    }
}

impl<F: StudyField> StudyField for Walled<F> {
    fn sample(&self, p: Vec3) -> f32 {
        self.walled(p, self.field.sample(p))
    }

    fn sample_row(&self, x: &[f32], y: f32, z: f32, values: &mut [f32]) {
        self.field.sample_row(x, y, z, values);
        for (value, &x) in values.iter_mut().zip(x) {
            *value = self.walled(Vec3::new(x, y, z), *value);
        }
    }

    fn sample_after(&self, p: Vec3, before: Option<(Vec3, f32)>) -> f32 {
        self.walled(p, self.field.sample_after(p, self.known(before)))
    }

    fn sample_row_after(&self, x: &[f32], y: f32, z: f32, values: &mut [f32], before: Option<(Vec3, f32)>) {
        self.field.sample_row_after(x, y, z, values, self.known(before));
        for (value, &x) in values.iter_mut().zip(x) {
            *value = self.walled(Vec3::new(x, y, z), *value);
        }
    }

    fn sample_near(&self, points: &[Vec3], values: &mut [f32], before: Option<(Vec3, f32)>) {
        self.field.sample_near(points, values, self.known(before));
        for (value, &p) in values.iter_mut().zip(points) {
            *value = self.walled(p, *value);
        }
    }

    fn values_at_once(&self) -> usize {
        self.field.values_at_once()
    }

    /// The field's; nothing is known where it jumps.
    fn slope(&self, bounds: Bounds) -> Option<f32> {
        if self.is_clear(bounds) { self.field.slope(bounds) } else { None }
    }

    /// The field's; on a wall and beyond it nothing is known.
    fn gradient(&self, p: Vec3) -> Option<Vec3> {
        if self.is_within(p) { self.field.gradient(p) } else { None }
    }

    fn range(&self, bounds: Bounds, value: f32) -> Option<(f32, f32)> {
        if self.is_clear(bounds) {
            return self.field.range(bounds, value);
        }
        let centre = (bounds.min + bounds.max) * 0.5;
        let value = if value.is_nan() || self.is_within(centre) { value } else { self.field.sample(centre) };
        let (low, high) = self.field.range(bounds, value)?;
        // A range that takes a value to tell stays not a number.
        Some((if low > self.isovalue { self.isovalue } else { low }, high))
    }
}
