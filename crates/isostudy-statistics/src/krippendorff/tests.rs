mod coverage;

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
    // `alpha_with_interval` written with that matrix: alpha of coincidences; each row deleted, less the sum over its answers of the
    // mean change by one answer of the column set to nan; b from all pairs of answers; X = people's deviations in coordinates,
    // S = X.T @ X / 17, f = trace(S)**2 over 17/(18*16*15)*(17*16*trace(S @ S) + trace(S)**2 - 18*sum((X**2).sum(1)**2)/17);
    // P by scipy.stats.t.cdf; ends by scipy.optimize.brentq(xtol=1e-15), the upper one bracketed from below on a grid.
    let all = golden::declared(&golden::ballots(&golden::study()));
    let some = |keep: &dyn Fn(&&DeclaredBallot) -> bool| all.iter().filter(keep).copied().collect::<Vec<_>>();
    let blocks = some(&|b| !(b.participant() + b.question()).is_multiple_of(3));
    let nine = some(&|b| (3..12).contains(&b.question()));
    for (ballots, metric, want) in [
        (&all, Metric::Nominal, [0.306_215_746_029_235, 0.160_421_267_568_579_66, 0.448_040_649_450_805_6]),
        (&all, Metric::Ordinal, [0.374_315_121_421_058, 0.177_172_430_930_719_7, 0.546_401_756_885_779_9]),
        (
            &blocks,
            Metric::Nominal,
            [0.333_447_302_419_219, 0.226_090_854_792_408_06, 0.434_711_662_990_448_1],
        ),
        (
            &blocks,
            Metric::Ordinal,
            [0.406_464_361_125_378, 0.272_488_711_987_180_44, 0.522_541_183_091_803_1],
        ),
        (&nine, Metric::Nominal, [0.438_316_498_316_498, 0.263_405_400_008_721_9, 0.569_106_107_768_913_8]),
        (&nine, Metric::Ordinal, [0.515_226_337_448_56, 0.291_071_776_659_224_07, 0.684_168_384_319_624_2]),
    ] {
        let found = alpha_with_interval(ballots, metric).unwrap();
        let interval = found.interval.unwrap();
        for (got, want) in [found.value, interval.low, interval.high].into_iter().zip(want) {
            assert!((got - want).abs() < 1e-11, "{metric:?}: {got} is not {want}");
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

/// Answers of some people to a few questions, some of them missing or given twice.
fn some_ballots() -> impl Strategy<Value = Vec<DeclaredBallot>> {
    prop::collection::vec((0..20usize, 0..5usize, 0..3usize), 150..260).prop_map(|answers| {
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

/// The answers of so many people to so many questions, of which they find all but every `odd`-th one clear.
fn answers(people: usize, questions: usize, odd: usize) -> Vec<DeclaredBallot> {
    let answer = |p: usize, q: usize| {
        let preference = match (q % odd, (p + q) % 2, q % 2) {
            (0, 0, _) => Preference::First,
            (0, ..) => Preference::Second,
            (_, _, 0) => Preference::First,
            _ => Preference::Second,
        };
        DeclaredBallot::new(p, q, [0, 1], preference)
    };
    (0..people * questions).map(|i| answer(i / questions, i % questions)).collect()
}

fn printed(ballots: &[DeclaredBallot]) -> bool {
    let [nominal, ordinal] =
        [Metric::Nominal, Metric::Ordinal].map(|metric| alpha_with_interval(ballots, metric).unwrap());
    assert_eq!(nominal.interval.is_some(), ordinal.interval.is_some());
    nominal.interval.is_some()
}

#[test]
fn twelve_people_per_question_are_needed() {
    assert_eq!((printed(&answers(11, 10, 2)), printed(&answers(12, 10, 2))), (false, true));
    let third = |people: usize| {
        let mut some = answers(people, 12, 2);
        some.retain(|ballot| (ballot.participant() + ballot.question() / 2).is_multiple_of(3));
        some
    };
    assert_eq!((printed(&third(33)), printed(&third(36))), (false, true));
    // Who answers twice is one person, and a question that one person answered is none.
    let mut twice = answers(11, 10, 2);
    twice.extend(answers(11, 10, 2));
    assert!(!printed(&twice));
    let mut alone = answers(12, 10, 2);
    alone.extend((10..20).map(|q| DeclaredBallot::new(0, q, [0, 1], Preference::First)));
    assert!(printed(&alone));
}

#[test]
fn disagreement_of_three_questions_is_needed() {
    // Questions are clear or halved, so that 1 - alpha is about the share of those that are halved, 12 / 11 of it for 12 people.
    for (questions, odd, want) in
        [(9, 9, false), (8, 4, false), (3, 1, false), (9, 3, true), (27, 27, false), (27, 9, true)]
    {
        let ballots = answers(12, questions, odd);
        let worth =
            alpha_with_interval(&ballots, Metric::Nominal).map(|a| questions as f64 * (1.0 - a.value));
        assert_eq!(
            (printed(&ballots), questions > 3 && worth.unwrap() >= 3.0),
            (want, want),
            "{questions} {odd} {worth:?}"
        );
    }
}

#[test]
fn more_people_have_a_narrower_interval() {
    let [few, many] = [12, 192].map(|people| {
        alpha_with_interval(&answers(people, 10, 2), Metric::Nominal).unwrap().interval.unwrap()
    });
    // sqrt(16), but for what is printed of few.
    assert!(few.high - few.low > 2.5 * (many.high - many.low), "{few:?} {many:?}");
}

/// Alpha depends on the questions that one group was asked and another was not, but that is no chance.
#[test]
fn who_was_asked_what_is_no_chance() {
    // All agree on even questions and are halved on odd ones; half the people are asked the one, half the other.
    let half = |of: usize| {
        let mut some = answers(48, 12, 2);
        some.retain(|b| of == 1 || b.question() % 2 == b.participant() / 2 % 2);
        alpha_with_interval(&some, Metric::Nominal).unwrap().interval.unwrap()
    };
    let (halves, all) = (half(2), half(1));
    // Half as many answers: sqrt 2 to 2 wider, but for degrees. Were it chance, it would be eight times as wide.
    assert!(halves.high - halves.low < 3.0 * (all.high - all.low), "{halves:?} {all:?}");
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
