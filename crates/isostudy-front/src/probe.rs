//! Values, gradients, and the way to the surface.

use std::cell::Cell;

use glam::DVec3;
use isostudy_field::{SAFE, StudyField};
use isostudy_mesh::Bounds;

/// Newton's steps until the way is given up.
const STEPS: u32 = 24;
/// A step shorter than this, in edge lengths, is the last: the error after it is about its square.
const LAST_STEP: f64 = 1e-3;
/// Halvings of a segment whose ends lie on different sides.
const HALVINGS: u32 = 24;

/// How far round a kink normals are compared, in reaches.
const MEAN_OVER: f64 = 0.1;
/// Normals with a greater cosine are one.
const ALIKE: f64 = 0.9;

/// A field that is asked for values relative to the isovalue, and counts.
pub(crate) struct Probe<'a> {
    field: &'a dyn StudyField,
    isovalue: f64,
    edge: f64,
    values: Cell<u64>,
    gradients: Cell<u64>,
}

/// A point on the surface.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Foot {
    /// Representable in single precision.
    pub(crate) place: DVec3,
    /// Unit, outward: against the gradient.
    pub(crate) normal: DVec3,
}

/// Why no point was found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Miss {
    /// The value or the gradient is no finite number here.
    NoNumber(DVec3),
    /// The gradient is zero here.
    Flat(DVec3),
    /// The surface is farther than the reach, or was not reached.
    Far,
}

impl<'a> Probe<'a> {
    pub(crate) fn new(field: &'a dyn StudyField, isovalue: f32, edge: f64) -> Self {
        Self { field, isovalue: f64::from(isovalue), edge, values: Cell::new(0), gradients: Cell::new(0) }
    }

    /// Values asked for, those for differences included.
    pub(crate) fn values(&self) -> u64 {
        self.values.get()
    }

    /// Gradients that the field gave itself.
    pub(crate) fn gradients(&self) -> u64 {
        self.gradients.get()
    }

    /// The value minus the isovalue, which may be `NaN`.
    pub(crate) fn value(&self, p: DVec3) -> f64 {
        self.values.set(self.values.get() + 1);
        f64::from(self.field.sample(p.as_vec3())) - self.isovalue
    }

    /// Whether a box is all inside or all outside, where the field knows.
    pub(crate) fn side_of_box(&self, min: DVec3, max: DVec3) -> Option<bool> {
        let bounds = Bounds { min: min.as_vec3(), max: max.as_vec3() };
        let mut range = self.field.range(bounds, f32::NAN)?;
        if range.0.is_nan() || range.1.is_nan() {
            self.values.set(self.values.get() + 1);
            let middle = self.field.sample((bounds.min + bounds.max) * 0.5);
            range = self.field.range(bounds, middle)?;
        }
        let (least, greatest) = range;
        let (least, greatest) = (f64::from(least) - self.isovalue, f64::from(greatest) - self.isovalue);
        let slack = f64::from(SAFE - 1.0) * (least.abs() + greatest.abs());
        match () {
            () if least > slack => Some(true),
            () if greatest < -slack => Some(false),
            () => None,
        }
    }

    /// The values of a row minus the isovalue.
    pub(crate) fn row(&self, x: &[f32], y: f32, z: f32, values: &mut [f32]) {
        self.values.set(self.values.get() + x.len() as u64);
        self.field.sample_row(x, y, z, values);
        values.iter_mut().for_each(|value| *value = (f64::from(*value) - self.isovalue) as f32);
    }

    /// The gradient: the field's own, or else differences of values a sixty-fourth of an edge to either side.
    pub(crate) fn gradient(&self, p: DVec3) -> Result<DVec3, Miss> {
        let gradient = match self.field.gradient(p.as_vec3()) {
            Some(gradient) => {
                self.gradients.set(self.gradients.get() + 1);
                gradient.as_dvec3()
            }
            None => self.differences(p),
        };
        match gradient {
            g if !g.is_finite() => Err(Miss::NoNumber(p)),
            DVec3::ZERO => Err(Miss::Flat(p)),
            g => Ok(g),
        }
    }

    fn differences(&self, p: DVec3) -> DVec3 {
        let step = self.edge / 64.0;
        let along = |axis: DVec3| {
            let [before, after] = [p - axis * step, p + axis * step].map(rounded);
            (self.value(after) - self.value(before)) / (after - before).dot(axis)
        };
        DVec3::new(along(DVec3::X), along(DVec3::Y), along(DVec3::Z))
    }

    /// The outward unit normal at a point.
    pub(crate) fn normal(&self, p: DVec3) -> Result<DVec3, Miss> {
        Ok(-self.gradient(p)?.normalize_or(DVec3::Z))
    }

