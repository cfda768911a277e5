use super::*;
use crate::ScoreTest;

#[track_caller]
fn close(got: f64, want: f64, by: f64) {
    assert!((got - want).abs() < by * want.abs().max(1.0), "{got} instead of {want}");
}

/// How much effort nine people needed to rise from each of four stools, on Borg's scale (Wretenberg, Arborelius and Lindberg 1993;
/// Pinheiro and Bates 2000, *Mixed-Effects Models in S and S-PLUS*, section 1.2; `ergoStool` of the R package nlme).
const STOOLS: [[i64; 9]; 4] = [
    [12, 10, 7, 7, 8, 9, 8, 7, 9],
    [15, 14, 14, 11, 11, 11, 12, 11, 13],
    [12, 13, 13, 10, 8, 11, 12, 8, 10],
    [10, 12, 9, 9, 7, 10, 11, 7, 8],
];

fn stools() -> Vec<Rating> {
    let of_item = |(item, of): (usize, &[i64; 9])| {
        let rating =
            move |(participant, &value): (usize, &i64)| Rating { participant, item, value: value as f64 };
        of.iter().enumerate().map(rating).collect::<Vec<_>>()
    };
    STOOLS.iter().enumerate().flat_map(of_item).collect()
}

#[test]
fn four_stools_as_r_has_them() {
    // R 4.2.2, lme4 1.1-31: lmer(effort ~ Type - 1 + (1 | Subject)): fixef, VarCorr, vcov, logLik. The book prints 1.332 and 1.100.
    let found = ratings(4, &stools()).unwrap();
    let means = [8.555_555_555_56, 12.444_444_444_44, 10.777_777_777_78, 9.222_222_222_22];
    means.into_iter().zip(&found.means).for_each(|(want, &got)| close(got, want, 1e-10));
    close(found.person_sd, 1.332_465_002_72, 1e-6);
    close(found.rest_sd, 1.100_294_571_63, 1e-6);
    close(found.covariance[0][0].sqrt(), 0.576_012_261_426, 1e-6);
    let difference = found.covariance[0][0] + found.covariance[1][1] - 2.0 * found.covariance[0][1];
    close(difference.sqrt(), 0.518_683_835_267, 1e-6);
    close(found.log_likelihood, -60.565_394_351, 1e-10);
    assert_eq!(found.participants, 9);
    // Of a balanced design the sandwich's error of a difference is that of the mean of people's differences.
    let own: Vec<f64> = (0..9).map(|p| (STOOLS[1][p] - STOOLS[0][p]) as f64).collect();
    let mean = own.iter().sum::<f64>() / 9.0;
    let error = (own.iter().map(|d| (d - mean).powi(2)).sum::<f64>() / 72.0).sqrt();
    let found = found.difference(1, 0).unwrap();
    close(found.estimate, mean, 1e-10);
    close(found.se, error, 1e-10);
}

#[test]
fn differences_within_people_by_sign_flips() {
    // SciPy 1.17.1: permutation_test((x,), np.sum, permutation_type="samples", n_resamples=np.inf), x = stool 3 less stool 1, and stool 4
    // less stool 1; people without a difference are left out.
    let of = |item: usize| {
        let rating = |part: usize| (0..9).map(move |p| (p, 0, part == 0, STOOLS[part][p]));
        ScoreTest::of_rating_difference(rating(item).chain(rating(0)), 14.0)
    };
    let third = of(2);
    assert_eq!(third.sign_flip.ratio, Some(PATTERNS[0]));
    assert_eq!(of(3).sign_flip.ratio, Some(PATTERNS[1]));
    close(third.mean, 20.0 / 9.0, 1e-12);
    assert_eq!(third.reach, 14.0);
    // Everybody one step higher: no more than 14 steps the other way, which has a chance of 2.5 % or more.
    let same =
        ScoreTest::of_rating_difference((0..9).flat_map(|p| [(p, 0, false, 3), (p, 0, true, 2)]), 14.0);
    let interval = same.interval.unwrap();
    close(interval.low, 15.0 * 0.025_f64.powf(1.0 / 9.0) - 14.0, 1e-12);
}

/// Patterns at least as extreme, and all.
const PATTERNS: [(u128, u128); 2] = [(2, 128), (92, 256)];

#[test]
fn the_order_of_ratings_changes_nothing_and_levels_are_taken_out() {
    let mut all = stools();
    let want = ratings(4, &all).unwrap();
    all.reverse();
    assert_eq!(ratings(4, &all).unwrap(), want);
    // Not everybody rates everything: means are then not the plain ones, but those of a person in the middle.
    let some: Vec<Rating> = all.iter().filter(|of| (of.participant + of.item) % 3 > 0).copied().collect();
    let unbalanced = ratings(4, &some).unwrap();
    close(unbalanced.means[0], UNBALANCED[0], 1e-6);
    close(unbalanced.means[1], UNBALANCED[1], 1e-6);
    close(unbalanced.person_sd, UNBALANCED[2], 1e-5);
}

/// R: lmer of the ratings with (Subject + Type) mod 3 above 0, both from 0, subjects in the order of the columns above.
const UNBALANCED: [f64; 3] = [8.405_286_816_69, 12.347_613_232_70, 1.145_207_110_37];

#[test]
fn what_has_no_estimate_says_so() {
    let of = |participant, item, value| Rating { participant, item, value };
    let says = |items: usize, of: &[Rating]| ratings(items, of).map(|_| ());
    assert_eq!(says(2, &[]), Err(FitError::Nothing));
    let two = [of(0, 0, 1.0), of(1, 0, 2.0), of(0, 1, 2.0), of(1, 1, 4.0)];
    assert_eq!(says(2, &two), Ok(()));
    assert_eq!(says(3, &two), Err(FitError::Disconnected));
    let exact = [of(0, 0, 1.0), of(1, 0, 2.0), of(0, 1, 2.0), of(1, 1, 3.0)];
    assert_eq!(says(2, &exact), Err(FitError::NoMaximum));
    // People alike but for chance: no spread is seen.
    let alike = [of(0, 0, 1.0), of(1, 0, 2.0), of(0, 1, 2.0), of(1, 1, 1.0)];
    assert_eq!(ratings(2, &alike).unwrap().person_sd, 0.0);
}
