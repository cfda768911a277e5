use super::*;
use isostudy_statistics::simulation::stream;
use isostudy_statistics::{Outcome, ShownBallot};
use rand::RngExt;

/// The chance of an answer of each size by the model of adjacent categories: weights e^(y u / 2) w_|y|, with w_0 = 0.6, w_1 = 1 and
/// w_2 = 0.5.
fn drawn(ahead: f64, random: &mut impl rand::Rng) -> i8 {
    let weights = [(2, 0.5), (1, 1.0), (0, 0.6), (-1, 1.0), (-2, 0.5)];
    let of = |(step, weight): (i8, f64)| (0.5 * f64::from(step) * ahead).exp() * weight;
    let mut left = random.random::<f64>() * weights.into_iter().map(of).sum::<f64>();
    for (step, weight) in weights {
        left -= of((step, weight));
        if left < 0.0 {
            return step;
        }
    }
    -2
}

#[test]
fn planted_worths_are_within_their_intervals() {
    const WORTHS: [f64; 3] = [0.0, 0.9, -0.6];
    let mut random = stream(17, 0);
    let mut ballots = Vec::new();
    for participant in 0..120 {
        for (question, [a, b]) in [[0, 1], [0, 2], [1, 2]].into_iter().enumerate() {
            let [left, right] = if (participant + question) % 2 == 0 { [a, b] } else { [b, a] };
            let step = drawn(WORTHS[left] - WORTHS[right], &mut random);
            let outcome = [Outcome::Right, Outcome::Tie, Outcome::Left][(step.signum() + 1) as usize];
            ballots.push(
                ShownBallot::new(participant, question, [left, right], outcome).by_much(step.abs() > 1),
            );
        }
    }
    let items = ["a", "b", "c"].map(String::from).to_vec();
    let groups = [BallotGroup { name: "G".into(), items, ballots, objects: Vec::new() }];
    let found = of_steps(&groups);
    assert_eq!(
        found.iter().map(|of| of.model).collect::<Vec<_>>(),
        [WayModel::Adjacent, WayModel::Cumulative]
    );
    for of in &found {
        let worths = of.worths.as_ref().unwrap();
        assert!(worths[2].value < 0.0 && worths[1].value > 0.0 && worths[0].value == 0.0, "{worths:?}");
        assert_eq!((of.answers, worths[0].error), (360, None));
    }
    let adjacent = found[0].worths.as_ref().unwrap();
    for (worth, truth) in adjacent.iter().zip(WORTHS).skip(1) {
        let interval = worth.interval.unwrap();
        assert!((interval.low..=interval.high).contains(&truth) && worth.p.unwrap() < 0.01, "{worth:?}");
    }
    // Without anything that is much better there is nothing to add to pairs.
    let plain = BallotGroup {
        ballots: groups[0].ballots.iter().map(|ballot| ballot.by_much(false)).collect(),
        ..groups[0].clone()
    };
    assert_eq!(of_steps(&[plain]), []);
}

/// A group of the paper's methods, without answers to pairs.
fn group(items: &[&str]) -> [BallotGroup; 2] {
    let named = |name: &str, items: &[&str]| BallotGroup {
        name: name.into(),
        items: items.iter().map(|item| (*item).to_owned()).collect(),
        ballots: Vec::new(),
        objects: Vec::new(),
    };
    [named("G", items), named("clustering", &["U", "I", "P"])]
}

fn place(study: &Study, id: &str) -> u32 {
    study.configurations.iter().position(|of| of.id.to_string() == id).unwrap() as u32
}

#[test]
fn ratings_are_compared_within_their_objects_and_repeats_count_nothing() {
    let study = crate::fixture::study();
    let mut judged = Vec::new();
    // Everybody likes the bunny by four steps better than the sphere, and `bi` by one and a half better than `bu`.
    for (participant, steps) in [[2, 4, 6, 7], [3, 4, 7, 9], [1, 3, 5, 7], [2, 3, 6, 7]].iter().enumerate() {
        for (id, &step) in ["ss_bu", "ss_bi", "bs_bu", "bs_bi"].iter().zip(steps) {
            let rated = |step, is_repeat| Judged {
                participant: participant as u32,
                shown: vec![place(&study, id)],
                verdict: Verdict::Rated(step),
                is_repeat,
                order: 1,
            };
            judged.extend([rated(step, false), rated(9 - step, true)]);
        }
    }
    let responses = Responses { judged, ..Responses::default() };
    let groups = group(&["bu", "bi"]);
    let [found] = &of_judged(&study, &responses, &BTreeSet::new(), &groups)[..] else {
        panic!("levels of a factor are no methods")
    };
    let worths = found.worths.as_ref().unwrap();
    // The means of the differences 2, 1, 1, 2, 2, 2, 1 and 1.
    assert!((worths[1].value - 1.5).abs() < 1e-12 && found.answers == 16, "{worths:?}");
    assert!(worths[1].interval.unwrap().low > 0.0 && found.model == WayModel::Ratings);
    let without = of_judged(&study, &responses, &[0, 1].into(), &groups);
    assert!((without[0].worths.as_ref().unwrap()[1].value - 1.5).abs() < 1e-12 && without[0].answers == 8);
    assert_eq!(of_judged(&study, &Responses::default(), &BTreeSet::new(), &groups), []);
}

#[test]
fn of_sets_the_planted_worths_come_out_also_of_a_group_that_is_a_part() {
    const WORTHS: [(&str, f64); 4] = [("bu", 0.0), ("bi", 1.0), ("bp", -0.5), ("su", 0.5)];
    let study = crate::fixture::study();
    let mut random = stream(23, 0);
    let mut judged = Vec::new();
    for participant in 0..150 {
        for left_out in 0..4 {
            let shown: Vec<(u32, f64)> = WORTHS
                .iter()
                .enumerate()
                .filter(|(i, _)| *i != left_out)
                .map(|(_, (method, worth))| (place(&study, &format!("ss_{method}")), worth.exp()))
                .collect();
            let mut left = random.random::<f64>() * shown.iter().map(|(_, weight)| weight).sum::<f64>();
            let taken = shown.iter().find(|(_, weight)| {
                left -= weight;
                left < 0.0
            });
            judged.push(Judged {
                participant,
                shown: shown.iter().map(|(item, _)| *item).collect(),
                verdict: Verdict::Taken(taken.map(|(item, _)| *item)),
                is_repeat: false,
                order: 1,
            });
        }
    }
    let responses = Responses { judged, ..Responses::default() };
    for items in [&["bu", "bi", "bp", "su"][..], &["bu", "bi", "bp"]] {
        let groups = group(items);
        let found = of_judged(&study, &responses, &BTreeSet::new(), &groups);
        let worths = found[0].worths.as_ref().unwrap();
        for (item, worth) in items.iter().zip(worths).skip(1) {
            let truth = WORTHS.iter().find(|(id, _)| id == item).unwrap().1;
            // Five intervals of 95 % would hold their truths in 77 of 100 such tests; five of 3.5 standard errors in 998 of 1,000.
            assert!((worth.value - truth).abs() < 3.5 * worth.error.unwrap(), "{item}: {worth:?}");
        }
        assert_eq!(found[0].answers == 600, items.len() == 4);
    }
}
