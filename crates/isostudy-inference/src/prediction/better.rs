//! How often the item with the better value was chosen.

use isostudy_statistics::{ClusteredShare, DeclaredBallot, ScoreTest, clustered_share};
use std::collections::BTreeMap;

/// Pairs by who won them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct PairCount {
    /// Won by the item with the better value: more answers for it than for the other.
    pub better: usize,
    /// As many answers for either.
    pub drawn: usize,
    /// Won by the other.
    pub worse: usize,
}

/// How answers fall between better and worse values.
#[derive(Debug, Clone)]
pub struct Better {
    /// Each participant's answers for the better value less those for the worse; pairs with equal values left out.
    pub test: ScoreTest,
    /// Share of decided answers that went to the better value.
    pub share: Option<ClusteredShare>,
    /// Pairs by winner.
    pub pairs: PairCount,
}

impl Better {
    /// `advantages` are those of each question's first item.
    pub fn of(advantages: &[Option<f64>], ballots: &[DeclaredBallot]) -> Self {
        let weight = |question: usize| match advantages.get(question).copied().flatten() {
            Some(advantage) if advantage > 0.0 => Some(1),
            Some(advantage) if advantage < 0.0 => Some(-1),
            _ => None,
        };
        let signed =
            |b: &DeclaredBallot| Some((b.participant(), weight(b.question())? * b.preference().sign()));
        let mut people: BTreeMap<usize, BTreeMap<usize, [u64; 2]>> = BTreeMap::new();
        for ballot in ballots {
            let Some(weight) = weight(ballot.question()) else { continue };
            let of = people.entry(ballot.participant()).or_default().entry(ballot.question()).or_default();
            match weight * ballot.preference().sign() {
                1 => of[0] += 1,
                -1 => of[1] += 1,
                _ => {}
            }
        }
        let people: Vec<BTreeMap<usize, [u64; 2]>> = people.into_values().collect();
        let answers = people.iter().map(|of| {
            let [hits, misses] = of.values().fold([0, 0], |[a, b], [x, y]| [a + x, b + y]);
            (hits as f64, (hits + misses) as f64)
        });
        let mut net: BTreeMap<usize, i64> = BTreeMap::new();
        for (&question, &[hits, misses]) in people.iter().flatten() {
            *net.entry(question).or_default() += hits as i64 - misses as i64;
        }
        Self {
            test: ScoreTest::of(ballots.iter().filter_map(signed)),
            share: clustered_share(answers),
            pairs: pairs(net.into_values()),
        }
    }

    /// Pairs with a better and a worse value.
    pub fn pair_count(&self) -> usize {
        self.pairs.better + self.pairs.drawn + self.pairs.worse
    }
}

/// Who wins each pair, from its answers for the better value less those for the worse.
fn pairs(net: impl Iterator<Item = i64>) -> PairCount {
    let mut count = PairCount::default();
    for net in net {
        match net.signum() {
            1 => count.better += 1,
            -1 => count.worse += 1,
            _ => count.drawn += 1,
        }
    }
    count
}

#[cfg(test)]
mod tests {
    use super::*;
    use isostudy_statistics::Preference::{self, First as Left, Neither as Tie, Second as Right};

    fn ballot(participant: usize, question: usize, preference: Preference) -> DeclaredBallot {
        DeclaredBallot::new(participant, question, [0, 1], preference)
    }

    #[test]
    fn by_hand() {
        // Question 0: left better; 1: right better; 2: equal; 3: no value.
        let advantages = [Some(0.5), Some(-2.0), Some(0.0), None];
        let ballots = [
            ballot(0, 0, Left),
            ballot(0, 1, Right),
            ballot(0, 2, Left),
            ballot(1, 0, Right),
            ballot(1, 1, Right),
            ballot(2, 0, Tie),
            ballot(2, 1, Left),
            ballot(2, 3, Right),
        ];
        let found = Better::of(&advantages, &ballots);
        assert_eq!(found.test.counts, Some([3, 1, 2]));
        assert_eq!(found.test.scores(), [-0.5, 0.0, 1.0]);
        // 2 of 2, 1 of 2, 0 of 1: p = 3/5; residuals 0.8, -0.2, -0.6, squares 1.04; se = sqrt(1.5 * 1.04) / 5 = 0.2498.
        let share = found.share.unwrap();
        assert_eq!((share.hits, share.of), (3.0, 5.0));
        let interval = share.interval.unwrap();
        assert!((interval.low - (0.6 - 4.302_653 * 0.249_800)).abs() < 1e-6, "{interval:?}");
        // Question 0 is drawn, 1 : 1; question 1 is won 2 : 1.
        assert_eq!(found.pairs, PairCount { better: 1, drawn: 1, worse: 0 });
        assert_eq!(found.pair_count(), 2);
    }

    #[test]
    fn of_nothing() {
        let found = Better::of(&[Some(1.0)], &[]);
        assert_eq!((found.share, found.pair_count()), (None, 0));
    }
}
