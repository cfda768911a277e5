//! How strong a liking for a side would have to be to undo a result.
//!
//! Where a method always stood on the right, people who like the right look like people who like the method. No analysis
//! tells them apart, but one can ask how far such a liking would have to go.

use super::fit::{fit_given_side, has_spread};
use super::participants::Participants;
use super::sandwich::Clusters;
use crate::interval::Interval;

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
    use crate::{Outcome, ShownBallot, golden};

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
