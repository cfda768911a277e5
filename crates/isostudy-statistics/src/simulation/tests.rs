use super::*;
use crate::sign_test;
use crate::{ScoreTest, sign_flip};
use rayon::prelude::*;

/// Share of simulated studies of one contrast, item 0 against 1, for which something holds.
fn rate(
    [questions, people, studies]: [usize; 3],
    population: &Population,
    holds: impl Fn(&ScoreTest) -> bool + Sync,
) -> f64 {
    let plan = Plan { counterbalanced: false, ..Plan::round_robin(2, questions) };
    let one = |study: u64| {
        let ballots = simulate(&plan, population, people, &mut stream(5, study));
        holds(&ScoreTest::of(ballots.iter().map(|b| (b.participant(), b.declared(0).preference().sign()))))
    };
    let count = (0..studies as u64).into_par_iter().filter(|&study| one(study)).count();
    count as f64 / studies as f64
}

fn ahead(by: f64, sd: f64) -> Population {
    Population { worths: vec![by, 0.0], ..Population::indifferent(2, sd) }
}

#[test]
fn chances_by_hand() {
    let [left, tie, right] = Population::indifferent(2, 0.0).chances((0, 1), 0);
    assert!((left - 1.0 / 2.3).abs() < 1e-12 && (tie - 0.3 / 2.3).abs() < 1e-12 && left == right);
    let chances = ahead(1.0_f64, 0.0).chances((0, 1), 0);
    let sum = 0.5_f64.exp() + (-0.5_f64).exp() + 0.3;
    assert!((chances[0] - 0.5_f64.exp() / sum).abs() < 1e-12);
    assert!((chances[1] - 0.3 / sum).abs() < 1e-12);
    // scipy.integrate.quad of norm.pdf(z) exp(u/2) / (exp(u/2) + .3 + exp(-u/2)), u = .8 + 1.5 z.
    let spread = ahead(0.8, 1.5).chances((0, 1), 0);
    assert!((spread[0] - CHANCE).abs() < 1e-9, "{spread:?}");
    assert!(davidson(2000.0, 0.3)[0] == 1.0 && davidson(-2000.0, 0.3)[2] == 1.0);
}

const CHANCE: f64 = 0.574_581_394_435_869;

#[test]
fn answers_have_these_chances() {
    let population = Population { side: 0.4, ..ahead(0.8, 1.0) };
    let plan = Plan::round_robin(2, 2);
    let ballots = simulate(&plan, &population, 40_000, &mut stream(1, 0));
    for sides in [(0, 1), (1, 0)] {
        let own: Vec<&ShownBallot> = ballots.iter().filter(|b| (b.left(), b.right()) == sides).collect();
        assert_eq!(own.len(), 40_000);
        for (o, want) in population.chances(sides, 0).into_iter().enumerate() {
            let share = own.iter().filter(|b| b.outcome().index() == o).count() as f64 / 40_000.0;
            assert!((share - want).abs() < 0.01, "{sides:?} {o}: {share} is not {want}");
        }
    }
    assert_eq!(ballots, simulate(&plan, &population, 40_000, &mut stream(1, 0)));
    assert_ne!(ballots[..40], simulate(&plan, &population, 10, &mut stream(1, 1))[..]);
}

#[test]
fn rejections_of_a_true_null() {
    // docs/statistics.md, size and coverage: nine questions, 18 people, in NumPy; the sign test on all answers rejects
    // 0.046, 0.080, 0.180, 0.243, sign-flip 0.035 to 0.050.
    for (sd, naive) in [(0.0, 0.046), (0.5, 0.080), (1.0, 0.180), (1.5, 0.243)] {
        let binomial = |t: &ScoreTest| {
            let [a, _, b] = t.counts.unwrap();
            sign_test::binomial(a, b) <= 0.05
        };
        let found = rate([9, 18, 4000], &ahead(0.0, sd), binomial);
        assert!((found - naive).abs() < 0.025, "{sd}: {found} is not {naive}");
        let exact = rate([9, 18, 4000], &ahead(0.0, sd), |t| t.sign_flip.p() <= 0.05);
        assert!((0.03..=0.06).contains(&exact), "{sd}: {exact}");
    }
}

#[test]
fn power_of_the_sign_flip_test() {
    // docs/statistics.md, size and coverage, in NumPy: sd 1, tie parameter 0.3, 18 and 36 people; the share of decided answers
    // of someone without a deviation is 0.60, 0.69, 0.77 at 0.4, 0.8, 1.2 logits. One question is a sign test, whose power
    // SciPy sums exactly.
    let table = [
        (1, [[0.0697, 0.1971, 0.4106], [0.1087, 0.3745, 0.7184]]),
        (3, [[0.132, 0.427, 0.781], [0.261, 0.772, 0.983]]),
        (9, [[0.230, 0.701, 0.963], [0.434, 0.955, 1.000]]),
    ];
    for (questions, powers) in table {
        for (people, row) in [18, 36].into_iter().zip(powers) {
            for (by, want) in [0.4, 0.8, 1.2].into_iter().zip(row) {
                let found = rate([questions, people, 3000], &ahead(by, 1.0), |t| t.sign_flip.p() <= 0.05);
                assert!(
                    (found - want).abs() < 0.035,
                    "{questions} questions, {people} people, {by}: {found} is not {want}"
                );
            }
        }
    }
}

#[test]
fn coverage_of_the_t_interval() {
    // 95 %, as a t interval of nearly normal scores has it.
    for by in [0.0, 0.8] {
        let population = ahead(by, 1.0);
        let [left, _, right] = population.chances((0, 1), 0);
        let covers =
            |t: &ScoreTest| t.interval.is_some_and(|i| i.low <= left - right && left - right <= i.high);
        let found = rate([9, 18, 4000], &population, covers);
        assert!((found - 0.95).abs() < 0.012, "{by}: {found}");
    }
}

#[test]
fn sides_are_counterbalanced() {
    let plan = Plan::round_robin(4, 4);
    assert_eq!((plan.questions.len(), plan.scenes()[23]), (24, 3));
    let lefts = |participant| {
        (0..24).filter(|&q| plan.sides(participant, q).0 < plan.sides(participant, q).1).count()
    };
    assert_eq!((lefts(0), lefts(1)), (12, 12));
    assert_ne!(plan.sides(0, 3), plan.sides(1, 3));
    assert_eq!(sign_flip(&[]).p(), 1.0);
}
