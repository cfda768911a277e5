use super::*;
use crate::simulation::{Plan, Population, simulate, stream};
use crate::{Outcome, ShownBallot};

fn planted(sd: f64, people: usize, seed: u64) -> Participants {
    let plan = Plan::round_robin(6, 2);
    let worths = vec![0.8, 1.5, 1.4, -1.5, 1.0, -1.0];
    let population = Population { worths, ..Population::indifferent(6, sd) };
    Participants::of(6, &simulate(&plan, &population, people, &mut stream(seed, 1)))
}

/// `[first, tie, second]` of each of ten people about two items.
const TEN: [[usize; 3]; 10] = [
    [7, 1, 4],
    [11, 0, 1],
    [3, 2, 7],
    [9, 1, 2],
    [5, 3, 4],
    [12, 0, 0],
    [2, 1, 9],
    [8, 2, 2],
    [6, 0, 6],
    [10, 1, 1],
];

fn ballots(people: &[[usize; 3]]) -> Vec<ShownBallot> {
    let of_person = |(participant, counts): (usize, &[usize; 3])| {
        let answers = Outcome::ALL.into_iter().zip(*counts).flat_map(|(o, n)| std::iter::repeat_n(o, n));
        let one = move |(question, outcome)| ShownBallot::new(participant, question, [0, 1], outcome);
        answers.enumerate().map(one).collect::<Vec<_>>()
    };
    people.iter().enumerate().flat_map(of_person).collect()
}

/// SciPy 1.17 and NumPy 2.4: the integral by 80 points of Gauss and Hermite's rule, maximised by Nelder and Mead over worth,
/// tie parameter and sd; ends by `brentq`. Laplace's approximation is a few percent off where a person gave a dozen answers.
#[test]
fn two_items_by_an_exact_integral() {
    let found = heterogeneity(&Participants::of(2, &ballots(&TEN))).unwrap();
    let close =
        |got: f64, want: f64, part: f64| assert!((got / want - 1.0).abs() < part, "{got} instead of {want}");
    close(found.sd, 1.380_372, 0.03);
    close(found.interval.low, 0.677_081, 0.04);
    close(found.interval.high, 2.793_998, 0.04);
    close(found.p.ln(), 3.394_018_9e-5_f64.ln(), 0.02);
}

/// R 4.2.2, lme4 1.1-31: glmer(cbind(w, l) ~ 1 + (1 | p), family = binomial, nAGQ = 1) of the decided answers of the same people,
/// confint(profile(.)), and twice the gain on glm. Laplace's approximation there too, so only the step of the search is between them.
#[test]
fn two_items_without_ties_as_lme4_has_them() {
    let decided: Vec<[usize; 3]> = TEN.iter().map(|&[first, _, second]| [first, 0, second]).collect();
    let found = heterogeneity(&Participants::of(2, &ballots(&decided))).unwrap();
    let close = |got: f64, want: f64| assert!((got - want).abs() < 0.011, "{got} instead of {want}");
    close(found.sd, 1.264_980_608);
    close(found.interval.low, 0.610_358_343);
    close(found.interval.high, 2.540_112_102);
    // 0.5 * pchisq(14.06601465, 1, lower.tail = FALSE)
    assert!((found.p / 8.825_220_7e-5 - 1.0).abs() < 0.01, "{}", found.p);
}

#[test]
fn a_planted_spread_is_found() {
    for (sd, off) in [(0.0, 0.3), (0.5, 0.2), (1.0, 0.2), (2.0, 0.35)] {
        let found: Vec<Heterogeneity> =
            (0..4).map(|seed| heterogeneity(&planted(sd, 40, seed)).unwrap()).collect();
        let mean = found.iter().map(|of| of.sd).sum::<f64>() / found.len() as f64;
        assert!((mean - sd).abs() < off, "{sd}: {mean}");
        let covers = |of: &&Heterogeneity| of.interval.low <= sd && sd <= of.interval.high;
        assert!(found.iter().filter(covers).count() >= 3, "{sd}: {found:?}");
        assert!(found.iter().all(|of| (of.p < 0.05) == (of.interval.low > 0.0) || of.p > 0.02), "{found:?}");
    }
}

#[test]
fn two_camps_of_opposite_taste_differ_and_indifferent_people_do_not() {
    let camps: Vec<[usize; 3]> = (0..18).map(|i| if i % 2 == 0 { [10, 1, 1] } else { [1, 1, 10] }).collect();
    let found = heterogeneity(&Participants::of(2, &ballots(&camps))).unwrap();
    assert!(found.sd > 2.0 && found.p < 1e-6 && found.interval.low > 1.0, "{found:?}");
    let alike = heterogeneity(&Participants::of(2, &ballots(&[[5, 2, 5]; 18]))).unwrap();
    assert_eq!((alike.sd, alike.interval.low, alike.p), (0.0, 0.0, 1.0));
}

#[test]
fn what_has_no_estimate_says_so() {
    let unanimous = ballots(&[[3, 0, 0]; 4]);
    assert_eq!(heterogeneity(&Participants::of(2, &unanimous)), Err(FitError::NoMaximum));
    assert_eq!(heterogeneity(&Participants::of(2, &ballots(&TEN[..1]))), Err(FitError::NoMaximum));
    assert_eq!(heterogeneity(&Participants::of(2, &[])), Err(FitError::Nothing));
}
