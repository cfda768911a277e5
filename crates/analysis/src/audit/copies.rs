//! Did somebody's answers get in twice?
//!
//! Two rows may be the same by chance, the more easily the more people agree. How much any two rows have in common tells
//! how often that is to be expected.

use super::{Probe, Report, list};
use crate::statistics::Ballot;
use statrs::distribution::{DiscreteCDF, Poisson};
use std::ops::Range;

/// Answers in a row below which sameness says nothing.
const FEWEST_ANSWERS: usize = 10;
/// People who saw the same questions on the same sides below which chance cannot be judged.
const FEWEST_PEOPLE: usize = 5;
/// Up to so many people every pair is looked at to judge chance, beyond it this many for each.
const PARTNERS: usize = 100;
/// Sameness has to exceed this many times what chance makes of the overlaps, which are extrapolated.
const ALLOWANCE: f64 = 3.0;

/// Among people who saw the same questions on the same sides: how many pairs gave the same answers, against the number
/// that chance makes of how much rows overlap, three times over, as Poisson.
pub(super) fn probe(ballots: &[Ballot]) -> Report {
    let mut sorted: Vec<Ballot> = ballots.to_vec();
    sorted.sort_unstable();
    let mut people: Vec<Range<usize>> = Vec::new();
    let mut start = 0;
    for of in sorted.chunk_by(|a, b| a.participant == b.participant) {
        people.push(start..start + of.len());
        start += of.len();
    }
    people.retain(|of| of.len() >= FEWEST_ANSWERS);
    let form = |of: &Range<usize>| sorted[of.clone()].iter().map(|b| (b.question, b.left, b.right));
    let row = |of: &Range<usize>| sorted[of.clone()].iter().map(|b| b.outcome);
    // Stable: people of one form stay in their order.
    people.sort_by(|a, b| form(a).cmp(form(b)));
    let (mut expected, mut same, mut copies, mut judged) = (0.0, 0_u64, Vec::new(), 0);
    for of_form in people.chunk_by(|a, b| form(a).eq(form(b))) {
        if of_form.len() < FEWEST_PEOPLE {
            continue;
        }
        judged += of_form.len();
        let m = of_form.len() as f64;
        expected += 0.5 * m * (m - 1.0) * chance_of_sameness(of_form, &sorted);
        let mut by_row: Vec<&Range<usize>> = of_form.iter().collect();
        by_row.sort_by(|a, b| row(a).cmp(row(b)));
        for twins in by_row.chunk_by(|a, b| row(a).eq(row(b))).filter(|twins| twins.len() > 1) {
            same += (twins.len() * (twins.len() - 1) / 2) as u64;
            let names: Vec<String> =
                twins.iter().map(|of| (sorted[of.start].participant + 1).to_string()).collect();
            copies.push(format!("respondents {}", list(&names)));
        }
    }
    if judged == 0 {
        let reason = "no five people answered the same ten questions on the same sides";
        return Report::not_answerable(Probe::CopiedRows, reason);
    }
    let p = match (same, expected > 0.0) {
        (0, _) => 1.0,
        (same, true) => Poisson::new(ALLOWANCE * expected).expect("above zero").sf(same - 1),
        (_, false) => 0.0,
    };
    let chance = format!("by chance about {}", few(expected));
    let evidence = match same {
        0 => format!("no two of {judged} people gave the same answers; {chance} would"),
        1 => format!("{} gave the same answers; {chance} pairs would", copies[0]),
        same => format!("{same} pairs gave the same answers, {chance} would: {}", list(&copies)),
    };
    Report::tested(Probe::CopiedRows, p, evidence)
}

fn few(expected: f64) -> String {
    if expected < 0.001 { "none (below 0.001)".into() } else { format!("{expected:.3}") }
}

/// The chance that two rows of one form are the same: that they are at every question, people taken as independent, and
/// more as far as overlaps of rows vary more than that. With P_q the chance of the same answer at question q and v the
/// variance of overlaps, rho = (v / sum P_q (1 - P_q) - 1) / (n - 1), and the chance is that of n successes of a
/// beta-binomial distribution with correlation rho and the P_q's geometric mean.
fn chance_of_sameness(people: &[Range<usize>], sorted: &[Ballot]) -> f64 {
    let n = people[0].len();
    let (mut ln_product, mut independent) = (0.0, 0.0);
    for question in 0..n {
        let mut counts = [0_u64; 3];
        people.iter().for_each(|of| counts[sorted[of.start + question].outcome.index()] += 1);
        let (same, m) =
            (counts.iter().map(|c| (c * c.saturating_sub(1)) as f64).sum::<f64>(), people.len() as f64);
        let p = same / (m * (m - 1.0));
        ln_product += p.ln();
        independent += p * (1.0 - p);
    }
    let p = (ln_product / n as f64).exp();
    let variance = variance_of_overlaps(people, sorted);
    let rho = ((variance / independent - 1.0) / (n as f64 - 1.0)).clamp(0.0, 0.99);
    if rho.is_nan() || rho == 0.0 || p == 0.0 {
        return p.powf(n as f64);
    }
    let (a, sum) = (p * (1.0 - rho) / rho, (1.0 - rho) / rho);
    (0..n).map(|i| (a + i as f64) / (sum + i as f64)).product()
}

/// Over pairs of rows that differ: every pair, or so many of each row's.
fn variance_of_overlaps(people: &[Range<usize>], sorted: &[Ballot]) -> f64 {
    let overlap = |a: usize, b: usize| {
        let (a, b) = (&sorted[people[a].clone()], &sorted[people[b].clone()]);
        a.iter().zip(b).filter(|(a, b)| a.outcome == b.outcome).count()
    };
    let (mut count, mut sum, mut squares) = (0.0, 0.0, 0.0);
    let m = people.len();
    for (a, own) in people.iter().enumerate() {
        let few = m <= PARTNERS;
        let partners = if few { m - 1 - a } else { PARTNERS };
        // Spread evenly over all people, whatever their order.
        for k in 1..=partners {
            let b = if few { a + k } else { (a + k * (m / (PARTNERS + 1)).max(1)) % m };
            let x = overlap(a, b);
            if x < own.len() {
                let x = x as f64;
                (count, sum, squares) = (count + 1.0, sum + x, squares + x * x);
            }
        }
    }
    if count > 1.0 { (squares - sum * sum / count) / (count - 1.0) } else { 0.0 }
}
