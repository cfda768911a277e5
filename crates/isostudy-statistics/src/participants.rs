//! Participants of a group of items, those who answered alike counted together.
//!
//! Models see of a participant only how often each pair came out how. Among a hundred thousand people few such patterns
//! are distinct, so what has to be done for everyone (gradients, resamples, leaving one out) is done for each pattern.

use super::ballot::{Outcome, ShownBallot};
use super::pairs::{Pair, Pairs};
use rayon::prelude::*;
use std::cmp::Ordering;

/// The distinct patterns of answers, and how many participants have each.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Participants {
    items: usize,
    /// The ordered pairs that anyone was shown, ascending.
    shown: Vec<(usize, usize)>,
    /// Pattern after pattern, the pairs that were answered. Of a thousand items, a person answers few of a million pairs.
    answered: Vec<AnsweredPair>,
    /// By pattern, where it ends in `answered`.
    ends: Vec<usize>,
    /// How many participants have each pattern; never 0.
    pub counts: Vec<u64>,
}

/// One person's answers to a pair that was shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct AnsweredPair {
    /// The place of the pair among those shown.
    place: u32,
    /// Answers `[left, tie, right]`; not all 0.
    pub(super) answers: [u32; 3],
}

impl AnsweredPair {
    /// The place of the pair among those shown.
    pub(super) fn place(&self) -> usize {
        self.place as usize
    }
}

/// The order of patterns as if each had the answers to every pair shown: to a pair that one of them leaves out, the other has more.
fn by_every_pair(a: &[AnsweredPair], b: &[AnsweredPair]) -> Ordering {
    let differing = a.iter().zip(b).find(|(a, b)| a != b);
    match differing {
        Some((a, b)) => b.place.cmp(&a.place).then(a.answers.cmp(&b.answers)),
        None => a.len().cmp(&b.len()),
    }
}

/// A table of all pairs of so many items takes 4 MiB. It saves sorting as many pairs as there are ballots.
const FEW_ITEMS: usize = 1024;

/// The ordered pairs that were shown, ascending; and of few items the place of each pair among them.
fn shown(items: usize, ballots: &[&ShownBallot]) -> (Vec<(usize, usize)>, Option<Vec<u32>>) {
    let pairs = ballots.iter().map(|b| (b.left(), b.right()));
    if items > FEW_ITEMS {
        let mut shown: Vec<(usize, usize)> = pairs.collect();
        shown.sort_unstable();
        shown.dedup();
        shown.shrink_to_fit();
        return (shown, None);
    }
    let mut is_shown = vec![false; items * items];
    pairs.for_each(|(left, right)| is_shown[left * items + right] = true);
    let (mut shown, mut places) = (Vec::new(), vec![0; items * items]);
    for at in (0..is_shown.len()).filter(|&at| is_shown[at]) {
        places[at] = shown.len() as u32;
        shown.push((at / items, at % items));
    }
    (shown, Some(places))
}

impl Participants {
    /// Everyone with a ballot about two different items. The order of ballots does not matter.
    pub fn of(items: usize, ballots: &[ShownBallot]) -> Self {
        let useful = |b: &&ShownBallot| b.left() != b.right();
        let mut own: Vec<&ShownBallot> = ballots.iter().filter(useful).collect();
        // Files have one participant after the other: then there is nothing to sort.
        own.sort_by_key(|b| b.participant());
        let (shown, places) = shown(items, &own);
        let place = |b: &ShownBallot| match &places {
            Some(places) => places[b.left() * items + b.right()] as usize,
            None => shown.binary_search(&(b.left(), b.right())).expect("it was shown"),
        };
        let (mut all, mut everybody) = (Vec::with_capacity(own.len()), Vec::new());
        let mut of_one: Vec<(u32, Outcome)> = Vec::new();
        for person in own.chunk_by(|a, b| a.participant() == b.participant()) {
            of_one.clear();
            of_one.extend(person.iter().map(|b| (place(b) as u32, b.outcome())));
            of_one.sort_unstable();
            let start = all.len();
            for of_pair in of_one.chunk_by(|a, b| a.0 == b.0) {
                let mut answers = [0; 3];
                of_pair.iter().for_each(|(_, outcome)| answers[outcome.index()] += 1);
                all.push(AnsweredPair { place: of_pair[0].0, answers });
            }
            everybody.push(start..all.len());
        }
        drop(own);
        everybody.par_sort_unstable_by(|a, b| by_every_pair(&all[a.clone()], &all[b.clone()]));
        let (mut answered, mut ends, mut counts) = (Vec::new(), Vec::new(), Vec::new());
        for alike in everybody.chunk_by(|a, b| all[a.clone()] == all[b.clone()]) {
            answered.extend_from_slice(&all[alike[0].clone()]);
            ends.push(answered.len());
            counts.push(alike.len() as u64);
        }
        Self { items, shown, answered, ends, counts }
    }

    /// How many participants.
    pub fn number(&self) -> u64 {
        self.counts.iter().sum()
    }

    /// How many participants have a pattern of answers that nobody else has, or share: distinct patterns.
    pub fn kinds(&self) -> usize {
        self.ends.len()
    }

    /// How many items there are, those that nobody was shown included.
    pub fn items(&self) -> usize {
        self.items
    }

    /// The ordered pairs that anyone was shown, ascending.
    pub(super) fn shown(&self) -> &[(usize, usize)] {
        &self.shown
    }

    /// Every kind: the pairs that it answered, ascending by place, and how many participants there are of it.
    pub(super) fn of_kinds(&self) -> impl Iterator<Item = (&[AnsweredPair], u64)> {
        (0..self.kinds()).map(|kind| (self.kind(kind), self.counts[kind]))
    }

    fn kind(&self, kind: usize) -> &[AnsweredPair] {
        let start = kind.checked_sub(1).map_or(0, |before| self.ends[before]);
        &self.answered[start..self.ends[kind]]
    }

    /// The answers of one participant of a kind.
    ///
    /// # Panics
    /// If there is no such kind.
    pub fn of_kind(&self, kind: usize) -> Pairs {
        let pair = |of: &AnsweredPair| {
            let (left, right) = self.shown[of.place()];
            Pair { left, right, answers: of.answers.map(f64::from) }
        };
        Pairs { items: self.items, pairs: self.kind(kind).iter().map(pair).collect() }
    }

    /// The answers of so many participants of each kind.
    pub fn sum(&self, weights: &[u64]) -> Pairs {
        let mut sums = vec![[0_u64; 3]; self.shown.len()];
        for ((pattern, _), &weight) in self.of_kinds().zip(weights).filter(|(_, weight)| **weight > 0) {
            for of in pattern {
                (0..3).for_each(|o| sums[of.place()][o] += weight * u64::from(of.answers[o]));
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
