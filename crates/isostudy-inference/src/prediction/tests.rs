use super::better::PairCount;
use super::*;
use crate::fixture::{self, Everything};
use isostudy_design::Clustering;
use isostudy_statistics::Outcome;

fn named<'a>(prediction: &'a Prediction, code: &str) -> &'a MetricPrediction {
    prediction.metrics.iter().find(|m| m.metric.code == code).unwrap_or_else(|| panic!("no {code}"))
}

fn predicted(inputs: &Inputs<'_>, shown: &[ShownBallot]) -> Option<Prediction> {
    Prediction::of(inputs, shown, &crate::ballots::declared(inputs.study, shown))
}

#[track_caller]
fn close(got: f64, want: f64) {
    assert!((got - want).abs() < 1e-8, "{got} instead of {want}");
}

/// The fixture's stimulus meshes have the published triangle counts, and equal radius ratios and angles.
#[test]
fn the_papers_answers_on_published_triangle_counts() {
    let all = Everything::of(fixture::study());
    let ballots = all.answers.shown.clone();
    let prediction = predicted(&all.inputs(), &ballots).unwrap();
    let codes: Vec<&str> = prediction.metrics.iter().map(|m| m.metric.code).collect();
    assert_eq!(codes, ["published_aspect_ratio", "triangles"]);
    assert_eq!((prediction.pairs, prediction.meshes, prediction.objects), (27, 18, 3));
    // Six meshes of an object have five differences, however many pairs are made of them.
    assert_eq!(prediction.independent, 15);
    let found = named(&prediction, "triangles");
    // statsmodels 0.15.0, SciPy 1.17.1, NumPy: x = -ln(triangles left / right) over its root mean square; GLM(counts, ...,
    // Poisson()) as in `regression`, and the same without one object each.
    close(found.unit, 0.893_065_898_989_785_2);
    let coefficient = found.coefficient.unwrap();
    close(coefficient.estimate, 0.9717443582986741);
    close(coefficient.se, 0.25234821819262415);
    let held_out = found.held_out.as_ref().unwrap();
    close(held_out.log_loss, 0.870_776_463_464_992_8);
    close(held_out.constant_log_loss, 0.951_766_132_061_881);
    // `scipy.stats.ttest_1samp(gains, 0, alternative="greater")`.
    close(held_out.gain_p.unwrap(), 0.018_136_956_644_352_352);
    assert_eq!((held_out.accuracy.hits, held_out.accuracy.of), (286.0, 437.0));
    assert_eq!(found.better.test.counts, Some([286, 49, 151]));
    let pairs = found.better.pairs;
    assert_eq!((pairs.better, pairs.drawn, pairs.worse), (19, 1, 7));
    // The better value stands on the right of 24 of 27 pairs, and everybody saw the same sides.
    assert_eq!((found.better_right, found.showings), (24 * 18, 27 * 18));
    // scipy.stats.spearmanr of both orders.
    close(prediction.correlations[0][1].unwrap(), 0.761_006_289_308_176);
    close(prediction.correlations[1][0].unwrap(), 0.761_006_289_308_176);
    close(prediction.correlations[1][1].unwrap(), 1.0);
    // The side alone: right in every question, 293 of 437.
    let side = prediction.side_held_out.as_ref().unwrap();
    assert_eq!((side.accuracy.hits, side.accuracy.of), (293.0, 437.0));
    let of_object: f64 = held_out.objects.iter().map(|(_, hits, _)| hits).sum();
    assert_eq!(of_object, held_out.accuracy.hits);
}

