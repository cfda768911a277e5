//! A study's answers as ballots, and the groups of items that the models compare.

use isostudy_design::{MethodId, Study};
use isostudy_responses::{Choice, Responses};
use isostudy_statistics::{DeclaredBallot, Outcome, ShownBallot};

/// Items compared with one another, and the answers about them.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct BallotGroup {
    /// Name in tables.
    pub name: String,
    /// Names of the items; the first is the reference of every worth.
    pub items: Vec<String>,
    /// The answers; `left` and `right` are indices into `items`.
    pub ballots: Vec<ShownBallot>,
    /// By question, the object on which it shows its items; empty where a study or nobody says it.
    pub objects: Vec<String>,
}

/// Every answer to a study's questions, question by question, with the sides as they were shown, or as the study lists them
/// where the file does not say; items are methods in the study's order. Controls and repeats, which check answers and are none of the study's comparisons, are left out.
///
/// # Panics
/// If the answers were read for another study.
pub fn ballots(study: &Study, answers: &Responses) -> Vec<ShownBallot> {
    let items = method_of_item(study, answers);
    let mut ballots: Vec<ShownBallot> = answers
        .answers
        .iter()
        .filter(|answer| is_asked(study, answer))
        .map(|answer| {
            let ballot = ShownBallot::new(
                answer.participant as usize,
                answer.question as usize,
                [items[answer.left as usize], items[answer.right as usize]],
                outcome(answer.choice),
            )
            .by_much(answer.much);
            let listed = answer.left == answers.questions[answer.question as usize].left;
            if answers.sides_recorded || listed { ballot } else { turned(&ballot) }
        })
        .collect();
    ballots.sort_by_key(|ballot| ballot.question());
    ballots
}

/// The same answer with the sides exchanged: where a file does not say which item was on which side, nobody may take the
/// order in which it names them for one.
pub fn turned(ballot: &ShownBallot) -> ShownBallot {
    ballot.turned()
}

/// The same answers, in the same order, about the methods of each question: first the one that the study lists on the left,
/// whichever side it stood on.
pub fn declared(study: &Study, ballots: &[ShownBallot]) -> Vec<DeclaredBallot> {
    let first: Vec<usize> = study.comparisons.iter().map(|c| study.place(c.left.method)).collect();
    ballots.iter().map(|ballot| ballot.declared(first[ballot.question()])).collect()
}

/// Whether an answer is to one of a study's comparisons, rather than to a control or a repeat.
pub fn is_asked(study: &Study, answer: &isostudy_responses::Answer) -> bool {
    (answer.question as usize) < study.comparisons.len()
}

/// The index of each item's method: a study's items are its configurations.
pub fn method_of_item(study: &Study, answers: &Responses) -> Vec<usize> {
    assert_eq!(answers.items.len(), study.configurations.len(), "answers were read for another study");
    study.configurations.iter().map(|c| study.place(c.id.method)).collect()
}

/// What a choice says of left and right.
pub fn outcome(choice: Choice) -> Outcome {
    match choice {
        Choice::Left => Outcome::Left,
        Choice::NoPreference => Outcome::Tie,
        Choice::Right => Outcome::Right,
    }
}

/// The study's comparison groups, then the levels of each declared factor pooled over all else, where more than one group has
/// them, named after the factor; then all methods (`all`), where the groups hang together. Groups without an answer are left out.
/// Items stand in the study's order, after the reference that its analysis names, or the reference's level.
pub fn ballot_groups(study: &Study, ballots: &[ShownBallot]) -> Vec<BallotGroup> {
    let methods = study.method_ids();
    let mut groups: Vec<BallotGroup> = study
        .groups
        .iter()
        .enumerate()
        .map(|(g, group)| {
            let members = reference_first(group.members.clone(), |&method| is_reference(study, method));
            let place = |method| members.iter().position(|&m| m == method);
            let own = ballots.iter().filter(|b| study.comparisons[b.question()].group == g);
            let items = members.iter().map(MethodId::to_string).collect();
            let ballots = relabel(own, |item| place(methods[item]));
            BallotGroup { name: group.id.clone(), items, ballots, objects: Vec::new() }
        })
        .collect();
    let one_group = |ballots: &[ShownBallot]| {
        let group = |b: &ShownBallot| study.comparisons[b.question()].group;
        ballots.iter().all(|b| group(b) == group(&ballots[0]))
    };
    for factor in study.declared_factors().rev() {
        let differs = |b: &&ShownBallot| study.difference(methods[b.left()], methods[b.right()]) == factor;
        let reference = methods.iter().find(|&&method| is_reference(study, method));
        let reference = reference.and_then(|&method| study.level_of(method, factor));
        let levels = (0..study.factor(factor).levels.len()).collect();
        let levels = reference_first(levels, |&level| reference.is_some_and(|of| of.index == level));
        let place = |item: usize| {
            let level = study.level_of(methods[item], factor)?;
            levels.iter().position(|&other| other == level.index)
        };
        let items = levels.iter().map(|&level| study.factor(factor).levels[level].code.clone()).collect();
        let pooled = relabel(ballots.iter().filter(differs), place);
        let name = study.factor(factor).name.clone();
        let group = BallotGroup { name, items, ballots: pooled, objects: Vec::new() };
        groups.extend(Some(group).filter(|group| !one_group(&group.ballots)));
    }
    groups.extend(all_methods(study, ballots));
    groups.retain(|group| !group.ballots.is_empty());
    groups
}

