use super::*;
use proptest::prelude::*;

#[track_caller]
fn close(got: f64, want: f64) {
    assert!((got - want).abs() < 1e-12, "{got} is not {want}");
}

#[test]
fn binomial_as_scipy_has_it() {
    // SciPy 1.17.1: binomtest(14, 18).pvalue and so on.
    close(binomial(14, 4), 0.030_883_789_062_5);
    close(binomial(84, 56), 0.022_154_955_980_559_547);
    close(binomial(0, 7), 0.015_625);
    close(binomial(9, 1), 0.021_484_375);
    assert_eq!((binomial(5, 5), binomial(0, 0)), (1.0, 1.0));
    assert!(binomial(10, 0) > 0.05 / 27.0 && binomial(16, 2) < 0.05 / 27.0 && binomial(15, 3) > 0.05 / 27.0);
}

#[test]
fn coakley_heise_as_scipy_has_it() {
    // z = (14 - 4) / sqrt(18); 2 * scipy.stats.norm.sf(z)
    let (z, p) = coakley_heise(14, 4).unwrap();
    close(z, 2.357_022_603_955_158_5);
    close(p, 0.018_422_125_454_099_002);
    close(coakley_heise(10, 36).unwrap().0, -3.833_490_860_027_325_6);
    close(coakley_heise(10, 36).unwrap().1, 0.000_126_337_497_299_173_32);
    assert_eq!(coakley_heise(0, 0), None);
}

#[test]
fn trinomial_by_its_definition() {
    // The double sum of Bian, McAleer and Wong, evaluated in Python with exact factorials.
    close(trinomial(11, 4, 3), 0.043_464_032_295_431_464);
    close(trinomial(9, 8, 1), 0.016_363_243_525_910_568);
    close(trinomial(2, 15, 1), 0.763_401_881_594_042_3);
    close(trinomial(14, 1, 3), 0.008_771_180_050_267_434);
    close(trinomial(1, 17, 0), 0.542_975_224_418_984_5);
    assert_eq!((trinomial(3, 9, 3), trinomial(0, 4, 0)), (1.0, 1.0));
    close(trinomial(9, 0, 1), binomial(9, 1));
}

proptest! {
    #[test]
    fn sides_swap_and_evidence_grows(wins in 0..40u64, ties in 0..20u64, losses in 0..40u64) {
        prop_assert_eq!(binomial(wins, losses), binomial(losses, wins));
        prop_assert_eq!(trinomial(wins, ties, losses), trinomial(losses, ties, wins));
        for p in [binomial(wins, losses), trinomial(wins, ties, losses)] {
            prop_assert!(p > 0.0 && p <= 1.0);
        }
        // One answer moved from the losses to the wins, the number decided kept.
        if wins >= losses && losses > 0 {
            prop_assert!(binomial(wins + 1, losses - 1) < binomial(wins, losses));
            prop_assert!(trinomial(wins + 1, ties, losses - 1) < trinomial(wins, ties, losses));
        }
    }
}

#[test]
fn trinomial_of_many_answers() {
    // SciPy 1.17.1: (binom.pmf(k, 100000, .6) * 2 * binom.sf((600 + k % 2 + k) // 2 - 1, k, .5)).sum()
    let p = trinomial(30_300, 40_000, 29_700);
    assert!((p / 0.014_386_938_226_239_642 - 1.0).abs() < 1e-9, "{p}");
}
