//! Were the sides of a stimulus mixed up in the key?
//!
//! A key that names the wrong side turns the answers to one stimulus file round. Where the same pair was shown in both
//! orders of sides, from two files, the two then contradict each other, and more than a general pull of one side explains.

use super::stimuli::{Stimuli, Stimulus};
use super::{ALARM, Audited, Probe, Report, list};
use crate::digits::number;
use statrs::distribution::{ContinuousCDF, StudentsT};
use std::collections::BTreeSet;

/// Answers in each order below which a stimulus is not judged.
const FEWEST_ANSWERS: f64 = 5.0;
/// Stimuli in both orders below which the general pull of a side cannot be told from one wrong key.
const FEWEST_STIMULI: usize = 4;

/// The report, and the questions whose key is suspect.
///
/// For each stimulus the left side's pull is compared with the mean of the others', as t; p times the number of stimuli.
/// Suspect is only who, the others' pull taken off, has the two orders choose different items.
pub(super) fn probe(audited: &Audited<'_>, stimuli: &Stimuli) -> (Report, BTreeSet<usize>) {
    if !audited.sides_recorded {
        return (Report::not_answerable(Probe::SwappedKey, super::NO_SIDES), BTreeSet::new());
    }
    let judged: Vec<&Stimulus> = stimuli.in_both_orders(FEWEST_ANSWERS).map(|(_, s)| s).collect();
    if judged.len() < FEWEST_STIMULI {
        let reason =
            "fewer than four pairs were seen in both orders of sides: a wrong key looks like a preference";
        return (Report::not_answerable(Probe::SwappedKey, reason), BTreeSet::new());
    }
    let n = judged.len() as f64;
    let (pulls, variances) = judged
        .iter()
        .fold((0.0, 0.0), |(pulls, variances), s| (pulls + s.pull(), variances + s.variance_of_pull()));
    let p = |s: &Stimulus| {
        let others = (pulls - s.pull()) / (n - 1.0);
        let variance = s.variance_of_pull() + (variances - s.variance_of_pull()) / ((n - 1.0) * (n - 1.0));
        let contradict = (s.orders[0].mean() - 0.5 * others) * (s.orders[1].mean() + 0.5 * others) < 0.0;
        let degrees = s.orders[0].n + s.orders[1].n - 2.0;
        let t = ((s.pull() - others) / variance.sqrt()).abs();
        let two_sided = 2.0 * StudentsT::new(0.0, 1.0, degrees).expect("ten answers or more").sf(t);
        if contradict { (n * two_sided).min(1.0) } else { 1.0 }
    };
    let all: Vec<(f64, &Stimulus)> = judged.iter().map(|s| (p(s), *s)).collect();
    let least = all.iter().map(|(p, _)| *p).fold(1.0, f64::min);
    let found: Vec<&Stimulus> = all.iter().filter(|(p, _)| *p < ALARM).map(|(_, s)| *s).collect();
    let name = |s: &&Stimulus| {
        let questions: Vec<String> = s.questions.iter().map(|&q| audited.questions[q].clone()).collect();
        let [one, other] = s.orders.map(|order| number(order.mean(), 2));
        format!("{}: mean {one} for an item on the left, {other} for it on the right", questions.join("/"))
    };
    let evidence = match found.is_empty() {
        true => format!("the two orders of {} pairs agree", judged.len()),
        false => {
            format!("two orders contradict each other. {}", list(&found.iter().map(name).collect::<Vec<_>>()))
        }
    };
    let suspects = found.iter().flat_map(|s| s.questions.iter().copied()).collect();
    (Report::tested(Probe::SwappedKey, least, evidence), suspects)
}
