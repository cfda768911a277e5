//! Participants of a group of items, those who answered alike counted together.
//!
//! Models see of a participant only how often each pair came out how. Among a hundred thousand people few such patterns
//! are distinct, so what has to be done for everyone (gradients, resamples, leaving one out) is done for each pattern.

use super::ballot::ShownBallot;
use super::pairs::{Pair, Pairs};

/// The distinct patterns of answers, and how many participants have each.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Participants {
    items: usize,
    /// The ordered pairs that anyone was shown, ascending.
    shown: Vec<(usize, usize)>,
    /// By pattern, `[left, tie, right]` of each pair shown.
    patterns: Vec<Vec<[u32; 3]>>,
    /// How many participants have each pattern; never 0.
    pub counts: Vec<u64>,
}

impl Participants {
    /// Everyone with a ballot about two different items. The order of ballots does not matter.
    pub fn of(items: usize, ballots: &[ShownBallot]) -> Self {
        let useful = |b: &&ShownBallot| b.left() != b.right();
        let mut own: Vec<&ShownBallot> = ballots.iter().filter(useful).collect();
        // Files have one participant after the other: then there is nothing to sort.
        own.sort_by_key(|b| b.participant());
        let mut shown: Vec<(usize, usize)> = Vec::new();
        for pair in own.iter().map(|b| (b.left(), b.right())) {
            if let Err(place) = shown.binary_search(&pair) {
                shown.insert(place, pair);
            }
        }
        let pattern = |of: &[&ShownBallot]| {
            let mut pattern = vec![[0; 3]; shown.len()];
            for b in of {
                let place = shown.binary_search(&(b.left(), b.right())).expect("collected above");
                pattern[place][b.outcome().index()] += 1;
            }
            pattern
        };
        let mut all: Vec<Vec<[u32; 3]>> =
            own.chunk_by(|a, b| a.participant() == b.participant()).map(pattern).collect();
        all.sort_unstable();
        let (patterns, counts) =
            all.chunk_by(|a, b| a == b).map(|alike| (alike[0].clone(), alike.len() as u64)).unzip();
        Self { items, shown, patterns, counts }
    }

    /// How many participants.
    pub fn number(&self) -> u64 {
        self.counts.iter().sum()
    }

    /// How many participants have a pattern of answers that nobody else has, or share: distinct patterns.
    pub fn kinds(&self) -> usize {
        self.patterns.len()
    }

    /// How many items there are, those that nobody was shown included.
    pub fn items(&self) -> usize {
        self.items
    }

    /// The ordered pairs that anyone was shown, ascending.
    pub(super) fn shown(&self) -> &[(usize, usize)] {
        &self.shown
    }

    /// Every kind: its answers `[left, tie, right]` to each pair shown, and how many participants there are of it.
    pub(super) fn of_kinds(&self) -> impl Iterator<Item = (&[[u32; 3]], u64)> {
        self.patterns.iter().map(Vec::as_slice).zip(self.counts.iter().copied())
    }

    /// The answers of one participant of a kind.
    ///
    /// # Panics
    /// If there is no such kind.
    pub fn of_kind(&self, kind: usize) -> Pairs {
        let counts = self.patterns[kind].iter().map(|counts| counts.map(f64::from));
        self.pairs(counts)
    }

    /// The answers of so many participants of each kind.
    pub fn sum(&self, weights: &[u64]) -> Pairs {
        let mut sums = vec![[0_u64; 3]; self.shown.len()];
        for (pattern, &weight) in self.patterns.iter().zip(weights).filter(|(_, weight)| **weight > 0) {
            for (sum, counts) in sums.iter_mut().zip(pattern) {
                (0..3).for_each(|o| sum[o] += weight * u64::from(counts[o]));
            }
        }
        self.pairs(sums.into_iter().map(|counts| counts.map(|count| count as f64)))
    }

    /// Pairs without an answer are left out.
    fn pairs(&self, counts: impl Iterator<Item = [f64; 3]>) -> Pairs {
        let answered = self.shown.iter().zip(counts).filter(|(_, answers)| *answers != [0.0; 3]);
        let pair = |(&(left, right), answers)| Pair { left, right, answers };
        Pairs { items: self.items, pairs: answered.map(pair).collect() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Outcome, golden};

    #[test]
    fn patterns_add_up_to_the_ballots() {
        let study = golden::study();
        let ballots = golden::clusterings(&study, None);
        let participants = Participants::of(3, &ballots);
        assert_eq!(participants.number(), 18);
        assert_eq!(participants.sum(&participants.counts), Pairs::of(3, &ballots));
        // Everyone three times: the same kinds, three times as many.
        let again = |times: usize| {
            let copy = move |b: &ShownBallot| b.with_participant(b.participant() + 18 * times);
            ballots.iter().rev().map(copy).collect::<Vec<_>>()
        };
        let tripled = Participants::of(3, &[again(2), again(0), again(1)].concat());
        assert_eq!(tripled.kinds(), participants.kinds());
        assert_eq!(tripled.counts, participants.counts.iter().map(|n| 3 * n).collect::<Vec<_>>());
        let one = Participants::of(3, &ballots[..1]);
        assert_eq!(one.of_kind(0), Pairs::of(3, &ballots[..1]));
    }

    #[test]
    fn controls_say_nothing_about_worths() {
        let ballot = |left, right| ShownBallot::new(3, 0, [left, right], Outcome::Left);
        assert_eq!(Participants::of(2, &[ballot(1, 1)]).number(), 0);
        assert_eq!(Participants::of(2, &[ballot(1, 1), ballot(1, 0)]).counts, [1]);
    }
}
