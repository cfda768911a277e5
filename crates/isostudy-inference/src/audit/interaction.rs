//! Do preferences depend on the object?

use super::evidence::{Difference, Differences, Reason};
use super::{ALARM, Audited, Evidence, Probe, Report};
use crate::ballots::BallotGroup;
use isostudy_statistics::{Protocol, ShownBallot, Split, exchange, holm, screening_with};
use std::collections::BTreeSet;

/// One person's answers are no sample of what people think.
const FEWEST_PEOPLE: usize = 2;
/// So many decided answers are on one side by chance of 1 in 32.
const FEWEST_DECIDED: u64 = 6;

struct Comparison {
    difference: Difference,
    p: f64,
}

/// The questions on an object and those on the others, the smaller set first: what makes a comparison another one.
type Compared = [Vec<usize>; 2];

/// For each group, pair of items and object: each participant's answers on the object against those on the others, by the
/// permutation test within participants ([`exchange`]); Holm over all. Questions with a suspect key are left out, and so are people who
/// press one side throughout: sides go with objects in a form, and then what they press does, too. What holds the same
/// answers against the same others is one comparison: one object against the other of two, or a pair that two groups have.
pub(super) fn probe(audited: &Audited<'_>, suspects: &BTreeSet<usize>) -> Report {
    let pressing = pressing_one_side(audited);
    let mut all: Vec<Comparison> = Vec::new();
    let mut known = BTreeSet::new();
    for group in audited.groups {
        for first in 0..group.items.len() {
            for second in first + 1..group.items.len() {
                all.extend(compare(audited, (suspects, &pressing), group, (first, second), &mut known));
            }
        }
    }
    if all.is_empty() {
        let reason = Reason::NoPairOnTwoObjects { pressing: pressing.len() };
        return Report::not_answerable(Probe::ObjectInteraction, reason);
    }
    let adjusted = holm(&all.iter().map(|c| c.p).collect::<Vec<_>>());
    let mut order: Vec<usize> = (0..all.len()).collect();
    order.sort_by(|&a, &b| adjusted[a].total_cmp(&adjusted[b]));
    let difference = |i: usize| all[i].difference.clone();
    let found = order.iter().filter(|&&i| adjusted[i] < ALARM).map(|&i| difference(i)).collect();
    let size = |&i: &usize| {
        let [own, others] = all[i].difference.means;
        (own - others).abs()
    };
    let largest = (0..all.len()).max_by(|a, b| size(a).total_cmp(&size(b)).then(b.cmp(a)));
    let largest = largest.filter(|i| size(i) > 0.0).map(difference);
    let seen = Differences { compared: all.len(), found, largest, pressing: pressing.len() };
    Report::tested(Probe::ObjectInteraction, adjusted[order[0]], Evidence::ObjectInteraction(seen))
}

/// Who decided on one side alone, whatever stood there; nobody where that may be what they prefer.
fn pressing_one_side(audited: &Audited<'_>) -> BTreeSet<usize> {
    let protocol = Protocol { scenes: audited.scenes, ..Protocol::default() };
    let one_side = |of: &isostudy_statistics::Screening| {
        let [left, _, right] = of.answers;
        left + right >= FEWEST_DECIDED && left.min(right) == 0 && of.tells_sides()
    };
    match audited.sides_recorded {
        true => screening_with(audited.ballots, &protocol)
            .iter()
            .filter(|of| one_side(of))
            .map(|of| of.participant)
            .collect(),
        false => BTreeSet::new(),
    }
}

fn compare(
    audited: &Audited<'_>,
    (suspects, pressing): (&BTreeSet<usize>, &BTreeSet<usize>),
    group: &BallotGroup,
    (first, second): (usize, usize),
    known: &mut BTreeSet<Compared>,
) -> Vec<Comparison> {
    let scenes = audited.objects.len();
    // By participant and scene: answers for the first, neither, for the second.
    let mut seen: Vec<[u64; 3]> = Vec::new();
    let mut shown: Vec<BTreeSet<usize>> = vec![BTreeSet::new(); scenes];
    let judged = |b: &&ShownBallot| !suspects.contains(&b.question()) && !pressing.contains(&b.participant());
    for ballot in group.ballots.iter().filter(judged) {
        let outcome = match (ballot.left(), ballot.right()) {
            sides if sides == (first, second) => ballot.outcome(),
            sides if sides == (second, first) => ballot.outcome().swapped(),
            _ => continue,
        };
        let scene = audited.scenes[ballot.question()];
        let place = ballot.participant() * scenes + scene;
        if place >= seen.len() {
            seen.resize((ballot.participant() + 1) * scenes, [0; 3]);
        }
        seen[place][outcome.index()] += 1;
        shown[scene].insert(ballot.question());
    }
    let add = |a: [u64; 3], b: &[u64; 3]| [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
    let mean = |of: [u64; 3]| (of[0] as f64 - of[2] as f64) / of.iter().sum::<u64>() as f64;
    let of_scene = |scene: usize| {
        let others = (0..scenes).filter(|&other| other != scene);
        let mut compared =
            [shown[scene].iter().copied().collect(), others.flat_map(|s| shown[s].clone()).collect()];
        compared.iter_mut().for_each(|questions: &mut Vec<usize>| questions.sort_unstable());
        compared.sort_unstable();
        if !known.insert(compared) {
            return None;
        }
        let split = |of: &[[u64; 3]]| Split { own: of[scene], all: of.iter().fold([0; 3], add) };
        let rest = |of: &Split| [0, 1, 2].map(|o| of.all[o] - of.own[o]);
        let mut splits: Vec<Split> = seen.chunks(scenes).map(split).collect();
        splits.retain(|of| of.own != [0; 3] && rest(of) != [0; 3]);
        let m = splits.len() as f64;
        let means = [
            splits.iter().map(|of| mean(of.own)).sum::<f64>() / m,
            splits.iter().map(|of| mean(rest(of))).sum::<f64>() / m,
        ];
        let difference = || Difference {
            items: [first, second].map(|item| group.items[item].clone()),
            group: group.name.clone(),
            object: audited.objects[scene].clone(),
            means,
        };
        (splits.len() >= FEWEST_PEOPLE).then(|| Comparison { difference: difference(), p: exchange(&splits) })
    };
    let several = shown.iter().filter(|shown| !shown.is_empty()).count() > 1;
    (0..scenes).filter(|&scene| several && !shown[scene].is_empty()).filter_map(of_scene).collect()
}
