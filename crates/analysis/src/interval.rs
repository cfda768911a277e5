//! Intervals for shares: descriptive, at 95 %.
//!
//! Answers of one person are not independent, so an interval over answers is too narrow for anything but a single
//! question. [`t_over_respondents`] treats each person as one observation; [`wilson`] is for one question, where each
//! person answers once.

use statrs::distribution::{ContinuousCDF, Normal, StudentsT};

/// Confidence level of every interval here.
pub const LEVEL: f64 = 0.95;

/// A lower and an upper end.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Interval {
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

/// Mean of one score a person, plus and minus t(n - 1) standard errors (sample standard deviation, divisor n - 1).
///
/// `None` for fewer than two people. The ends are not cut to the scores' range.
pub fn t_over_respondents(scores: &[f64]) -> Option<Interval> {
    if scores.len() < 2 {
        return None;
    }
    let n = scores.len() as f64;
    let mean = scores.iter().sum::<f64>() / n;
    let variance = scores.iter().map(|s| (s - mean) * (s - mean)).sum::<f64>() / (n - 1.0);
    let t = StudentsT::new(0.0, 1.0, n - 1.0).expect("n - 1 > 0").inverse_cdf(0.5 + LEVEL / 2.0);
    let half = t * (variance / n).sqrt();
    Some(Interval { low: mean - half, high: mean + half })
}

/// The t quantile that half a t interval has of standard errors; `None` below one degree of freedom.
pub(crate) fn t_half_width(degrees: f64) -> Option<f64> {
    (degrees >= 1.0)
        .then(|| StudentsT::new(0.0, 1.0, degrees).expect("degrees >= 1").inverse_cdf(0.5 + LEVEL / 2.0))
}

/// Wilson's score interval for `wins` of `n` independent answers (Wilson 1927), within 0..=1. `None` if `n` is 0.
pub fn wilson(wins: u64, n: u64) -> Option<Interval> {
    if n == 0 {
        return None;
    }
    let (p, n) = (wins as f64 / n as f64, n as f64);
    let z = Normal::standard().inverse_cdf(0.5 + LEVEL / 2.0);
    let centre = (p + z * z / (2.0 * n)) / (1.0 + z * z / n);
    let half = z / (1.0 + z * z / n) * (p * (1.0 - p) / n + z * z / (4.0 * n * n)).sqrt();
    Some(Interval { low: (centre - half).max(0.0), high: (centre + half).min(1.0) })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wilson_as_statsmodels_has_it() {
        // statsmodels.stats.proportion.proportion_confint(16, 18, method="wilson"), and (0, 18)
        let interval = wilson(16, 18).unwrap();
        assert!((interval.low - 0.672_002_348_7).abs() < 1e-9, "{interval:?}");
        assert!((interval.high - 0.968_980_477_4).abs() < 1e-9, "{interval:?}");
        let none = wilson(0, 18).unwrap();
        assert_eq!(none.low, 0.0);
        assert!((none.high - 0.175_879_223_6).abs() < 1e-9, "{none:?}");
        assert_eq!(wilson(0, 0), None);
    }

    #[test]
    fn t_as_scipy_has_it() {
        // x = [1, 2, 4, 7]; scipy.stats.t.interval(.95, 3, mean(x), sem(x))
        let interval = t_over_respondents(&[1.0, 2.0, 4.0, 7.0]).unwrap();
        assert!((interval.low - -0.709_980_742).abs() < 1e-8, "{interval:?}");
        assert!((interval.high - 7.709_980_742).abs() < 1e-8, "{interval:?}");
        assert_eq!(t_over_respondents(&[1.0]), None);
    }
}