/// People who always take the rounder triangles, but for one answer each.
#[test]
fn a_planted_metric_is_found() {
    let mut all = Everything::of(fixture::study());
    for mesh in &mut all.meshes {
        mesh.quality.radius_ratio.mean = match crate::fixture::crossed(mesh.id.method).clustering {
            Clustering::None => 0.5,
            Clustering::EdgeCollapse => 0.8,
            _ => 0.9,
        };
    }
    let mut ballots = all.answers.shown.clone();
    for ballot in &mut ballots {
        let c = &all.study.comparisons[ballot.question()];
        let ratio =
            |id: &isostudy_design::ConfigurationId| match crate::fixture::crossed(id.method).clustering {
                Clustering::None => 5,
                Clustering::EdgeCollapse => 8,
                _ => 9,
            };
        let rounder = match ratio(&c.left).cmp(&ratio(&c.right)) {
            std::cmp::Ordering::Greater => Outcome::Left,
            std::cmp::Ordering::Equal => Outcome::Tie,
            std::cmp::Ordering::Less => Outcome::Right,
        };
        let slip = ballot.question() == 9 * (ballot.participant() % 3) + ballot.participant() % 6;
        *ballot = ballot.with_outcome(if slip { rounder.swapped() } else { rounder });
    }
    let prediction = predicted(&all.inputs(), &ballots).unwrap();
    let found = named(&prediction, "radius_ratio");
    // 18 pairs differ in clustering; the other nine are equal and count for nothing. The first six questions of an object are on clusterings.
    assert_eq!(found.better.test.counts, Some([18 * 17, 0, 18]));
    assert_eq!(found.better.pairs, PairCount { better: 18, drawn: 0, worse: 0 });
    close(found.better.share.unwrap().share, 17.0 / 18.0);
    assert!(found.coefficient.unwrap().interval.low > 1.0);
    let held_out = found.held_out.as_ref().unwrap();
    assert_eq!(held_out.accuracy.hits, 18.0 * 17.0);
    assert!(held_out.gain_p.unwrap() < 0.025);
    assert!(found.adjusted < 1e-3);
}

#[test]
fn sides_do_not_matter_to_metrics() {
    // The same choices of items, every other person's pairs the other way round.
    let all = Everything::of(fixture::study());
    let ballots = all.answers.shown.clone();
    let turned: Vec<ShownBallot> =
        ballots.iter().map(|b| if b.participant() % 2 == 0 { *b } else { b.turned() }).collect();
    let [one, other] = [&ballots, &turned].map(|of| predicted(&all.inputs(), of).unwrap());
    for (a, b) in one.metrics.iter().zip(&other.metrics) {
        assert_eq!((a.better.test.counts, a.better.pairs), (b.better.test.counts, b.better.pairs));
        close(a.coefficient.unwrap().estimate, b.coefficient.unwrap().estimate);
        assert_eq!(b.better_right, b.showings / 2);
    }
    // The side alone knows nothing any more: nine people saw it one way and nine the other.
    let side = other.side_held_out.as_ref().unwrap();
    assert!((side.accuracy.share - 0.5).abs() < 0.1, "{}", side.accuracy.share);
}

#[test]
fn nothing_measured_or_nothing_answered_predicts_nothing() {
    let all = Everything::of(fixture::study());
    let ballots = all.answers.shown.clone();
    assert!(predicted(&all.inputs(), &[]).is_none());
    let bare = Inputs { meshes: &[], ..all.inputs() };
    assert!(predicted(&bare, &ballots).is_none());
    // One object: a fit, but nothing to judge it on.
    let sphere: Vec<ShownBallot> = ballots.iter().filter(|b| b.question() < 9).copied().collect();
    let prediction = predicted(&all.inputs(), &sphere).unwrap();
    assert_eq!((prediction.pairs, prediction.independent), (9, 5));
    let found = named(&prediction, "triangles");
    assert!(found.held_out.is_none() && found.coefficient.is_ok());
    // Only ties: counts, and no coefficient.
    let ties: Vec<ShownBallot> = ballots.iter().map(|b| b.with_outcome(Outcome::Tie)).collect();
    let prediction = predicted(&all.inputs(), &ties).unwrap();
    let found = named(&prediction, "triangles");
    assert_eq!(found.coefficient, Err(FitError::OnlyTies));
    assert!(found.better.share.is_none() && prediction.joint.is_err());
}
