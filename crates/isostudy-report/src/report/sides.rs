//! What the design cannot answer: sides, other objects, other people.

use super::evidence::Evidence;
use super::names;
use crate::evidence_of_probes;
use crate::statement::Block;
use crate::statement::{Finding, Standing};
use crate::words::{capital, counted, interval, list, number, p as p_value};
use isostudy_design::Level;
use isostudy_design::contrast::{Over, contrasts};
use isostudy_inference::audit::{Finding as Verdict, Probe, Report};
use isostudy_inference::sides::{SideBonus, Sides};
use isostudy_statistics::interval::Interval;
use isostudy_statistics::{SideBound, SideDesign};
use std::collections::BTreeSet;

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

/// Whether the probe for a side could look.
pub(super) fn is_probed(evidence: &Evidence<'_>) -> bool {
    Probed::of(evidence.audit()).is_some()
}

/// That sides and methods go together, where they do.
pub(super) fn sides_and_methods(evidence: &Evidence<'_>) -> Vec<Block> {
    let sides = evidence.preferences.and_then(|of| of.sides.as_ref());
    if evidence.shown.is_empty() || !sides.is_some_and(Sides::go_with_items) {
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
    let Some(sides) = evidence.preferences.and_then(|of| of.sides.as_ref()) else {
        let text = "Whether people favour a side is not answerable here, because the file does not say which item was on \
                    which side.";
        return vec![Finding::new(Standing::NotAnswerable, text)];
    };
    let mut counts = [0_u64; 3];
    evidence.shown.iter().for_each(|b| counts[b.outcome().index()] += 1);
    let [left, none, right] = counts;
    let totals =
        format!("{} went left, {right} right and {none} to neither", counted(left as usize, "answer"));
    let everywhere = sides.go_with_items();
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
    for (design, what) in [
        (
            SideDesign::Counterbalanced,
            format!("{}, so a bonus for the left side can be estimated", capital(&in_both_orders(evidence))),
        ),
        (
            SideDesign::ThroughAdditivity,
            "Where three items or more were compared, a bonus for the left side can be estimated, but only if worths are \
             additive, which the answers cannot show"
                .into(),
        ),
    ] {
        let own = sides
            .with(design)
            .filter_map(|of| Some(format!("{} in group {}", bonus(of.bonus?), of.group.name)));
        let parts: Vec<String> = own.collect();
        if !parts.is_empty() {
            let text = format!(
                "{what}. In log-odds, by Davidson's model with a side (95 % t interval, participants as clusters): {}.",
                list(&parts)
            );
            found.push(Finding::new(Standing::Noted, text));
        }
    }
    let confounded: Vec<&str> = sides.with(SideDesign::Confounded).map(|of| of.group.name.as_str()).collect();
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

fn bonus(of: SideBonus) -> String {
    match of {
        SideBonus::AtLeast(SideBound { side, at_least }) => {
            format!("at least {} for the {}, without an upper bound,", number(at_least, 2), names::side(side))
        }
        SideBonus::Left(side, Some(within)) => format!("{} ({})", number(side, 2), interval(within, 2)),
        SideBonus::Left(side, None) => {
            format!("{} (no interval: the answers tell no spread between participants)", number(side, 2))
        }
    }
}

/// How many pairs of items were shown in both orders, in words. On one object or not is left open: models take all objects together.
pub(super) fn in_both_orders(evidence: &Evidence<'_>) -> String {
    let compared = evidence.shown.iter().filter(|b| b.left() != b.right());
    let shown: BTreeSet<[usize; 2]> = compared.map(|b| [b.left(), b.right()]).collect();
    let pairs: BTreeSet<[usize; 2]> = shown.iter().map(|&[a, b]| [a.min(b), a.max(b)]).collect();
    let both = pairs.iter().filter(|&&[a, b]| shown.contains(&[a, b]) && shown.contains(&[b, a])).count();
    let was = if both == 1 { "was" } else { "were" };
    format!("{both} of {} {was} shown in both orders", counted(pairs.len(), "pair"))
}

/// Which side people favour by the model of the widest group that shows pairs in both orders; `None` where its interval spans zero.
pub(super) fn favoured(sides: &Sides<'_>) -> Option<String> {
    let widest = sides.with(SideDesign::Counterbalanced).max_by_key(|of| of.group.ballots.len())?;
    let (side, by) = match widest.bonus? {
        SideBonus::AtLeast(SideBound { side, at_least }) => (names::side(side), said_at_least(at_least)?),
        SideBonus::Left(left, Some(within)) if within.low > 0.0 || within.high < 0.0 => {
            let turned = Interval { low: -within.high, high: -within.low };
            let (name, of, within) =
                if left > 0.0 { ("left", left, within) } else { ("right", -left, turned) };
            (name, format!("{} ({})", number(of, 2), interval(within, 2)))
        }
        SideBonus::Left(..) => return None,
    };
    Some(format!(
        "Whatever stood there, the {side} side was favoured by {by} log-odds, by Davidson's model with a side."
    ))
}

/// A bound from below; `None` where nobody could see it in the number.
fn said_at_least(bound: f64) -> Option<String> {
    (bound >= 0.005).then(|| format!("at least {}", number(bound, 2)))
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

#[cfg(test)]
mod tests {
    use super::said_at_least;

    #[test]
    fn a_bound_that_reads_as_nothing_is_not_said() {
        assert_eq!([0.0, 0.004].map(said_at_least), [None, None]);
        assert_eq!(
            [0.005, 1.23].map(said_at_least),
            ["at least 0.01", "at least 1.23"].map(|of| Some(of.into()))
        );
    }
}
