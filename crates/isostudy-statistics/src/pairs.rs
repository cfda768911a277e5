//! Answers added up by who stood left and who stood right: all that the models need to know.

use super::ballot::{Outcome, ShownBallot};
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet};

/// Answers to one item on the left of another; parts of answers where a penalty was added.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pair {
    /// Item on the left.
    pub left: usize,
    /// Item on the right.
    pub right: usize,
    /// Answers `[left, tie, right]`.
    pub answers: [f64; 3],
}

/// All pairs of a group of items, ordered by left and right item, without repeats.
#[derive(Debug, Clone, PartialEq)]
pub struct Pairs {
    /// How many items.
    pub items: usize,
    /// Pairs with an answer at least.
    pub pairs: Vec<Pair>,
}

impl Pairs {
    /// Adds up answers given as `(left, right, [left, tie, right])`; the same pair may come more than once.
    ///
    /// # Panics
    /// If an item is not below `items`, or is compared with itself.
    pub fn new(items: usize, answers: impl IntoIterator<Item = (usize, usize, [f64; 3])>) -> Self {
        let mut sums: BTreeMap<(usize, usize), [f64; 3]> = BTreeMap::new();
        for (left, right, counts) in answers {
            assert!(left < items && right < items && left != right, "items {left}, {right} of {items}");
            let sum = sums.entry((left, right)).or_default();
            (0..3).for_each(|o| sum[o] += counts[o]);
        }
        let pair = |((left, right), answers)| Pair { left, right, answers };
        Self { items, pairs: sums.into_iter().map(pair).collect() }
    }

    /// Adds up ballots. Controls, which show an item beside itself, say nothing about worths and are left out.
    ///
    /// # Panics
    /// If an item is not below `items`.
    pub fn of<'a>(items: usize, ballots: impl IntoIterator<Item = &'a ShownBallot>) -> Self {
        let mut answers: Vec<(u32, u32, Outcome)> = ballots
            .into_iter()
            .filter(|b| b.left() != b.right())
            .map(|b| (b.left() as u32, b.right() as u32, b.outcome()))
            .collect();
        answers.par_sort_unstable();
        let alike = answers.chunk_by(|a, b| a == b).map(|alike| {
            let (left, right, outcome) = alike[0];
            let mut counts = [0.0; 3];
            counts[outcome.index()] = alike.len() as f64;
            (left as usize, right as usize, counts)
        });
        Self::new(items, alike)
    }

    /// Half a win each way on every compared pair, shared by its two orders if both were shown: the stated penalty that
    /// keeps separated estimates finite. Pulls every worth towards its neighbours'.
    pub fn with_half_wins(&self) -> Self {
        let orders: BTreeSet<(usize, usize)> = self.pairs.iter().map(|p| (p.left, p.right)).collect();
        let mut penalised = self.clone();
        for pair in &mut penalised.pairs {
            let part = if orders.contains(&(pair.right, pair.left)) { 0.25 } else { 0.5 };
            pair.answers[0] += part;
            pair.answers[2] += part;
        }
        penalised
    }

    /// Every tie as half a win for each.
    pub(super) fn with_ties_split(&self) -> Self {
        let mut split = self.clone();
        for pair in &mut split.pairs {
            let [left, tie, right] = pair.answers;
            pair.answers = [left + 0.5 * tie, 0.0, right + 0.5 * tie];
        }
        split
    }

    /// Sum of the ties.
    pub fn ties(&self) -> f64 {
        self.pairs.iter().map(|pair| pair.answers[1]).sum()
    }

    /// Sum of all answers.
    pub fn answers(&self) -> f64 {
        self.pairs.iter().flat_map(|pair| pair.answers).sum()
    }
}
