//! Signs of polynomials of samples, without rounding.
//!
//! A number is a sum of `f64` of falling size whose digits do not overlap (Shewchuk 1997). Differences of `f32`, and products of
//! four of them, neither overflow nor underflow there. Only what a quick bound leaves open comes this way.

use std::cmp::Ordering;

/// A sum of parts, each a last digit or more beyond the one after it; smallest first, none zero.
#[derive(Debug, Clone, Default)]
pub(super) struct Sum(Vec<f64>);

/// `a + b` and what rounding took from it.
fn two_sum(a: f64, b: f64) -> [f64; 2] {
    let sum = a + b;
    let of_b = sum - a;
    [sum, (a - (sum - of_b)) + (b - of_b)]
}

impl Sum {
    /// The difference of two finite numbers.
    pub(super) fn difference(a: f32, b: f32) -> Self {
        let mut sum = Self::default();
        sum.add_one(f64::from(a));
        sum.add_one(-f64::from(b));
        sum
    }

    fn add_one(&mut self, value: f64) {
        let mut carried = value;
        let mut parts = Vec::with_capacity(self.0.len() + 1);
        for &part in &self.0 {
            let [sum, rest] = two_sum(carried, part);
            if rest != 0.0 {
                parts.push(rest);
            }
            carried = sum;
        }
        if carried != 0.0 {
            parts.push(carried);
        }
        self.0 = parts;
    }

    pub(super) fn plus(&self, other: &Self) -> Self {
        let mut sum = self.clone();
        other.0.iter().for_each(|&part| sum.add_one(part));
        sum
    }

    pub(super) fn minus(&self, other: &Self) -> Self {
        let mut sum = self.clone();
        other.0.iter().for_each(|&part| sum.add_one(-part));
        sum
    }

    pub(super) fn times(&self, other: &Self) -> Self {
        let mut sum = Self::default();
        for &a in &self.0 {
            for &b in &other.0 {
                let product = a * b;
                sum.add_one(a.mul_add(b, -product));
                sum.add_one(product);
            }
        }
        sum
    }

    /// Compared with zero.
    pub(super) fn sign(&self) -> Ordering {
        let largest = self.0.last().copied().unwrap_or(0.0);
        largest.partial_cmp(&0.0).expect("sums of finite numbers are finite")
    }
}

/// Whether `(a - l)(c - l) > (b - l)(d - l)`, exactly; not where any is infinite or no number. The same whichever way round a face
/// its corners are taken.
pub(super) fn is_joined([a, b, c, d]: [f32; 4], isovalue: f32) -> bool {
    if ![a, b, c, d].iter().all(|v| v.is_finite()) {
        return false;
    }
    let difference = |v: f32| f64::from(v) - f64::from(isovalue);
    let (one, other) = (difference(a) * difference(c), difference(b) * difference(d));
    if (one - other).abs() > 1e-15 * (one.abs() + other.abs()) {
        return one > other;
    }
    let [a, b, c, d] = [a, b, c, d].map(|v| Sum::difference(v, isovalue));
    a.times(&c).minus(&b.times(&d)).sign() == Ordering::Greater
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_are_exact() {
        let one = Sum::difference(1.0, 0.0);
        let tiny = Sum::difference(1e-45, 0.0);
        let large = Sum::difference(f32::MAX, 0.0);
        let both = large.plus(&tiny);
        assert_eq!(both.minus(&large).minus(&tiny).sign(), Ordering::Equal);
        assert_eq!(both.minus(&large).sign(), Ordering::Greater);
        // (m + t)(m - t) = m^2 - t^2.
        let square = both.times(&large.minus(&tiny));
        let difference = large.times(&large).minus(&square);
        assert_eq!(difference.minus(&tiny.times(&tiny)).sign(), Ordering::Equal);
        assert_eq!(difference.sign(), Ordering::Greater);
        assert_eq!(one.times(&one).minus(&one).sign(), Ordering::Equal);
    }

    #[test]
    fn a_tie_is_apart_and_a_hair_is_not() {
        // 3 * 5 against 1 * 15, and the next number either way.
        for (d, joined) in [(-15.0, false), ((-15.0f32).next_down(), false), ((-15.0f32).next_up(), true)] {
            assert_eq!(is_joined([3.0, -1.0, 5.0, d], 0.0), joined, "{d}");
        }
        // The same far from zero, where a difference has more digits than f32.
        assert!(!is_joined([0.1 + 0.2, -0.7, 0.1 + 0.2, -0.7], 0.1));
        assert!(!is_joined([f32::INFINITY, -1.0, 1.0, -1.0], 0.0));
        assert!(!is_joined([1.0, f32::NAN, 1.0, -1.0], 0.0));
        assert!(is_joined([1e30, -1.0, 1.0, -1e29], 0.0));
    }
}
