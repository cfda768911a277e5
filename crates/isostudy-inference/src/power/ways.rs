//! Ways to ask about two things, as simulated people answer them: what an answer counts towards a person's score.
//!
//! To a person the first thing is ahead of the second by u log-odds. In every way but the first, each thing has a utility at each
//! showing: u / 2 or -u / 2, and a random part of Gumbel's distribution. So the difference of two is logistic around u (McFadden 1974), and
//! whoever must choose takes the first with the same odds e^u that decided answers have in the first way. The same people, asked
//! otherwise.

use isostudy_statistics::Outcome;
use isostudy_statistics::simulation::{davidson, draw};
use rand::{Rng, RngExt};

/// How people are asked.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Way {
    /// Left, no preference or right: Davidson's model.
    #[default]
    Pairs,
    /// Left or right.
    Forced,
    /// In five steps, from much better on the left to much better on the right.
    Graded,
    /// The best of three: the two, and one more that is liked like the second.
    BestOfThree,
    /// The best of four: the two, and two more that are liked like the second.
    BestOfFour,
    /// Each of the two is rated from 1 to 7.
    Ratings,
}

/// How far apart the cuts between ratings are, in log-odds: seven reach over 4.8, beyond which few differences are.
const RATING: f64 = 0.8;
/// The cuts are around this, near the mean of Gumbel's distribution.
const CENTRE: f64 = 0.58;

impl Way {
    /// All of them.
    pub const ALL: [Self; 6] =
        [Self::Pairs, Self::Forced, Self::Graded, Self::BestOfThree, Self::BestOfFour, Self::Ratings];

    /// The name in arguments and files.
    pub fn code(self) -> &'static str {
        match self {
            Self::Pairs => "pairs",
            Self::Forced => "forced",
            Self::Graded => "graded",
            Self::BestOfThree => "best-of-3",
            Self::BestOfFour => "best-of-4",
            Self::Ratings => "ratings",
        }
    }

    /// The way of this name.
    pub fn of_code(code: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|way| way.code() == code)
    }

    /// Whether people may have no preference.
    pub fn has_ties(self) -> bool {
        matches!(self, Self::Pairs | Self::Graded)
    }

    /// What the answer of somebody counts to whom the first is ahead by so many log-odds, a side's bonus included: above 0 for the
    /// first, below for the second. `ties` is Davidson's nu: equals tie with chance nu / (2 + nu).
    pub(super) fn answer(self, ahead: f64, ties: f64, random: &mut impl Rng) -> i64 {
        match self {
            Self::Pairs => Outcome::sign(draw(davidson(ahead, ties), random)),
            Self::Forced => {
                let [first, second] = utilities(ahead, random);
                if first > second { 1 } else { -1 }
            }
            Self::Graded => {
                let [first, second] = utilities(ahead, random);
                let between = first - second;
                // Equals tie as often as above, and half of the rest are much better or much worse.
                let cuts = [ties.ln_1p(), (3.0 + 2.0 * ties).ln()];
                let step = cuts.into_iter().filter(|&cut| between.abs() > cut).count() as i64;
                if between > 0.0 { step } else { -step }
            }
            Self::BestOfThree | Self::BestOfFour => {
                let [first, second] = utilities(ahead, random);
                let others = if self == Self::BestOfThree { 1 } else { 2 };
                let other =
                    (0..others).map(|_| gumbel(random) - 0.5 * ahead).fold(f64::NEG_INFINITY, f64::max);
                match first.max(second) {
                    best if best < other => 0,
                    best if best == first => 1,
                    _ => -1,
                }
            }
            Self::Ratings => {
                let [first, second] = utilities(ahead, random).map(rating);
                first - second
            }
        }
    }
}

/// Utilities of the first and the second.
fn utilities(ahead: f64, random: &mut impl Rng) -> [f64; 2] {
    [0.5 * ahead, -0.5 * ahead].map(|mean| mean + gumbel(random))
}

/// A number of Gumbel's distribution with scale 1 around 0.
fn gumbel(random: &mut impl Rng) -> f64 {
    let u: f64 = random.random();
    // In (0, 1): neither logarithm is of 0.
    -(-(u.max(f64::MIN_POSITIVE)).ln()).max(f64::MIN_POSITIVE).ln()
}

/// The rating of a thing with this utility, 1 to 7.
fn rating(utility: f64) -> i64 {
    (((utility - CENTRE) / RATING).round().clamp(-3.0, 3.0)) as i64 + 4
}

#[cfg(test)]
mod tests {
    use super::*;
    use isostudy_statistics::simulation::stream;
    use std::collections::BTreeMap;

    const MANY: u64 = 200_000;

    /// Shares of values among many answers.
    fn shares(way: Way, ahead: f64) -> BTreeMap<i64, f64> {
        let mut random = stream(8, 0);
        let mut counts = BTreeMap::new();
        (0..MANY).for_each(|_| *counts.entry(way.answer(ahead, 0.3, &mut random)).or_insert(0.0) += 1.0);
        counts.values_mut().for_each(|count| *count /= MANY as f64);
        counts
    }

    #[track_caller]
    fn near(got: f64, want: f64) {
        // Four standard errors of a share.
        assert!((got - want).abs() < 4.0 * (0.25 / MANY as f64).sqrt(), "{got} instead of {want}");
    }

    #[test]
    fn each_way_has_the_chances_of_its_model() {
        let logistic = |z: f64| 1.0 / (1.0 + (-z).exp());
        for ahead in [0.0, 0.8, -1.5] {
            let pairs = shares(Way::Pairs, ahead);
            let davidson = davidson(ahead, 0.3);
            (0..3).for_each(|i| near(pairs[&(1 - i)], davidson[i as usize]));
            let forced = shares(Way::Forced, ahead);
            near(forced[&1], logistic(ahead));
            assert_eq!(forced.len(), 2);
            // The cumulative model of five steps.
            let graded = shares(Way::Graded, ahead);
            let [none, much] = [1.3_f64.ln(), 3.6_f64.ln()];
            near(graded[&2], logistic(ahead - much));
            near(graded[&1], logistic(ahead - none) - logistic(ahead - much));
            near(graded[&0], logistic(ahead + none) - logistic(ahead - none));
            near(graded[&-2], logistic(-ahead - much));
            // Luce's choice: worths e^u, 1 and 1 for each other.
            for (way, others) in [(Way::BestOfThree, 1.0), (Way::BestOfFour, 2.0)] {
                let best = shares(way, ahead);
                let all = ahead.exp() + 1.0 + others;
                near(best[&1], ahead.exp() / all);
                near(best[&-1], 1.0 / all);
                near(best[&0], others / all);
            }
        }
    }

    #[test]
    fn equals_tie_alike_in_both_ways_that_have_ties_and_ratings_are_fair() {
        near(shares(Way::Graded, 0.0)[&0], 0.3 / 2.3);
        near(shares(Way::Pairs, 0.0)[&0], 0.3 / 2.3);
        let ratings = shares(Way::Ratings, 0.0);
        for difference in 1..=6 {
            let of = |value: i64| ratings.get(&value).copied().unwrap_or(0.0);
            near(of(difference), of(-difference));
        }
        let ahead: f64 = shares(Way::Ratings, 0.8).iter().map(|(value, share)| *value as f64 * share).sum();
        // One log-odds is a step and a quarter, less what the ends of the scale take.
        assert!((0.8..=1.0).contains(&ahead), "{ahead}");
        assert!(Way::ALL.into_iter().all(|way| Way::of_code(way.code()) == Some(way)));
        assert_eq!(Way::of_code("best"), None);
    }
}