fn is_reference(study: &Study, method: MethodId) -> bool {
    study.file.analysis.reference.as_deref() == Some(method.as_str())
}

/// The others keep their order.
fn reference_first<T>(mut items: Vec<T>, is_reference: impl Fn(&T) -> bool) -> Vec<T> {
    items.sort_by_key(|item| !is_reference(item));
    items
}

/// The group of all methods.
pub const ALL_METHODS: &str = "all";

/// Every method that is compared, as one group, where a study has several groups and they hang together.
fn all_methods(study: &Study, ballots: &[ShownBallot]) -> Option<BallotGroup> {
    let methods = study.method_ids();
    let compared = |method: &MethodId| {
        study.comparisons.iter().any(|c| c.left.method == *method || c.right.method == *method)
    };
    let items: Vec<MethodId> = methods.iter().copied().filter(compared).collect();
    let items = reference_first(items, |&method| is_reference(study, method));
    let place = |item: usize| items.iter().position(|&method| method == methods[item]);
    let own = relabel(ballots.iter(), place);
    // Linked to the first, directly or through others.
    let mut linked = vec![false; items.len()];
    *linked.first_mut()? = true;
    while let Some(ballot) = own.iter().find(|b| linked[b.left()] != linked[b.right()]) {
        (linked[ballot.left()], linked[ballot.right()]) = (true, true);
    }
    let named = study.groups.iter().all(|group| group.id != ALL_METHODS);
    let several = named && study.groups.len() > 1 && linked.into_iter().all(|linked| linked);
    several.then(|| BallotGroup {
        name: ALL_METHODS.into(),
        items: items.iter().map(MethodId::to_string).collect(),
        ballots: own,
        objects: Vec::new(),
    })
}

/// Ballots with other item numbers; those with an item that has none are left out.
fn relabel<'a>(
    ballots: impl Iterator<Item = &'a ShownBallot>,
    place: impl Fn(usize) -> Option<usize>,
) -> Vec<ShownBallot> {
    let renamed = |b: &ShownBallot| Some(b.with_items([place(b.left())?, place(b.right())?]));
    let mut renamed: Vec<ShownBallot> = ballots.filter_map(renamed).collect();
    // There may be millions, and they grew by doubling.
    renamed.shrink_to_fit();
    renamed
}

/// The group with the most answers: of equal ones the one with the most items.
pub(crate) fn widest(groups: &[BallotGroup]) -> Option<&BallotGroup> {
    groups.iter().max_by_key(|of| (of.ballots.len(), of.items.len()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture;

    #[test]
    fn the_papers_groups() {
        let study = fixture::study();
        let ballots = ballots(&study, &fixture::answers(&study));
        assert_eq!(ballots.len(), 486);
        let groups = ballot_groups(&study, &ballots);
        let seen: Vec<(&str, String, usize)> =
            groups.iter().map(|g| (g.name.as_str(), g.items.join(" "), g.ballots.len())).collect();
        let want = [
            ("B", "bu bi bp", 162),
            ("S", "su si sp", 162),
            ("U", "su bu", 54),
            ("I", "si bi", 54),
            ("P", "sp bp", 54),
            ("clustering", "U I P", 324),
            ("arrangement", "S B", 162),
            ("all", "bu bi bp su si sp", 486),
        ];
        assert_eq!(seen.len(), want.len());
        for ((name, items, ballots), want) in seen.iter().zip(want) {
            let mut sorted: Vec<&str> = items.split(' ').collect();
            let mut wanted: Vec<&str> = want.1.split(' ').collect();
            sorted.sort_unstable();
            wanted.sort_unstable();
            assert_eq!((*name, sorted, *ballots), (want.0, wanted, want.2));
        }
        // Q7 shows bu on the left of su; sixteen of eighteen chose it.
        let own = groups[2].ballots.iter().filter(|b| b.question() == 6 && b.outcome() == Outcome::Left);
        assert_eq!(own.clone().count(), 16);
        assert!(own.clone().all(|b| groups[2].items[b.left()] == "bu" && groups[2].items[b.right()] == "su"));
    }
}
