use super::*;
use crate::golden;
use proptest::prelude::*;
use std::collections::BTreeSet;

fn group(numerator: i64, denominator: i64, people: u64) -> ScoreGroup {
    ScoreGroup { numerator, denominator, people }
}

#[test]
fn partly_answered_rows_count_as_far_as_they_go() {
    let test = ScoreTest::of([(0, 1), (0, 1), (0, 0), (4, -1)]);
    assert_eq!((test.counts, test.participants(), test.leaning()), (Some([2, 1, 1]), 2, 2));
    assert_eq!(test.groups, [group(-1, 1, 1), group(2, 3, 1)]);
    assert_eq!(test.scores(), [-1.0, 2.0 / 3.0]);
    // Scores of 2/3 and -1: all four patterns are as far from zero as these are, or farther.
    assert_eq!((test.sign_flip.net, test.sign_flip.p()), (-1, 1.0));
    assert_eq!(ScoreTest::of([]).leave_one_out(), Vec::<f64>::new());
}

#[test]
fn the_test_is_about_the_scores_that_are_estimated() {
    // Eight people answer nine questions for the first, twelve people one for the second: most people are for the second.
    let eager = (0..8).flat_map(|person| std::iter::repeat_n((person, 1), 9));
    let test = ScoreTest::of(eager.chain((8..20).map(|person| (person, -1))));
    assert_eq!((test.counts, test.people()), (Some([72, 0, 12]), [8, 0, 12]));
    assert!((test.mean + 0.2).abs() < 1e-15);
    // scipy.stats.binomtest(8, 20).pvalue: every score is 1 or -1.
    assert!((test.sign_flip.p() - 0.503_444_671_630_859_4).abs() < 1e-15);
}

#[test]
fn differences_need_an_answer_to_both_parts() {
    let answers = [
        (0, 0, false, 1),
        (0, 0, false, 1),
        (0, 0, true, -1),
        (1, 0, false, 1),
        (2, 0, true, 1),
        (3, 0, false, 0),
        (3, 0, true, 1),
    ];
    let test = ScoreTest::of_difference(answers);
    assert_eq!((test.counts, test.groups), (None, vec![group(-1, 1, 1), group(2, 1, 1)]));
    assert_eq!(test.reach, 2.0);
}

#[test]
fn who_stops_early_tells_nothing_about_differences() {
    // The first part is liked on stratum 0 alone, and so is the second: that is no difference.
    let row = |person, strata: usize| {
        (0..strata).flat_map(move |stratum| {
            let sign = if stratum == 0 { 1 } else { -1 };
            [(person, stratum, false, sign), (person, stratum, true, sign)]
        })
    };
    let stopped = row(0, 2).chain([(0, 2, false, -1)]);
    let test = ScoreTest::of_difference(stopped.chain(row(1, 3)));
    assert_eq!(test.scores(), [0.0, 0.0]);
    // Blocks: no stratum with both parts. (1 - 1/2) and, with both parts in stratum 1, -1 - 1.
    let blocks = [(0, 0, false, 1), (0, 1, true, 1), (0, 2, true, 0)];
    let matched = [(1, 0, false, 1), (1, 1, false, -1), (1, 1, true, 1)];
    assert_eq!(ScoreTest::of_difference(blocks.into_iter().chain(matched)).scores(), [-2.0, 0.5]);
}

/// p of every pattern of signs, in fractions of one common denominator.
fn enumerated(scores: &[(i128, i128)]) -> f64 {
    let common: i128 = scores.iter().map(|of| of.1).product();
    let whole: Vec<i128> = scores.iter().map(|of| of.0 * common / of.1).collect();
    let observed = whole.iter().sum::<i128>().abs();
    let flipped = |pattern: u32| -> i128 {
        whole.iter().enumerate().map(|(i, x)| if pattern >> i & 1 == 1 { -x } else { *x }).sum()
    };
    let extreme = (0..1_u32 << whole.len()).filter(|&of| flipped(of).abs() >= observed).count();
    extreme as f64 / f64::from(1_u32 << whole.len())
}

