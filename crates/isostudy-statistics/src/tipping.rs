//! How strong a liking for a side would have to be to undo a result.
//!
//! Where a method always stood on the right, people who like the right look like people who like the method. No analysis
//! tells them apart, but one can ask how far such a liking would have to go.

use super::ballot::ShownBallot;
use super::fit::{fit_given_side, has_spread};
use super::participants::Participants;
use super::regression::regression_given_side;
use super::sandwich::Clusters;
use crate::interval::Interval;
use std::collections::BTreeMap;

/// No liking beyond this is looked at, in log-odds: at 5 a side wins 99.3 % of the decided answers about equal items.
pub const FARTHEST_TIP: f64 = 5.0;

/// Steps between no liking and the farthest; the interval's end is followed from one to the next.
const STEPS: u32 = 20;

/// What a liking for one side would do.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Tip {
    /// The interval reaches zero without any such liking.
    Open,
    /// At a liking of so many log-odds, above zero, the interval reaches zero.
    At(f64),
    /// No liking up to [`FARTHEST_TIP`] takes the interval to zero.
    Beyond,
}

/// What a liking for each side would do to a difference of two items.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tipping {
    /// A liking for the left.
    pub left: Tip,
    /// A liking for the right.
    pub right: Tip,
}

/// The smallest liking for either side, the same in everybody and every question, with which the clustered 95 % t interval of
/// `item` less `other` reaches zero: Davidson's model with that liking given ([`fit_given_side`]), all worths fitted anew.
/// Found to 1e-6. The bonus of a side is in log-odds among decided answers, as Davidson and Beaver have it (1977).
///
/// `None` where there is no interval: nothing on one scale, separated items, fewer than two participants, or participants
/// who do not differ.
///
/// # Panics
/// If there is no such item.
pub fn tipping(participants: &Participants, item: usize, other: usize) -> Option<Tipping> {
    let clusters = Clusters::of(participants);
    let interval = |left: f64| -> Option<Interval> {
        let fit = fit_given_side(&clusters.all, left).ok()?;
        let clustered = clusters.covariance(&fit)?;
        let [se, independent] =
            [&clustered, &fit.covariance].map(|covariance| fit.standard_error(covariance, item, other));
        let known = has_spread(se, independent);
        known.then(|| fit.clustered_interval(&clustered, participants.number(), item, other))
    };
    towards_zero(interval)
}

/// As [`tipping`], of a difference of two preferences: how much more `item` is preferred to `other` in the first part's answers
/// than in the second's. Davidson's model with worths of each part's own and one weight of ties, fitted to both at once, so that
/// a participant's answers to both hang together.
///
/// `None` as there, and where a part's answers separate its items.
///
/// # Panics
/// If there is no such item among so many.
pub fn tipping_of_difference(
    parts: [&[ShownBallot]; 2],
    items: usize,
    item: usize,
    other: usize,
) -> Option<Tipping> {
    assert!(item.max(other) < items && item != other, "no items {item} and {other} among {items}");
    // What `item` is worth more in the first part, what it is worth in the second, and each part's other items; `other` is at
    // zero in both.
    let mut places: BTreeMap<(usize, usize), usize> = BTreeMap::from([((0, item), 0), ((1, item), 1)]);
    for (of, part) in parts.iter().enumerate() {
        for shown in part.iter().flat_map(|ballot| [ballot.left(), ballot.right()]).filter(|&i| i != other) {
            let next = places.len();
            places.entry((of, shown)).or_insert(next);
        }
    }
    let mut covariates: Vec<Option<Vec<f64>>> = Vec::new();
    let mut kinds: BTreeMap<(usize, usize, usize), usize> = BTreeMap::new();
    let mut ballots = Vec::new();
    for (of, part) in parts.iter().enumerate() {
        for ballot in *part {
            let sides = [ballot.left(), ballot.right()];
            let kind = *kinds.entry((of, sides[0], sides[1])).or_insert_with(|| {
                let mut x = vec![0.0; places.len()];
                for (shown, sign) in sides.into_iter().zip([1.0, -1.0]).filter(|&(shown, _)| shown != other) {
                    x[places[&(of, shown)]] += sign;
                    if (of, shown) == (0, item) {
                        x[1] += sign;
                    }
                }
                covariates.push(Some(x));
                covariates.len() - 1
            });
            ballots.push(ShownBallot::new(ballot.participant(), kind, sides, ballot.outcome()));
        }
    }
    towards_zero(|left| {
        let fit = regression_given_side(&covariates, &ballots, left).ok()?;
        let se = fit.clustered.as_ref()?[0][0].sqrt();
        has_spread(se, fit.covariance[0][0].sqrt()).then(|| fit.coefficient(0))?.map(|of| of.interval)
    })
}

