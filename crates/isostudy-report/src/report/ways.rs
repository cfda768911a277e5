//! What the models of the way in which people were asked say.

use super::evidence::Evidence;
use super::names;
use crate::standing::Standing;
use crate::statement::{Block, Finding};
use crate::words::{counted, interval, list, number, percent};
use isostudy_design::Study;
use isostudy_design::config::Way;
use isostudy_inference::ways::{OfGroup, WayModel};
use isostudy_responses::{Judged, Verdict};
use std::collections::BTreeMap;

/// Groups told at most; the table has all.
const MOST: usize = 12;

/// How people were asked, where it is not in pairs with three answers.
pub(super) fn asked(study: &Study) -> Option<String> {
    let forms = study.file.forms.as_ref()?;
    if forms.adaptive {
        return Some(
            "Answers that were there before decided half of what each person was asked. Intervals of the likelihood alone are then too \
             narrow: in simulated studies of 36 items, those at 95 % held 89 to 94 % of the true differences. The model of worths \
             drawn together is made for such answers. Nobody has measured how often the tests of contrasts are mistaken then."
                .into(),
        );
    }
    match forms.way {
        Way::Pairs => None,
        Way::Forced => Some(
            "They had to choose one of the two: \u{201c}no preference\u{201d} was no answer. So to decide between equals is no \
             sign of guessing here."
                .into(),
        ),
        Way::Graded => Some(
            "They answered in five steps, from much better on the left to much better on the right. Tests and all but one model \
             take them as left, none or right."
                .into(),
        ),
        Way::Ratings => Some(format!(
            "They rated one surface at a time, from 1 to {}. Tests and models of pairs take the one of two that somebody rated higher.",
            study.file.forms.as_ref()?.steps
        )),
        way => Some(format!(
            "They took the best of {} surfaces that turned at once{}. Tests and models of pairs take what was taken before each other.",
            way.shown(),
            if study.file.forms.as_ref()?.none { ", or none of them" } else { "" }
        )),
    }
}

/// The worths of each group by the model on the scale of pairs, the highest first.
pub(super) fn findings(evidence: &Evidence<'_>) -> Vec<Block> {
    let ways = evidence.preferences.map_or(&[][..], |of| &of.ways);
    // On another scale, and there to compare orders.
    let mut told: Vec<&OfGroup<'_>> = ways.iter().filter(|of| of.model != WayModel::Cumulative).collect();
    // What says most stands first.
    told.sort_by_key(|of| std::cmp::Reverse(of.group.items.len()));
    let one = |of: &&OfGroup<'_>| Block::Finding(Finding::new(Standing::Noted, sentences(evidence, of)));
    let mut found: Vec<Block> = told.iter().take(MOST).map(one).collect();
    let judged = evidence.preferences.map_or(&[][..], |of| &of.responses.judged);
    let none = judged.iter().filter(|of| of.verdict == Verdict::Taken(None)).count();
    if none > 0 {
        let text = format!(
            "In {} of {} none was taken. These say nothing of two, and are left out.",
            none,
            counted(judged.len(), "set")
        );
        found.push(Block::Finding(Finding::new(Standing::Noted, text)));
    }
    found.extend(repeats(judged).map(|text| Block::Finding(Finding::new(Standing::Noted, text))));
    found
}

/// How far people answered alike when they were asked again.
fn repeats(judged: &[Judged]) -> Option<String> {
    let sorted = |of: &Judged| {
        let mut shown = of.shown.clone();
        shown.sort_unstable();
        (of.participant, shown)
    };
    let first: BTreeMap<(u32, Vec<u32>), Verdict> =
        judged.iter().filter(|of| !of.is_repeat).map(|of| (sorted(of), of.verdict)).collect();
    let again: Vec<(Verdict, Verdict)> = judged
        .iter()
        .filter(|of| of.is_repeat)
        .filter_map(|of| Some((*first.get(&sorted(of))?, of.verdict)))
        .collect();
    if again.is_empty() {
        return None;
    }
    let apart = |(a, b): &(Verdict, Verdict)| match (a, b) {
        (Verdict::Rated(a), Verdict::Rated(b)) => u32::from(a.abs_diff(*b)),
        _ => u32::from(a != b),
    };
    let all = again.len();
    let alike = again.iter().filter(|two| apart(two) == 0).count();
    let share = percent(alike as f64 / all as f64);
    Some(match again[0].0 {
        Verdict::Rated(_) => {
            let sum: u32 = again.iter().map(apart).sum();
            format!(
                "Asked again, people gave the same rating in {share} of {}; the mean difference is {} steps.",
                counted(all, "repeat"),
                number(f64::from(sum) / all as f64, 2)
            )
        }
        Verdict::Taken(_) => {
            format!(
                "Asked again with other places, people took the same in {share} of {}.",
                counted(all, "repeat")
            )
        }
    })
}

fn sentences(evidence: &Evidence<'_>, of: &OfGroup<'_>) -> String {
    let whose = names::in_group(evidence, &of.group.name);
    let name = |item: usize| names::item(evidence.study, &of.group.name, &of.group.items[item]);
    let worths = match &of.worths {
        Err(reason) => return format!("The model of {}{whose}: {reason}.", named(of.model)),
        Ok(worths) => worths,
    };
    let mut order: Vec<usize> = (0..worths.len()).collect();
    order.sort_by(|&a, &b| worths[b].value.total_cmp(&worths[a].value));
    let place = |&item: &usize| {
        let worth = &worths[item];
        let ends = worth.interval.map_or_else(String::new, |ends| format!(" ({})", interval(ends, 2)));
        format!("{} {}{ends}", name(item), number(worth.value, 2))
    };
    let told: Vec<String> = order.iter().map(place).collect();
    let (model, answers) = (named(of.model), counted(of.answers as usize, "answer"));
    let scale = match of.model {
        WayModel::Ratings => "steps of the scale",
        _ => "log-odds",
    };
    let begin = match of.model {
        WayModel::Adjacent | WayModel::Cumulative => {
            let much = percent(of.much as f64 / of.answers as f64);
            format!(
                "{much} of {answers}{whose} say that one is much better. By the model of {model} the worths"
            )
        }
        _ => format!("By the model of {model} of {answers}{whose} the worths"),
    };
    format!(
        "{begin} are, highest first: {}. These are {scale} against {}, with intervals at 95 % over people.",
        list(&told),
        name(0)
    )
}

/// What a model is called.
fn named(model: WayModel) -> &'static str {
    match model {
        WayModel::Adjacent | WayModel::Cumulative => "five steps",
        WayModel::Ratings => "ratings",
        WayModel::FirstChoice => "the best of several",
        WayModel::DrawnTogether => "worths drawn together",
    }
}
