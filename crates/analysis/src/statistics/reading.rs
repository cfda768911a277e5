//! One order of sides for each question, where participants saw it in different ones.

use super::ballot::{Ballot, Outcome};
use std::collections::BTreeMap;

/// For each question the item that stood on the left most often; of two that did equally often, the lower one. Read like
/// this, answers speak of items, not of sides.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Reading {
    first: Vec<usize>,
}

impl Reading {
    pub(crate) fn of(ballots: &[Ballot]) -> Self {
        let questions = ballots.iter().map(|b| b.question() + 1).max().unwrap_or(0);
        // Few questions are shown in more than two orders of sides.
        let mut shown: Vec<BTreeMap<usize, u64>> = vec![BTreeMap::new(); questions];
        ballots.iter().for_each(|b| *shown[b.question()].entry(b.left()).or_default() += 1);
        let most = |lefts: BTreeMap<usize, u64>| {
            let of = lefts.into_iter().max_by_key(|&(item, n)| (n, std::cmp::Reverse(item)));
            of.map_or(0, |(item, _)| item)
        };
        Self { first: shown.into_iter().map(most).collect() }
    }

    /// How many questions, unanswered ones included.
    pub(crate) fn questions(&self) -> usize {
        self.first.len()
    }

    /// Whether a ballot shows its question's first item on the left.
    pub(crate) fn first_is_left(&self, ballot: &Ballot) -> bool {
        self.first[ballot.question()] == ballot.left()
    }

    /// The outcome with the question's first item on the left.
    pub(crate) fn outcome(&self, ballot: &Ballot) -> Outcome {
        if self.first_is_left(ballot) { ballot.outcome() } else { ballot.outcome().swapped() }
    }
}
