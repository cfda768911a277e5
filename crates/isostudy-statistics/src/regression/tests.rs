use super::*;
use crate::{Outcome, ShownBallot, golden};
use isostudy_design::ConfigurationId;

/// Two covariates of the paper's questions: log ratio of the published triangle counts, and whether a side is merged.
fn covariates() -> Vec<Option<Vec<f64>>> {
    let study = golden::study();
    let triangles = |id: &ConfigurationId| {
        study.published.benchmark.iter().find(|row| row.id == *id).unwrap().triangles as f64
    };
    let merged = |id: &ConfigurationId| f64::from(u8::from(!id.method.as_str().ends_with('u')));
    let of = |c: &isostudy_design::Comparison| {
        vec![(triangles(&c.left) / triangles(&c.right)).ln(), merged(&c.left) - merged(&c.right)]
    };
    study.comparisons.iter().map(|c| Some(of(c))).collect()
}

#[track_caller]
fn close(got: f64, want: f64) {
    assert!((got - want).abs() < 1e-9 * want.abs().max(1.0), "{got} instead of {want}");
}

#[test]
fn without_ties_as_statsmodels_has_it() {
    // statsmodels 0.15.0 on the decided answers, y = left: Logit(y, x).fit(tol=1e-14) without intercept: params, llf, bse;
    // fit(cov_type="cluster", cov_kwds={"groups": respondent, "use_correction": False}): bse times sqrt(18/17).
    let mut ballots = golden::ballots(&golden::study());
    ballots.retain(|ballot| ballot.outcome() != Outcome::Tie);
    let fit = regression(&covariates(), &ballots).unwrap();
    assert_eq!((fit.ln_nu, fit.participants), (None, 18));
    close(fit.coefficients[0], 0.108_274_578_369);
    close(fit.coefficients[1], 1.539_343_735_775);
    close(fit.log_likelihood, -261.461_059_878_651_04);
    close(fit.covariance[0][0].sqrt(), 0.479_616_159_384);
    close(fit.covariance[1][1].sqrt(), 0.648_887_603_251);
    close(fit.coefficient(0).unwrap().se, 0.395_932_818_193);
    close(fit.coefficient(1).unwrap().se, 0.701_236_993_485);
    assert_eq!(fit.chances(&[0.0, 0.0]), [0.5, 0.0, 0.5]);
}

#[test]
fn with_ties_as_a_log_linear_model_has_it() {
    // statsmodels 0.15.0: GLM(counts, [x/2, 0, -x/2 | tie | question], Poisson()) on the 27 x 3 counts: params and bse. The
    // sandwich from its parameters with NumPy, m/(m-1); p = 2 * scipy.stats.t.sf(|b/se|, 17).
    let fit = regression(&covariates(), &golden::ballots(&golden::study())).unwrap();
    close(fit.coefficients[0], 0.104_149_880_454);
    close(fit.coefficients[1], 1.683_834_616_505);
    close(fit.ln_nu.unwrap(), -1.380_596_243_373);
    close(fit.log_likelihood, -416.234_516_927_127_4);
    for (i, se) in [0.474_242_420_451, 0.645_330_061_519, 0.152_571_456_668].into_iter().enumerate() {
        close(fit.covariance[i][i].sqrt(), se);
    }
    let merged = fit.coefficient(1).unwrap();
    close(merged.se, 0.740_497_185_774);
    close(merged.p, 0.036_220_947_345_33);
    close(fit.coefficient(0).unwrap().p, 0.790_287_698_250_7);
    close(fit.clustered.as_ref().unwrap()[2][2].sqrt(), 0.233_401_009_415);
    // t(17) at 0.975 is 2.109816.
    close(merged.interval.high - merged.estimate, 2.109_815_577_833_318 * merged.se);
    let chances = fit.chances(&[0.0, 1.0]);
    close(chances.iter().sum::<f64>(), 1.0);
    close((chances[0] / chances[2]).ln(), 1.683_834_616_505);
}

