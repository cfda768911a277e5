//! Spearman's rank correlation.

/// Pearson's correlation of the ranks, ties sharing the mean of their ranks (Spearman 1904, Amer. J. Psychol. 15:72).
/// `None` for fewer than two values or if one side does not vary.
///
/// # Panics
/// If the sides differ in length.
pub fn spearman(a: &[f64], b: &[f64]) -> Option<f64> {
    assert_eq!(a.len(), b.len(), "one rank correlation, two lengths");
    let (a, b) = (ranks(a), ranks(b));
    let middle = (a.len() as f64 + 1.0) / 2.0;
    let sum =
        |x: &[f64], y: &[f64]| -> f64 { x.iter().zip(y).map(|(x, y)| (x - middle) * (y - middle)).sum() };
    let (of_a, of_b) = (sum(&a, &a), sum(&b, &b));
    (of_a > 0.0 && of_b > 0.0).then(|| sum(&a, &b) / (of_a * of_b).sqrt())
}

fn ranks(values: &[f64]) -> Vec<f64> {
    let rank = |value: &f64| {
        let below = values.iter().filter(|other| *other < value).count() as f64;
        let same = values.iter().filter(|other| *other == value).count() as f64;
        below + (same + 1.0) / 2.0
    };
    values.iter().map(rank).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn as_scipy_has_it() {
        // SciPy 1.17.1: spearmanr([1, 2, 2, 4, 7, 3], [2, 1, 3, 3, 9, 0]).statistic = 0.4852941176470589
        let r = spearman(&[1., 2., 2., 4., 7., 3.], &[2., 1., 3., 3., 9., 0.]).unwrap();
        assert!((r - 0.485_294_117_647_058_9).abs() < 1e-12, "{r}");
        assert_eq!(spearman(&[1.0, 1.0], &[1.0, 2.0]), None);
        assert_eq!(spearman(&[], &[]), None);
    }
}
