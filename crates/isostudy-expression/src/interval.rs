//! Intervals that hold what single-precision arithmetic makes of any of their numbers.
//!
//! fidget has intervals as well. They are not used, because they panic at infinity minus infinity, which
//! `exp(99*x) - exp(99*y)` reaches, pass over 0 times infinity, which is no number, and round to the nearest.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// More than the rounding of a single-precision operation, and than the error of a platform's functions.
const ROUNDING: f64 = 1e-6;
/// More than the smallest single-precision number.
const TINY: f64 = 1e-44;
/// Beyond this a value may be infinite in single precision.
const LARGE: f64 = 3.4e38;

/// Both ends belong to it; they may be infinite. No number in it is `NaN`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Interval {
    pub(crate) low: f64,
    pub(crate) high: f64,
}

/// `None` where a result may be no number, or nothing is known.
pub(crate) type Known = Option<Interval>;

impl Interval {
    pub(crate) fn new(low: f64, high: f64) -> Self {
        Self { low, high }
    }

    /// Wide enough for the rounding of what was computed; nothing if an end is no number.
    pub(crate) fn rounded(low: f64, high: f64) -> Known {
        let slack = |v: f64| v.abs() * ROUNDING + TINY;
        let infinite = |v: f64| if v.abs() >= LARGE { v.signum() * f64::INFINITY } else { v };
        let (low, high) = (infinite(low - slack(low)), infinite(high + slack(high)));
        (low <= high).then_some(Self { low, high })
    }

    /// Of a function that grows.
    fn growing(self, f: impl Fn(f64) -> f64) -> Known {
        Self::rounded(f(self.low), f(self.high))
    }

    fn has(self, v: f64) -> bool {
        self.low <= v && v <= self.high
    }

    pub(crate) fn is_finite(self) -> bool {
        self.low.is_finite() && self.high.is_finite()
    }

    pub(crate) fn neg(self) -> Known {
        Some(Self::new(-self.high, -self.low))
    }

    pub(crate) fn abs(self) -> Self {
        let largest = self.low.abs().max(self.high.abs());
        let smallest = if self.has(0.0) { 0.0 } else { self.low.abs().min(self.high.abs()) };
        Self::new(smallest, largest)
    }

    /// Infinity less infinity is no number.
    pub(crate) fn add(self, other: Self) -> Known {
        let clash = |a: f64, b: f64| a.is_infinite() && b == -a;
        if clash(self.low, other.high) || clash(self.high, other.low) {
            return None;
        }
        Self::rounded(self.low + other.low, self.high + other.high)
    }

    /// Zero times infinity is no number.
    pub(crate) fn mul(self, other: Self) -> Known {
        let clash = |a: Self, b: Self| a.has(0.0) && !b.is_finite();
        if clash(self, other) || clash(other, self) {
            return None;
        }
        let all =
            [self.low * other.low, self.low * other.high, self.high * other.low, self.high * other.high];
        let (low, high) =
            all.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), &v| (l.min(v), h.max(v)));
        Self::rounded(low, high)
    }

    pub(crate) fn square(self) -> Known {
        let Self { low, high } = self.abs();
        Self::rounded(low * low, high * high).map(|v| Self::new(v.low.max(0.0), v.high))
    }

    /// Nothing is known of a division by what may be zero, or underflow to it, nor of infinities.
    pub(crate) fn div(self, other: Self) -> Known {
        if other.abs().low < 1e-37 || !other.is_finite() || !self.is_finite() {
            return None;
        }
        self.mul(Self::rounded(1.0 / other.high, 1.0 / other.low)?)
    }

    pub(crate) fn sqrt(self) -> Known {
        if self.low < 0.0 {
            return None;
        }
        self.growing(f64::sqrt).map(|v| Self::new(v.low.max(0.0), v.high))
    }

    pub(crate) fn exp(self) -> Known {
        self.growing(f64::exp).map(|v| Self::new(v.low.max(0.0), v.high))
    }

    pub(crate) fn ln(self) -> Known {
        if self.low <= 0.0 { None } else { self.growing(f64::ln) }
    }

    pub(crate) fn sin(self) -> Known {
        // Far out the period is wider than the rounding of the argument only in double precision.
        if !self.is_finite() {
            return None;
        }
        let slack = 1e-9 + 1e-12 * self.low.abs().max(self.high.abs());
        let (low, high) = (self.low - slack, self.high + slack);
        let reaches = |crest: f64| ((low - crest) / TAU).ceil() <= ((high - crest) / TAU).floor();
        let ends = [self.low.sin(), self.high.sin()];
        let far = self.abs().high > 1e6;
        let least = if far || reaches(-FRAC_PI_2) { -1.0 } else { ends[0].min(ends[1]) };
        let most = if far || reaches(FRAC_PI_2) { 1.0 } else { ends[0].max(ends[1]) };
        Self::rounded(least, most)
    }

    pub(crate) fn cos(self) -> Known {
        // The slack of the sine covers the rounding of the sum.
        Self::new(self.low + FRAC_PI_2, self.high + FRAC_PI_2).sin()
    }

    pub(crate) fn tan(self) -> Known {
        let slack = 1e-6 * (1.0 + self.abs().high);
        let branch = |v: f64| ((v + FRAC_PI_2) / PI).floor();
        let is_one = self.is_finite() && branch(self.low - slack) == branch(self.high + slack);
        if is_one { Self::rounded((self.low).tan(), self.high.tan()) } else { None }
    }

    pub(crate) fn asin(self) -> Known {
        if self.low < -1.0 || self.high > 1.0 { None } else { self.growing(f64::asin) }
    }

    pub(crate) fn acos(self) -> Known {
        if self.low < -1.0 || self.high > 1.0 {
            None
        } else {
            Self::rounded(self.high.acos(), self.low.acos())
        }
    }

    pub(crate) fn atan(self) -> Known {
        self.growing(f64::atan)
    }

    /// Anything where the branch cut or the origin may be met.
    pub(crate) fn atan2(self, x: Self) -> Known {
        if self.has(0.0) && x.low <= 0.0 {
            return Self::rounded(-PI, PI);
        }
        let corners = [(self.low, x.low), (self.low, x.high), (self.high, x.low), (self.high, x.high)];
        let angles = corners.map(|(y, x)| y.atan2(x));
        let (low, high) = angles.iter().fold((PI, -PI), |(l, h), &v| (l.min(v), h.max(v)));
        Self::rounded(low, high)
    }

    pub(crate) fn min(self, other: Self) -> Self {
        Self::new(self.low.min(other.low), self.high.min(other.high))
    }

    pub(crate) fn max(self, other: Self) -> Self {
        Self::new(self.low.max(other.low), self.high.max(other.high))
    }

    /// The remainder, not negative. A divisor that may be zero, or a dividend without end, leaves none.
    pub(crate) fn modulo(self, divisor: Self) -> Known {
        let divisor = divisor.abs();
        if divisor.low == 0.0 || !self.is_finite() { None } else { Self::rounded(0.0, divisor.high) }
    }

    /// -1, 0 or 1.
    pub(crate) fn compare(self, other: Self) -> Known {
        let least = if self.low > other.high {
            1.0
        } else if self.low >= other.high {
            0.0
        } else {
            -1.0
        };
        let most = if self.high < other.low {
            -1.0
        } else if self.high <= other.low {
            0.0
        } else {
            1.0
        };
        Some(Self::new(least, most))
    }

    /// A whole number near each: floor, ceiling, nearest.
    pub(crate) fn stepped(self, f: impl Fn(f64) -> f64) -> Known {
        Some(Self::new(f(self.low), f(self.high)))
    }
}
