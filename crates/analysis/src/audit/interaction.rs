//! Do preferences depend on the object?

use super::{ALARM, Audited, Probe, Report, list};
use crate::ballots::BallotGroup;
use crate::statistics::{holm, sign_flip};
use std::collections::BTreeSet;

/// One pair of items in one group, on one object against the others.
struct Comparison {
    name: String,
    /// Mean over participants for the first item, on the object and on the others.
    means: [f64; 2],
    p: f64,
}

/// For each group, pair of items and object: each participant's mean on the object against that on the others, by the
/// sign-flip test; Holm over all. Questions with a suspect key are left out.
pub(super) fn probe(audited: &Audited<'_>, suspects: &BTreeSet<usize>) -> Report {
    let mut all: Vec<Comparison> = Vec::new();
    for group in audited.groups {
        for first in 0..group.items.len() {
            for second in first + 1..group.items.len() {
                all.extend(compare(audited, suspects, group, (first, second)));
            }
        }
    }
    if all.is_empty() {
        let reason = "no pair of items was shown to the same people on more than one object";
        return Report::not_answerable(Probe::ObjectInteraction, reason);
    }
    let adjusted = holm(&all.iter().map(|c| c.p).collect::<Vec<_>>());
    let mut order: Vec<usize> = (0..all.len()).collect();
    order.sort_by(|&a, &b| adjusted[a].total_cmp(&adjusted[b]));
    let name = |&i: &usize| {
        let Comparison { name, means: [own, others], .. } = &all[i];
        format!("{name}: mean {own:.2} against {others:.2}")
    };
    let found: Vec<String> = order.iter().filter(|&&i| adjusted[i] < ALARM).map(name).collect();
    let evidence = match found.is_empty() {
        true => format!("{} comparisons; the largest difference is {}", all.len(), name(&order[0])),
        false => list(&found),
    };
    Report::tested(Probe::ObjectInteraction, adjusted[order[0]], evidence)
}

fn compare(
    audited: &Audited<'_>,
    suspects: &BTreeSet<usize>,
    group: &BallotGroup,
    (first, second): (usize, usize),
) -> Vec<Comparison> {
    let scenes = audited.objects.len();
    // By participant and scene: answers for the first less those for the second, and answers.
    let mut seen: Vec<(i64, i64)> = Vec::new();
    let mut shown = vec![false; scenes];
    for ballot in group.ballots.iter().filter(|b| !suspects.contains(&b.question)) {
        let towards = match (ballot.left, ballot.right) {
            sides if sides == (first, second) => 1,
            sides if sides == (second, first) => -1,
            _ => continue,
        };
        let scene = audited.scenes[ballot.question];
        let place = ballot.participant * scenes + scene;
        if place >= seen.len() {
            seen.resize((ballot.participant + 1) * scenes, (0, 0));
        }
        seen[place].0 += towards * ballot.outcome.sign();
        seen[place].1 += 1;
        shown[scene] = true;
    }
    let of_scene = |scene: usize| {
        let (mut differences, mut own, mut others) = (Vec::new(), 0.0, 0.0);
        for of in seen.chunks(scenes) {
            let (a, n) = of[scene];
            let (sum, all) = of.iter().fold((0, 0), |(sum, all), (a, n)| (sum + a, all + n));
            let (b, rest) = (sum - a, all - n);
            if n > 0 && rest > 0 {
                // The difference of the two means, in whole numbers.
                differences.push(a * rest - b * n);
                own += a as f64 / n as f64;
                others += b as f64 / rest as f64;
            }
        }
        let m = differences.len() as f64;
        let items = [first, second].map(|item| group.items[item].as_str()).join("-");
        let name = format!("{items} ({}) on {}", group.name, audited.objects[scene]);
        (m > 0.0).then(|| Comparison { name, means: [own / m, others / m], p: sign_flip(&differences).p() })
    };
    let several = shown.iter().filter(|&&shown| shown).count() > 1;
    (0..scenes).filter(|&scene| several && shown[scene]).filter_map(of_scene).collect()
}
