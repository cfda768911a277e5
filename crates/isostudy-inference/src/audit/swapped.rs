//! Were the sides of a stimulus mixed up in the key?
//!
//! Two things happen. The key names the sides of a file the wrong way round: all answers to it are then labelled in the other
//! order, which [`labels`] tell. Or the answers to it were turned and the labels were not: then the two orders of the pair
//! contradict each other, by more than a general pull of one side explains, which [`turned`] tells.

use super::evidence::{Key, Orders, Reason, TurnedPair};
use super::labels::Labels;
use super::stimuli::{Stimuli, Stimulus};
use super::turned::judge;
use super::{ALARM, Audited, Evidence, Finding, Probe, Report};
use std::collections::BTreeSet;

/// The report, and the questions whose answers may be about another order of sides than they say: those of which the probe
/// speaks up, and those that are merely doubtful, since neither a side nor an object is to be blamed for what may be the key's.
/// `stimuli` are without those whose labels contradict.
pub(super) fn probe(audited: &Audited<'_>, labels: Labels, stimuli: &Stimuli) -> (Report, BTreeSet<usize>) {
    if !audited.sides_recorded {
        return (Report::not_answerable(Probe::SwappedKey, Reason::NoSides), BTreeSet::new());
    }
    let judged = judge(stimuli);
    let orders = judged.as_deref().unwrap_or_default();
    let found: Vec<&Stimulus> =
        orders.iter().filter(|of| of.adjusted < ALARM).map(|of| of.stimulus).collect();
    let doubtful = orders.iter().filter(|of| of.is_doubtful()).flat_map(|of| of.stimulus.questions.iter());
    let suspects: BTreeSet<usize> = labels.suspects.iter().chain(doubtful).copied().collect();
    let Labels { found: contradictions, remarks, looked, .. } = labels;
    let turned: Vec<TurnedPair> = found.iter().map(|of| turned(audited, of)).collect();
    let orders = match &judged {
        Some(all) if turned.is_empty() => Orders::Agree { pairs: all.len() },
        Some(_) => Orders::Contradict(turned),
        None if looked => Orders::Few,
        None => {
            let reason = Reason::FewPairsInBothOrders { remarks, apart: stimuli.apart() };
            return (Report::not_answerable(Probe::SwappedKey, reason), suspects);
        }
    };
    let certain = !contradictions.is_empty();
    let p = judged.as_ref().map(|all| all.iter().map(|of| of.adjusted).fold(1.0, f64::min));
    let p = if certain { None } else { p };
    let finding = if certain || p.is_some_and(|p| p < ALARM) { Finding::Found } else { Finding::NotFound };
    let evidence = Evidence::SwappedKey(Key { contradictions, remarks, orders });
    (Report { probe: Probe::SwappedKey, finding, p, evidence }, suspects)
}

fn turned(audited: &Audited<'_>, stimulus: &Stimulus) -> TurnedPair {
    TurnedPair {
        questions: audited.names(stimulus.questions.iter().copied()),
        means: stimulus.orders.map(|order| order.mean()),
    }
}
