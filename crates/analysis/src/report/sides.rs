//! What the design cannot answer: sides, other objects, other people.

use super::finding::{Finding, Standing};
use super::words::{capital, counted, interval, list, number};
use super::{Block, Evidence, names};
use design::contrast::{Level, Over, contrasts};
use statistics::{
    Model, Pairs, Participants, Separation, ShownBallot, SideDesign, clustered_covariance, fit, has_spread,
    separation, side_design,
};
use std::collections::BTreeMap;

pub(super) fn findings(evidence: &Evidence<'_>) -> Vec<Block> {
    let mut found = side(evidence);
    if let Some(study) = evidence.study {
        let names: Vec<&str> = study.file.objects.iter().map(|o| o.name.as_str()).collect();
        found.push(Finding::new(
            Standing::NotAnswerable,
            format!(
                "Whether the results hold for other objects cannot be told from {} ({}): objects are compared one by one, \
                 and no interval here covers an object that was not shown.",
                counted(names.len(), "object"),
                list(&names)
            ),
        ));
    }
    found.into_iter().map(Block::Finding).collect()
}

fn side(evidence: &Evidence<'_>) -> Vec<Finding> {
    let mut counts = [0_u64; 3];
    evidence.shown.iter().for_each(|b| counts[b.outcome().index()] += 1);
    let [left, none, right] = counts;
    let totals =
        format!("{} went left, {right} right and {none} to neither", counted(left as usize, "answer"));
    let items = evidence.shown.iter().map(|b| b.left().max(b.right()) + 1).max().unwrap_or(0);
    let mut designs: BTreeMap<&str, (SideDesign, &[ShownBallot], usize)> = BTreeMap::new();
    for group in evidence.groups {
        let pairs = Pairs::of(group.items.len(), &group.ballots);
        designs.insert(&group.name, (side_design(&pairs), &group.ballots, group.items.len()));
    }
    let of = |design: SideDesign| -> Vec<&str> {
        evidence.groups.iter().map(|g| g.name.as_str()).filter(|name| designs[name].0 == design).collect()
    };
    let everywhere = side_design(&Pairs::of(items, evidence.shown)) != SideDesign::Counterbalanced
        && of(SideDesign::Counterbalanced).is_empty();
    let mut found = Vec::new();
    if everywhere {
        found.push(Finding::new(
            Standing::NotAnswerable,
            format!(
                "Whether people favour a side is not answerable here, because no pair was shown in both orders. {}. {}, and \
                 how much of that is the side and how much what stood there, no analysis of these answers can tell.",
                always(evidence).unwrap_or_else(|| "Every pair kept its sides".into()),
                capital(&totals)
            ),
        ));
    } else {
        found.push(Finding::new(Standing::Noted, format!("Over all questions {totals}.")));
    }
    let estimates = |names: &[&str]| -> Vec<String> {
        names.iter().filter_map(|name| estimate(name, designs[name].1, designs[name].2)).collect()
    };
    let (balanced, additive) = (of(SideDesign::Counterbalanced), of(SideDesign::ThroughAdditivity));
    for (names, what) in [
        (&balanced, "Pairs were shown in both orders, so a bonus for the left side can be estimated"),
        (
            &additive,
            "Where three items or more were compared, a bonus for the left side can be estimated, but only if worths are \
             additive, which the answers cannot show",
        ),
    ] {
        let parts = estimates(names);
        if !parts.is_empty() {
            let text = format!(
                "{what}. In log-odds, by Davidson's model with a side (95 % t interval, participants as clusters): {}.",
                list(&parts)
            );
            found.push(Finding::new(Standing::Noted, text));
        }
    }
    let confounded = of(SideDesign::Confounded);
    if !everywhere && !confounded.is_empty() {
        let text = format!(
            "In {} {} side and item cannot be separated: no pair was shown in both orders, and each item's side goes with \
             its worth.",
            if confounded.len() == 1 { "group" } else { "groups" },
            list(&confounded)
        );
        found.push(Finding::new(Standing::NotAnswerable, text));
    }
    found
}

fn estimate(name: &str, ballots: &[ShownBallot], items: usize) -> Option<String> {
    let pairs = Pairs::of(items, ballots);
    // Where ties alone keep the worths finite, the side would take the blame.
    if separation(&pairs) != Separation::None {
        return None;
    }
    let fitted = fit(Model::DavidsonSide, &pairs).ok().filter(|fit| !fit.penalised)?;
    let participants = Participants::of(items, ballots);
    let covariance = clustered_covariance(&fitted, &participants)?;
    let place = fitted.parameters.len() - 1;
    let side = fitted.side?;
    let (people, se) = (participants.number() as f64, covariance[place][place].sqrt());
    let t = statistics::interval::t_half_width(people - 1.0)?;
    if !has_spread(se, fitted.covariance[place][place].sqrt()) {
        return Some(format!(
            "{} (no interval: the answers tell no spread between participants) in group {name}",
            number(side, 2)
        ));
    }
    let found = statistics::interval::Interval { low: side - t * se, high: side + t * se };
    Some(format!("{} ({}) in group {name}", number(side, 2), interval(found, 2)))
}

/// The levels of a study that always stood on one side of the questions that compare them.
fn always(evidence: &Evidence<'_>) -> Option<String> {
    let study = evidence.study?;
    let mut seen: Vec<(Level, [bool; 2])> = Vec::new();
    for contrast in contrasts(study).into_iter().filter(|c| c.over == Over::All) {
        for &weight in contrast.weights.values() {
            for (level, left) in [(contrast.levels[0], weight > 0), (contrast.levels[1], weight < 0)] {
                let place = seen.iter().position(|(l, _)| *l == level).unwrap_or_else(|| {
                    seen.push((level, [false; 2]));
                    seen.len() - 1
                });
                seen[place].1[usize::from(!left)] = true;
            }
        }
    }
    let of = |sides: [bool; 2], word: &str| {
        let own: Vec<String> =
            seen.iter().filter(|(_, s)| *s == sides).map(|(level, _)| names::level(*level)).collect();
        (!own.is_empty()).then(|| format!("{} always stood on the {word}", list(&own)))
    };
    let parts: Vec<String> =
        [of([true, false], "left"), of([false, true], "right")].into_iter().flatten().collect();
    (!parts.is_empty()).then(|| capital(&parts.join(", ")))
}
