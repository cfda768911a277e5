//! The same two items in the same scene, seen in either order of sides.

use isostudy_statistics::ShownBallot;
use std::collections::{BTreeMap, BTreeSet};

/// Answers to one stimulus in one order of sides.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) struct Answers {
    /// For the lower item.
    pub(super) chosen: u64,
    /// For neither.
    ties: u64,
    /// For the other item.
    pub(super) other: u64,
}

impl Answers {
    pub(super) fn n(&self) -> u64 {
        self.chosen + self.ties + self.other
    }

    /// 1 where all chose the lower item, -1 where all chose the other.
    pub(super) fn mean(&self) -> f64 {
        (self.chosen as f64 - self.other as f64) / self.n() as f64
    }
}

/// One pair of items in one scene.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Stimulus {
    /// The questions that show it.
    pub(super) questions: Vec<usize>,
    /// With the lower item on the left, and on the right.
    pub(super) orders: [Answers; 2],
}

/// Every stimulus that was answered; controls are none.
pub(super) struct Stimuli {
    places: BTreeMap<(usize, usize, usize), usize>,
    pub(super) all: Vec<Stimulus>,
}

impl Stimuli {
    /// The answers to all questions but those that are `left_out`.
    pub(super) fn of(ballots: &[ShownBallot], scenes: &[usize], left_out: &BTreeSet<usize>) -> Self {
        let mut stimuli = Self { places: BTreeMap::new(), all: Vec::new() };
        let compares = |b: &&ShownBallot| b.left() != b.right() && !left_out.contains(&b.question());
        for ballot in ballots.iter().filter(compares) {
            let next = stimuli.all.len();
            let place = *stimuli.places.entry(key(ballot, scenes)).or_insert(next);
            if place == next {
                stimuli.all.push(Stimulus { questions: Vec::new(), orders: [Answers::default(); 2] });
            }
            let stimulus = &mut stimuli.all[place];
            if !stimulus.questions.contains(&ballot.question()) {
                stimulus.questions.push(ballot.question());
            }
            let answers = &mut stimulus.orders[usize::from(ballot.left() > ballot.right())];
            match for_lower(ballot) {
                1 => answers.chosen += 1,
                0 => answers.ties += 1,
                _ => answers.other += 1,
            }
        }
        stimuli
    }

    /// Which stimulus a ballot is about, by index; `None` for a control.
    pub(super) fn place(&self, ballot: &ShownBallot, scenes: &[usize]) -> Option<usize> {
        self.places.get(&key(ballot, scenes)).copied()
    }

    /// Those seen in both orders.
    pub(super) fn in_both_orders(&self) -> impl Iterator<Item = (usize, &Stimulus)> {
        self.all.iter().enumerate().filter(|(_, s)| s.orders.iter().all(|order| order.n() > 0))
    }

    /// How many pairs of items were seen in both orders, but each order on an object of its own.
    pub(super) fn apart(&self) -> usize {
        let mut pairs: BTreeMap<(usize, usize), ([bool; 2], bool)> = BTreeMap::new();
        for (&(_, lower, higher), &place) in &self.places {
            let own = self.all[place].orders.map(|order| order.n() > 0);
            let (seen, together) = pairs.entry((lower, higher)).or_default();
            *together |= own == [true; 2];
            *seen = [seen[0] || own[0], seen[1] || own[1]];
        }
        pairs.values().filter(|(seen, together)| *seen == [true; 2] && !together).count()
    }
}

fn key(ballot: &ShownBallot, scenes: &[usize]) -> (usize, usize, usize) {
    (scenes[ballot.question()], ballot.left().min(ballot.right()), ballot.left().max(ballot.right()))
}

/// 1 if the lower item was chosen, 0 if none, -1 if the other.
pub(super) fn for_lower(ballot: &ShownBallot) -> i64 {
    let sign = ballot.outcome().sign();
    if ballot.left() < ballot.right() { sign } else { -sign }
}
