//! The isosurface of a field that can be called: its side, its gradient, and the way to it.

use glam::{DVec3, Vec3};

use crate::sampling::bracket::Bracket;
use isostudy_field::StudyField;

/// Half the width of a central difference, as a fraction of the spacing: wide against the rounding of a position,
/// narrow against what a lattice of that spacing can show.
const STENCIL: f32 = 1.0 / 64.0;
/// A root is known to this fraction of the spacing.
const TOLERANCE: f64 = 1e-5;
/// Steps of the root search; the Illinois rule converges in far fewer.
const MOST_STEPS: usize = 40;

/// Where a field has an isovalue, as seen from a lattice with some spacing.
#[derive(Clone, Copy)]
pub(crate) struct Level<'a> {
    pub(crate) field: &'a dyn StudyField,
    pub(crate) isovalue: f32,
    pub(crate) spacing: f32,
}

/// A point of the isosurface and how far it was to go there, never negative.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Foot {
    pub(crate) position: Vec3,
    pub(crate) distance: f64,
}

impl Level<'_> {
    /// Field minus isovalue: positive inside.
    pub(crate) fn difference(&self, p: Vec3) -> f32 {
        self.field.sample(p) - self.isovalue
    }

    /// The gradient by central differences. `difference` is the one at `p`; it only makes the search of a distance
    /// shorter.
    pub(crate) fn gradient(&self, p: Vec3, difference: f32) -> DVec3 {
        self.gradient_after(p, Some((p, difference + self.isovalue)))
    }

    /// The same, where the value at a point nearby may be known.
    fn gradient_after(&self, p: Vec3, near: Option<(Vec3, f32)>) -> DVec3 {
        let step = self.spacing * STENCIL;
        // By axis, the lower point first.
        let points: [Vec3; 6] = std::array::from_fn(|i| {
            let mut there = p;
            there[i / 2] += if i % 2 == 0 { -step } else { step };
            there
        });
        let mut values = [0.0; 6];
        self.field.sample_near(&points, &mut values, near);
        let slope = |axis: usize| {
            let change = f64::from(values[2 * axis + 1]) - f64::from(values[2 * axis]);
            // The step as it is after rounding.
            change / (f64::from(points[2 * axis + 1][axis]) - f64::from(points[2 * axis][axis]))
        };
        DVec3::new(slope(0), slope(1), slope(2))
    }

    /// The first point of the surface that is found along the gradient, uphill from outside and downhill from inside,
    /// at most `reach` away. `None` where there is none, no gradient or no number.
    ///
    /// The first look is a little beyond where Newton's step ends; from there the way doubles until the side changes.
    /// Regula falsi does the rest.
    pub(crate) fn foot(&self, p: Vec3, reach: f32) -> Option<Foot> {
        let here = self.difference(p);
        if here == 0.0 {
            return Some(Foot { position: p, distance: 0.0 });
        }
        let gradient = self.gradient(p, here);
        let steepness = gradient.length();
        let outward = -gradient / steepness;
        if !here.is_finite() || !outward.is_finite() {
            return None;
        }
        let inside = here > 0.0;
        let direction = if inside { outward } else { -outward };
        let at = |way: f64| (p.as_dvec3() + direction * way).as_vec3();
        let value = |way: f64| {
            f64::from(self.field.sample_after(at(way), Some((p, here + self.isovalue))))
                - f64::from(self.isovalue)
        };

        let tolerance = f64::from(self.spacing) * TOLERANCE;
        let reach = f64::from(reach);
        let mut near = (0.0, f64::from(here));
        let mut way = (f64::from(here.abs()) / steepness * 1.01 + tolerance).min(reach);
        let far = loop {
            let there = value(way);
            if there.is_nan() {
                return None;
            }
            if (there > 0.0) != inside {
                break (way, there);
            }
            near = (way, there);
            if way >= reach {
                return None;
            }
            way = (2.0 * way).min(reach);
        };
        let mut bracket = Bracket::new(near, far);
        let mut last = f64::INFINITY;
        for _ in 0..MOST_STEPS {
            way = bracket.guess();
            if (way - last).abs() <= tolerance || bracket.width() <= tolerance {
                break;
            }
            let there = value(way);
            if there.is_nan() {
                return None;
            }
            bracket.narrow(way, there);
            last = way;
        }
        Some(Foot { position: at(way), distance: way })
    }

    /// One Newton step along the gradient, towards the isosurface. `None` where it would be longer than `longest`, or
    /// end where the field is no nearer to the isovalue.
    pub(crate) fn newton(&self, p: Vec3, longest: f32) -> Option<Vec3> {
        let here = self.difference(p);
        if here == 0.0 {
            return Some(p);
        }
        let gradient = self.gradient(p, here);
        let step = gradient * (-f64::from(here) / gradient.length_squared());
        let there = (p.as_dvec3() + step).as_vec3();
        // Not a number fails either.
        let near = step.length() <= f64::from(longest);
        let nearer = || {
            let value = self.field.sample_after(there, Some((p, here + self.isovalue)));
            (value - self.isovalue).abs() <= here.abs()
        };
        (near && nearer()).then_some(there)
    }

    /// The outward direction at `p`, as the field has it or else as samples nearby have it. `None` where there is none.
    pub(crate) fn normal(&self, p: Vec3) -> Option<Vec3> {
        self.normal_after(p, None)
    }

    /// The same, where the value at a point nearby may be known.
    pub(crate) fn normal_after(&self, p: Vec3, near: Option<(Vec3, f32)>) -> Option<Vec3> {
        match self.field.gradient(p) {
            Some(gradient) => (-gradient).try_normalize(),
            None => Some(self.outward_after(p, near)?.as_vec3()),
        }
    }

    /// The outward direction at `p`: against the gradient, since inside is above. `None` where there is no gradient.
    pub(crate) fn outward(&self, p: Vec3) -> Option<DVec3> {
        self.outward_after(p, None)
    }

    fn outward_after(&self, p: Vec3, near: Option<(Vec3, f32)>) -> Option<DVec3> {
        (-self.gradient_after(p, near)).try_normalize()
    }
}
