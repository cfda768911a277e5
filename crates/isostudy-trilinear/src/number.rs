//! Samples as whole numbers of a common unit, and the polynomials that decide.

use std::cmp::Ordering;
use std::ops::{Add, Mul, Neg, Sub};

use num_bigint::BigInt;

/// Whole numbers that do not overflow where they are used.
pub(crate) trait Whole:
    Clone + Ord + From<i64> + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Neg<Output = Self>
{
    fn sign(&self) -> Ordering {
        self.cmp(&Self::from(0))
    }
}

impl Whole for i128 {}
impl Whole for BigInt {}

/// The samples of a cell less the isovalue, times a power of two.
pub(crate) enum Differences {
    /// All smaller than 2^29, so that products of four of them, and a few of those, fit.
    Short([i128; 8]),
    Long(Box<[BigInt; 8]>),
}

/// Bits of a sample or an isovalue, of which differences have one more.
const SHORT_BITS: i32 = 28;

impl Differences {
    /// All given numbers must be finite.
    pub(crate) fn new(values: [f32; 8], isovalue: f32) -> Self {
        let parts = values.map(parts);
        let level = self::parts(isovalue);
        let all = || parts.iter().chain([&level]).filter(|(mantissa, _)| *mantissa != 0);
        let low = all().map(|&(_, exponent)| exponent).min().unwrap_or(0);
        let bits = |&(mantissa, exponent): &(i64, i32)| {
            exponent - low + (i64::BITS - mantissa.abs().leading_zeros()) as i32
        };
        let high = all().map(bits).max().unwrap_or(0);
        let shift = |(_, exponent): (i64, i32)| (exponent - low).max(0) as u32;
        if high <= SHORT_BITS {
            // A zero may have any exponent.
            let whole = |part: (i64, i32)| if part.0 == 0 { 0 } else { i128::from(part.0) << shift(part) };
            Self::Short(parts.map(|part| whole(part) - whole(level)))
        } else {
            let whole = |part: (i64, i32)| {
                if part.0 == 0 { BigInt::from(0) } else { BigInt::from(part.0) << shift(part) }
            };
            Self::Long(Box::new(parts.map(|part| whole(part) - whole(level))))
        }
    }
}

/// A finite number as an odd whole number, or zero, times a power of two.
fn parts(value: f32) -> (i64, i32) {
    let bits = value.to_bits();
    let exponent = (bits >> 23 & 0xff) as i32;
    let fraction = i64::from(bits & 0x7f_ffff);
    let (mantissa, exponent) =
        if exponent == 0 { (fraction, -149) } else { (fraction | 0x80_0000, exponent - 150) };
    let zeros = if mantissa == 0 { 0 } else { mantissa.trailing_zeros() };
    let mantissa = mantissa >> zeros;
    (if value.is_sign_negative() { -mantissa } else { mantissa }, exponent + zeros as i32)
}

/// A fraction with a positive denominator.
#[derive(Debug, Clone)]
pub(crate) struct Fraction<W> {
    pub(crate) over: W,
    pub(crate) under: W,
}

impl<W: Whole> Fraction<W> {
    pub(crate) fn whole(value: i64) -> Self {
        Self { over: W::from(value), under: W::from(1) }
    }

    /// Where a line from `low` at 0 to `high` at 1 is zero; they are not equal.
    pub(crate) fn root(low: &W, high: &W) -> Self {
        let slope = low.clone() - high.clone();
        if slope.sign() == Ordering::Greater {
            Self { over: low.clone(), under: slope }
        } else {
            Self { over: -low.clone(), under: -slope }
        }
    }

    pub(crate) fn compare(&self, other: &Self) -> Ordering {
        (self.over.clone() * other.under.clone()).cmp(&(other.over.clone() * self.under.clone()))
    }
}

/// `two z^2 + one z + zero`.
#[derive(Debug, Clone)]
pub(crate) struct Quadratic<W> {
    two: W,
    one: W,
    zero: W,
}

