//! What the design cannot answer: sides, other objects, other people.

use super::evidence::Evidence;
use super::{asked, names};
use crate::evidence_of_probes;
use crate::statement::Block;
use crate::statement::{Finding, Standing};
use crate::words::{capital, counted, interval, list, number, p as p_value};
use isostudy_design::Level;
use isostudy_design::contrast::{Over, contrasts};
use isostudy_inference::audit::{Finding as Verdict, Probe, Report};
use isostudy_statistics::{
    Model, Pairs, Participants, Separation, ShownBallot, Side, SideBound, SideDesign, clustered_covariance,
    fit, has_spread, separation, side_bound, side_design,
};
use std::collections::BTreeMap;

/// What the probe for a side says.
struct Probed {
    found: bool,
    evidence: String,
}

impl Probed {
    /// `None` where the probe could not look.
    fn of(audit: &[Report]) -> Option<Self> {
        let of_side = |of: &&Report| of.probe == Probe::Side && of.finding != Verdict::NotAnswerable;
        let report = audit.iter().find(of_side)?;
        let p = report.p.map_or(String::new(), |p| format!(" ({})", p_value(p)));
        let evidence = format!("{}{p}", evidence_of_probes::evidence(&report.evidence));
        Some(Self { found: report.finding == Verdict::Found, evidence })
    }
}

/// What stands before results: what people were asked, and that sides and methods go together where they do.
pub(super) fn caution(evidence: &Evidence<'_>) -> Vec<Block> {
    let asked = evidence.study.and_then(asked::instruction).map(|instruction| {
        Block::Text(format!("Results are about what people were asked: {}", asked::ended(instruction)))
    });
    asked.into_iter().chain(sides_and_methods(evidence)).collect()
}

pub(super) fn sides_and_methods(evidence: &Evidence<'_>) -> Vec<Block> {
    if !evidence.sides_recorded {
        return Vec::new();
    }
    let items = evidence.shown.iter().map(|b| b.left().max(b.right()) + 1).max().unwrap_or(0);
    let both = |ballots: &[ShownBallot], items| {
        side_design(&Pairs::of(items, ballots)) == SideDesign::Counterbalanced
    };
    if evidence.shown.is_empty()
        || both(evidence.shown, items)
        || evidence.groups.iter().any(|group| both(&group.ballots, group.items.len()))
    {
        return Vec::new();
    }
    let text = "No comparison was shown in both orders. So each result is about a method together with the side on which it \
                stood.";
    vec![Block::Text(text.into())]
}

pub(super) fn findings(evidence: &Evidence<'_>) -> Vec<Block> {
    let mut found = side(evidence, Probed::of(evidence.audit()));
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

fn side(evidence: &Evidence<'_>, probe: Option<Probed>) -> Vec<Finding> {
    if !evidence.sides_recorded {
        let text = "Whether people favour a side is not answerable here, because the file does not say which item was on \
                    which side.";
        return vec![Finding::new(Standing::NotAnswerable, text)];
    }
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
    match (everywhere, probe) {
        (true, None) => found.push(Finding::new(
            Standing::NotAnswerable,
            format!(
                "Whether people favour a side is not answerable here, because no pair was shown in both orders. {}. {}. How \
                 much of that is the side and how much what stood there, these answers cannot tell.",
                always(evidence).unwrap_or_else(|| "Every pair kept its sides".into()),
                capital(&totals)
            ),
        )),
        (true, Some(probe)) => {
            let (standing, verdict) = match probe.found {
                true => (Standing::Holds, "People favour a side"),
                false => (Standing::Open, "That people favour a side is not shown"),
            };
            found.push(Finding::new(standing, format!("{verdict}: {}. {}.", probe.evidence, capital(&totals))));
            let text = format!(
                "How much of a preference is the side cannot be told, because no comparison was shown in both orders. {}.",
                always(evidence).unwrap_or_else(|| "Every pair kept its sides".into())
            );
            found.push(Finding::new(Standing::NotAnswerable, text));
        }
        (false, probe) => {
            found.push(Finding::new(Standing::Noted, format!("Over all questions {totals}.")));
            if let Some(probe) = probe.filter(|probe| probe.found) {
                found.push(Finding::new(Standing::Holds, format!("People favour a side: {}.", probe.evidence)));
            }
        }
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
    let participants = Participants::of(items, ballots);
    if let Some(SideBound { side, at_least }) = side_bound(&participants) {
        let side = match side {
            Side::Left => "left",
            Side::Right => "right",
        };
        return Some(format!(
            "at least {} for the {side}, without an upper bound, in group {name}",
            number(at_least, 2)
        ));
    }
    let fitted = fit(Model::DavidsonSide, &pairs).ok().filter(|fit| !fit.penalised())?;
    let covariance = clustered_covariance(&fitted, &participants)?;
    let place = fitted.parameters.len() - 1;
    let side = fitted.side?;
    let (people, se) = (participants.number() as f64, covariance[place][place].sqrt());
    let t = isostudy_statistics::interval::t_half_width(people - 1.0)?;
    if !has_spread(se, fitted.covariance[place][place].sqrt()) {
        return Some(format!(
            "{} (no interval: the answers tell no spread between participants) in group {name}",
            number(side, 2)
        ));
    }
    let found = isostudy_statistics::interval::Interval { low: side - t * se, high: side + t * se };
    Some(format!("{} ({}) in group {name}", number(side, 2), interval(found, 2)))
}

/// The levels of a study that always stood on one side of the questions that compare them, as people saw them.
fn always(evidence: &Evidence<'_>) -> Option<String> {
    let study = evidence.study?;
    // By question: which level is its first item's, and its second's.
    let mut levels: Vec<Option<[Level; 2]>> = vec![None; study.comparisons.len()];
    for contrast in contrasts(study).into_iter().filter(|c| c.over == Over::All) {
        let [a, b] = contrast.levels;
        for (&question, &sign) in &contrast.parts[0] {
            levels[question] = Some(if sign > 0 { [a, b] } else { [b, a] });
        }
    }
    let mut seen: Vec<(Level, [bool; 2])> = Vec::new();
    for (shown, declared) in evidence.shown.iter().zip(evidence.declared.iter()) {
        let Some([first, second]) = levels[shown.question()] else { continue };
        let straight = declared.first() == shown.left();
        let [left, right] = if straight { [first, second] } else { [second, first] };
        for (level, side) in [(left, 0), (right, 1)] {
            let place = seen.iter().position(|(l, _)| *l == level).unwrap_or_else(|| {
                seen.push((level, [false; 2]));
                seen.len() - 1
            });
            seen[place].1[side] = true;
        }
    }
    let of = |sides: [bool; 2], word: &str| {
        let own: Vec<String> =
            seen.iter().filter(|(_, s)| *s == sides).map(|(level, _)| names::level(study, *level)).collect();
        (!own.is_empty()).then(|| format!("{} always stood on the {word}", list(&own)))
    };
    let parts: Vec<String> =
        [of([true, false], "left"), of([false, true], "right")].into_iter().flatten().collect();
    (!parts.is_empty()).then(|| capital(&parts.join(", ")))
}
