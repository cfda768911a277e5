use super::*;
use crate::{Model, Outcome, fit, golden};

#[track_caller]
fn close(got: f64, want: f64) {
    assert!((got - want).abs() < 2e-9 * want.abs().max(1.0), "{got} instead of {want}");
}

/// 303 students about six schools, by whether they study commerce (Dittrich, Hatzinger and Katzenbeisser 1998; `CEMS` of the R package
/// BradleyTerry2): left, right, then answers `[left, tie, right]` of the others and of those who do. Schools are Barcelona, London,
/// Milan, Paris, St. Gallen, Stockholm.
const SCHOOLS: [([usize; 2], [[u32; 3]; 2]); 15] = [
    ([1, 0], [[141, 11, 40], [76, 8, 27]]),
    ([2, 0], [[63, 50, 79], [41, 17, 53]]),
    ([3, 0], [[91, 25, 76], [66, 12, 33]]),
    ([4, 0], [[99, 15, 78], [45, 10, 56]]),
    ([1, 2], [[135, 18, 39], [86, 8, 17]]),
    ([3, 2], [[64, 23, 39], [57, 9, 20]]),
    ([1, 3], [[132, 13, 47], [54, 13, 44]]),
    ([1, 4], [[124, 16, 52], [84, 6, 21]]),
    ([2, 4], [[75, 19, 98], [60, 9, 42]]),
    ([3, 4], [[93, 12, 87], [72, 7, 32]]),
    ([0, 5], [[102, 30, 60], [70, 11, 30]]),
    ([1, 5], [[156, 15, 21], [94, 4, 13]]),
    ([2, 5], [[89, 34, 69], [68, 12, 31]]),
    ([3, 5], [[122, 15, 55], [81, 15, 15]]),
    ([4, 5], [[105, 27, 60], [50, 23, 38]]),
];

/// Each answer as that of another person, so that students of one subject need not be told apart.
fn schools() -> (Vec<ShownBallot>, Vec<Option<Vec<f64>>>) {
    let (mut ballots, mut covariates) = (Vec::new(), Vec::new());
    for (question, (sides, of)) in SCHOOLS.into_iter().enumerate() {
        for (commerce, counts) in of.into_iter().enumerate() {
            for (outcome, count) in Outcome::ALL.into_iter().zip(counts) {
                for _ in 0..count {
                    ballots.push(ShownBallot::new(covariates.len(), question, sides, outcome));
                    covariates.push(Some(vec![commerce as f64]));
                }
            }
        }
    }
    (ballots, covariates)
}

#[test]
fn six_schools_by_subject_as_r_has_it() {
    // R 4.2.2: glm(y ~ X + Z + tie + factor(pair) - 1, poisson), X half credits, Z those of students of commerce: coefficients,
    // sqrt(diag(vcov)), and the multinomial log-likelihood; -3964.378 without Z.
    let (ballots, covariates) = schools();
    let found = person_model(6, &ballots, &covariates).unwrap();
    close(found.log_likelihood, -3_938.664_018_263_2);
    let worths = [1.257_885_522_485_4, -0.152_041_190_400_2, 0.246_788_869_982_1, 0.187_455_246_152_1];
    worths.into_iter().zip(&found.log_worths[1..]).for_each(|(want, &got)| close(got, want));
    let slopes = [
        -0.111_568_086_641_5,
        -0.048_693_909_600_1,
        0.494_390_717_683_6,
        -0.566_912_040_402_7,
        -0.349_446_142_429_1,
    ];
    let errors = [
        0.164_888_756_048_0,
        0.154_766_944_526_2,
        0.157_586_080_508_7,
        0.153_443_218_069_2,
        0.158_312_937_312_6,
    ];
    for item in 1..6 {
        close(found.slopes[0][item], slopes[item - 1]);
        assert!((found.covariance[4 + item][4 + item].sqrt() / errors[item - 1] - 1.0).abs() < 1e-6);
    }
    close(found.ln_nu.unwrap(), -1.309_684_932_68);
    assert_eq!((found.side, found.participants), (None, 4_454));
    // The likelihood ratio that the docs print.
    let without = fit(Model::Davidson, &Pairs::of(6, &ballots)).unwrap().log_likelihood;
    assert_eq!(format!("{:.3}", 2.0 * (found.log_likelihood - without)), "51.428");
}

