//! Which comparisons a participant is asked where a form cannot hold them all.
//!
//! A person's answers hang together, so hypotheses are tested within people: what is asked of different people tells nothing
//! about it. Blocks should therefore differ in nothing that a hypothesis is about. Dealing a sorted list does not see to that:
//! where the number of blocks divides the number of a group's pairs, every block gets the same pairs on every object.

use crate::contrast::{Family, contrasts};
use crate::study::{Comparison, Study};
use rand::seq::SliceRandom;
use rand_pcg::Pcg64;
use std::collections::BTreeMap;

/// What counts, the most important first. Sizes of blocks, which come before, are kept by exchanging two comparisons.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Aim {
    /// Each pair of methods as often in each block.
    Pairs,
    /// No interaction of which no block has both parts.
    Interactions,
    /// No two objects between which no block shows a difference.
    ObjectPairs,
    /// What speaks for one level, over all and on each object, as often in each block.
    Levels,
    /// Each group as often in each block.
    Groups,
    /// Both parts of differences in as many blocks as can be.
    Differences,
    /// All pairs of three methods on one object in one block, for a person who prefers in a circle.
    Triads,
    /// A group's comparisons on one object in one block: the way there.
    Together,
    /// Each object as often in each block.
    Objects,
}

const AIMS: usize = Aim::Objects as usize + 1;

/// How far each aim is missed, compared aim by aim.
type Missed = [i64; AIMS];

/// Comparisons that an aim is about together.
type Part = Vec<usize>;

/// One thing to be judged, from how many of its parts' comparisons are in each block.
enum Term {
    /// The sum of squares should be small.
    Even(Aim, Part),
    /// The sum of squares should be large.
    Gather(Part),
    /// All should be in one block.
    Whole(Part),
    /// Blocks should have some of both parts: one at least, and then as many as can be.
    Both(Aim, Part, Part),
}

/// Orders that are dealt and improved: steps by group, steps by pair of a group, and at random.
const GROUP_STEPS: usize = 6;
const PAIR_STEPS: usize = 2;
const SHUFFLES: usize = 16;
/// Additions after which the search ends: a fraction of a second.
const BUDGET: usize = 40_000_000;

/// The comparisons of `count` blocks, ascending.
///
/// Sizes of blocks differ by at most one, and so does the number of each pair of methods in one block and another: a list sorted
/// by group and pair is dealt in turn, and exchanges never undo that. The rest is searched for, aim by aim.
pub(super) fn split(study: &Study, count: usize, random: &mut Pcg64) -> Vec<Vec<usize>> {
    let mut search = Search::of(study, count);
    let mut best: Option<(Missed, Vec<usize>)> = None;
    let mut starts: Vec<(Missed, Vec<usize>)> =
        orders(study, random).iter().map(|order| search.start(dealt(order, count))).collect();
    starts.sort();
    starts.dedup();
    let mut budget = BUDGET;
    for (_, blocks) in starts {
        let found = search.improve(blocks, &mut budget);
        if best.as_ref().is_none_or(|best| found < *best) {
            best = Some(found);
        }
    }
    let (_, block_of) = best.expect("some order was dealt");
    let mut blocks = vec![Vec::new(); count];
    block_of.iter().enumerate().for_each(|(comparison, &block)| blocks[block].push(comparison));
    blocks
}

fn dealt(order: &[usize], count: usize) -> Vec<usize> {
    let mut block_of = vec![0; order.len()];
    order.iter().enumerate().for_each(|(place, &comparison)| block_of[comparison] = place % count);
    block_of
}

