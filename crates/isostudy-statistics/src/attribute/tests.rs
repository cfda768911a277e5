use super::*;
use crate::simulation::{Plan, Population, simulate};
use crate::{Outcome, golden};
use rand::Rng;

/// Respondents 1 to 9 against 10 to 18, by thirds, and by number: NumPy 2.4.6, Davidson's model by Newton's method, efficient scores
/// and T from their definition. The exact p counts all C(18, 9) = 48,620 divisions; that of the number is over 200,000 orders of
/// `default_rng(1)`.
#[test]
fn as_numpy_has_it() {
    let ballots = golden::clusterings(&golden::study(), None);
    let groups = |of: fn(usize) -> usize| Attribute::Group((0..18).map(|i| Some(of(i))).collect());
    let close = |got: f64, want: f64| assert!((got / want - 1.0).abs() < 1e-9, "{got} instead of {want}");
    let near = |got: f64, want: f64| {
        let error = (want * (1.0 - want) / ORDERS as f64).sqrt();
        assert!((got - want).abs() < 3.5 * error, "{got} instead of {want}");
    };
    let halves = attribute_test(3, &ballots, &groups(|i| i / 9)).unwrap();
    close(halves.statistic, 11.468_114_694_902_24);
    near(halves.p, 10_246.0 / 48_620.0);
    assert_eq!((halves.degrees, halves.people, halves.orders), (2, 18, 9_999));
    let thirds = attribute_test(3, &ballots, &groups(|i| i % 3)).unwrap();
    close(thirds.statistic, 23.493_182_327_210_185);
    assert_eq!(thirds.degrees, 4);
    let number = Attribute::Number((0..18).map(|i| Some(i as f64)).collect());
    let number = attribute_test(3, &ballots, &number).unwrap();
    close(number.statistic, 5.982_478_489_291_828);
    near(number.p, 0.405_303);
}

#[test]
fn neither_the_order_of_people_nor_the_names_of_groups_matter() {
    let ballots = golden::clusterings(&golden::study(), None);
    let of = |groups: [usize; 2]| Attribute::Group((0..18).map(|i| Some(groups[i / 9])).collect());
    let want = attribute_test(3, &ballots, &of([0, 1])).unwrap();
    let turned: Vec<ShownBallot> =
        ballots.iter().rev().map(|b| b.with_participant(17 - b.participant())).collect();
    let got = attribute_test(3, &turned, &of([7, 3])).unwrap();
    assert!((got.statistic - want.statistic).abs() < 1e-9);
    assert_eq!(got.p, want.p);
    // People of whom nothing is known are left out, as if they were not there.
    let of_some = Attribute::Group((0..18).map(|i| (i > 3).then_some(i % 2)).collect());
    let some: Vec<ShownBallot> = ballots.iter().filter(|b| b.participant() > 3).copied().collect();
    let all_of_some = Attribute::Group((0..18).map(|i| Some(i % 2)).collect());
    assert_eq!(attribute_test(3, &ballots, &of_some), attribute_test(3, &some, &all_of_some));
}

#[test]
fn what_cannot_be_tested_says_so() {
    let ballots = golden::clusterings(&golden::study(), None);
    let same = Attribute::Group(vec![Some(2); 18]);
    assert_eq!(attribute_test(3, &ballots, &same), Err(FitError::Nothing));
    assert_eq!(attribute_test(3, &ballots, &Attribute::Number(vec![None; 18])), Err(FitError::Nothing));
    let unanimous: Vec<ShownBallot> = ballots.iter().map(|b| b.with_outcome(Outcome::Left)).collect();
    let halves = Attribute::Group((0..18).map(|i| Some(i / 9)).collect());
    assert_eq!(attribute_test(3, &unanimous, &halves), Err(FitError::NoMaximum));
}

/// Studies of people of whom some, in a group of their own, like the last item more by `more` log-odds: how many reject.
fn rejected(studies: u64, sizes: [usize; 2], sd: [f64; 2], more: f64, seed: u64) -> f64 {
    let plan = Plan::round_robin(4, 2);
    let one = |study: u64| {
        let mut random = stream(seed, study);
        let mut ballots = Vec::new();
        for (group, worth) in [(0, 0.9), (1, 0.9 + more)] {
            let worths = vec![0.0, 0.3, 0.6, worth];
            let population = Population { worths, ..Population::indifferent(4, sd[group]) };
            let own = simulate(&plan, &population, sizes[group], &mut random);
            ballots.extend(own.iter().map(|b| b.with_participant(b.participant() + group * sizes[0])));
        }
        let groups = (0..sizes[0] + sizes[1]).map(|i| Some(usize::from(i >= sizes[0]))).collect();
        attribute_test(4, &ballots, &Attribute::Group(groups)).is_ok_and(|test| test.p <= 0.05)
    };
    (0..studies).into_par_iter().filter(|&study| one(study)).count() as f64 / studies as f64
}

#[test]
fn five_percent_of_no_differences_are_found_and_most_planted_ones() {
    // 400 studies: a standard error of 0.011.
    let none = rejected(400, [12, 12], [1.0, 1.0], 0.0, 3);
    assert!((0.02..=0.085).contains(&none), "{none}");
    let planted = rejected(100, [20, 20], [1.0, 1.0], 2.0, 4);
    assert!(planted > 0.85, "{planted}");
}

#[test]
fn a_number_that_goes_with_worths_is_found() {
    let mut random = stream(5, 0);
    let plan = Plan::round_robin(3, 3);
    let ages: Vec<f64> = (0..40).map(|i| 20.0 + f64::from(i)).collect();
    let mut ballots = Vec::new();
    for (person, age) in ages.iter().enumerate() {
        let worths = vec![0.0, 0.0, (age - 40.0) / 10.0];
        let population = Population { worths, ..Population::indifferent(3, 0.5) };
        let own = simulate(&plan, &population, 1, &mut random);
        ballots.extend(own.iter().map(|b| b.with_participant(person)));
    }
    let found = attribute_test(3, &ballots, &Attribute::Number(ages.iter().copied().map(Some).collect()));
    assert_eq!(found.unwrap().p, 1.0 / 10_000.0);
    let mixed: Vec<Option<f64>> = (0..40).map(|_| Some(f64::from(random.next_u32()))).collect();
    assert!(attribute_test(3, &ballots, &Attribute::Number(mixed)).unwrap().p > 0.01);
}

#[test]
#[ignore = "minutes: run by make test-long; prints a table"]
fn size_of_the_test_of_attributes() {
    println!("people | sd | rejected of 2,000");
    for sizes in [[6, 6], [9, 9], [4, 14], [30, 30], [10, 90]] {
        for sd in [[0.0, 0.0], [1.0, 1.0], [2.0, 2.0]] {
            let share = rejected(2_000, sizes, sd, 0.0, 6);
            println!("{} + {} | {} | {share:.3}", sizes[0], sizes[1], sd[0]);
            // A permutation test keeps its level; with few people it may stay below. 2,000 studies: 0.005.
            assert!(share < 0.066, "{sizes:?} {sd:?}: {share}");
        }
    }
}