#[test]
fn clustered_as_r_has_it() {
    // R 4.2.2, sandwich 3.0-2: the same with a row per answer and outcome of the paper's answers about clusterings, Z those times
    // (respondent - 9.5) / 10; vcovCL(m, cluster = respondent, type = "HC0", cadjust = TRUE); F as for one scale.
    let ballots = golden::clusterings(&golden::study(), None);
    let covariates: Vec<_> = (0..18).map(|i| Some(vec![(f64::from(i) - 8.5) / 10.0])).collect();
    let found = person_model(3, &ballots, &covariates).unwrap();
    close(found.log_worths[1], 1.119_908_374_950);
    close(found.log_worths[2], 2.188_277_570_491);
    close(found.ln_nu.unwrap(), -1.450_275_351_754);
    let clustered = found.clustered.as_ref().unwrap();
    let errors = [0.361_939_833_864, 0.475_784_992_289, 0.735_149_079_914, 0.976_763_140_125];
    (0..4).for_each(|i| assert!((clustered[i][i].sqrt() / errors[i] - 1.0).abs() < 1e-8));
    let slope = found.slope(0, 1, 0).unwrap();
    close(slope.estimate, -0.689_591_486_810);
    assert!((slope.p - 0.361_366_138_628).abs() < 1e-8);
    let last = found.slope(0, 2, 0).unwrap();
    assert!((last.p - 0.394_851_459_086).abs() < 1e-8);
    let turned = found.slope(0, 0, 2).unwrap();
    assert_eq!((turned.estimate, turned.interval.low), (-last.estimate, -last.interval.high));
    let omnibus = found.omnibus(0).unwrap();
    assert_eq!(omnibus.degrees, [2, 16]);
    assert!((omnibus.f - 0.414_145_820_991).abs() < 1e-8, "{}", omnibus.f);
    assert!((omnibus.p - 0.667_789_554_828).abs() < 1e-8);
}

#[test]
fn units_and_zero_points_change_nothing_but_themselves() {
    let ballots = golden::clusterings(&golden::study(), None);
    let of = |unit: f64, zero: f64| -> Vec<_> {
        (0..18).map(|i| Some(vec![unit * f64::from(i) + zero, f64::from(i * i % 7)])).collect()
    };
    let (small, large) = (of(1.0, 0.0), of(1e6, 3e9));
    let [a, b] = [&small, &large].map(|of| person_model(3, &ballots, of).unwrap());
    assert!((a.log_likelihood - b.log_likelihood).abs() < 1e-9);
    for item in 1..3 {
        let [p, q] = [&a, &b].map(|of| of.slope(0, item, 0).unwrap());
        assert!((p.estimate / (1e6 * q.estimate) - 1.0).abs() < 1e-6, "{p:?} {q:?}");
        assert!((p.p - q.p).abs() < 1e-7);
        assert!((a.slope(1, item, 0).unwrap().p - b.slope(1, item, 0).unwrap().p).abs() < 1e-7);
    }
}

#[test]
fn what_has_no_estimate_says_so() {
    let ballots = golden::clusterings(&golden::study(), None);
    let with = |of: &dyn Fn(usize) -> Option<Vec<f64>>| {
        person_model(3, &ballots, &(0..18).map(of).collect::<Vec<_>>()).map(|_| ())
    };
    assert_eq!(with(&|_| None), Err(FitError::Nothing));
    assert_eq!(with(&|_| Some(vec![3.7])), Err(FitError::Collinear));
    assert_eq!(with(&|i| Some(vec![i as f64, 2.0 * i as f64])), Err(FitError::Collinear));
    // Whoever has a 1 always takes the item with the higher number, whoever has none never does.
    let foretold: Vec<ShownBallot> = ballots
        .iter()
        .map(|b| {
            let likes_left = (b.left() > b.right()) == (b.participant() % 2 == 1);
            b.with_outcome(if likes_left { Outcome::Left } else { Outcome::Right })
        })
        .collect();
    let parity: Vec<_> = (0..18).map(|i| Some(vec![f64::from(i % 2)])).collect();
    assert_eq!(person_model(3, &foretold, &parity).map(|_| ()), Err(FitError::NoMaximum));
}