impl<W: Whole> Quadratic<W> {
    /// `a c - b d`, where each is a line from its first number at 0 to its second at 1.
    pub(crate) fn of_lines([a, b, c, d]: [&[W; 2]; 4]) -> Self {
        let product = |p: &[W; 2], q: &[W; 2]| {
            let [rise_p, rise_q] = [p, q].map(|line| line[1].clone() - line[0].clone());
            let one = p[0].clone() * rise_q.clone() + q[0].clone() * rise_p.clone();
            [rise_p * rise_q, one, p[0].clone() * q[0].clone()]
        };
        let [two, one, zero] = product(a, c);
        let [other_two, other_one, other_zero] = product(b, d);
        Self { two: two - other_two, one: one - other_one, zero: zero - other_zero }
    }

    fn sign_at(&self, z: &Fraction<W>) -> Ordering {
        let Fraction { over, under } = z;
        let high = self.two.clone() * over.clone() + self.one.clone() * under.clone();
        (high * over.clone() + self.zero.clone() * under.clone() * under.clone()).sign()
    }

    /// The sign of its largest value from `from` to `to`, both included.
    pub(crate) fn largest_sign(&self, from: &Fraction<W>, to: &Fraction<W>) -> Ordering {
        let at_ends = self.sign_at(from).max(self.sign_at(to));
        if at_ends == Ordering::Greater || self.two.sign() != Ordering::Less {
            return at_ends;
        }
        let top = Fraction { over: self.one.clone(), under: -(self.two.clone() + self.two.clone()) };
        if from.compare(&top) != Ordering::Less || top.compare(to) != Ordering::Less {
            return at_ends;
        }
        // The top's value is the discriminant over a positive number.
        let four = W::from(4);
        let discriminant = self.one.clone() * self.one.clone() - four * self.two.clone() * self.zero.clone();
        at_ends.max(discriminant.sign())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_is_its_parts() {
        for value in [0.0, 1.0, -1.5, 0.1, f32::MAX, f32::MIN_POSITIVE, 1e-45, -3e-40, 16_777_215.0] {
            let (mantissa, exponent) = parts(value);
            assert_eq!(mantissa as f64 * 2f64.powi(exponent), f64::from(value));
            assert!(mantissa == 0 || mantissa % 2 != 0);
        }
    }

    #[test]
    fn short_and_long_differences_are_the_same_numbers() {
        let values = [0.5, -1.0, 3.25, 0.0, 7.0, -2.5, 1e-3, 100.0];
        for extra in [0.0, 1e-30] {
            let mut values = values;
            values[3] = extra;
            let whole: Vec<f64> = match Differences::new(values, 0.25) {
                Differences::Short(all) => all.iter().map(|&v| v as f64).collect(),
                Differences::Long(all) => all.iter().map(|v| v.to_string().parse().unwrap()).collect(),
            };
            let unit = (f64::from(values[0]) - 0.25) / whole[0];
            for (value, whole) in values.iter().zip(whole) {
                let wanted = f64::from(*value) - 0.25;
                assert!((whole * unit - wanted).abs() <= 1e-12 * wanted.abs(), "{value}");
            }
        }
    }

    #[test]
    fn the_largest_value_may_be_inside() {
        // -(z - 1/2)^2 + 1/16 has its top at 1/2, roots at 1/4 and 3/4.
        let quadratic = Quadratic::<i128> { two: -16, one: 16, zero: -3 };
        let at = |over: i128, under: i128| Fraction { over, under };
        assert_eq!(quadratic.largest_sign(&at(0, 1), &at(1, 1)), Ordering::Greater);
        assert_eq!(quadratic.largest_sign(&at(0, 1), &at(1, 4)), Ordering::Equal);
        assert_eq!(quadratic.largest_sign(&at(0, 1), &at(1, 5)), Ordering::Less);
        let touching = Quadratic::<i128> { two: -4, one: 4, zero: -1 };
        assert_eq!(touching.largest_sign(&at(0, 1), &at(1, 1)), Ordering::Equal);
    }
}
