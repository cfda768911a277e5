//! Numbers that may carry their gradient, so that values and gradients are of one formula.

use std::ops::{Add, Mul, Sub};

use glam::DVec3;

/// A number, or a number with its gradient.
pub(super) trait Real: Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> {
    /// A number that does not change.
    fn of(value: f64) -> Self;
    fn value(self) -> f64;
    /// The same function of this: its value and its slope here.
    fn mapped(self, value: f64, slope: impl FnOnce() -> f64) -> Self;

    fn times(self, factor: f64) -> Self {
        self * Self::of(factor)
    }

    fn inverse(self) -> Self {
        let inverse = 1.0 / self.value();
        self.mapped(inverse, || -inverse * inverse)
    }

    fn sqrt(self) -> Self {
        let root = self.value().sqrt();
        self.mapped(root, || 0.5 / root)
    }

    fn cos(self) -> Self {
        self.mapped(libm::cos(self.value()), || -libm::sin(self.value()))
    }

    /// The angle of the point `(x, self)`, from the axis of `x`.
    fn angle(self, x: Self) -> Self;
}

impl Real for f64 {
    fn of(value: f64) -> Self {
        value
    }
    fn value(self) -> f64 {
        self
    }
    fn mapped(self, value: f64, _: impl FnOnce() -> f64) -> Self {
        value
    }
    fn angle(self, x: Self) -> Self {
        libm::atan2(self, x)
    }
}

/// A number with its gradient.
#[derive(Clone, Copy)]
pub(super) struct Dual {
    pub(super) value: f64,
    pub(super) gradient: DVec3,
}

impl Add for Dual {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self { value: self.value + other.value, gradient: self.gradient + other.gradient }
    }
}

impl Sub for Dual {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self { value: self.value - other.value, gradient: self.gradient - other.gradient }
    }
}

impl Mul for Dual {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let gradient = self.value * other.gradient + other.value * self.gradient;
        Self { value: self.value * other.value, gradient }
    }
}

impl Real for Dual {
    fn of(value: f64) -> Self {
        Self { value, gradient: DVec3::ZERO }
    }
    fn value(self) -> f64 {
        self.value
    }
    fn mapped(self, value: f64, slope: impl FnOnce() -> f64) -> Self {
        Self { value, gradient: slope() * self.gradient }
    }
    fn angle(self, x: Self) -> Self {
        let squared = self.value * self.value + x.value * x.value;
        let turn = x.value * self.gradient - self.value * x.gradient;
        Self { value: libm::atan2(self.value, x.value), gradient: turn / squared }
    }
}

/// A point of such numbers.
#[derive(Clone, Copy)]
pub(super) struct Point<R>([R; 3]);

impl Point<f64> {
    pub(super) fn plain(p: DVec3) -> Self {
        Self(p.to_array())
    }
}

impl Point<Dual> {
    /// The point whose gradient is asked for.
    pub(super) fn with_gradient(p: DVec3) -> Self {
        let axes = [DVec3::X, DVec3::Y, DVec3::Z];
        Self(std::array::from_fn(|k| Dual { value: p[k], gradient: axes[k] }))
    }
}

impl<R: Real> Point<R> {
    pub(super) fn minus(self, q: DVec3) -> Self {
        Self(std::array::from_fn(|k| self.0[k] - R::of(q[k])))
    }

    pub(super) fn dot(self, v: DVec3) -> R {
        self.0[0].times(v.x) + self.0[1].times(v.y) + self.0[2].times(v.z)
    }

    pub(super) fn square(self) -> R {
        self.0[0] * self.0[0] + self.0[1] * self.0[1] + self.0[2] * self.0[2]
    }

    pub(super) fn value(self) -> DVec3 {
        DVec3::from_array(self.0.map(R::value))
    }

    /// `self . m self` of a matrix by its rows.
    pub(super) fn form(self, rows: &[DVec3; 3]) -> R {
        (0..3).fold(R::of(0.0), |sum, k| sum + self.0[k] * self.dot(rows[k]))
    }
}
