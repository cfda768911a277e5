//! What the models say: all items on one scale, and how well the models fit.

use super::evidence::{Evidence, WEIGHTS, answer_unequally};
use super::names;
use super::told::named;
use crate::standing::Standing;
use crate::statement::{Block, Finding};
use crate::words::{capital, counted, list, number, p};
use isostudy_inference::conclusions::{About, Conclusions, Verdict, Why};
use isostudy_inference::scale::GroupScale;
use isostudy_statistics::{Difference, Goodness, Model};

/// Scales told at most; the tables have all.
const MOST: usize = 12;

pub(super) fn findings(evidence: &Evidence<'_>) -> Vec<Block> {
    let Some(conclusions) = evidence.preferences.map(|of| &of.conclusions) else { return Vec::new() };
    let several = |(_, of): &(usize, &GroupScale<'_>)| of.group.items.len() > 2;
    let mut scales: Vec<(usize, &GroupScale<'_>)> =
        evidence.scales.iter().enumerate().filter(several).collect();
    // What says most stands first.
    scales.sort_by_key(|(_, of)| std::cmp::Reverse(of.group.items.len()));
    let level = evidence.rules().level;
    let one = |&(place, of): &(usize, &GroupScale<'_>)| one_scale(evidence, conclusions, place, of, level);
    let mut found: Vec<Finding> = scales.iter().take(MOST).map(one).collect();
    if scales.len() > MOST {
        let text = format!("The table of scales has {} more groups.", scales.len() - MOST);
        found.push(Finding::new(Standing::Noted, text));
    }
    if evidence.scales.iter().any(|of| of.scale.is_ok()) && answer_unequally(evidence.shown) {
        found.push(Finding::new(Standing::Noted, WEIGHTS));
    }
    found.extend(misfits(evidence, level));
    found.into_iter().map(Block::Finding).collect()
}

/// Whether the items are all liked alike, how many differ, and who stands highest.
fn one_scale(
    evidence: &Evidence<'_>,
    conclusions: &Conclusions,
    place: usize,
    of: &GroupScale<'_>,
    level: f64,
) -> Finding {
    let group = &of.group;
    let items = counted(group.items.len(), "item");
    let whose = match evidence.groups.len() {
        1 => format!("the {items}"),
        _ => format!("the {items} of group {}", group.name),
    };
    let omnibus = |of: &GroupScale<'_>| match of.scale.as_ref().map(|scale| scale.omnibus) {
        Ok(Ok(test)) => {
            let [one, other] = test.degrees;
            let shown = format!(
                "F = {} on {one} and {other} degrees of freedom, {}",
                number(test.f, 2),
                corrected(of, test.p)
            );
            match of.omnibus_adjusted.unwrap_or(test.p) <= level {
                true => format!("They are not all liked alike: {shown}."),
                false => format!("One test of all does not show that they are not liked alike: {shown}."),
            }
        }
        Ok(Err(reason)) => format!("Whether they are all liked alike is {reason}."),
        Err(_) => String::new(),
    };
    let Some(found) = conclusions.about(About::Scale(place)) else {
        return Finding::new(Standing::NotAnswerable, format!("There is no scale of {whose}."));
    };
    let first = match &found.verdict {
        Verdict::Holds { held, of } => {
            format!(
                "On one scale of {whose}, {held} of {} hold, corrected by Holm.",
                counted(*of, "difference")
            )
        }
        Verdict::NotJudged(Why::NoEstimate(reason)) => format!("One scale of {whose}: {reason}."),
        Verdict::NotJudged(Why::TooFew) => {
            format!("On one scale of {whose} no difference can be shown by so few people.")
        }
        Verdict::NotJudged(_) => format!(
            "On one scale of {whose} no difference can be tested, because some items never won against the others, or a side always \
             did. The positions in the tables come from half a win added each way."
        ),
        _ => format!("On one scale of {whose} no difference was shown."),
    };
    let name = |item: &String| names::item(evidence.study, &group.name, item);
    // A name of an item stays as it is.
    let opening = |item: &String| if name(item) == *item { item.clone() } else { capital(&name(item)) };
    let highest = match conclusions.about(About::Top(place)).map(|of| &of.verdict) {
        Some(Verdict::Best { is_everybody: true, .. }) | None => String::new(),
        Some(Verdict::Best { best, tied, .. }) if tied.is_empty() => {
            format!("{} stands highest.", opening(best))
        }
        Some(Verdict::Best { best, tied, .. }) => {
            let tied: Vec<String> = tied.iter().map(name).collect();
            format!("{} stands highest, and is not shown to differ from {}.", opening(best), named(&tied))
        }
        Some(_) => String::new(),
    };
    let parts = [first, highest, omnibus(of)];
    let text: Vec<String> = parts.into_iter().filter(|part| !part.is_empty()).collect();
    Finding::new(Standing::of(found), text.join(" "))
}

/// The p of a group's omnibus test, and with the correction for as many groups as have one.
fn corrected(of: &GroupScale<'_>, alone: f64) -> String {
    match of.omnibus_adjusted.filter(|&adjusted| adjusted > alone) {
        Some(adjusted) => format!("{}, {} after Holm's correction over groups", p(alone), p(adjusted)),
        None => p(alone),
    }
}

/// Groups whose answers Davidson's model does not reproduce.
fn misfits(evidence: &Evidence<'_>, level: f64) -> Option<Finding> {
    let tests = evidence.scales.iter().filter_map(|of| {
        let davidson = of.fits.iter().find(|fit| fit.model.model == Model::Davidson)?;
        Some((of, &davidson.goodness, davidson.goodness.p.filter(|p| *p <= level)?))
    });
    let missed: Vec<(&GroupScale<'_>, &Goodness, f64)> = tests.collect();
    let largest = missed.iter().map(|(.., p)| *p).max_by(f64::total_cmp)?;
    let names: Vec<&str> = missed.iter().map(|(of, ..)| of.group.name.as_str()).collect();
    let text = format!(
        "Davidson's model does not reproduce the answers of {} {} (deviance test as if answers were independent, largest {}). The \
         intervals of the scale allow for that; its own standard errors do not. The table of fits names each pair that it misses.",
        if names.len() == 1 { "group" } else { "groups" },
        list(&names),
        p(largest)
    );
    Some(Finding::new(Standing::Noted, text))
}

/// What the scale says of two items whose own comparison shows nothing, to stand beside it; nothing where it shows no more.
pub(super) fn beside(evidence: &Evidence<'_>, group: &str, items: [&str; 2]) -> String {
    // Of two items alone the scale knows nothing that their direct comparison does not.
    let several = |of: &&GroupScale<'_>| of.group.name == group && of.group.items.len() > 2;
    let Some(of) = evidence.scales.iter().find(several) else { return String::new() };
    let Ok(scale) = &of.scale else { return String::new() };
    let place = |name: &str| of.group.items.iter().position(|item| item == name);
    let Some((a, b)) = place(items[0]).zip(place(items[1])) else { return String::new() };
    let Some(Difference { log_odds, spread: Some(spread), .. }) =
        scale.differences.iter().find(|of| (of.first, of.second) == (a.min(b), a.max(b)))
    else {
        return String::new();
    };
    if spread.adjusted > evidence.rules().level {
        return String::new();
    }
    let winner = if (*log_odds > 0.0) == (a < b) { items[0] } else { items[1] };
    format!(
        " All answers of the group together put {winner} ahead, by {} log-odds (Davidson's model, {} after Holm's correction).",
        number(log_odds.abs(), 2),
        p(spread.adjusted)
    )
}
