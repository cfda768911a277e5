use super::*;
use crate::simulation::{Plan, Population, simulate, stream};
use crate::{Preference, golden};
use proptest::prelude::*;

#[test]
fn as_the_krippendorff_package_has_it() {
    // PyPI krippendorff 0.9.0: alpha(value_counts=concatenate([counts, counts[:, ::-1]]), level_of_measurement="nominal"),
    // "ordinal"
    let counts = [[3, 1, 2], [0, 4, 2], [5, 0, 1], [1, 1, 0], [0, 0, 1], [2, 2, 2]];
    let (nominal, ordinal) =
        (alpha(&counts, Metric::Nominal).unwrap(), alpha(&counts, Metric::Ordinal).unwrap());
    assert!((nominal - 0.070_666_666_666_666_77).abs() < 1e-14, "{nominal}");
    assert!((ordinal - 0.062_820_512_820_512_93).abs() < 1e-14, "{ordinal}");
}

#[test]
fn the_papers_answers_as_numpy_has_them() {
    // NumPy 2.4.6 and SciPy 1.17.1, alpha of the 54 rows of counts as above for all participants and without each, l:
    // alpha -+ t.ppf(.975, 17) * sqrt(17 / 18 * ((l - l.mean())**2).sum()).
    let declared = golden::declared(&golden::ballots(&golden::study()));
    for (metric, want) in [
        (Metric::Nominal, [0.306_215_746_029_234_74, 0.146_456_579_883_146, 0.465_974_912_175_323_5]),
        (Metric::Ordinal, [0.374_315_121_421_057_8, 0.169_075_411_782_654_67, 0.579_554_831_059_568_4]),
    ] {
        let found = alpha_with_interval(&declared, metric).unwrap();
        let interval = found.interval.unwrap();
        for (got, want) in [found.value, interval.low, interval.high].into_iter().zip(want) {
            assert!((got - want).abs() < 1e-9, "{metric:?}: {got} is not {want}");
        }
    }
}

#[test]
fn ends() {
    for metric in [Metric::Nominal, Metric::Ordinal] {
        assert_eq!(alpha(&[[4, 0, 0], [0, 0, 4], [0, 4, 0]], metric), Some(1.0));
        // Everybody prefers what is named first, which is no accident of chance.
        assert_eq!(alpha(&[[4, 0, 0], [3, 0, 0]], metric), Some(1.0));
        assert_eq!(alpha(&[[0, 4, 0], [0, 3, 0]], metric), None);
        assert_eq!(alpha(&[[1, 0, 0], [0, 0, 1]], metric), None);
        assert_eq!(alpha(&[], metric), None);
    }
    let all = |people: usize| -> Vec<DeclaredBallot> {
        let answer = |i| DeclaredBallot::new(i / 3, i % 3, [0, 1], Preference::First);
        (0..3 * people).map(answer).collect()
    };
    // Whom one leaves out changes nothing.
    assert_eq!(alpha_with_interval(&all(9), Metric::Nominal), Some(Alpha { value: 1.0, interval: None }));
    assert_eq!(alpha_with_interval(&all(1), Metric::Nominal), None);
}

/// Answers of a few people to a few questions, some of them missing or given twice.
fn some_ballots() -> impl Strategy<Value = Vec<DeclaredBallot>> {
    prop::collection::vec((0..6usize, 0..5usize, 0..3usize), 12..40).prop_map(|answers| {
        let preference = [Preference::First, Preference::Neither, Preference::Second];
        answers.into_iter().map(|(p, q, o)| DeclaredBallot::new(p, q, [0, 1], preference[o])).collect()
    })
}

proptest! {
    #[test]
    fn which_item_is_named_first_changes_nothing(ballots in some_ballots(), turned in 0..32u32) {
        let turn = |b: &DeclaredBallot| match turned >> b.question() & 1 {
            0 => *b,
            _ => DeclaredBallot::new(b.participant(), b.question(), [1, 0], b.preference().reversed()),
        };
        let mirrored: Vec<DeclaredBallot> = ballots.iter().rev().map(turn).collect();
        for metric in [Metric::Nominal, Metric::Ordinal] {
            prop_assert_eq!(alpha_with_interval(&ballots, metric), alpha_with_interval(&mirrored, metric));
        }
    }

    #[test]
    fn leaving_one_out_is_alpha_without_their_ballots(ballots in some_ballots()) {
        for metric in [Metric::Nominal, Metric::Ordinal] {
            let people: std::collections::BTreeSet<usize> = ballots.iter().map(DeclaredBallot::participant).collect();
            let without = |p: &usize| {
                let others: Vec<DeclaredBallot> = ballots.iter().filter(|b| b.participant() != *p).copied().collect();
                alpha(&outcome_counts(&others), metric)
            };
            let value = alpha(&outcome_counts(&ballots), metric);
            let left_out: Option<Vec<f64>> = people.iter().map(without).collect();
            let want = value.zip(left_out).and_then(|(value, left_out)| jackknife(value, &left_out));
            let got = alpha_with_interval(&ballots, metric).and_then(|alpha| alpha.interval);
            match (got, want) {
                (Some(got), Some(want)) => {
                    prop_assert!((got.low - want.low).abs() < 1e-9 && (got.high - want.high).abs() < 1e-9);
                }
                (got, want) => prop_assert_eq!(got, want),
            }
        }
    }
}

#[test]
fn the_interval_covers_what_many_people_show() {
    let plan = Plan::round_robin(4, 3);
    let population = Population { worths: vec![0.2, 1.4, 1.0, -0.2], ..Population::indifferent(4, 0.8) };
    let value = |people: usize, study: u64| {
        let ballots = simulate(&plan, &population, people, &mut stream(8, study));
        alpha_with_interval(&golden::by_item(&ballots), Metric::Nominal).unwrap()
    };
    let truth = value(40_000, 0).value;
    let covers = |study| value(18, study).interval.is_some_and(|i| i.low <= truth && truth <= i.high);
    let covered = (1..=400).filter(|&study| covers(study)).count();
    // 380 but for chance; a little more where people hardly agree.
    assert!((368..=396).contains(&covered), "{covered}");
}