proptest! {
    #[test]
    fn unequal_rows_as_every_pattern_of_signs_has_it(
        rows in prop::collection::vec(prop::collection::vec(-1..=1i64, 1..8), 1..9)
    ) {
        let answers = rows.iter().enumerate().flat_map(|(person, row)| row.iter().map(move |&sign| (person, sign)));
        let test = ScoreTest::of(answers);
        let score = |row: &Vec<i64>| (i128::from(row.iter().sum::<i64>()), row.len() as i128);
        let scores: Vec<(i128, i128)> = rows.iter().map(score).collect();
        prop_assert!((test.sign_flip.p() - enumerated(&scores)).abs() < 1e-12);
        if rows.len() > 1 {
            let left_out = test.leave_one_out();
            for (group, p) in test.groups.iter().zip(left_out) {
                let mut others = scores.clone();
                let equal = |of: &(i128, i128)| of.0 * i128::from(group.denominator) == i128::from(group.numerator) * of.1;
                let place = others.iter().position(equal).unwrap();
                others.remove(place);
                prop_assert!((p - enumerated(&others)).abs() < 1e-12);
            }
        }
    }

    /// Primes have no common unit that is small enough: rounded, p may be larger, never smaller.
    #[test]
    fn rounded_scores_give_an_upper_bound(nets in prop::collection::vec(-100..=100i64, 9)) {
        const SIZES: [i64; 9] = [101, 103, 107, 109, 113, 127, 131, 137, 139];
        let answers = nets.iter().zip(SIZES).enumerate().flat_map(|(person, (&net, size))| {
            (0..size).map(move |i| (person, if i < net.abs() { net.signum() } else { 0 }))
        });
        let test = ScoreTest::of(answers);
        let scores: Vec<(i128, i128)> =
            nets.iter().zip(SIZES).map(|(&net, size)| (i128::from(net), i128::from(size))).collect();
        let exact = enumerated(&scores);
        prop_assert!((exact - 1e-12..=exact + 0.02).contains(&test.sign_flip.p()), "{} {exact}", test.sign_flip.p());
    }

    #[test]
    fn order_and_names_of_participants_change_nothing(keep in prop::collection::vec(prop::bool::weighted(0.8), 486)) {
        let all = golden::ballots(&golden::study());
        let kept: Vec<(usize, i64)> = all
            .iter()
            .zip(keep)
            .filter(|(_, keep)| *keep)
            .map(|(ballot, _)| (ballot.participant(), ballot.outcome().sign()))
            .collect();
        let test = ScoreTest::of(kept.iter().copied());
        let other = ScoreTest::of(kept.iter().rev().map(|&(person, sign)| (17 - person, sign)));
        prop_assert_eq!(&test.groups, &other.groups);
        prop_assert_eq!((test.counts, test.sign_flip, test.interval), (other.counts, other.sign_flip, other.interval));
        prop_assert!((0..18).all(|person| test.group_of(person) == other.group_of(17 - person)));
        let turned = ScoreTest::of(kept.iter().map(|&(person, sign)| (person, -sign)));
        prop_assert_eq!(turned.sign_flip.ratio, test.sign_flip.ratio);
        prop_assert_eq!(turned.sign_flip.net, -test.sign_flip.net);
        let people: BTreeSet<usize> = kept.iter().map(|of| of.0).collect();
        prop_assert_eq!(test.participants(), people.len());
    }
}

#[test]
fn a_hundred_thousand_people_with_rows_of_any_length() {
    let rows = (0..100_000_usize).map(|person| (person, 1 + person % 27, (person * 7919) % 5));
    let answers = rows
        .flat_map(|(person, size, kind)| (0..size).map(move |i| (person, [1, -1, 1, 0, -1][(i + kind) % 5])));
    let test = ScoreTest::of(answers);
    let scores = test.scores();
    let z = scores.iter().sum::<f64>().abs() / scores.iter().map(|s| s * s).sum::<f64>().sqrt();
    use statrs::distribution::{ContinuousCDF, Normal};
    let normal = 2.0 * Normal::standard().cdf(-z);
    assert!((test.sign_flip.p() / normal - 1.0).abs() < 5e-3, "{} {normal}", test.sign_flip.p());
}

/// People who answered the parts on objects of their own: if everybody did so the same way, objects may be what differs; if the halves
/// change places, they are not.
#[test]
fn parts_about_different_strata_are_apart() {
    let of = |answers: &[(usize, usize, bool)]| {
        ScoreTest::of_difference(
            answers.iter().map(|&(person, stratum, second)| (person, stratum, second, 1)),
        )
    };
    let same_way = [(0, 0, false), (0, 1, true), (1, 0, false), (1, 1, true)];
    assert_eq!(of(&same_way).apart, 1.0);
    let turned = [(0, 0, false), (0, 1, true), (1, 1, false), (1, 0, true)];
    assert_eq!(of(&turned).apart, 0.0);
    // Two people one way and one the other: 2/3 and 1/3 against 1/3 and 2/3.
    let both = [same_way.as_slice(), &[(2, 1, false), (2, 0, true)]].concat();
    assert!((of(&both).apart - 1.0 / 3.0).abs() < 1e-12);
    // Who answered both parts on one object is compared there.
    let matched = [(0, 0, false), (0, 0, true), (0, 1, true), (1, 3, false)];
    assert_eq!(of(&matched).apart, 0.0);
}
