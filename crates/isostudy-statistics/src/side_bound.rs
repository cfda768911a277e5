//! A liking for a side that the answers put beyond any bound is at least so large.

use super::fit::{Penalty, fit_given_side};
use super::participants::Participants;
use super::side::Side;
use super::side_separation::side_separation;
use crate::interval::LEVEL;

/// A liking beyond this is as good as none other, in log-odds: one answer in 500 million goes against it.
const FARTHEST: f64 = 20.0;

/// What can be said of a liking without an estimate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SideBound {
    /// The side that is liked.
    pub side: Side,
    /// The liking is at least this, in log-odds among decided answers about equal items; from 0 to 20.
    pub at_least: f64,
}

/// Bounds the liking for a side where [`side_separation`] finds it beyond any bound, as where everybody takes the left.
///
/// The bound is the liking with which the answers keep (1 - [`LEVEL`]) / 2 of the likelihood that they approach as it grows,
/// all worths fitted anew, each participant counting as one answer however many they gave (Davidson's model). If everybody
/// takes the left throughout it is the bound of Clopper and Pearson (1934) for a share of m out of m people.
///
/// `None` where the side has an estimate or items are to blame.
pub fn side_bound(participants: &Participants) -> Option<SideBound> {
    let all = participants.sum(&participants.counts);
    let side = side_separation(&all)?;
    let sign = if side == Side::Left { 1.0 } else { -1.0 };
    let weight = participants.number() as f64 / all.answers();
    let at = |liking: f64| -> Option<f64> {
        let fit = fit_given_side(&all, sign * liking).ok().filter(|fit| fit.penalty == Penalty::None)?;
        Some(weight * fit.log_likelihood)
    };
    let enough = at(FARTHEST)? + (0.5 - LEVEL / 2.0).ln();
    // The profile of a concave likelihood is concave: it rises all the way.
    let (mut low, mut high) = (0.0, FARTHEST);
    while high - low > 1e-9 {
        let middle = 0.5 * (low + high);
        if at(middle)? < enough { low = middle } else { high = middle }
    }
    Some(SideBound { side, at_least: high })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Outcome, ShownBallot};

    /// Everybody answers every pair of three items in both orders.
    fn everybody(people: usize, outcome: impl Fn(usize, usize, usize) -> Outcome) -> Participants {
        let ordered = [(0, 1), (1, 0), (0, 2), (2, 0), (1, 2), (2, 1)];
        let answer = |p, q: usize| {
            let (left, right) = ordered[q];
            ShownBallot::new(p, q, [left, right], outcome(p, left, right))
        };
        let all: Vec<ShownBallot> = (0..people).flat_map(|p| (0..6).map(move |q| answer(p, q))).collect();
        Participants::of(3, &all)
    }

    #[test]
    fn always_one_side_is_clopper_and_pearsons_bound() {
        // SciPy 1.17.1: logit(binomtest(36, 36).proportion_ci().low), its end as 0.025**(1 / 36); and of 5,
        // which even no liking at all could do.
        for (people, outcome, side, share) in [
            (36, Outcome::Left, Side::Left, 0.902_606_244_085_508_f64),
            (5, Outcome::Right, Side::Right, 0.478_176_249_895_018_6),
        ] {
            let found = side_bound(&everybody(people, |_, _, _| outcome));
            let want = (share / (1.0 - share)).ln().max(0.0);
            let SideBound { side: found, at_least } = found.unwrap();
            assert_eq!(found, side);
            assert!((at_least - want).abs() < 1e-6, "{at_least} is not {want}");
        }
    }

    #[test]
    fn ties_count_as_answers_and_say_nothing_of_sides() {
        // Two items, equal by symmetry: 30 answers to the left and 10 ties of 20 people keep
        // (1 + e^-d)^-30 of their likelihood, at 20 / 40 of its logarithm.
        let ties = |p| if p < 5 { Outcome::Tie } else { Outcome::Left };
        let ballots =
            (0..20).flat_map(|p| [[0, 1], [1, 0]].map(|items| ShownBallot::new(p, 0, items, ties(p))));
        let found = side_bound(&Participants::of(2, &ballots.collect::<Vec<_>>())).unwrap();
        let share = 0.025_f64.powf(40.0 / (30.0 * 20.0));
        assert!((found.at_least - (share / (1.0 - share)).ln()).abs() < 1e-6, "{found:?}");
    }

    #[test]
    fn a_side_with_an_estimate_has_no_bound() {
        // One answer to the right in both orders of a pair.
        let right = |p, l, r| if p == 0 && l + r == 1 { Outcome::Right } else { Outcome::Left };
        assert_eq!(side_bound(&everybody(36, right)), None);
        // The lower number always wins: the items' doing.
        let lower = |_, l, r| if l < r { Outcome::Left } else { Outcome::Right };
        assert_eq!(side_bound(&everybody(36, lower)), None);
    }
}
