//! The same two items in the same scene, seen in either order of sides.

use statistics::ShownBallot;
use std::collections::BTreeMap;

/// Answers to one stimulus in one order of sides, for its lower item: 1 chosen, 0 tie, -1 the other chosen.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Answers {
    pub(super) n: f64,
    sum: f64,
    squares: f64,
}

impl Answers {
    pub(super) fn mean(&self) -> f64 {
        self.sum / self.n
    }

    /// Variance of the mean, with two answers' worth of doubt added, so that unanimity is not certainty.
    pub(super) fn variance_of_mean(&self) -> f64 {
        (self.squares - self.sum * self.sum / self.n + 2.0) / (self.n * self.n)
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

impl Stimulus {
    /// Mean for the lower item on the left less that on the right: twice the pull of the left side.
    pub(super) fn pull(&self) -> f64 {
        self.orders[0].mean() - self.orders[1].mean()
    }

    pub(super) fn variance_of_pull(&self) -> f64 {
        self.orders[0].variance_of_mean() + self.orders[1].variance_of_mean()
    }
}

/// Every stimulus that was answered; controls are none.
pub(super) struct Stimuli {
    places: BTreeMap<(usize, usize, usize), usize>,
    pub(super) all: Vec<Stimulus>,
}

impl Stimuli {
    pub(super) fn of(ballots: &[ShownBallot], scenes: &[usize]) -> Self {
        let mut stimuli = Self { places: BTreeMap::new(), all: Vec::new() };
        for ballot in ballots.iter().filter(|b| b.left() != b.right()) {
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
            let x = for_lower(ballot);
            answers.n += 1.0;
            answers.sum += x;
            answers.squares += x * x;
        }
        stimuli
    }

    /// Which stimulus a ballot is about, by index; `None` for a control.
    pub(super) fn place(&self, ballot: &ShownBallot, scenes: &[usize]) -> Option<usize> {
        self.places.get(&key(ballot, scenes)).copied()
    }

    /// Those seen in both orders, at least so often in each.
    pub(super) fn in_both_orders(&self, least: f64) -> impl Iterator<Item = (usize, &Stimulus)> {
        self.all.iter().enumerate().filter(move |(_, s)| s.orders.iter().all(|order| order.n >= least))
    }
}

fn key(ballot: &ShownBallot, scenes: &[usize]) -> (usize, usize, usize) {
    (scenes[ballot.question()], ballot.left().min(ballot.right()), ballot.left().max(ballot.right()))
}

/// 1 if the lower item was chosen, -1 if the other.
pub(super) fn for_lower(ballot: &ShownBallot) -> f64 {
    let sign = ballot.outcome().sign() as f64;
    if ballot.left() < ballot.right() { sign } else { -sign }
}
