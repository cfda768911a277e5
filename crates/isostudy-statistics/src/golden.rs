//! The paper's 18 x 27 answers against the values of docs/statistics.md, each to its printed digit.

use super::*;
use isostudy_design::{Arrangement, Clustering, Crossed, Study};
use std::path::Path;

/// The paper's study; its bunny is any file that is always there.
pub(super) fn study() -> Study {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../configs/paper.toml");
    let text = std::fs::read_to_string(&path).unwrap().replace("../cache/bunny.ply", "paper.toml");
    Study::parse(&text, &path).unwrap()
}

/// All 486 answers; items are methods in the study's order.
pub(super) fn ballots(study: &Study) -> Vec<ShownBallot> {
    let text = std::fs::read_to_string(study.responses.as_deref().unwrap()).unwrap();
    let methods = study.method_ids();
    let item = |method| methods.iter().position(|&m| m == method).unwrap();
    let mut ballots = Vec::new();
    for (participant, line) in text.lines().skip(1).enumerate() {
        for (question, cell) in line.trim().split(',').enumerate() {
            let comparison = &study.comparisons[question];
            assert_eq!(comparison.question, format!("Q{}", question + 1));
            let outcome = match cell {
                "L" => Outcome::Left,
                "NP" => Outcome::Tie,
                "R" => Outcome::Right,
                other => panic!("{other}"),
            };
            let (left, right) = (item(comparison.left.method), item(comparison.right.method));
            ballots.push(ShownBallot::new(participant, question, [left, right], outcome));
        }
    }
    ballots
}

/// The answers about items; every question names its left item first, as everybody saw it.
pub(super) fn declared(ballots: &[ShownBallot]) -> Vec<DeclaredBallot> {
    ballots.iter().map(|ballot| ballot.declared(ballot.left())).collect()
}

/// The answers about items, the lower number named first.
pub(super) fn by_item(ballots: &[ShownBallot]) -> Vec<DeclaredBallot> {
    ballots.iter().map(ShownBallot::by_item).collect()
}

/// The clustering questions as items U, P, I (the order the golden worths are printed in), of one arrangement or both.
pub(super) fn clusterings(study: &Study, of: Option<Arrangement>) -> Vec<ShownBallot> {
    let order = [Clustering::None, Clustering::EdgeCollapse, Clustering::Integrated];
    let item = |clustering| order.iter().position(|&c| c == clustering).unwrap();
    let mut kept = ballots(study);
    kept.retain_mut(|ballot| {
        let comparison = &study.comparisons[ballot.question()];
        let crossed = |method| Crossed::of(method).expect("the paper's methods");
        let (left, right) = (crossed(comparison.left.method), crossed(comparison.right.method));
        *ballot = ballot.with_items([item(left.clustering), item(right.clustering)]);
        left.arrangement == right.arrangement && of.is_none_or(|of| of == left.arrangement)
    });
    kept
}

#[track_caller]
fn prints(value: f64, want: &str) {
    let decimals = want.split_once('.').map_or(0, |(_, decimals)| decimals.len());
    let got = format!("{value:.decimals$}");
    assert_eq!(got, want, "{value}");
}

#[test]
fn counts() {
    let all = outcome_counts(&declared(&ballots(&study())));
    let sum = |o: usize| all.iter().map(|counts| counts[o]).sum::<u64>();
    assert_eq!([sum(0), sum(1), sum(2)], [144, 49, 293]);
}

#[test]
fn davidson_of_the_clusterings() {
    let study = study();
    let fitted = |of| fit(Model::Davidson, &Pairs::of(3, &clusterings(&study, of))).unwrap();
    let pooled = fitted(None);
    prints(pooled.log_worths[1], "1.08196");
    prints(pooled.log_worths[2], "2.13788");
    prints(pooled.ln_nu.unwrap(), "-1.46240");
    for (i, want) in ["0.1980", "0.2282", "0.2061"].into_iter().enumerate() {
        prints(pooled.covariance[i][i].sqrt(), want);
    }
    prints(pooled.log_likelihood, "-238.0987");
    let cases = [
        (Arrangement::BodyCentred, ["1.7531", "2.0989", "-1.0629", "-126.4937"]),
        (Arrangement::SimpleCubic, ["0.5169", "2.3888", "-1.9525", "-100.2690"]),
    ];
    for (of, [edge_collapse, integrated, ln_nu, log_likelihood]) in cases {
        let fit = fitted(Some(of));
        prints(fit.log_worths[1], edge_collapse);
        prints(fit.log_worths[2], integrated);
        prints(fit.ln_nu.unwrap(), ln_nu);
        prints(fit.log_likelihood, log_likelihood);
    }
}

#[test]
fn side_term_by_likelihood_ratio() {
    // R 4.2.2: deviance(g) - deviance(update(g, . ~ . + s)), g <- glm(y ~ factor(answer) + X + tie - 1, poisson), s = 1/2, 0,
    // -1/2 for left, none, right.
    let study = study();
    for (of, want) in
        [(Some(Arrangement::BodyCentred), "0.09"), (Some(Arrangement::SimpleCubic), "2.08"), (None, "0.12")]
    {
        let pairs = Pairs::of(3, &clusterings(&study, of));
        let [with, without] = [Model::DavidsonSide, Model::Davidson].map(|model| fit(model, &pairs).unwrap());
        prints(2.0 * (with.log_likelihood - without.log_likelihood), want);
        assert_eq!(side_design(&pairs), SideDesign::ThroughAdditivity);
    }
}

#[test]
fn friedman_on_clustering_scores() {
    let study = study();
    let mut scores = vec![vec![0.0; 3]; 18];
    for ballot in clusterings(&study, None) {
        scores[ballot.participant()][ballot.left()] += ballot.outcome().sign() as f64;
        scores[ballot.participant()][ballot.right()] -= ballot.outcome().sign() as f64;
    }
    let test = friedman(&scores).unwrap();
    prints(test.statistic, "23.690");
    assert_eq!(format!("{:.2e}", test.p), "7.17e-6");
}

#[test]
fn triads_of_the_clusterings() {
    let study = study();
    let mut all = Triads::default();
    for arrangement in [Arrangement::BodyCentred, Arrangement::SimpleCubic] {
        for object in 0..3 {
            let mut of = clusterings(&study, Some(arrangement));
            of.retain(|ballot| study.comparisons[ballot.question()].object == object);
            all = all.and(triads(&declared(&of)));
        }
    }
    assert_eq!((all.all, all.decided, all.strict_cycles), (108, 82, 5));
}

#[test]
fn one_respondent_answers_against_the_others() {
    // NumPy: the share of decided answers with the sign of the others' sum, where that is not 0.
    let screened = screening(&ballots(&study()));
    let shares: Vec<f64> = screened.iter().map(|s| s.agreement().unwrap()).collect();
    prints(shares[15], "0.37");
    let others = || shares.iter().enumerate().filter(|(i, _)| *i != 15).map(|(_, &share)| share);
    prints(others().fold(1.0, f64::min), "0.64");
    prints(others().fold(0.0, f64::max), "0.95");
    assert_eq!(screened[15].answers, [19, 0, 8]);
    let leaning: Vec<[u64; 3]> = screened.iter().map(|s| s.answers).filter(|a| a[0] > a[2]).collect();
    assert_eq!(leaning.iter().map(|a| [a[0], a[2]]).collect::<Vec<_>>(), [[12, 10], [19, 8]]);
}
