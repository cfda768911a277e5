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
    // NumPy 2.4.6 and SciPy 1.17.1, from a matrix of 18 people by questions, nan where not asked, by the formulas of
    // `alpha_with_interval` written with that matrix: alpha of coincidences; loo = each row deleted; b from all pairs of answers; X =
    // people's deviations in coordinates, S = X.T @ X / 17, f = trace(S)**2 over
    // 17/(18*16*15)*(17*16*trace(S @ S) + trace(S)**2 - 18*sum((X**2).sum(1)**2)/17); ends by scipy.optimize.brentq(xtol=1e-15).
    let all = golden::declared(&golden::ballots(&golden::study()));
    let some = |keep: &dyn Fn(&&DeclaredBallot) -> bool| all.iter().filter(keep).copied().collect::<Vec<_>>();
    let blocks = some(&|b| !(b.participant() + b.question()).is_multiple_of(3));
    let three = some(&|b| (3..6).contains(&b.question()));
    for (ballots, metric, want) in [
        (&all, Metric::Nominal, [0.306_215_746_029_235, 0.160_421_267_568_58, 0.448_040_649_465_727]),
        (&all, Metric::Ordinal, [0.374_315_121_421_058, 0.177_172_430_930_72, 0.546_401_764_080_736]),
        (&blocks, Metric::Nominal, [0.333_447_302_419_219, 0.214_828_821_445_385, 0.445_471_290_022_099]),
        (&blocks, Metric::Ordinal, [0.406_464_361_125_378, 0.255_396_671_187_506, 0.536_338_302_009_936]),
        (&three, Metric::Nominal, [0.583_308_993_905_407, 0.384_835_467_101_48, 0.713_357_426_482_975]),
        (&three, Metric::Ordinal, [0.616_239_158_137_049, 0.400_069_720_707_074, 0.747_674_123_036_237]),
    ] {
        let found = alpha_with_interval(ballots, metric).unwrap();
        let interval = found.interval.unwrap();
        for (got, want) in [found.value, interval.low, interval.high].into_iter().zip(want) {
            assert!((got - want).abs() < 1e-12, "{metric:?}: {got} is not {want}");
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
    // Nothing tells how people differ.
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
    fn the_interval_has_the_estimate_between_its_ends(ballots in some_ballots()) {
        for metric in [Metric::Nominal, Metric::Ordinal] {
            let Some(Alpha { value, interval: Some(interval) }) = alpha_with_interval(&ballots, metric) else { continue };
            prop_assert!(-1.0 <= interval.low && interval.low < value, "{:?} of {}", interval, value);
            prop_assert!(value < interval.high && interval.high <= 1.0, "{:?} of {}", interval, value);
        }
    }
}

/// Four people who answer at random have an interval as wide as can be, and whoever is as many again a narrower one.
#[test]
fn who_is_needed() {
    let answer = |p: usize, q: usize| {
        let preference =
            [Preference::First, Preference::Second, Preference::Neither, Preference::First][(p * q + p) % 4];
        DeclaredBallot::new(p, q, [0, 1], preference)
    };
    let of = |people: usize| {
        let all: Vec<_> = (0..5 * people).map(|i| answer(i / 5, i % 5)).collect();
        alpha_with_interval(&all, Metric::Nominal).unwrap().interval
    };
    assert_eq!(of(3), None);
    let [few, many] = [4, 64].map(|people| of(people).unwrap());
    assert!(few.high - few.low > 3.0 * (many.high - many.low), "{few:?} {many:?}");
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
    // 380 but for chance, whose standard error is 4.4.
    assert!((368..=392).contains(&covered), "{covered}");
}
