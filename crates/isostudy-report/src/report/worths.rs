//! What the models say: all items on one scale, and how well the models fit.

use super::evidence::Evidence;
use crate::statement::{Block, Finding, Standing};
use crate::words::{counted, interval, list, number, p};
use isostudy_inference::scale::GroupScale;
use isostudy_statistics::{Difference, Model, Scale};

/// Log-odds that differ by less differ by rounding.
const ALIKE: f64 = 1e-9;

/// Pairs and items named at most.
const NAMED: usize = 5;

pub(super) fn findings(evidence: &Evidence<'_>) -> Vec<Block> {
    let level = evidence.rules().level;
    let mut found = Vec::new();
    for of in evidence.scales.iter().filter(|of| of.group.items.len() > 2) {
        match &of.scale {
            Ok(scale) => found.extend(one_scale(of, scale, level)),
            Err(reason) => {
                let text = format!("One scale for group {}: {reason}.", of.group.name);
                found.push(Finding::new(Standing::NotAnswerable, text));
            }
        }
    }
    found.extend(misfits(evidence, level));
    found.into_iter().map(Block::Finding).collect()
}

fn one_scale(of: &GroupScale<'_>, scale: &Scale, level: f64) -> Vec<Finding> {
    let name = &of.group.name;
    let mut found = Vec::new();
    match scale.omnibus {
        Ok(test) if of.omnibus_adjusted.unwrap_or(test.p) <= level => {
            let text = format!(
                "The {} of group {name} are not all liked alike: F = {} on {} and {} degrees of freedom, {}.",
                counted(of.group.items.len(), "item"),
                number(test.f, 2),
                test.degrees[0],
                test.degrees[1],
                corrected(of, test.p)
            );
            found.push(Finding::new(Standing::Holds, text));
        }
        Ok(test) => {
            let text = format!(
                "One test of all {} of group {name} does not show that they are not all liked alike: F = {} on {} and {} degrees of \
                 freedom, {}.",
                counted(of.group.items.len(), "item"),
                number(test.f, 2),
                test.degrees[0],
                test.degrees[1],
                corrected(of, test.p)
            );
            found.push(Finding::new(Standing::Open, text));
        }
        Err(reason) => {
            let text = format!("Whether the items of group {name} are all liked alike is {reason}.");
            found.push(Finding::new(Standing::NotAnswerable, text));
        }
    }
    if scale.fit.penalised() {
        let text = format!(
            "On one scale of group {name} no difference can be tested, because some items never won against the others, or a side \
             always did. The positions in the tables come from half a win added each way."
        );
        found.push(Finding::new(Standing::NotAnswerable, text));
        return found;
    }
    let told = scale.differences.iter().filter(|of| of.spread.is_some_and(|s| s.adjusted <= level)).count();
    let at = |item: usize| scale.positions[item].log_odds;
    let mut order: Vec<usize> = (0..of.group.items.len()).collect();
    order.sort_by(|&a, &b| at(b).total_cmp(&at(a)));
    let Some(&first) = order.first() else { return found };
    // What differs by rounding alone stands in the order of the items.
    let mut highest: Vec<usize> =
        order.iter().copied().filter(|&item| at(first) - at(item) < ALIKE).collect();
    highest.sort_unstable();
    let rest: Vec<usize> = order.into_iter().filter(|item| !highest.contains(item)).collect();
    let first = highest[0];
    let between = |a: usize, b: usize| {
        scale.differences.iter().find(|of| (of.first, of.second) == (a.min(b), a.max(b)))
    };
    let open: Vec<String> = rest
        .iter()
        .filter_map(|&other| {
            let difference = between(first, other)?;
            let spread = difference.spread.filter(|spread| spread.adjusted > level)?;
            let sign = if difference.first == first { 1.0 } else { -1.0 };
            let ends = if sign > 0.0 {
                spread.interval
            } else {
                isostudy_statistics::interval::Interval {
                    low: -spread.interval.high,
                    high: -spread.interval.low,
                }
            };
            Some(format!(
                "{} ({}; {})",
                of.group.items[other],
                number(sign * difference.log_odds, 2),
                interval(ends, 2)
            ))
        })
        .collect();
    let best = list(&highest.iter().map(|&item| of.group.items[item].clone()).collect::<Vec<_>>());
    let (stands, is) = if highest.len() == 1 { ("stands", "is") } else { ("stand", "are") };
    let next = match open.len() {
        0 if rest.is_empty() => " All stand alike.".into(),
        0 => String::new(),
        _ => {
            let mut named: Vec<String> = open.iter().take(NAMED).cloned().collect();
            if open.len() > NAMED {
                named.push(format!("{} more", open.len() - NAMED));
            }
            format!(
                " {best} {stands} highest, but {is} not shown to differ from {}: difference in log-odds and its 95 % interval.",
                list(&named)
            )
        }
    };
    let text = format!(
        "On one scale of group {name}, {told} of {} hold after Holm's correction over the pairs of this group.{next}",
        counted(scale.differences.len(), "difference")
    );
    found.push(Finding::new(Standing::Noted, text));
    found
}

