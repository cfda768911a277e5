use super::*;
use crate::statistics::golden;
use proptest::prelude::*;

fn named(family: Family) -> Vec<String> {
    let all = contrasts(&golden::study());
    all.iter().filter(|c| c.family == family).map(|c| format!("{} {}", c.name, c.scope)).collect()
}

#[test]
fn the_papers_contrasts() {
    assert_eq!(named(Family::Pooled), ["U-I all", "U-P all", "P-I all", "B-S all"]);
    assert_eq!(named(Family::Groups).len(), 9);
    assert_eq!(named(Family::Objects), ["B-S sphere", "B-S asteroid", "B-S bunny"]);
    assert_eq!(
        named(Family::Interactions),
        [
            "U-I B - S",
            "U-P B - S",
            "P-I B - S",
            "B-S U - I",
            "B-S U - P",
            "B-S I - P",
            "B-S sphere - others",
            "B-S asteroid - others",
            "B-S bunny - others",
        ]
    );
}

#[test]
fn interactions_weigh_both_parts_alike() {
    let study = golden::study();
    for contrast in contrasts(&study) {
        let sum: i64 = contrast.weights.values().sum();
        if contrast.family == Family::Interactions {
            // Every question of the paper shows the first on the left, so the two means cancel.
            assert_eq!(sum, 0, "{contrast:?}");
        } else {
            assert!(contrast.weights.values().all(|&weight| weight == 1), "{contrast:?}");
        }
    }
    let weights = |scope: &str| {
        let all = contrasts(&study);
        let found = all.into_iter().find(|c| c.scope == scope).unwrap();
        found.weights.into_values().collect::<Vec<_>>()
    };
    assert_eq!(weights("sphere - others"), [2, 2, 2, -1, -1, -1, -1, -1, -1]);
    assert_eq!(weights("U - I"), [1, -1, 1, -1, 1, -1]);
}

#[test]
fn partly_answered_rows_count_as_far_as_they_go() {
    let contrast = Contrast {
        family: Family::Pooled,
        name: "A-B".into(),
        scope: "all".into(),
        levels: [Arrangement::BodyCentred, Arrangement::SimpleCubic].map(Level::Arrangement),
        over: Over::All,
        weights: [(0, 1), (1, -1), (2, 1)].into(),
    };
    let ballot = |participant, question, outcome| Ballot::new(participant, question, [0, 1], outcome);
    use Outcome::{Left, Right, Tie};
    let ballots =
        [ballot(0, 0, Left), ballot(0, 1, Right), ballot(0, 2, Tie), ballot(4, 1, Left), ballot(5, 9, Left)];
    let test = contrast.test(&ballots);
    let kinds = [Kind { net: -1, size: 1, people: 1 }, Kind { net: 2, size: 3, people: 1 }];
    assert_eq!((test.counts, test.kinds.as_slice()), (Some([2, 1, 1]), kinds.as_slice()));
    assert_eq!(test.scores(), [-1.0, 2.0 / 3.0]);
    assert_eq!((test.sign_flip.net, test.sign_flip.p()), (1, 1.0));
    assert_eq!(contrast.test(&[]).leave_one_out(), None);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]
    #[test]
    fn order_and_names_of_participants_change_nothing(keep in prop::collection::vec(prop::bool::weighted(0.8), 486)) {
        let study = golden::study();
        let all = golden::ballots(&study);
        let kept: Vec<Ballot> = all.into_iter().zip(keep).filter(|(_, keep)| *keep).map(|(b, _)| b).collect();
        let mut turned: Vec<Ballot> =
            kept.iter().rev().map(|b| b.with_participant(17 - b.participant())).collect();
        let swapped = |b: &Ballot| b.with_outcome(b.outcome().swapped());
        for contrast in contrasts(&study) {
            let (test, other) = (contrast.test(&kept), contrast.test(&turned));
            prop_assert_eq!(test.counts, other.counts);
            prop_assert_eq!(test.sign_flip, other.sign_flip);
            prop_assert!((test.mean - other.mean).abs() < 1e-12);
        }
        turned = kept.iter().map(swapped).collect();
        for contrast in contrasts(&study) {
            let (test, other) = (contrast.test(&kept), contrast.test(&turned));
            prop_assert_eq!(test.sign_flip.ratio, other.sign_flip.ratio);
            prop_assert_eq!(test.sign_flip.net, -other.sign_flip.net);
        }
    }
}
