//! Exact fractions: preference factors are ratios of counts, and stay so until they are printed.

use std::fmt;
use std::ops::{Add, Sub};

/// A fraction in lowest terms with a denominator above zero.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Fraction {
    numerator: i128,
    denominator: i128,
}

impl Fraction {
    /// Zero.
    pub const ZERO: Self = Self { numerator: 0, denominator: 1 };

    /// `numerator / denominator` in lowest terms.
    ///
    /// # Panics
    /// If the denominator is zero.
    pub fn new(numerator: i128, denominator: i128) -> Self {
        assert!(denominator != 0, "{numerator}/0 is not a fraction");
        let divisor = gcd(numerator.abs(), denominator.abs()) * denominator.signum();
        Self { numerator: numerator / divisor, denominator: denominator / divisor }
    }

    /// Arithmetic mean; `None` of nothing.
    pub fn mean(values: &[Self]) -> Option<Self> {
        let sum = values.iter().fold(Self::ZERO, |sum, &value| sum + value);
        let count = values.len() as i128;
        (count > 0).then(|| Self::new(sum.numerator, sum.denominator * count))
    }

    /// The nearest double.
    pub fn value(self) -> f64 {
        self.numerator as f64 / self.denominator as f64
    }

    /// Rounded to whole units of 10^-`decimals`, halves away from zero: 68/162 to 3 decimals is 420.
    pub fn rounded(self, decimals: u32) -> i128 {
        let scaled = 2 * self.numerator.abs() * 10_i128.pow(decimals) + self.denominator;
        self.numerator.signum() * (scaled / (2 * self.denominator))
    }
}

impl Add for Fraction {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self::new(
            self.numerator * other.denominator + other.numerator * self.denominator,
            self.denominator * other.denominator,
        )
    }
}

impl Sub for Fraction {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        self + Self { numerator: -other.numerator, ..other }
    }
}

impl fmt::Display for Fraction {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.numerator, self.denominator)
    }
}

fn gcd(a: i128, b: i128) -> i128 {
    if b == 0 { a } else { gcd(b, a % b) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn rounds_exactly() {
        assert_eq!(Fraction::new(68, 162).rounded(3), 420); // .41975...; the paper prints .419
        assert_eq!(Fraction::new(1, 16).rounded(3), 63); // .0625, a tie
        assert_eq!(Fraction::new(-1, 16).rounded(3), -63);
        assert_eq!(Fraction::mean(&[]), None);
    }

    proptest! {
        #[test]
        fn agrees_with_doubles(a in -1000..1000i128, b in 1..1000i128, c in -1000..1000i128, d in 1..1000i128) {
            let (x, y) = (Fraction::new(a, b), Fraction::new(c, d));
            prop_assert!(((x + y).value() - (x.value() + y.value())).abs() < 1e-9);
            prop_assert_eq!(x + y - y, x);
            let mean = Fraction::mean(&[x, y]).unwrap();
            prop_assert_eq!(mean + mean, x + y);
        }
    }
}
