//! Davidson's worths with their intervals, group by group.

use super::axis::Axis;
use super::draft::{Unfinished, canvas_with_legend};
use super::forest::{self, Block, Row};
use super::legend::Swatch;
use super::marks::Mark;
use super::sheet::Sheet;
use crate::words::capital;
use isostudy_design::Study;
use isostudy_inference::ballots::{ALL_METHODS, BallotGroup};
use isostudy_inference::scale::GroupScale;
use isostudy_table::digits::number;

/// In words where there is a study: its ids of groups and items are the same letters.
pub(super) fn draft(study: Option<&Study>, scales: &[GroupScale<'_>], sheet: Sheet) -> Option<Unfinished> {
    let blocks: Vec<Block> = scales.iter().filter_map(|of| block(study, of)).collect();
    if blocks.is_empty() {
        return None;
    }
    let legend = [
        (Swatch::Mark(Mark::nth(0, true)), "estimate".to_owned()),
        (Swatch::Mark(Mark::nth(0, false)), "reference, 0 by definition".to_owned()),
        forest::interval_entry(),
    ];
    let (mut canvas, top) = canvas_with_legend(sheet, &legend, forest::height(sheet, &blocks));
    let (low, high) = forest::range(&blocks, 0.0);
    let axis = Axis::spanning(low, high);
    forest::draw(&mut canvas, &blocks, &axis, "log worth", 0.0, top);
    let caption = "Worths by Davidson's model, with a bonus for a side where pairs were shown in both orders: log-odds of being preferred to the group's first item. Intervals take participants \
                   as clusters; where answers separate the items, half a win each way was added and no interval is given."
        .into();
    Some(Unfinished { name: "worths", caption, canvas })
}

fn block(study: Option<&Study>, of: &GroupScale<'_>) -> Option<Block> {
    let (group, scale) = (of.group, of.scale.as_ref().ok()?);
    let row = |(item, name): (usize, &String)| {
        let position = &scale.positions[item];
        let interval = position.spread.map(|spread| spread.interval);
        let worth = number(position.log_odds, 2);
        let remark = match (item, scale.fit.penalised(), interval) {
            (0, ..) => "reference".into(),
            (_, true, _) => format!("{worth}, penalised"),
            (_, _, Some(i)) => format!("{worth} [{}, {}]", number(i.low, 2), number(i.high, 2)),
            _ => worth,
        };
        Row {
            label: study.map_or(name.clone(), |study| item_in_words(study, group, name)),
            value: Some(position.log_odds),
            interval,
            mark: Mark::nth(0, item > 0),
            remark,
        }
    };
    let rows = group.items.iter().enumerate().map(row).collect();
    let heading = study.map_or(group.name.clone(), |study| group_in_words(study, &group.name));
    Some(Block { heading, rows })
}

fn group_in_words(study: &Study, name: &str) -> String {
    if let Some(group) = study.groups.iter().find(|group| group.id == name) {
        return capital(&group.label);
    }
    match name {
        ALL_METHODS => "All methods on one scale".into(),
        factor => format!("{}, over all other factors", capital(factor)),
    }
}

/// A method's label, or that of a level of the factor after which the group is named.
fn item_in_words(study: &Study, group: &BallotGroup, name: &str) -> String {
    let level = study.level_named(&group.name, name);
    let method = study.methods.iter().find(|method| method.id.as_str() == name);
    match (level, method) {
        (Some(level), _) if level.label == "none" => level.phrase.clone(),
        (Some(level), _) => level.label.clone(),
        (None, Some(method)) => method.label.clone(),
        (None, None) => name.to_owned(),
    }
}
