//! The second computation itself, against values that were published or can be counted by hand.

use super::*;

fn close(got: f64, want: f64) {
    assert!((got - want).abs() < 1e-9, "{got} and not {want}");
}

#[test]
fn signs_by_hand() {
    let p = |scores: &[(i128, i128)]| {
        let range = sign_flip(scores);
        assert_eq!(range.low, range.high);
        range.low
    };
    // All five one way: two of 32 patterns.
    close(p(&[(1, 1); 5]), 2.0 / 32.0);
    // 1/2 + 1/3 - 1/6 = 2/3; beyond that are +++ and ++-, and the opposites.
    close(p(&[(1, 2), (1, 3), (-1, 6)]), 0.5);
    close(p(&[(0, 1), (1, 1), (-1, 1)]), 1.0);
    close(p(&[]), 1.0);
    // One unit is too fine for the program, and its p may be larger.
    let fine = sign_flip(&[(1, 7919), (1, 2), (1, 3), (1, 5), (1, 7), (1, 11)]);
    assert!(fine.low <= fine.high && fine.low >= 2.0 / 64.0);
}

#[test]
fn corrections_as_r_has_them() {
    // R 4.2.2: p <- c(.01,.04,.03,.005,.5,.04); p.adjust(p, "holm"); p.adjust(p, "BH")
    let p = [0.01, 0.04, 0.03, 0.005, 0.5, 0.04];
    let holm = holm(&p);
    holm.iter().zip([0.05, 0.12, 0.12, 0.03, 0.5, 0.12]).for_each(|(got, want)| close(*got, want));
    let own = benjamini_hochberg(&p);
    own.iter().zip([0.03, 0.048, 0.048, 0.03, 0.5, 0.048]).for_each(|(got, want)| close(*got, want));
}

#[test]
fn intervals_as_scipy_has_them() {
    // x = [1, 2, 4, 7]; scipy.stats.t.interval(.95, 3, mean(x), sem(x))
    let [low, high] = t_interval(&[1.0, 2.0, 4.0, 7.0]).unwrap();
    assert!((low + 0.709_980_742).abs() < 1e-8 && (high - 7.709_980_742).abs() < 1e-8);
    // scipy.stats.binomtest(18, 18).proportion_ci().low = 0.8146980319, and a mean score is 2 p - 1.
    let [low, high] = interval(&[1.0; 18], 1.0).unwrap();
    assert!((low - (2.0 * 0.814_698_031_9 - 1.0)).abs() < 1e-9 && high == 1.0);
    // SciPy 1.17.1, ttest_1samp, the larger p of both sides at -.2 and .2.
    let scores = [0.1, -0.2, 0.3, 0.0, 0.1, -0.1, 0.05];
    close(equivalence(&scores, 0.2, 1.0).unwrap(), 0.017_393_486_936_827_105);
    close(equivalence(&[0.0; 4], 0.2, 1.0).unwrap(), 0.8_f64.powi(4));
}

#[test]
fn coins_by_hand() {
    close(binomial(5, 0), 2.0 / 32.0);
    close(binomial(3, 3), 1.0);
    // Two steps that rest half the time end where they began with 1/4 + 2/16, and two away with 1/16 each.
    close(trinomial(1, 1, 0), 0.625);
    close(steps(2, 0.5, 2), 2.0 / 16.0);
}