    /// Newton's method along the gradient, to a point at most `reach` away. Where two steps land on different sides and the second is
    /// not much nearer, the segment between them is halved: so creases end in a root as well.
    pub(crate) fn project(&self, from: DVec3, reach: f64) -> Result<Foot, Miss> {
        self.project_within(from, reach, |direction| direction)
    }

    /// The same, with steps in the directions that `allowed` leaves of a gradient.
    pub(crate) fn project_within(
        &self,
        from: DVec3,
        reach: f64,
        allowed: impl Fn(DVec3) -> DVec3,
    ) -> Result<Foot, Miss> {
        let mut p = rounded(from);
        let mut value = self.value(p);
        let mut before: Option<DVec3> = None;
        for _ in 0..STEPS {
            if !value.is_finite() {
                return Err(Miss::NoNumber(p));
            }
            let gradient = self.gradient(p)?;
            let along = allowed(gradient);
            let slope = along.length_squared();
            if slope == 0.0 {
                return Err(Miss::Flat(p));
            }
            let step = (along * (-value / slope)).clamp_length_max(0.5 * reach);
            let next = rounded(p + step);
            if step.length() < LAST_STEP * self.edge {
                let normal = -gradient.normalize_or(DVec3::Z);
                let is_kink = before.is_some_and(|before| before.dot(normal) < ALIKE * 0.9);
                let normal = if is_kink { self.mean_normal(next, MEAN_OVER * reach)? } else { normal };
                return Ok(Foot { place: next, normal });
            }
            if next.distance(from) > reach {
                return Err(Miss::Far);
            }
            let there = self.value(next);
            if there.is_finite() && (there > 0.0) != (value > 0.0) && there.abs() > 0.3 * value.abs() {
                let place = self.root(p, next)?;
                return Ok(Foot { place, normal: self.mean_normal(place, MEAN_OVER * reach)? });
            }
            (p, value, before) = (next, there, Some(-gradient.normalize_or(DVec3::Z)));
        }
        Err(Miss::Far)
    }

    /// A point on a crease has no normal; this is the mean of those that differ round it. Elsewhere it is the normal.
    pub(crate) fn mean_normal(&self, p: DVec3, radius: f64) -> Result<DVec3, Miss> {
        let first = self.normal(p)?;
        let u = first.any_orthonormal_vector();
        let v = first.cross(u);
        let mut normals = vec![first];
        for corner in 0..8 {
            let sign = |bit: u32| if corner >> bit & 1 == 1 { radius } else { -radius };
            let normal = self.normal(p + sign(0) * u + sign(1) * v + sign(2) * first)?;
            if normals.iter().all(|other| other.dot(normal) < ALIKE) {
                normals.push(normal);
            }
        }
        Ok(normals.into_iter().sum::<DVec3>().try_normalize().unwrap_or(first))
    }

    /// A root between two points on different sides; `NaN` is outside.
    pub(crate) fn between(&self, a: DVec3, b: DVec3) -> Result<Foot, Miss> {
        let place = self.root(a, b)?;
        Ok(Foot { place, normal: self.normal(place)? })
    }

    /// The place of that root.
    pub(crate) fn root(&self, a: DVec3, b: DVec3) -> Result<DVec3, Miss> {
        let (mut low, mut high) = (a, b);
        let (mut at_low, mut at_high) = (self.value(a), self.value(b));
        let short = 1e-2 * LAST_STEP * self.edge;
        for i in 0..HALVINGS {
            if low.distance(high) < short {
                break;
            }
            // The secant, and every third time the middle.
            let share = if i % 3 == 2 { 0.5 } else { (at_low / (at_low - at_high)).clamp(0.02, 0.98) };
            let share = if share.is_finite() { share } else { 0.5 };
            let middle = rounded(low.lerp(high, share));
            let value = self.value(middle);
            if value.abs() < 1e-9 * (at_low - at_high).abs() {
                return Ok(middle);
            }
            if (value > 0.0) == (at_low > 0.0) {
                (low, at_low) = (middle, value);
            } else {
                (high, at_high) = (middle, value);
            }
        }
        if !at_low.is_finite() || !at_high.is_finite() {
            return Err(Miss::NoNumber(low));
        }
        let share = (at_low / (at_low - at_high)).clamp(0.0, 1.0);
        Ok(rounded(low.lerp(high, if share.is_finite() { share } else { 0.5 })))
    }
}

/// The nearest point that single precision has.
pub(crate) fn rounded(p: DVec3) -> DVec3 {
    p.as_vec3().as_dvec3()
}
