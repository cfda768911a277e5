//! A value and where it may lie.

use isostudy_statistics::interval::Interval;

/// A value with its interval at 95 %; of a value that is counted, both ends are the value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate {
    /// The value.
    pub value: f64,
    /// The lower end.
    pub low: f64,
    /// The upper end.
    pub high: f64,
}

impl Estimate {
    /// A value that is known exactly.
    pub fn exact(value: f64) -> Self {
        Self { value, low: value, high: value }
    }

    /// A value that may be anything where its interval is not known.
    pub fn within(value: f64, interval: Option<Interval>) -> Self {
        match interval {
            Some(Interval { low, high }) => Self { value, low, high },
            None => Self { value, low: f64::NEG_INFINITY, high: f64::INFINITY },
        }
    }

    /// In another unit, which is above 0.
    pub fn per(self, unit: f64) -> Self {
        Self { value: self.value / unit, low: self.low / unit, high: self.high / unit }
    }

    /// What is less than `least` becomes it.
    pub fn at_least(self, least: f64) -> Self {
        Self { value: self.value.max(least), low: self.low.max(least), high: self.high.max(least) }
    }

    /// Whether both ends are the value.
    pub fn is_exact(self) -> bool {
        self.low == self.value && self.high == self.value
    }

    /// Whether the intervals have a value in common.
    pub fn meets(self, other: Self) -> bool {
        self.low <= other.high && other.low <= self.high
    }
}

impl std::ops::Neg for Estimate {
    type Output = Self;

    fn neg(self) -> Self {
        Self { value: -self.value, low: -self.high, high: -self.low }
    }
}
