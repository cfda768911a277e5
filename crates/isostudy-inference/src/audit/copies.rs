//! Did somebody's answers get in twice?
//!
//! Two rows may be the same by chance, the more easily the more people agree. How much any two rows have in common tells
//! how often that is to be expected. Who saw the questions in different orders can hardly be copies; whose times agree to
//! the millisecond are, whatever the answers ([`times`]).

mod times;

use super::evidence::{Copies, Reason, SameAnswers};
use super::{Evidence, Probe, Report};
use isostudy_statistics::{Circumstances, ShownBallot};
use statrs::distribution::{DiscreteCDF, Poisson};
use std::collections::BTreeMap;
use std::ops::Range;

/// Answers in a row below which sameness says nothing.
const FEWEST_ANSWERS: usize = 10;
/// People who saw the same questions on the same sides below which chance cannot be judged.
const FEWEST_PEOPLE: usize = 5;
/// Up to so many people every pair is looked at to judge chance, beyond it this many for each.
const PARTNERS: usize = 100;
/// Sameness has to exceed this many times what chance makes of the overlaps, which are extrapolated.
const ALLOWANCE: f64 = 3.0;

/// The least p of these, times their number. Of answers, among people who saw the same questions on the same sides and did not
/// press one button throughout:
/// - how many pairs gave the same answers, against the number that chance makes of how much rows overlap, three times
///   over, as Poisson;
/// - how improbable the least probable of these rows is: the number of pairs times the chance that somebody gives that
///   row, three times over, which bounds the chance that any two people give one as improbable. One copy of a row that is
///   nobody's modal one shows here long before it does in the count;
/// - where orders are recorded, the same of those pairs that saw the questions in the same order, who are few.
///
/// And where times are recorded, how improbable it is that two rows have them in common.
///
/// # Panics
/// If there are circumstances, but not one a ballot.
pub(super) fn probe(ballots: &[ShownBallot], circumstances: &[Circumstances]) -> Report {
    let rows = Rows::of(ballots, circumstances);
    let (answers, times) = (Seen::of(&rows), times::look(&rows));
    let mut p = Vec::new();
    p.extend(times.as_ref().map(|times| times.p));
    if answers.judged > 0 {
        p.extend(answers.p());
    }
    let Some(least) = p.iter().copied().reduce(f64::min) else {
        return Report::not_answerable(Probe::CopiedRows, Reason::FewRowsAlike);
    };
    let copies = Copies { times: times.map(|times| times.same), answers: answers.same() };
    Report::tested(Probe::CopiedRows, (p.len() as f64 * least).min(1.0), Evidence::CopiedRows(copies))
}

/// Everybody's answers, participant by participant, each by question.
struct Rows {
    ballots: Vec<ShownBallot>,
    /// One a ballot; none if nothing is known.
    circumstances: Vec<Circumstances>,
    /// Whether every answer's order is known.
    ordered: bool,
    people: Vec<Range<usize>>,
}

impl Rows {
    fn of(ballots: &[ShownBallot], circumstances: &[Circumstances]) -> Self {
        let known = !circumstances.is_empty();
        assert!(!known || circumstances.len() == ballots.len(), "circumstances of another set of ballots");
        let mut places: Vec<u32> = (0..ballots.len() as u32).collect();
        places.sort_unstable_by_key(|&i| (ballots[i as usize], i));
        let sorted: Vec<ShownBallot> = places.iter().map(|&i| ballots[i as usize]).collect();
        let own =
            if known { places.iter().map(|&i| circumstances[i as usize]).collect() } else { Vec::new() };
        let mut people = Vec::new();
        let mut start = 0;
        for of in sorted.chunk_by(|a, b| a.participant() == b.participant()) {
            people.push(start..start + of.len());
            start += of.len();
        }
        let ordered = known && circumstances.iter().all(|of| of.order.is_some());
        Self { ballots: sorted, circumstances: own, ordered, people }
    }

    fn participant(&self, of: &Range<usize>) -> usize {
        self.ballots[of.start].participant()
    }

    /// At which place each question was seen.
    fn order(&self, of: &Range<usize>) -> Vec<Option<u32>> {
        self.circumstances[of.clone()].iter().map(|of| of.order).collect()
    }
}

