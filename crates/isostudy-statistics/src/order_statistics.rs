//! A median with the interval that order statistics give: nothing is assumed of the distribution.

use crate::interval::Interval;
use serde::Serialize;
use statrs::function::factorial::ln_binomial;

/// A median and where it may lie.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Median {
    /// The middle value, or the mean of the two in the middle.
    pub median: f64,
    /// The interval; `None` of a single value.
    pub interval: Option<Interval>,
    /// The interval's true level. Ranks are whole numbers, so it is above what was asked for; of few values it is below,
    /// and the interval reaches from the smallest to the largest.
    pub level: f64,
}

impl Median {
    /// The interval if it reaches a level, which few values do not.
    pub fn interval_at(&self, level: f64) -> Option<Interval> {
        self.interval.filter(|_| self.level >= level)
    }
}

/// The median of independent values, and the narrowest interval between equally far order statistics that holds the
/// distribution's median at least at `level`: the ranks are those of the binomial distribution with p = 1/2 (Conover
/// 1999, section 3.2). `None` of no values.
pub fn median(mut values: Vec<f64>, level: f64) -> Option<Median> {
    values.sort_unstable_by(f64::total_cmp);
    let n = values.len();
    let middle = (values.get(n / 2)? + values[(n - 1) / 2]) / 2.0;
    if n == 1 {
        return Some(Median { median: middle, interval: None, level: 0.0 });
    }
    // From the middle outwards, until enough is between the ranks: P(j <= B <= n - j) for B binomial.
    let mut j = n / 2;
    let mut probability = (ln_binomial(n as u64, j as u64) - n as f64 * std::f64::consts::LN_2).exp();
    let mut holds = if n.is_multiple_of(2) { probability } else { 2.0 * probability };
    while holds < level && j > 1 {
        probability *= j as f64 / (n - j + 1) as f64;
        j -= 1;
        holds += 2.0 * probability;
    }
    let rank = j - 1;
    let interval = Interval { low: values[rank], high: values[n - 1 - rank] };
    Some(Median { median: middle, interval: Some(interval), level: holds })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ranks(n: u32, level: f64) -> (f64, f64, f64) {
        let found = median((1..=n).rev().map(f64::from).collect(), level).unwrap();
        let interval = found.interval.unwrap();
        assert_eq!(found.median, f64::from(n + 1) / 2.0);
        (interval.low, interval.high, found.level)
    }

    /// Levels are 1 - 2 pbinom(rank - 1, n, 0.5) in R; the ranks those of Conover (1999), table A3, and of SciPy's
    /// `quantile_test(x, q=.5, p=.5).confidence_interval`.
    #[test]
    fn ranks_and_levels_of_the_binomial() {
        let near = |found: (f64, f64, f64), low: f64, high: f64, level: f64| {
            assert_eq!((found.0, found.1), (low, high));
            assert!((found.2 - level).abs() < 5e-6, "{found:?}");
        };
        near(ranks(8, 0.95), 1.0, 8.0, 0.992_188);
        near(ranks(10, 0.95), 2.0, 9.0, 0.978_516);
        near(ranks(20, 0.95), 6.0, 15.0, 0.958_611);
        near(ranks(100, 0.95), 40.0, 61.0, 0.964_800);
        near(ranks(100, 0.99), 37.0, 64.0, 0.993_363);
    }

    #[test]
    fn too_few_values_have_the_level_they_have() {
        let (low, high, level) = ranks(3, 0.95);
        assert_eq!((low, high, level), (1.0, 3.0, 0.75));
        assert_eq!(ranks(2, 0.95), (1.0, 2.0, 0.5));
        let one = median(vec![7.0], 0.95).unwrap();
        assert_eq!((one.median, one.interval), (7.0, None));
        assert_eq!(median(Vec::new(), 0.95), None);
    }

    #[test]
    fn many_values_do_not_vanish_in_rounding() {
        // 1 / 2^5000 is no number of double precision.
        let (low, high, level) = ranks(5000, 0.95);
        assert!((0.95..0.96).contains(&level), "{level}");
        // The normal approximation: 2500.5 -+ 0.98 sqrt(5000).
        assert!((low - 2431.0).abs() <= 2.0 && (high - 2570.0).abs() <= 2.0, "{low} {high}");
    }
}