/// Comparisons sorted by group and pair of methods; those of a pair begin with an object further on from group to group or
/// from pair to pair, or are shuffled.
fn orders(study: &Study, random: &mut Pcg64) -> Vec<Vec<usize>> {
    let mut groups: Vec<Vec<Part>> = Vec::new();
    for group in by(study, |c| c.group) {
        let mut pairs: BTreeMap<(usize, usize), Part> = BTreeMap::new();
        group.iter().for_each(|&i| pairs.entry(pair(study, &study.comparisons[i])).or_default().push(i));
        groups.push(pairs.into_values().collect());
    }
    groups.iter_mut().flatten().for_each(|own| own.sort_by_key(|&i| study.comparisons[i].object));
    let mut orders = Vec::new();
    for (by_group, by_pair) in (0..PAIR_STEPS).flat_map(|p| (0..GROUP_STEPS).map(move |g| (g, p))) {
        let mut order = Vec::new();
        for (g, pairs) in groups.iter().enumerate() {
            for (p, own) in pairs.iter().enumerate() {
                let step = (g * by_group + p * by_pair) % own.len();
                order.extend(own[step..].iter().chain(&own[..step]));
            }
        }
        orders.push(order);
    }
    for _ in 0..SHUFFLES {
        groups.shuffle(random);
        groups.iter_mut().for_each(|pairs| pairs.shuffle(random));
        groups.iter_mut().flatten().for_each(|own| own.shuffle(random));
        orders.push(groups.iter().flatten().flatten().copied().collect());
    }
    orders
}

/// The places of the two methods, the lower first.
fn pair(study: &Study, Comparison { left, right, .. }: &Comparison) -> (usize, usize) {
    let (left, right) = (study.place(left.method), study.place(right.method));
    (left.min(right), left.max(right))
}

/// The comparisons with each value of a label, in the order of values.
fn by<T: Ord>(study: &Study, label: impl Fn(&Comparison) -> T) -> Vec<Part> {
    let mut parts: BTreeMap<T, Part> = BTreeMap::new();
    for (i, comparison) in study.comparisons.iter().enumerate() {
        parts.entry(label(comparison)).or_default().push(i);
    }
    parts.into_values().collect()
}

/// Everything that is judged.
fn terms(study: &Study) -> Vec<Term> {
    let mut terms = Vec::new();
    terms.extend(by(study, |c| pair(study, c)).into_iter().map(|part| Term::Even(Aim::Pairs, part)));
    terms.extend(by(study, |c| c.group).into_iter().map(|part| Term::Even(Aim::Groups, part)));
    terms.extend(by(study, |c| c.object).into_iter().map(|part| Term::Even(Aim::Objects, part)));
    for contrast in contrasts(study) {
        let mut parts = contrast.parts.iter().map(|part| part.keys().copied().collect::<Part>());
        match (parts.next(), parts.next()) {
            (Some(first), Some(second)) => {
                let aim = if contrast.family == Family::Interactions {
                    Aim::Interactions
                } else {
                    Aim::ObjectPairs
                };
                terms.push(Term::Both(aim, first, second));
            }
            (Some(only), None) => terms.push(Term::Even(Aim::Levels, only)),
            _ => {}
        }
    }
    for tournament in by(study, |c| (c.group, c.object)) {
        let triads = triads(study, &tournament);
        if !triads.is_empty() {
            terms.push(Term::Gather(tournament));
        }
        terms.extend(triads.into_iter().map(Term::Whole));
    }
    terms
}

/// Of comparisons of one object, every three that are all pairs of three methods.
fn triads(study: &Study, own: &[usize]) -> Vec<Part> {
    let mut found = Vec::new();
    for (i, &first) in own.iter().enumerate() {
        let (a, b) = pair(study, &study.comparisons[first]);
        for (j, &second) in own.iter().enumerate().skip(i + 1) {
            let (c, d) = pair(study, &study.comparisons[second]);
            // The methods in which the two differ are the third's.
            let third = match [a == c, a == d, b == c, b == d] {
                [true, false, false, false] => (b.min(d), b.max(d)),
                [false, true, false, false] => (b.min(c), b.max(c)),
                [false, false, true, false] => (a.min(d), a.max(d)),
                [false, false, false, true] => (a.min(c), a.max(c)),
                _ => continue,
            };
            let thirds = own[j + 1..].iter().filter(|&&i| pair(study, &study.comparisons[i]) == third);
            found.extend(thirds.map(|&third| vec![first, second, third]));
        }
    }
    found
}

struct Search {
    count: usize,
    terms: Vec<Term>,
    /// For each comparison the terms that it is in.
    of: Vec<Vec<usize>>,
    /// For each term, for its first and its second part, how many comparisons are in each block.
    counts: Vec<[Vec<i64>; 2]>,
    block_of: Vec<usize>,
}