/// What was seen of the answers of all forms.
#[derive(Debug, Default)]
struct Seen {
    /// People who were compared with others.
    judged: usize,
    /// Pairs of them.
    pairs: f64,
    /// Pairs with the same answers, and how many chance makes.
    same: u64,
    expected: f64,
    /// The chance of the least probable row that was given twice.
    least: Option<f64>,
    /// Pairs that saw the questions in the same order, and the chance of the least probable row that two of them gave; `None`
    /// if orders are not recorded.
    in_order: Option<(f64, Option<f64>)>,
    /// Who gave the same answers.
    copies: Vec<Vec<usize>>,
}

impl Seen {
    fn of(rows: &Rows) -> Self {
        let sorted = &rows.ballots;
        // Who presses one button throughout gives the row of everybody who does, which is no copy of it.
        let varies =
            |of: &Range<usize>| sorted[of.clone()].windows(2).any(|two| two[0].outcome() != two[1].outcome());
        let judged = |of: &&Range<usize>| of.len() >= FEWEST_ANSWERS && varies(of);
        let mut people: Vec<&Range<usize>> = rows.people.iter().filter(judged).collect();
        let form = |of: &Range<usize>| sorted[of.clone()].iter().map(|b| (b.question(), b.left(), b.right()));
        let row = |of: &Range<usize>| sorted[of.clone()].iter().map(|b| b.outcome());
        // Stable: people of one form stay in their order.
        people.sort_by(|a, b| form(a).cmp(form(b)));
        let mut seen = Self { in_order: rows.ordered.then_some((0.0, None)), ..Self::default() };
        for of_form in people.chunk_by(|a, b| form(a).eq(form(b))) {
            if of_form.len() < FEWEST_PEOPLE {
                continue;
            }
            seen.judged += of_form.len();
            let chances = Chances::of(of_form, sorted);
            let own_pairs = pairs(of_form.len());
            seen.pairs += own_pairs;
            seen.expected += own_pairs * chances.of_any_row();
            if let Some((in_order, _)) = &mut seen.in_order {
                *in_order += alike(of_form, |of| rows.order(of)).into_iter().map(pairs).sum::<f64>();
            }
            let mut by_row = of_form.to_vec();
            by_row.sort_by(|a, b| row(a).cmp(row(b)));
            for twins in by_row.chunk_by(|a, b| row(a).eq(row(b))).filter(|twins| twins.len() > 1) {
                let chance = chances.of_row(&sorted[twins[0].clone()], twins.len());
                let least = |known: Option<f64>| Some(known.map_or(chance, |known| known.min(chance)));
                seen.same += pairs(twins.len()) as u64;
                seen.least = least(seen.least);
                if let Some((_, of_order)) = &mut seen.in_order
                    && alike(twins, |of| rows.order(of)).into_iter().any(|people| people > 1)
                {
                    *of_order = least(*of_order);
                }
                seen.copies.push(twins.iter().map(|of| rows.participant(of)).collect());
            }
        }
        seen
    }

    /// One p for each thing that was looked at.
    fn p(&self) -> Vec<f64> {
        let count = match (self.same, self.expected > 0.0) {
            (0, _) => 1.0,
            (same, true) => Poisson::new(ALLOWANCE * self.expected).expect("above zero").sf(same - 1),
            (_, false) => 0.0,
        };
        let of_row =
            |pairs: f64, chance: Option<f64>| chance.map_or(1.0, |of| (ALLOWANCE * pairs * of).min(1.0));
        let mut p = vec![count, of_row(self.pairs, self.least)];
        p.extend(self.in_order.map(|(pairs, chance)| of_row(pairs, chance)));
        p
    }

    /// `None` if nobody was compared.
    fn same(self) -> Option<SameAnswers> {
        let Self { judged: people, same, expected, copies, .. } = self;
        let least_expected = self.pairs * self.least.unwrap_or(1.0);
        (people > 0).then_some(SameAnswers { people, same, expected, least_expected, copies })
    }
}

/// Of so many people.
fn pairs(people: usize) -> f64 {
    0.5 * people as f64 * (people as f64 - 1.0)
}

