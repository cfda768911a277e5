//! A share of answers whose interval knows that one person's answers hang together.

use crate::interval::{Interval, LEVEL};
use statrs::distribution::{ContinuousCDF, StudentsT};

/// A share with its interval over participants.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ClusteredShare {
    /// Answers that count; halves are possible.
    pub hits: f64,
    /// Of how many.
    pub of: f64,
    /// `hits / of`.
    pub share: f64,
    /// t interval at [`LEVEL`], participants as clusters; `None` for fewer than two and where all have the same
    /// share, which tells no spread. Not cut to 0..=1.
    pub interval: Option<Interval>,
}

/// The share p = sum a / sum n over participants' `(a, n)`, with the ratio estimator's standard error
/// sqrt(m/(m-1) sum (a - p n)^2) / sum n over the m participants with n above zero (Cochran 1977, *Sampling Techniques*,
/// section 6.3), and t on m - 1 degrees of freedom. For equal n it is the t interval for the mean of a / n.
///
/// `None` if there is nothing to count.
pub fn clustered_share(counts: impl IntoIterator<Item = (f64, f64)>) -> Option<ClusteredShare> {
    let counts: Vec<(f64, f64)> = counts.into_iter().filter(|(_, n)| *n > 0.0).collect();
    let (hits, of) = counts.iter().fold((0.0, 0.0), |(hits, of), (a, n)| (hits + a, of + n));
    let (share, m) = (hits / of, counts.len() as f64);
    let squares: f64 = counts.iter().map(|(a, n)| (a - share * n) * (a - share * n)).sum();
    let spread = counts.iter().any(|(a, n)| a * of != hits * n);
    let interval = (counts.len() > 1 && spread).then(|| {
        let t = StudentsT::new(0.0, 1.0, m - 1.0).expect("m - 1 > 0").inverse_cdf(0.5 + LEVEL / 2.0);
        let half = t * (m / (m - 1.0) * squares).sqrt() / of;
        Interval { low: share - half, high: share + half }
    });
    (!counts.is_empty()).then_some(ClusteredShare { hits, of, share, interval })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::interval::t_over_respondents;

    #[test]
    fn by_hand() {
        // a = 3, 1, 4 of n = 4, 2, 4: p = 8/10. a - p n = -0.2, -0.6, 0.8; squares 1.04; se = sqrt(1.5 * 1.04) / 10
        // = 0.124900; t(2) = 4.302653: 0.8 -+ 0.537401.
        let found = clustered_share([(3.0, 4.0), (1.0, 2.0), (0.0, 0.0), (4.0, 4.0)]).unwrap();
        assert_eq!((found.hits, found.of, found.share), (8.0, 10.0, 0.8));
        let interval = found.interval.unwrap();
        assert!((interval.low - 0.262_599).abs() < 1e-6, "{interval:?}");
        assert!((interval.high - 1.337_401).abs() < 1e-6, "{interval:?}");
    }

    #[test]
    fn equal_numbers_are_a_t_interval_over_scores() {
        let found = clustered_share([(1.0, 4.0), (2.0, 4.0), (4.0, 4.0), (3.0, 4.0)]).unwrap();
        let (interval, scores) =
            (found.interval.unwrap(), t_over_respondents(&[0.25, 0.5, 1.0, 0.75]).unwrap());
        assert!((interval.low - scores.low).abs() < 1e-12 && (interval.high - scores.high).abs() < 1e-12);
    }

    #[test]
    fn nothing_and_one() {
        assert_eq!(clustered_share([]), None);
        assert_eq!(clustered_share([(0.0, 0.0)]), None);
        assert_eq!(clustered_share([(1.0, 3.0)]).unwrap().interval, None);
    }
}