impl Search {
    fn of(study: &Study, count: usize) -> Self {
        let terms = terms(study);
        let mut of = vec![Vec::new(); study.comparisons.len()];
        for (t, term) in terms.iter().enumerate() {
            term.parts().into_iter().flatten().for_each(|&comparison| of[comparison].push(t));
        }
        Self { count, terms, of, counts: Vec::new(), block_of: Vec::new() }
    }

    fn start(&mut self, block_of: Vec<usize>) -> (Missed, Vec<usize>) {
        self.counts = self
            .terms
            .iter()
            .map(|term| {
                term.parts().map(|part| {
                    let mut counts = vec![0; self.count];
                    part.iter().for_each(|&comparison| counts[block_of[comparison]] += 1);
                    counts
                })
            })
            .collect();
        self.block_of = block_of;
        let mut missed = [0; AIMS];
        (0..self.terms.len()).for_each(|term| self.judge(term, &mut missed));
        (missed, self.block_of.clone())
    }

    /// Exchanges two comparisons as long as that helps and the budget lasts.
    fn improve(&mut self, block_of: Vec<usize>, budget: &mut usize) -> (Missed, Vec<usize>) {
        let (mut missed, _) = self.start(block_of);
        let mut improved = true;
        while improved {
            improved = false;
            for i in 0..self.of.len() {
                for j in 0..i {
                    let concerned = self.of[i].len() + self.of[j].len();
                    if self.block_of[i] == self.block_of[j] {
                        continue;
                    }
                    let Some(left) = budget.checked_sub(2 * concerned * self.count) else {
                        return (missed, self.block_of.clone());
                    };
                    *budget = left;
                    let before = self.concerned(i, j);
                    self.exchange(i, j);
                    let after = self.concerned(i, j);
                    if after < before {
                        (0..AIMS).for_each(|aim| missed[aim] += after[aim] - before[aim]);
                        improved = true;
                    } else {
                        self.exchange(i, j);
                    }
                }
            }
        }
        (missed, self.block_of.clone())
    }

    /// What is missed of everything that either comparison is in.
    fn concerned(&self, i: usize, j: usize) -> Missed {
        let mut missed = [0; AIMS];
        self.of[i].iter().for_each(|&term| self.judge(term, &mut missed));
        let others = self.of[j].iter().filter(|term| self.of[i].binary_search(term).is_err());
        others.for_each(|&term| self.judge(term, &mut missed));
        missed
    }

    fn exchange(&mut self, i: usize, j: usize) {
        let (from, to) = (self.block_of[i], self.block_of[j]);
        for (comparison, from, to) in [(i, from, to), (j, to, from)] {
            for &term in &self.of[comparison] {
                let second = usize::from(!self.terms[term].parts()[0].contains(&comparison));
                self.counts[term][second][from] -= 1;
                self.counts[term][second][to] += 1;
            }
            self.block_of[comparison] = to;
        }
    }

    fn judge(&self, term: usize, missed: &mut Missed) {
        let [first, second] = &self.counts[term];
        let squares = || first.iter().map(|n| n * n).sum::<i64>();
        match &self.terms[term] {
            Term::Even(aim, _) => missed[*aim as usize] += squares(),
            Term::Gather(_) => missed[Aim::Together as usize] -= squares(),
            Term::Whole(part) => {
                let whole = first.contains(&(part.len() as i64));
                missed[Aim::Triads as usize] += i64::from(!whole);
            }
            Term::Both(aim, ..) => {
                let both = first.iter().zip(second).filter(|(a, b)| **a > 0 && **b > 0).count();
                missed[*aim as usize] += i64::from(both == 0);
                missed[Aim::Differences as usize] += ((self.count - both) as i64).pow(2);
            }
        }
    }
}

impl Term {
    fn parts(&self) -> [&[usize]; 2] {
        match self {
            Self::Even(_, part) | Self::Gather(part) | Self::Whole(part) => [part, &[]],
            Self::Both(_, first, second) => [first, second],
        }
    }
}

#[cfg(test)]
mod tests;