/// How many people have each key.
fn alike<K: Ord>(of: &[&Range<usize>], key: impl Fn(&Range<usize>) -> K) -> Vec<usize> {
    let mut people: BTreeMap<K, usize> = BTreeMap::new();
    of.iter().for_each(|of| *people.entry(key(of)).or_default() += 1);
    people.into_values().collect()
}

/// How probable rows of one form are: that they are at every question, people taken as independent, and more as far as
/// overlaps of rows vary more than that. With P_q the chance of the same answer at question q and v the variance of
/// overlaps, rho = (v / sum P_q (1 - P_q) - 1) / (n - 1); a chance is that of n successes of a beta-binomial distribution
/// with correlation rho and the geometric mean of the questions' chances.
struct Chances {
    /// By question, how often each answer was given.
    counts: Vec<[u64; 3]>,
    people: u64,
    rho: f64,
}

impl Chances {
    fn of(people: &[&Range<usize>], sorted: &[ShownBallot]) -> Self {
        let n = people[0].len();
        let mut counts = vec![[0_u64; 3]; n];
        for of in people {
            counts.iter_mut().zip(&sorted[(*of).clone()]).for_each(|(c, b)| c[b.outcome().index()] += 1);
        }
        let m = people.len() as u64;
        let independent: f64 = counts.iter().map(|c| same_answer(c, m)).map(|p| p * (1.0 - p)).sum();
        let rho = (variance_of_overlaps(people, sorted) / independent - 1.0) / (n as f64 - 1.0);
        Self { counts, people: m, rho: if rho.is_nan() { 0.0 } else { rho.clamp(0.0, 0.99) } }
    }

    /// That two people give the same row, whichever.
    fn of_any_row(&self) -> f64 {
        self.joint(self.counts.iter().map(|counts| same_answer(counts, self.people)))
    }

    /// That somebody gives the row which so many gave, who count once.
    fn of_row(&self, row: &[ShownBallot], gave: usize) -> f64 {
        let extra = gave as u64 - 1;
        let rest = (self.people - extra) as f64;
        self.joint(
            row.iter()
                .zip(&self.counts)
                .map(|(b, counts)| (counts[b.outcome().index()] - extra) as f64 / rest),
        )
    }

    fn joint(&self, chances: impl Iterator<Item = f64>) -> f64 {
        let n = self.counts.len();
        let p = (chances.map(f64::ln).sum::<f64>() / n as f64).exp();
        if self.rho == 0.0 || p == 0.0 {
            return p.powf(n as f64);
        }
        let (a, sum) = (p * (1.0 - self.rho) / self.rho, (1.0 - self.rho) / self.rho);
        (0..n).map(|i| (a + i as f64) / (sum + i as f64)).product()
    }
}

/// The chance that two of so many people gave the same answer to a question.
fn same_answer(counts: &[u64; 3], people: u64) -> f64 {
    let same: u64 = counts.iter().map(|c| c * c.saturating_sub(1)).sum();
    same as f64 / (people * (people - 1)) as f64
}

/// Over pairs of rows that differ: every pair, or so many of each row's.
fn variance_of_overlaps(people: &[&Range<usize>], sorted: &[ShownBallot]) -> f64 {
    let overlap = |a: usize, b: usize| {
        let (a, b) = (&sorted[people[a].clone()], &sorted[people[b].clone()]);
        a.iter().zip(b).filter(|(a, b)| a.outcome() == b.outcome()).count()
    };
    let (mut count, mut sum, mut squares) = (0.0, 0.0, 0.0);
    let m = people.len();
    for (a, of) in people.iter().enumerate() {
        let few = m <= PARTNERS;
        let partners = if few { m - 1 - a } else { PARTNERS };
        // Spread evenly over all people, whatever their order.
        for k in 1..=partners {
            let b = if few { a + k } else { (a + k * (m / (PARTNERS + 1)).max(1)) % m };
            let x = overlap(a, b);
            if x < of.len() {
                let x = x as f64;
                (count, sum, squares) = (count + 1.0, sum + x, squares + x * x);
            }
        }
    }
    if count > 1.0 { (squares - sum * sum / count) / (count - 1.0) } else { 0.0 }
}