/// The smallest liking for either side with which an interval reaches zero.
fn towards_zero(interval: impl Fn(f64) -> Option<Interval>) -> Option<Tipping> {
    let alone = interval(0.0)?;
    let positive = alone.low > 0.0;
    let excludes = |left: f64| {
        interval(left).is_none_or(|found| if positive { found.low > 0.0 } else { found.high < 0.0 })
    };
    if !excludes(0.0) {
        return Some(Tipping { left: Tip::Open, right: Tip::Open });
    }
    let towards = |sign: f64| {
        let place = |step: u32| FARTHEST_TIP * f64::from(step) / f64::from(STEPS);
        let Some(tipped) = (1..=STEPS).find(|&step| !excludes(sign * place(step))) else {
            return Tip::Beyond;
        };
        let (mut low, mut high) = (place(tipped - 1), place(tipped));
        while high - low > 1e-6 {
            let middle = 0.5 * (low + high);
            if excludes(sign * middle) { low = middle } else { high = middle }
        }
        Tip::At(0.5 * (low + high))
    };
    Some(Tipping { left: towards(1.0), right: towards(-1.0) })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simulation::{Plan, Population, simulate, stream};
    use crate::{Outcome, golden};
    use isostudy_design::Arrangement;

    #[track_caller]
    fn at(tip: Tip, want: f64) {
        match tip {
            Tip::At(found) => assert!((found - want).abs() < 2e-6, "{found} is not {want}"),
            other => panic!("{other:?} is not {want}"),
        }
    }

    #[test]
    fn the_papers_results_as_scipy_has_them() {
        // SciPy 1.17.1: brentq of the lower end over the offset, Davidson's model and its sandwich in NumPy 2.4.6.
        let study = golden::study();
        let participants = Participants::of(3, &golden::clusterings(&study, None));
        // Items U, P, I: integrated over none, collapse over none, integrated over collapse.
        let none = 0;
        for (item, other, right) in [
            (2, none, 0.748_269_763_331_688_8),
            (1, none, 0.304_987_490_390_236_2),
            (2, 1, 0.862_060_394_465_897_4),
        ] {
            let found = tipping(&participants, item, other).unwrap();
            at(found.right, right);
            assert_eq!(found.left, Tip::Beyond);
            // The other way round, the same.
            assert_eq!(tipping(&participants, other, item).unwrap().left, Tip::Beyond);
            at(tipping(&participants, other, item).unwrap().right, right);
        }
        // Body-centred (left) over simple cubic: two items, so the lower end itself.
        let methods = study.method_ids();
        let lattice = |method: usize| usize::from(methods[method].as_str().starts_with('b'));
        let all = golden::ballots(&study);
        let of_lattices = all.iter().filter(|b| lattice(b.left()) != lattice(b.right()));
        let lattices: Vec<ShownBallot> =
            of_lattices.map(|b| b.with_items([lattice(b.left()), lattice(b.right())])).collect();
        assert_eq!(lattices.len(), 162);
        let found = tipping(&Participants::of(2, &lattices), 1, 0).unwrap();
        at(found.left, 0.114_780_348_128_463_3);
        assert_eq!(found.right, Tip::Beyond);
    }

    #[test]
    fn differences_of_the_papers_results_as_scipy_has_them() {
        // NumPy 2.4.6 and SciPy 1.17.1: brentq of the interval's end over the offset. Items U, P, I.
        let study = golden::study();
        let [body, simple] = [Arrangement::BodyCentred, Arrangement::SimpleCubic]
            .map(|arrangement| golden::clusterings(&study, Some(arrangement)));
        let found = tipping_of_difference([&body, &simple], 3, 1, 0).unwrap();
        at(found.left, 2.574_579_152_523_849);
        assert_eq!(found.right, Tip::Beyond);
        // The other part first, and the other item first, the same.
        for other_way in [
            tipping_of_difference([&simple, &body], 3, 1, 0),
            tipping_of_difference([&body, &simple], 3, 0, 1),
        ] {
            at(other_way.unwrap().left, 2.574_579_152_523_849);
        }
        let open = tipping_of_difference([&body, &simple], 3, 2, 0).unwrap();
        assert_eq!(open, Tipping { left: Tip::Open, right: Tip::Open });
        let beyond = tipping_of_difference([&body, &simple], 3, 2, 1).unwrap();
        assert_eq!(beyond, Tipping { left: Tip::Beyond, right: Tip::Beyond });
    }

    #[test]
    fn balanced_sides_hold_against_any_liking() {
        let plan = Plan::round_robin(3, 4);
        let population = Population { worths: vec![0.0, 1.5, 0.0], ..Population::indifferent(3, 0.5) };
        let participants = Participants::of(3, &simulate(&plan, &population, 24, &mut stream(2, 0)));
        assert_eq!(tipping(&participants, 1, 0), Some(Tipping { left: Tip::Beyond, right: Tip::Beyond }));
        assert_eq!(tipping(&participants, 2, 0), Some(Tipping { left: Tip::Open, right: Tip::Open }));
    }

    #[test]
    fn without_an_interval_nothing_tips() {
        let ballot = |p| ShownBallot::new(p, 0, [0, 1], Outcome::Left);
        assert_eq!(tipping(&Participants::of(2, &[ballot(0), ballot(1)]), 0, 1), None);
    }
}
