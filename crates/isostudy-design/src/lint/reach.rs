//! What the planned participants can show at all.

use super::{Fault, Rule};
use crate::contrast::{Contrast, TestFamily, contrasts, families};
use crate::forms::Questionnaire;
use crate::study::Study;
use std::collections::BTreeSet;

/// What can be shown of one contrast by people who all agree.
#[derive(Debug, Clone, PartialEq)]
pub struct Reach {
    /// What is tested.
    pub contrast: Contrast,
    /// Name of the family in which it is corrected, see [`families`].
    pub family: String,
    /// Whether some form asks about every part of it.
    pub asked: bool,
    /// How many participants would [count](Contrast::counts) who answer everything they are asked.
    pub participants: usize,
    /// The smallest p that the exact sign-flip test can give them, and the same after Holm's correction over the contrasts of
    /// the family for which somebody counts, all of them unanimous; `None` if nobody counts.
    pub p: Option<[f64; 2]>,
}

/// What so many participants who are dealt the study's forms can show, contrast by contrast in the order of [`contrasts`]; none for
/// a study that asks nobody.
///
/// All agreeing, one of the 2^m patterns of signs of m people, and its opposite, are as extreme: p = 2^(1-m).
pub fn reach(study: &Study, participants: usize) -> Vec<Reach> {
    let Some(questionnaire) = Questionnaire::of(study) else { return Vec::new() };
    let all = contrasts(study);
    let count = questionnaire.blocks();
    // Forms of a block ask the same.
    let block = |block: usize| -> (BTreeSet<usize>, usize) {
        let people = participants / count + usize::from(block < participants % count);
        (questionnaire.form(block).comparisons(study), people)
    };
    let blocks: Vec<(BTreeSet<usize>, usize)> = (0..count).map(block).collect();
    let families = families(&all, &study.file.analysis);
    let of_contrast = |contrast: Contrast| {
        let counts =
            |(asked, _): &&(BTreeSet<usize>, usize)| contrast.counts(|question| asked.contains(&question));
        let people: Vec<usize> = blocks.iter().filter(counts).map(|(_, people)| *people).collect();
        Reach {
            family: String::new(),
            asked: !people.is_empty(),
            participants: people.iter().sum(),
            p: None,
            contrast,
        }
    };
    let mut reach: Vec<Reach> = all.into_iter().map(of_contrast).collect();
    for TestFamily { name, members } in families {
        members.iter().for_each(|&i| reach[i].family.clone_from(&name));
        let mut counted = members;
        counted.retain(|&i| reach[i].participants > 0);
        // The most people first: their p is smallest.
        counted.sort_by_key(|&i| std::cmp::Reverse(reach[i].participants));
        let mut adjusted = 0.0f64;
        for (rank, &i) in counted.iter().enumerate() {
            let p = 2f64.powi(1 - i32::try_from(reach[i].participants).unwrap_or(i32::MAX));
            adjusted = adjusted.max((p * (counted.len() - rank) as f64).min(1.0));
            reach[i].p = Some([p, adjusted]);
        }
    }
    reach
}

/// One fault a family: of differences that no form asks both parts of, and of contrasts that too few people are asked about.
pub(super) fn faults(study: &Study, participants: usize) -> Vec<Fault> {
    let level = study.file.analysis.level;
    let reach = reach(study, participants);
    let mut faults = Vec::new();
    let mut judged: Vec<&str> = Vec::new();
    for Reach { family, .. } in &reach {
        if judged.contains(&family.as_str()) {
            continue;
        }
        judged.push(family);
        let own = || reach.iter().filter(|of| of.family == *family);
        let place = format!("family {family}");
        let unasked: Vec<&Reach> = own().filter(|of| !of.asked).collect();
        if !unasked.is_empty() {
            let evidence = format!("no form asks about both parts of {}", listed(&unasked));
            faults.push(Fault { rule: Rule::UntestableComparison, place: place.clone(), evidence });
        }
        let best = |of: &&Reach| of.p.map_or(1.0, |[_, adjusted]| adjusted);
        let mut short: Vec<&Reach> = own().filter(|of| of.asked && best(of) > level).collect();
        short.sort_by_key(|of| of.participants);
        if let Some(first) = short.first() {
            let tests = own().filter(|of| of.participants > 0).count();
            let [people, tests] = [(first.participants, "participant"), (tests, "test")]
                .map(|(number, word)| format!("{number} {word}{}", if number == 1 { "" } else { "s" }));
            let evidence = format!("{}: {people}, {tests}, p is at least {:.4}", listed(&short), best(first));
            faults.push(Fault { rule: Rule::NotEnoughParticipants, place, evidence });
        }
    }
    faults.sort_by_key(|fault| fault.rule);
    faults
}

/// The first, and how many more.
fn listed(reach: &[&Reach]) -> String {
    let first = reach.first().map(|of| of.contrast.to_string()).unwrap_or_default();
    if reach.len() > 1 { format!("{first} and {} more", reach.len() - 1) } else { first }
}

#[cfg(test)]
mod tests;