/// The p of a group's omnibus test, and with the correction for as many groups as have one.
fn corrected(of: &GroupScale<'_>, alone: f64) -> String {
    match of.omnibus_adjusted.filter(|&adjusted| adjusted > alone) {
        Some(adjusted) => format!("{}, {} after Holm's correction over groups", p(alone), p(adjusted)),
        None => p(alone),
    }
}

/// Groups whose answers Davidson's model does not reproduce, and the pair that it misses most.
fn misfits(evidence: &Evidence<'_>, level: f64) -> Vec<Finding> {
    let mut found = Vec::new();
    for of in evidence.scales {
        let davidson = of.fits.iter().find(|fit| fit.model.model == Model::Davidson);
        let Some(test) = davidson.map(|fit| &fit.goodness) else { continue };
        let Some(p_value) = test.p.filter(|p| *p <= level) else { continue };
        let miss = |i: usize| {
            let pair = &test.pairs[i];
            (0..3)
                .filter(|&o| pair.fitted[o] > 0.0)
                .map(|o| (pair.answers[o] - pair.fitted[o]).powi(2) / pair.fitted[o])
                .sum::<f64>()
        };
        let Some(worst) = (0..test.pairs.len()).max_by(|&a, &b| miss(a).total_cmp(&miss(b))) else {
            continue;
        };
        let pair = &test.pairs[worst];
        let shown = |of: [f64; 3], decimals| of.map(|n| number(n, decimals)).join(" : ");
        let text = format!(
            "Davidson's model does not reproduce the answers of group {}: deviance {} on {} degrees of freedom, {} as if answers \
             were independent. It misses {} against {} most, with {} answers (first, neither, second) where it expects {}. The \
             intervals of the scale allow for that; its own standard errors do not.",
            of.group.name,
            number(test.deviance, 1),
            test.degrees,
            p(p_value),
            of.group.items[pair.left],
            of.group.items[pair.right],
            shown(pair.answers, 0),
            shown(pair.fitted, 1)
        );
        found.push(Finding::new(Standing::Noted, text));
    }
    found
}

/// What the scale says of two items that were compared, to stand beside their direct comparison; nothing where it says no
/// more than that.
pub(super) fn beside(evidence: &Evidence<'_>, group: &str, items: [&str; 2], shown: bool) -> String {
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
    if shown || spread.adjusted > evidence.rules().level {
        return String::new();
    }
    let winner = if (*log_odds > 0.0) == (a < b) { items[0] } else { items[1] };
    format!(
        " All answers of the group together put {winner} ahead, by {} log-odds (Davidson's model, {} after Holm's correction).",
        number(log_odds.abs(), 2),
        p(spread.adjusted)
    )
}
