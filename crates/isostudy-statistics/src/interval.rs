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

impl Interval {
    /// Both ends cut to what is possible: a t interval knows of no range.
    pub fn cut(self, low: f64, high: f64) -> Self {
        Self { low: self.low.clamp(low, high), high: self.high.clamp(low, high) }
    }
}

/// Mean of one score a person, plus and minus t(n - 1) standard errors (sample standard deviation, divisor n - 1).
///
/// `None` for fewer than two people, and where all scores are the same, which tells no spread. The ends are not cut to the
/// scores' range.
pub fn t_over_respondents(scores: &[f64]) -> Option<Interval> {
    if scores.len() < 2 || unanimous(scores).is_some() {
        return None;
    }
    let n = scores.len() as f64;
    let mean = scores.iter().sum::<f64>() / n;
    let variance = scores.iter().map(|s| (s - mean) * (s - mean)).sum::<f64>() / (n - 1.0);
    let t = StudentsT::new(0.0, 1.0, n - 1.0).expect("n - 1 > 0").inverse_cdf(0.5 + LEVEL / 2.0);
    let half = t * (variance / n).sqrt();
    Some(Interval { low: mean - half, high: mean + half })
}

/// The mean of one score a person between -`reach` and `reach`: the t interval, or, where all scores are the same, the means
/// that would have made so many equal scores at least as probable as 2.5 % ([`chance_of_unanimity`]). `None` for fewer than
/// two people.
pub fn of_mean_score(scores: &[f64], reach: f64) -> Option<Interval> {
    let Some(score) = unanimous(scores).filter(|_| scores.len() > 1) else {
        return t_over_respondents(scores);
    };
    // (reach - mean) / (reach - score) is the greatest chance of one such score from above; likewise from below.
    let root = ((1.0 - LEVEL) / 2.0).powf(1.0 / scores.len() as f64);
    Some(Interval { low: (reach + score) * root - reach, high: reach - (reach - score) * root })
}

/// The one value that all scores have.
pub fn unanimous(scores: &[f64]) -> Option<f64> {
    let (first, others) = scores.split_first()?;
    others.iter().all(|score| score == first).then_some(*first)
}

/// The greatest chance of `people` independent scores between -`reach` and `reach` being all `score`, whatever their
/// distribution, if its mean is `mean`: the rest of it is then at the far end. For a score of 1 that reaches as far it is
/// Clopper and Pearson's bound (1934).
pub fn chance_of_unanimity(score: f64, people: usize, mean: f64, reach: f64) -> f64 {
    let far = if mean > score { reach } else { -reach };
    if mean == score { 1.0 } else { ((far - mean) / (far - score)).powf(people as f64) }
}

/// The t quantile that half a t interval has of standard errors; `None` below one degree of freedom.
pub fn t_half_width(degrees: f64) -> Option<f64> {
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
    // Exactly 0 and 1 there, but for rounding.
    let low = if wins == 0 { 0.0 } else { (centre - half).max(0.0) };
    Some(Interval { low, high: if p == 1.0 { 1.0 } else { (centre + half).min(1.0) } })
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
        // In doubles the formula leaves 7e-18 of the lower end of none in thirty.
        assert_eq!((wilson(0, 30).unwrap().low, wilson(30, 30).unwrap().high), (0.0, 1.0));
        assert_eq!(wilson(0, 0), None);
    }

    #[test]
    fn t_as_scipy_has_it() {
        // x = [1, 2, 4, 7]; scipy.stats.t.interval(.95, 3, mean(x), sem(x))
        let interval = t_over_respondents(&[1.0, 2.0, 4.0, 7.0]).unwrap();
        assert!((interval.low - -0.709_980_742).abs() < 1e-8, "{interval:?}");
        assert!((interval.high - 7.709_980_742).abs() < 1e-8, "{interval:?}");
        assert_eq!(t_over_respondents(&[1.0]), None);
        assert_eq!(t_over_respondents(&[1.0; 5]), None);
        assert_eq!(of_mean_score(&[0.5, -0.5, 0.25], 1.0), t_over_respondents(&[0.5, -0.5, 0.25]));
    }

    #[test]
    fn all_the_same_is_no_certainty() {
        // scipy.stats.binomtest(18, 18).proportion_ci().low = 0.8146980319, and a mean score is 2 p - 1.
        let all = of_mean_score(&[1.0; 18], 1.0).unwrap();
        assert!((all.low - (2.0 * 0.814_698_031_9 - 1.0)).abs() < 1e-9 && all.high == 1.0, "{all:?}");
        let against = of_mean_score(&[-1.0; 18], 1.0).unwrap();
        assert_eq!((against.low, against.high), (-all.high, -all.low));
        // Two people without a preference tell next to nothing; the ends have a chance of 2.5 % each.
        let none = of_mean_score(&[0.0; 2], 1.0).unwrap();
        assert!((none.high - (1.0 - 0.025_f64.sqrt())).abs() < 1e-15 && none.low == -none.high);
        for (score, people, reach) in [(0.0, 2, 1.0), (0.25, 7, 1.0), (-1.0, 4, 1.0), (-1.0, 4, 2.0)] {
            let interval = of_mean_score(&vec![score; people], reach).unwrap();
            for end in [interval.low, interval.high].into_iter().filter(|end| end.abs() < reach) {
                assert!(
                    (chance_of_unanimity(score, people, end, reach) - 0.025).abs() < 1e-12,
                    "{score} {end}"
                );
            }
        }
        assert_eq!((of_mean_score(&[1.0], 1.0), of_mean_score(&[], 1.0)), (None, None));
    }
}
