//! The groups of answers that no study explains: items, groups and questions are what the answers name.

use crate::ballots::{BallotGroup, outcome, turned};
use isostudy_responses::{Answer, Responses};
use isostudy_statistics::ShownBallot;
use std::collections::{BTreeMap, BTreeSet};

/// The answers by the group that their question names, groups by name. Answers that name none are in groups of items that
/// were compared with one another, directly or through others: `all`, or the object, or a number.
///
/// Items stand in the order of the [`Responses`], so that no order of rows changes anything. The first is the reference of
/// every worth: `reference`, where the group has it.
pub fn open_groups(answers: &Responses, reference: Option<&str>) -> Vec<BallotGroup> {
    let names = group_of_question(answers);
    let asked = |answer: &&Answer| answers.questions[answer.question as usize].is_comparison();
    // There may be millions of answers: their groups are looked up by number.
    let known: BTreeSet<&str> = names.iter().map(String::as_str).collect();
    let known: Vec<&str> = known.into_iter().collect();
    let group_of: Vec<usize> =
        names.iter().map(|name| known.binary_search(&name.as_str()).expect("collected above")).collect();
    let mut members = vec![Vec::new(); known.len()];
    for answer in answers.answers.iter().filter(asked) {
        let own: &mut Vec<bool> = &mut members[group_of[answer.question as usize]];
        own.resize(answers.items.len(), false);
        [answer.left, answer.right].into_iter().for_each(|item| own[item as usize] = true);
    }
    let name = |&item: &u32| answers.items[item as usize].clone();
    let objects: Vec<String> = answers.questions.iter().map(|question| question.object.clone()).collect();
    let mut places: Vec<Vec<usize>> = Vec::new();
    let mut groups: Vec<BallotGroup> = Vec::new();
    for (group, own) in known.iter().zip(&members) {
        let mut items: Vec<u32> = (0..own.len() as u32).filter(|&item| own[item as usize]).collect();
        // Stable: the others keep their order.
        items.sort_by_key(|item| Some(name(item).as_str()) != reference);
        let mut place = vec![0; own.len()];
        items.iter().enumerate().for_each(|(at, &item)| place[item as usize] = at);
        places.push(place);
        let (items, objects) = (items.iter().map(name).collect(), objects.clone());
        groups.push(BallotGroup { name: (*group).into(), items, ballots: Vec::new(), objects });
    }
    for answer in answers.answers.iter().filter(asked) {
        let group = group_of[answer.question as usize];
        let sides = [answer.left, answer.right].map(|item| places[group][item as usize]);
        let (participant, question) = (answer.participant as usize, answer.question as usize);
        let ballot =
            ShownBallot::new(participant, question, sides, outcome(answer.choice)).by_much(answer.much);
        let ordered = answers.sides_recorded || sides[0] < sides[1];
        groups[group].ballots.push(if ordered { ballot } else { turned(&ballot) });
    }
    // Controls may stand alone in a group.
    groups.retain(|group| !group.ballots.is_empty());
    groups.iter_mut().for_each(|group| group.ballots.shrink_to_fit());
    groups
}

/// By question, the name of its group.
pub fn group_of_question(answers: &Responses) -> Vec<String> {
    let own = |group: &str| !group.is_empty();
    // Items joined by questions without a group; each leads to the first of its kind.
    let mut first: Vec<u32> = (0..answers.items.len() as u32).collect();
    fn root(first: &mut [u32], item: u32) -> u32 {
        let mut item = item;
        while first[item as usize] != item {
            first[item as usize] = first[first[item as usize] as usize];
            item = first[item as usize];
        }
        item
    }
    let compared = answers.questions.iter().filter(|q| !own(&q.group) && q.is_comparison());
    for question in compared.clone() {
        let (a, b) = (root(&mut first, question.left), root(&mut first, question.right));
        first[a.max(b) as usize] = a.min(b);
    }
    let mut objects: BTreeMap<u32, Vec<&str>> = BTreeMap::new();
    for question in compared {
        let of = objects.entry(root(&mut first, question.left)).or_default();
        if !of.contains(&question.object.as_str()) {
            of.push(&question.object);
        }
    }
    let single = |of: &Vec<&str>| of.len() == 1 && own(of[0]);
    let distinct = objects.values().all(single)
        && objects.values().map(|of| of[0]).collect::<std::collections::BTreeSet<_>>().len() == objects.len();
    let name = |place: usize, of: &[&str]| match (objects.len(), distinct) {
        (1, _) => "all".to_owned(),
        (_, true) => of[0].to_owned(),
        _ => (place + 1).to_string(),
    };
    let names: BTreeMap<u32, String> =
        objects.iter().enumerate().map(|(place, (&root, of))| (root, name(place, of))).collect();
    answers
        .questions
        .iter()
        .map(|question| match own(&question.group) {
            true => question.group.clone(),
            false => names.get(&root(&mut first, question.left)).cloned().unwrap_or_default(),
        })
        .collect()
}

#[cfg(test)]
mod tests;
