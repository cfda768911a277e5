use super::*;
use crate::{Preferences, fixture, open_groups};
use isostudy_responses::{Mapping, parse};
use std::path::Path;

/// Answers in the long format, simulated with planted worths: `items` items, and `each` answers of each person.
fn answers(items: usize, people: usize, each: usize, sides_differ: bool) -> isostudy_responses::Responses {
    let mut state = 7_u64;
    let mut draw = move |below: usize| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % below
    };
    let mut text = String::from("participant,left,right,choice,order\n");
    for person in 0..people {
        for order in 0..each {
            let left = draw(items);
            let right = (left + 1 + draw(items - 1)) % items;
            let [left, right] = if sides_differ { [left, right] } else { [left.min(right), left.max(right)] };
            // The chance of the left grows with its number.
            let at = draw(100 * items) as i64;
            let middle = 50 * items as i64 + 40 * (left as i64 - right as i64);
            let choice = match at {
                at if at < middle - 10 * items as i64 => "left",
                at if at < middle + 10 * items as i64 => "none",
                _ => "right",
            };
            text += &format!("p{person},m{left},m{right},{choice},{order}\n");
        }
    }
    parse(text.as_bytes(), Path::new("many.csv"), None, &Mapping::default()).unwrap().responses
}

/// Every number of `Many` is that of `Preferences`, which takes another way to the tests.
#[test]
fn the_same_numbers_as_of_few_answers() {
    for sides_differ in [true, false] {
        let responses = answers(6, 300, 8, sides_differ);
        let groups = open_groups(&responses, None);
        let few = Preferences::without_study(&responses, &groups, None);
        let many = Many::of(&groups, responses.sides_recorded);
        assert_eq!((many.people, many.answers, many.tests.len()), (300, 2400, 15));
        assert!(many.tests.iter().any(|test| test.counts.iter().sum::<u64>() > test.people));
        assert_eq!(few.hypotheses.len(), many.tests.len());
        for (test, own) in few.hypotheses.iter().zip(&many.tests) {
            let name = own.items.map(|item| groups[own.group].items[item].clone()).join("-");
            assert_eq!((&test.contrast, test.test.counts), (&name, Some(own.counts)));
            assert_eq!(test.test.participants() as u64, own.people);
            let reach = test.test.reach;
            let interval = test.test.interval.map(|of| of.cut(-reach, reach));
            assert_eq!((test.test.sign_flip.p(), test.adjusted), (own.p, own.adjusted), "{name}");
            assert_eq!(
                (test.test.mean, interval, test.equivalence),
                (own.mean, own.interval, own.equivalence)
            );
        }
        for (model, own) in few.models.iter().zip(&many.models) {
            let of = |model: &GroupModel<'_>| {
                model.worths.iter().map(|of| (of.log_worth, of.clustered_error)).collect::<Vec<_>>()
            };
            assert_eq!((model.model, of(model)), (own.model, of(own)));
        }
    }
}

/// The paper's factors are exact fractions of whole numbers.
#[test]
fn factors_are_the_papers() {
    let study = fixture::study();
    let ballots = crate::ballots::ballots(&study, &fixture::answers(&study));
    let groups = crate::ballots::ballot_groups(&study, &ballots);
    let many = Many::of(&groups, true);
    let of = |group: &str, item: &str| {
        let is_meant =
            |of: &&ItemFactor| groups[of.group].name == group && groups[of.group].items[of.item] == item;
        many.factors.iter().find(is_meant).unwrap()
    };
    // Costen's questionnaire: 68 of 162 in B, and 91 of 162 in S; ties 19 and 8.
    assert_eq!((of("B", "bi").counts[0], of("B", "bi").answers), (68, 162));
    assert_eq!(of("S", "si").factor(), Fraction::new(91, 162));
    assert_eq!((of("U", "bu").counts, of("U", "su").counts), ([36, 8, 10], [10, 8, 36]));
    assert_eq!(of("U", "bu").appearance_share(), Fraction::new(36, 54));
    let ties: u64 = ["bu", "bi", "bp"].iter().map(|item| of("B", item).counts[1]).sum();
    assert_eq!(ties, 2 * 19);
}

/// More items than small matrices are kept for: worths that are planted come out, and lie in their intervals.
#[test]
fn a_hundred_items_have_the_worths_that_are_planted() {
    use isostudy_statistics::simulation::{Plan, Population, simulate, stream};
    use isostudy_statistics::{Pairs, Participants, clustered_covariance, fit};
    let items = 100;
    let worths: Vec<f64> = (0..items).map(|item| 0.02 * item as f64).collect();
    let plan = Plan::round_robin(items, 1);
    let population = Population { worths: worths.clone(), ..Population::indifferent(items, 0.6) };
    let ballots = simulate(&plan, &population, 60, &mut stream(5, 0));
    let group = BallotGroup {
        name: "all".into(),
        items: (0..items).map(|item| item.to_string()).collect(),
        ballots,
        objects: Vec::new(),
    };
    let groups = [group];
    let many = Many::of(&groups, true);
    let davidson = &many.models[0];
    assert_eq!(davidson.worths.len(), items);
    let inside = davidson.worths.iter().zip(&worths).skip(1).filter(|(found, truth)| {
        let interval = found.interval.unwrap();
        interval.low <= **truth - worths[0] && **truth - worths[0] <= interval.high
    });
    // The intervals share the first item's error, so that they miss together: 99 of them at 95 %.
    assert!(inside.count() >= 80);
    // The sandwich by its definition: one gradient a person from a model of one person's answers, in dense matrices.
    let pairs = Pairs::of(items, &groups[0].ballots);
    let fitted = fit(isostudy_statistics::Model::Davidson, &pairs).unwrap();
    let participants = Participants::of(items, &groups[0].ballots);
    let sandwich = clustered_covariance(&fitted, &participants).unwrap();
    let scores = |item: usize| -> Vec<f64> {
        (0..60)
            .map(|person| {
                let own = groups[0].ballots.iter().filter(|b| b.participant() == person);
                own.map(|b| {
                    let [left, tie, right] = fitted.chances(b.left(), b.right());
                    let expected = [left + 0.5 * tie, right + 0.5 * tie];
                    let won = 0.5 * (b.outcome().sign() + 1) as f64;
                    match item {
                        item if item == b.left() => won - expected[0],
                        item if item == b.right() => 1.0 - won - expected[1],
                        _ => 0.0,
                    }
                })
                .sum()
            })
            .collect()
    };
    let mut gradients: Vec<Vec<f64>> = (1..items).map(scores).collect();
    let ties = |person: usize| {
        let own = groups[0].ballots.iter().filter(|b| b.participant() == person);
        own.map(|b| f64::from(b.outcome() == Outcome::Tie) - fitted.chances(b.left(), b.right())[1]).sum()
    };
    gradients.push((0..60).map(ties).collect());
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    for (row, column) in [(0, 0), (0, 50), (98, 98), (99, 99), (3, 99)] {
        let (b, n) = (&fitted.covariance, gradients.len());
        let influence = |of: usize| -> Vec<f64> {
            (0..60).map(|person| (0..n).map(|k| b[of][k] * gradients[k][person]).sum()).collect()
        };
        let want = 60.0 / 59.0 * dot(&influence(row), &influence(column));
        let got = sandwich[row][column];
        assert!((got - want).abs() < 1e-9 * (1.0 + want.abs()), "{row} {column}: {got} {want}");
    }
}
