use super::*;
use proptest::prelude::*;

#[test]
fn as_the_krippendorff_package_has_it() {
    // PyPI krippendorff 0.9.0: krippendorff.alpha(value_counts=counts, level_of_measurement="nominal"), "ordinal"
    let counts = [[3, 1, 2], [0, 4, 2], [5, 0, 1], [1, 1, 0], [0, 0, 1], [2, 2, 2]];
    let (nominal, ordinal) =
        (alpha(&counts, Metric::Nominal).unwrap(), alpha(&counts, Metric::Ordinal).unwrap());
    assert!((nominal - 0.072_398_190_045_248_94).abs() < 1e-14, "{nominal}");
    assert!((ordinal - 0.069_500_674_763_832_81).abs() < 1e-14, "{ordinal}");
}

#[test]
fn ends() {
    for metric in [Metric::Nominal, Metric::Ordinal] {
        assert_eq!(alpha(&[[4, 0, 0], [0, 0, 4], [0, 4, 0]], metric), Some(1.0));
        assert_eq!(alpha(&[[4, 0, 0], [3, 0, 0]], metric), None);
        assert_eq!(alpha(&[[1, 0, 0], [0, 0, 1]], metric), None);
        assert_eq!(alpha(&[], metric), None);
    }
}

proptest! {
    #[test]
    fn sides_and_order_of_questions_change_nothing(
        counts in prop::collection::vec([0..6u64, 0..6u64, 0..6u64], 2..9),
        turn in 0..9usize,
    ) {
        let mut swapped: Vec<[u64; 3]> = counts.iter().map(|&[l, t, r]| [r, t, l]).collect();
        swapped.rotate_left(turn % counts.len());
        for metric in [Metric::Nominal, Metric::Ordinal] {
            match (alpha(&counts, metric), alpha(&swapped, metric)) {
                (Some(a), Some(b)) => prop_assert!((a - b).abs() < 1e-12 && a <= 1.0 + 1e-12),
                (a, b) => prop_assert_eq!(a, b),
            }
        }
    }
}
