//! Were the sides of a stimulus mixed up in the key?
//!
//! Two things happen. The key names the sides of a file the wrong way round: all answers to it are then labelled in the other
//! order, which [`labels`] tell. Or the answers to it were turned and the labels were not: then the two orders of the pair
//! contradict each other, by more than a general pull of one side explains, which [`turned`] tells.

use super::labels::Labels;
use super::stimuli::{Stimuli, Stimulus};
use super::turned::{Judged, judge};
use super::{ALARM, Audited, Finding, Probe, Report, list};
use isostudy_table::digits::{counted, number};
use std::collections::BTreeSet;

/// The report, and the questions whose answers may be about another order of sides than they say: those of which the probe
/// speaks up, and those that are merely doubtful, since neither a side nor an object is to be blamed for what may be the key's.
/// `stimuli` are without those whose labels contradict.
pub(super) fn probe(audited: &Audited<'_>, labels: Labels, stimuli: &Stimuli) -> (Report, BTreeSet<usize>) {
    if !audited.sides_recorded {
        return (Report::not_answerable(Probe::SwappedKey, super::NO_SIDES), BTreeSet::new());
    }
    let judged = judge(stimuli);
    let orders = judged.as_deref().unwrap_or_default();
    let found: Vec<&Stimulus> =
        orders.iter().filter(|of| of.adjusted < ALARM).map(|of| of.stimulus).collect();
    let doubtful = orders.iter().filter(|of| of.is_doubtful()).flat_map(|of| of.stimulus.questions.iter());
    let suspects: BTreeSet<usize> = labels.suspects.iter().chain(doubtful).copied().collect();
    let mut evidence = labels.found;
    let certain = !evidence.is_empty();
    if !found.is_empty() {
        let each: Vec<String> = found.iter().map(|s| contradiction(audited, s)).collect();
        evidence.push(format!("two orders contradict each other. {}", list(&each)));
    }
    evidence.extend(labels.remarks);
    match &judged {
        Some(all) if found.is_empty() => {
            evidence.push(format!("the two orders of {} agree", counted(all.len(), "pair")));
        }
        Some(_) => {}
        None if labels.looked => {
            evidence.push(format!("whether answers were turned cannot be told, because {FEW}"))
        }
        None if certain => {}
        None => {
            let remarks: Vec<String> = evidence.iter().map(|remark| format!("; {remark}")).collect();
            let reason = format!("{FEW}: a wrong key looks like a preference{}", remarks.concat());
            return (Report::not_answerable(Probe::SwappedKey, &reason), suspects);
        }
    }
    let p = judged.map(|all: Vec<Judged<'_>>| all.iter().map(|of| of.adjusted).fold(1.0, f64::min));
    let p = if certain { None } else { p };
    let finding = if certain || p.is_some_and(|p| p < ALARM) { Finding::Found } else { Finding::NotFound };
    (Report { probe: Probe::SwappedKey, finding, p, evidence: evidence.join("; ") }, suspects)
}

const FEW: &str = "fewer than four pairs were seen in both orders of sides";

fn contradiction(audited: &Audited<'_>, stimulus: &Stimulus) -> String {
    let questions: Vec<String> = stimulus.questions.iter().map(|&q| audited.questions[q].clone()).collect();
    let [one, other] = stimulus.orders.map(|order| number(order.mean(), 2));
    format!("{}: mean {one} for an item on the left, {other} for it on the right", questions.join("/"))
}
