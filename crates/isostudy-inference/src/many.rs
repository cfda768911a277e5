//! Many answers over many items: what can be said of them in one pass over the answers, and in one over the people.
//!
//! Factors, models of worths with intervals clustered on people, and a test of every pair of items. Each of these is the number that
//! [`Preferences`](crate::Preferences) has for the same answers. What costs more than a pass is left out: resampling, leaving
//! people out, probes, screening, and tests object by object.

use crate::ballots::BallotGroup;
use crate::fraction::Fraction;
use crate::hypotheses::Rules;
use crate::models::{self, GroupModel};
use isostudy_responses::Responses;
use isostudy_statistics::interval::Interval;
use isostudy_statistics::{Outcome, ScoreTest, holm};
use rayon::prelude::*;
use std::collections::BTreeMap;

/// More answers than this are many.
pub const MANY_ANSWERS: usize = 1_000_000;
/// More items than this in one group are many.
pub const MANY_ITEMS: usize = 100;

/// Whether there are more answers or items than everything is computed for. `groups` are those of the answers.
pub fn is_many(responses: &Responses, groups: &[BallotGroup]) -> bool {
    responses.answers.len() > MANY_ANSWERS || groups.iter().any(|group| group.items.len() > MANY_ITEMS)
}

/// What many answers say.
pub struct Many<'a> {
    /// The items that are compared with one another, and the answers about them.
    pub groups: &'a [BallotGroup],
    /// How many people gave answers that count.
    pub people: usize,
    /// How many answers count: those to controls and repeats do not.
    pub answers: usize,
    /// Every item of every group.
    pub factors: Vec<ItemFactor>,
    /// Every model of every group.
    pub models: Vec<GroupModel<'a>>,
    /// Every pair of items that was compared, group by group.
    pub tests: Vec<PairTest>,
}

/// How often an item of a group was chosen.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ItemFactor {
    /// Index of the group.
    pub group: usize,
    /// Index of the item in the group.
    pub item: usize,
    /// Answers for the item, without preference and for the other item, of those that showed it.
    pub counts: [u64; 3],
    /// All answers of the group.
    pub answers: u64,
}

impl ItemFactor {
    /// The preference factor: its wins among all answers of the group.
    pub fn factor(&self) -> Fraction {
        Fraction::new(self.counts[0].into(), self.answers.into())
    }

    /// Its wins among the answers that showed it.
    pub fn appearance_share(&self) -> Fraction {
        Fraction::new(self.counts[0].into(), self.appearances().into())
    }

    /// The answers that showed it.
    pub fn appearances(&self) -> u64 {
        self.counts.iter().sum()
    }
}

/// The test that people lean to neither of two items.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PairTest {
    /// Index of the group.
    pub group: usize,
    /// Indices of the items in the group, the lower one first.
    pub items: [usize; 2],
    /// Answers for the first, for neither, for the second.
    pub counts: [u64; 3],
    /// How many people gave them.
    pub people: u64,
    /// Exact two-sided p of people's scores.
    pub p: f64,
    /// That p by Holm over the pairs of the group.
    pub adjusted: f64,
    /// Mean of people's scores.
    pub mean: f64,
    /// Its t interval over people.
    pub interval: Option<Interval>,
    /// p of the test that the mean lies within the margin, by Holm over the pairs of the group.
    pub equivalence: Option<f64>,
}

impl<'a> Many<'a> {
    /// Computes everything once. Without `sides_recorded` there is no model with a side.
    pub fn of(groups: &'a [BallotGroup], sides_recorded: bool) -> Self {
        let answers = groups.iter().map(|group| group.ballots.len()).sum();
        let tests = || groups.iter().enumerate().flat_map(|(g, group)| pair_tests(g, group)).collect();
        let (tests, models) = rayon::join(tests, || models::of_groups(groups, sides_recorded));
        Self { groups, people: people(groups), answers, factors: factors(groups), models, tests }
    }
}

/// How many people answered.
fn people(groups: &[BallotGroup]) -> usize {
    let mut seen: Vec<bool> = Vec::new();
    for ballot in groups.iter().flat_map(|group| &group.ballots) {
        if ballot.participant() >= seen.len() {
            seen.resize(ballot.participant() + 1, false);
        }
        seen[ballot.participant()] = true;
    }
    seen.into_iter().filter(|seen| *seen).count()
}