#[test]
fn two_items_are_the_saturated_davidson_model() {
    // 36 : 8 : 10: ln 3.6 = 1.2809, nu = 8 / sqrt(360) = 0.4216.
    let answer = |participant: usize, outcome| ShownBallot::new(participant, 0, [0, 1], outcome);
    let counts = [(36, Outcome::Left), (8, Outcome::Tie), (10, Outcome::Right)];
    let ballots: Vec<ShownBallot> =
        counts.iter().flat_map(|&(n, outcome)| (0..n).map(move |p| answer(p, outcome))).collect();
    let fit = regression(&[Some(vec![2.0])], &ballots).unwrap();
    close(2.0 * fit.coefficients[0], 3.6_f64.ln());
    close(fit.ln_nu.unwrap(), (8.0 / 360.0_f64.sqrt()).ln());
}

#[test]
fn exchanged_sides_change_nothing() {
    let ballots = golden::ballots(&golden::study());
    let turned: Vec<ShownBallot> = ballots
        .iter()
        .map(|b| if b.question().is_multiple_of(2) { *b } else { b.with_outcome(b.outcome().swapped()) })
        .collect();
    let x = covariates();
    let turn = |(q, x): (usize, Option<Vec<f64>>)| {
        x.map(|x| x.into_iter().map(|x| if q % 2 == 0 { x } else { -x }).collect())
    };
    let turned_x: Vec<Option<Vec<f64>>> = x.clone().into_iter().enumerate().map(turn).collect();
    let (one, other) = (regression(&x, &ballots).unwrap(), regression(&turned_x, &turned).unwrap());
    for i in 0..2 {
        close(one.coefficients[i], other.coefficients[i]);
        close(one.coefficient(i).unwrap().se, other.coefficient(i).unwrap().se);
    }
}

#[test]
fn the_unit_of_a_covariate_is_no_separation() {
    let ballots = golden::ballots(&golden::study());
    let metres = regression(&covariates(), &ballots).unwrap();
    for unit in [1e-6, 1e6] {
        let x: Vec<Option<Vec<f64>>> =
            covariates().into_iter().map(|x| x.map(|x| vec![x[0] * unit, x[1]])).collect();
        let found = regression(&x, &ballots).unwrap();
        close(found.coefficients[0] * unit, metres.coefficients[0]);
        close(found.coefficient(0).unwrap().p, metres.coefficient(0).unwrap().p);
        close(found.coefficients[1], metres.coefficients[1]);
    }
}

#[test]
fn what_has_no_estimate_says_why() {
    let ballots = golden::ballots(&golden::study());
    assert_eq!(regression::<ShownBallot>(&covariates(), &[]), Err(FitError::Nothing));
    assert_eq!(regression(&[None, None], &ballots), Err(FitError::Nothing));
    let ties: Vec<ShownBallot> = ballots.iter().map(|b| b.with_outcome(Outcome::Tie)).collect();
    assert_eq!(regression(&covariates(), &ties), Err(FitError::OnlyTies));
    let twice: Vec<Option<Vec<f64>>> =
        covariates().into_iter().map(|x| x.map(|x| vec![x[0], -3.0 * x[0]])).collect();
    assert_eq!(regression(&twice, &ballots), Err(FitError::Collinear));
    // Everybody always takes the larger: the likelihood rises for ever.
    let x: Vec<Option<Vec<f64>>> = (0..27).map(|q| Some(vec![if q % 2 == 0 { 1.0 } else { -1.0 }])).collect();
    let always = |b: &ShownBallot| {
        b.with_outcome(if b.question().is_multiple_of(2) { Outcome::Left } else { Outcome::Right })
    };
    let ballots: Vec<ShownBallot> = ballots.iter().map(always).collect();
    assert_eq!(regression(&x, &ballots), Err(FitError::NoMaximum));
    let one: Vec<ShownBallot> = golden::ballots(&golden::study()).into_iter().take(1).collect();
    assert!(regression(&covariates(), &one).is_err());
}
