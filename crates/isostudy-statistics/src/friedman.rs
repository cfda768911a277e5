//! Friedman's test: do any of k related scores differ?

use statrs::distribution::{ChiSquared, ContinuousCDF};

/// A chi-square statistic with its degrees of freedom and upper tail.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ChiSquareTest {
    /// The statistic.
    pub statistic: f64,
    /// Degrees of freedom.
    pub degrees: f64,
    /// P(chi-square >= statistic).
    pub p: f64,
}

impl ChiSquareTest {
    /// The test with this statistic; `degrees` above zero.
    pub(super) fn new(statistic: f64, degrees: f64) -> Self {
        let p = ChiSquared::new(degrees).expect("degrees above zero").sf(statistic.max(0.0));
        Self { statistic, degrees, p }
    }
}

/// Friedman's rank test (1937, J. Amer. Statist. Assoc. 32:675) on one row of k scores a participant, corrected for
/// ties: Q = 12 / (n k (k+1)) sum R_j^2 - 3 n (k+1), over 1 - sum (t^3 - t) / (n k (k^2 - 1)), chi-square on k - 1.
///
/// `None` with fewer than two scores or if every row is all ties: then there is nothing to rank.
///
/// # Panics
/// If rows differ in length.
pub fn friedman(rows: &[Vec<f64>]) -> Option<ChiSquareTest> {
    let (n, k) = (rows.len() as f64, rows.first()?.len());
    let (mut sums, mut ties) = (vec![0.0; k], 0.0);
    for row in rows {
        assert_eq!(row.len(), k, "rows of Friedman's test differ in length");
        for (sum, score) in sums.iter_mut().zip(row) {
            let below = row.iter().filter(|other| *other < score).count() as f64;
            let same = row.iter().filter(|other| *other == score).count() as f64;
            *sum += below + (same + 1.0) / 2.0;
            // Each of the t members of a tie adds t^2 - 1, together t^3 - t.
            ties += same * same - 1.0;
        }
    }
    let width = k as f64;
    let correction = 1.0 - ties / (n * width * (width * width - 1.0));
    if k < 2 || correction <= 1e-12 {
        return None;
    }
    let squares: f64 = sums.iter().map(|sum| sum * sum).sum();
    let q = 12.0 / (n * width * (width + 1.0)) * squares - 3.0 * n * (width + 1.0);
    Some(ChiSquareTest::new(q / correction, width - 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn as_scipy_has_it() {
        // SciPy 1.17.1: friedmanchisquare([1,2,3,4,2], [2,2,1,5,3], [3,4,3,4,1])
        let rows = [[1., 2., 3.], [2., 2., 4.], [3., 1., 3.], [4., 5., 4.], [2., 3., 1.]].map(Vec::from);
        let test = friedman(&rows).unwrap();
        assert!(
            (test.statistic - 0.823_529_411_764_709_3).abs() < 1e-12
                && (test.p - 0.662_480_135_393_925_1).abs() < 1e-12,
            "{test:?}"
        );
        assert_eq!(friedman(&[vec![1.0, 1.0], vec![2.0, 2.0]]), None);
        assert_eq!(friedman(&[]), None);
    }
}
