//! A field with inside and outside exchanged.

use glam::{DVec3, Vec3};
use isostudy_mesh::Bounds;
use isostudy_mesh::metro::Foot;

use super::StudyField;

/// Minus a field. With the isovalue negated as well, inside is where the field is *below* its isovalue, as with a
/// signed distance that is negative inside. A value equal to the isovalue stays outside, and so does `NaN`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Negated<F>(pub F);

impl<F: StudyField> StudyField for Negated<F> {
    fn sample(&self, p: Vec3) -> f32 {
        -self.0.sample(p)
    }

    fn sample_row(&self, x: &[f32], y: f32, z: f32, values: &mut [f32]) {
        self.0.sample_row(x, y, z, values);
        values.iter_mut().for_each(|v| *v = -*v);
    }

    fn sample_after(&self, p: Vec3, before: Option<(Vec3, f32)>) -> f32 {
        -self.0.sample_after(p, before.map(|(q, v)| (q, -v)))
    }

    fn sample_row_after(&self, x: &[f32], y: f32, z: f32, values: &mut [f32], before: Option<(Vec3, f32)>) {
        self.0.sample_row_after(x, y, z, values, before.map(|(q, v)| (q, -v)));
        values.iter_mut().for_each(|v| *v = -*v);
    }

    fn sample_near(&self, points: &[Vec3], values: &mut [f32], before: Option<(Vec3, f32)>) {
        self.0.sample_near(points, values, before.map(|(q, v)| (q, -v)));
        values.iter_mut().for_each(|v| *v = -*v);
    }

    fn values_at_once(&self) -> usize {
        self.0.values_at_once()
    }

    fn slope(&self, bounds: Bounds) -> Option<f32> {
        self.0.slope(bounds)
    }

    fn range(&self, bounds: Bounds, value: f32) -> Option<(f32, f32)> {
        self.0.range(bounds, -value).map(|(low, high)| (-high, -low))
    }

    fn gradient(&self, p: Vec3) -> Option<Vec3> {
        self.0.gradient(p).map(|gradient| -gradient)
    }

    fn nearest_on_isosurface(&self, p: DVec3, isovalue: f32) -> Option<Foot> {
        self.0.nearest_on_isosurface(p, -isovalue)
    }

    fn isosurface_triangles(&self, isovalue: f32) -> Option<&[[Vec3; 3]]> {
        self.0.isosurface_triangles(-isovalue)
    }
}
