use super::*;
use proptest::prelude::*;

#[track_caller]
fn close(got: f64, want: f64, tolerance: f64) {
    assert!((got / want - 1.0).abs() < tolerance, "{got} is not {want}");
}

#[test]
fn by_hand() {
    // Eight patterns of 1, 1, 2: sums of size 4, 2, 2, 0 twice each; 2 or more in 6.
    let test = sign_flip(&[1, -1, 2]);
    assert_eq!((test.net, test.participants, test.ratio), (2, 3, Some((6, 8))));
    assert_eq!(sign_flip(&[1, 0, 1]).ratio, Some((2, 4)));
    assert_eq!(sign_flip(&[0, 0]).p(), 1.0);
    assert_eq!(sign_flip(&[]).p(), 1.0);
    // All 30 agree: two patterns of 2^30.
    assert_eq!(sign_flip(&[3; 30]).ratio, Some((2, 1 << 30)));
}

#[test]
fn as_exact_rank_tests_has_it() {
    // R 4.2.2, exactRankTests 0.8-35: perm.test(x, mu = 0, exact = TRUE)$p.value
    close(sign_flip(&[3, -1, 2, 0, 5, -2, 4, 1, 1, -3, 2, 6]).p(), 0.107_421_875, 1e-15);
    close(sign_flip(&[1, 2, 3, -1, -2, 0, 4].repeat(5)).p(), 0.008_611_904_457_211_494, 1e-14);
    // 225 participants with a difference: beyond the exact ratio.
    let test = sign_flip(&[1, 2, 3, -1, -2, 0, 4, -3, -2, 1].repeat(25));
    assert_eq!(test.ratio, None);
    close(test.p(), 0.03429163670777054, 1e-9);
}

#[test]
fn as_scipy_has_the_binomial() {
    // SciPy 1.17.1: binomtest(160, 400).pvalue; log(2) + binom.logsf(1299, 2000, .5)
    let signs = |plus: usize, minus: usize| [vec![1; plus], vec![-1; minus]].concat();
    close(sign_flip(&signs(160, 240)).p(), 7.426_568_076_372_613e-5, 1e-10);
    close(sign_flip(&signs(1300, 700)).ln_p, -93.917_807_832_902_87, 1e-11);
    // Only two of 2^3000 patterns; a double would underflow.
    let all = sign_flip(&[2; 3000]);
    close(all.ln_p, -2999.0 * std::f64::consts::LN_2, 1e-15);
    assert_eq!((all.p(), sign_flip(&signs(150, 150)).p()), (0.0, 1.0));
}

#[test]
fn a_hundred_thousand_participants() {
    // Against the normal tail with the Edgeworth correction left out: 1e-3 apart at this size.
    let differences: Vec<i64> =
        (0..100_000_i64).map(|i| (i * 7919 % 55) - 27 + i64::from(i % 40 == 0)).collect();
    let test = sign_flip(&differences);
    let squares: i64 = differences.iter().map(|d| d * d).sum();
    let z = (test.net.abs() as f64 - 1.0) / (squares as f64).sqrt();
    use statrs::distribution::{ContinuousCDF, Normal};
    close(test.p(), 2.0 * Normal::standard().cdf(-z), 2e-3);
}

#[test]
fn lattices_with_gaps() {
    // Python 3.11, subsets counted in whole numbers: sizes that leave nearly every other sum empty.
    let many = |parts: &[(i64, usize)]| -> Vec<i64> {
        parts.iter().flat_map(|&(d, n)| std::iter::repeat_n(d, n)).collect()
    };
    let cases: [(&[(i64, usize)], f64); 4] = [
        (&[(2, 130), (-2, 70), (1, 1)], -10.810_169_418_591_443),
        (&[(6, 150), (-6, 60), (3, 1), (1, 1), (-2, 1)], -22.012_053_856_325_99),
        (&[(4, 90), (-4, 80), (-1, 1)], -0.713_067_137_847_048_1),
        (&[(9, 300), (-9, 20), (-5, 1), (1, 1)], -148.886_706_893_766_3),
    ];
    for (parts, ln_p) in cases {
        let test = sign_flip(&many(parts));
        assert_eq!(test.ratio, None);
        assert!((test.ln_p - ln_p).abs() < 1e-10, "{} is not {ln_p}", test.ln_p);
    }
}

proptest! {
    #[test]
    fn symmetric_and_blind_to_order(
        differences in prop::collection::vec(-9..=9i64, 0..25),
        turn in 0..25usize,
    ) {
        let test = sign_flip(&differences);
        let mut turned: Vec<i64> = differences.iter().map(|d| -d).collect();
        turned.rotate_left(turn % differences.len().max(1));
        let other = sign_flip(&turned);
        prop_assert_eq!(other.net, -test.net);
        prop_assert_eq!(other.ratio, test.ratio);
        let tripled: Vec<i64> = differences.iter().map(|d| 3 * d).collect();
        prop_assert_eq!(sign_flip(&tripled).ratio, test.ratio);
    }

    #[test]
    fn counts_what_enumeration_counts(differences in prop::collection::vec(-5..=5i64, 1..11)) {
        let net = differences.iter().sum::<i64>().abs();
        let flipped = |pattern: u32| -> i64 {
            differences.iter().enumerate().map(|(i, d)| if pattern >> i & 1 == 1 { -d } else { *d }).sum()
        };
        let extreme = (0..1_u32 << differences.len()).filter(|&p| flipped(p).abs() >= net).count();
        let want = extreme as f64 / f64::from(1_u32 << differences.len());
        prop_assert_eq!(sign_flip(&differences).p(), want);
    }

    #[test]
    fn tilted_sum_equals_the_exact_count(differences in prop::collection::vec(-6..=6i64, 1..110)) {
        let mut sizes = BTreeMap::new();
        for &d in differences.iter().filter(|&&d| d != 0) {
            *sizes.entry(d.unsigned_abs()).or_insert(0_u64) += 1;
        }
        let sizes: Vec<(u64, u64)> = sizes.into_iter().collect();
        let net = differences.iter().sum::<i64>();
        let exact = sign_flip(&differences);
        prop_assert!((ln_tilted(&sizes, net.unsigned_abs()) - exact.ln_p).abs() < 1e-10);
    }

    #[test]
    fn more_for_a_lowers_p(differences in prop::collection::vec(-4..=9i64, 1..20), who in 0..20usize) {
        // With every size kept, turning a minus into a plus moves a positive net away from zero.
        let before = sign_flip(&differences);
        let mut after = differences.clone();
        let who = who % after.len();
        after[who] = after[who].abs();
        if before.net >= 0 {
            prop_assert!(sign_flip(&after).p() <= before.p());
        }
    }
}