/// Every item of every group, in their order.
fn factors(groups: &[BallotGroup]) -> Vec<ItemFactor> {
    let of_group = |(g, group): (usize, &BallotGroup)| {
        let answers = group.ballots.len() as u64;
        let of_item = |item| ItemFactor { group: g, item, counts: [0; 3], answers };
        let mut items: Vec<ItemFactor> = (0..group.items.len()).map(of_item).collect();
        for ballot in &group.ballots {
            items[ballot.left()].counts[ballot.outcome().index()] += 1;
            items[ballot.right()].counts[ballot.outcome().swapped().index()] += 1;
        }
        items
    };
    groups.iter().enumerate().flat_map(of_group).collect()
}

/// How many people gave so many answers about a pair, with so many more for the first than for the second.
type Scores = Vec<((i64, i64), u64)>;

/// The numbers that people's scores give, whichever pair they are about.
#[derive(Clone, Copy)]
struct Tested {
    p: f64,
    mean: f64,
    interval: Option<Interval>,
    equivalence: Option<f64>,
}

/// The test of every pair of a group that somebody compared.
fn pair_tests(g: usize, group: &BallotGroup) -> Vec<PairTest> {
    let answer = |ballot: &isostudy_statistics::ShownBallot| {
        let (left, right) = (ballot.left() as u32, ballot.right() as u32);
        let person = ballot.participant() as u32;
        match left < right {
            true => (left, right, person, ballot.outcome()),
            false => (right, left, person, ballot.outcome().swapped()),
        }
    };
    let mut answers: Vec<(u32, u32, u32, Outcome)> = group.ballots.iter().map(answer).collect();
    answers.par_sort_unstable();
    let pairs: Vec<&[(u32, u32, u32, Outcome)]> =
        answers.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)).filter(|of| of[0].0 != of[0].1).collect();
    // Of a million pairs few have scores that no other has.
    let scores: Vec<Scores> = pairs.par_iter().map(|answers| scores(answers)).collect();
    let mut different: Vec<&Scores> = scores.iter().collect();
    different.par_sort_unstable();
    different.dedup();
    let tested: Vec<Tested> = different.par_iter().map(|scores| tested(scores)).collect();
    let test = |(answers, scores): (&&[(u32, u32, u32, Outcome)], &Scores)| {
        let of = tested[different.binary_search(&scores).expect("collected above")];
        let mut counts = [0; 3];
        answers.iter().for_each(|(.., outcome)| counts[outcome.index()] += 1);
        PairTest {
            group: g,
            items: [answers[0].0 as usize, answers[0].1 as usize],
            counts,
            people: scores.iter().map(|(_, people)| people).sum(),
            p: of.p,
            adjusted: of.p,
            mean: of.mean,
            interval: of.interval,
            equivalence: of.equivalence,
        }
    };
    let mut tests: Vec<PairTest> = pairs.iter().zip(&scores).map(test).collect();
    let adjusted = holm(&tests.iter().map(|test| test.p).collect::<Vec<_>>());
    let mut equal = holm(&tests.iter().filter_map(|test| test.equivalence).collect::<Vec<_>>()).into_iter();
    for (test, adjusted) in tests.iter_mut().zip(adjusted) {
        test.adjusted = adjusted;
        test.equivalence = test.equivalence.and_then(|_| equal.next());
    }
    tests
}

/// The scores of a pair's answers, which are ordered by person.
fn scores(answers: &[(u32, u32, u32, Outcome)]) -> Scores {
    let mut scores: BTreeMap<(i64, i64), u64> = BTreeMap::new();
    for person in answers.chunk_by(|a, b| a.2 == b.2) {
        let net = person.iter().map(|(.., outcome)| outcome.sign()).sum();
        *scores.entry((net, person.len() as i64)).or_default() += 1;
    }
    scores.into_iter().collect()
}

fn tested(scores: &Scores) -> Tested {
    let people = scores.iter().flat_map(|&(score, people)| std::iter::repeat_n(score, people as usize));
    // As many answers with the same sum: a score is their mean.
    let answers = people.enumerate().flat_map(|(person, (net, answers))| {
        let sign = move |place: i64| if place < net.abs() { net.signum() } else { 0 };
        (0..answers).map(move |place| (person, sign(place)))
    });
    let test = ScoreTest::of(answers);
    Tested {
        p: test.sign_flip.p(),
        mean: test.mean,
        interval: test.interval.map(|interval| interval.cut(-test.reach, test.reach)),
        equivalence: test.equivalence(Rules::default().margin).map(|of| of.p),
    }
}

#[cfg(test)]
mod tests;
