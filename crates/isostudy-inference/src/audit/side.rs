//! Is one side chosen whatever it shows?

use super::evidence::{BothOrders, Pull, Pulls, Reason};
use super::stimuli::{Stimuli, for_lower};
use super::{ALARM, Audited, Evidence, Probe, Report};
use isostudy_statistics::ScoreTest;
use statrs::distribution::{ContinuousCDF, StudentsT};
use std::collections::{BTreeMap, BTreeSet};

/// A smaller mean pull, of one answer in twenty, is none. Where people are of two camps, and each camp was dealt forms of its own, the forms
/// leave a small pull that everybody shares and that no test of spread takes for chance.
const SMALLEST: f64 = 0.05;

/// From pairs seen in both orders of sides: each participant's mean pull to the left, what the items themselves are worth
/// taken off, against zero as t. From controls: the exact sign-flip test of left against right. If there are both, the
/// smaller p, doubled. Questions with a suspect key are left out.
pub(super) fn probe(audited: &Audited<'_>, stimuli: &Stimuli, suspects: &BTreeSet<usize>) -> Report {
    if !audited.sides_recorded {
        return Report::not_answerable(Probe::Side, Reason::NoSides);
    }
    let controls = audited.ballots.iter().filter(|b| b.left() == b.right());
    let controls = ScoreTest::of(controls.map(|b| (b.participant(), b.outcome().sign())));
    let mut seen = Pulls { pairs: None, controls: None };
    let mut p = Vec::new();
    let both_orders = match pull(audited, stimuli, suspects) {
        Ok((pull, of)) => {
            seen.pairs = Some(pull);
            p.push(of);
            BothOrders::default()
        }
        Err(few) => few,
    };
    if let (Some(counts), false) = (controls.counts, controls.participants() == 0) {
        seen.controls = Some(counts);
        // Fewer people could not show anything, whatever they chose.
        if 2.0_f64.powi(1 - controls.participants() as i32) < ALARM {
            p.push(controls.sign_flip.p());
        }
    }
    match p.len() {
        0 => {
            let reason = match seen.controls {
                None => Reason::FewInBothOrders(both_orders),
                Some(counts) => Reason::FewControls(counts, both_orders),
            };
            Report::not_answerable(Probe::Side, reason)
        }
        n => {
            let least = p.iter().copied().fold(1.0, f64::min);
            Report::tested(Probe::Side, (n as f64 * least).min(1.0), Evidence::Side(seen))
        }
    }
}

/// The mean pull to the left and its p; what there is if no pair or fewer than four people can tell.
///
/// A participant's score is the mean, over the answers, of (x - the stimulus's mean over both orders), counted for the
/// left side. Two orders were fitted, hence m - 2 degrees of freedom. p is 1 where the pull is below [`SMALLEST`].
fn pull(
    audited: &Audited<'_>,
    stimuli: &Stimuli,
    suspects: &BTreeSet<usize>,
) -> Result<(Pull, f64), BothOrders> {
    let middles: BTreeMap<usize, f64> = stimuli
        .in_both_orders()
        .map(|(place, s)| (place, 0.5 * (s.orders[0].mean() + s.orders[1].mean())))
        .collect();
    let mut sums: Vec<(f64, f64)> = Vec::new();
    for ballot in audited.ballots.iter().filter(|b| !suspects.contains(&b.question())) {
        let place = stimuli.place(ballot, audited.scenes);
        let Some(middle) = place.and_then(|place| middles.get(&place)) else { continue };
        if ballot.participant() >= sums.len() {
            sums.resize(ballot.participant() + 1, (0.0, 0.0));
        }
        let towards = if ballot.left() < ballot.right() { 1.0 } else { -1.0 };
        let (sum, n) = &mut sums[ballot.participant()];
        *sum += towards * (for_lower(ballot) as f64 - middle);
        *n += 1.0;
    }
    let scores: Vec<f64> = sums.into_iter().filter(|&(_, n)| n > 0.0).map(|(sum, n)| sum / n).collect();
    if scores.len() < 4 {
        return Err(BothOrders { pairs: middles.len(), people: scores.len(), apart: stimuli.apart() });
    }
    let m = scores.len() as f64;
    let mean = scores.iter().sum::<f64>() / m;
    let variance = scores.iter().map(|s| (s - mean) * (s - mean)).sum::<f64>() / (m - 2.0);
    let t = mean.abs() / (variance / m).sqrt();
    let p = match t.is_nan() || mean.abs() < SMALLEST {
        true => 1.0,
        false => 2.0 * StudentsT::new(0.0, 1.0, m - 2.0).expect("m - 2 > 0").sf(t),
    };
    // People who do not differ tell no spread, and t is beyond all bounds: no p is below that of the exact sign-flip test of so many
    // who all lean one way.
    let p = p.max(2.0_f64.powi(1 - m as i32));
    Ok((Pull { pairs: middles.len(), mean }, p))
}
