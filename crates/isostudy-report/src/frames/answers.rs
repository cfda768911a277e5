//! One row per answer.

use super::LongFrame;
use isostudy_design::Study;
use isostudy_design::forms::Role;
use isostudy_inference::ballots::{is_asked, method_of_item};
use isostudy_responses::{Answer, Choice, Responses, Step};
use polars::prelude::*;
use std::collections::BTreeSet;

/// Every column, in the order of the Parquet file.
pub(crate) const COLUMNS: [&str; 13] = [
    "participant",
    "question",
    "object",
    "group",
    "role",
    "left",
    "right",
    "choice",
    "chosen",
    "sides_recorded",
    "place",
    "seconds",
    "counted",
];

/// Some columns of every answer in the order in which it was read, with the sides as they were shown, or as the study lists them
/// where the file does not say.
///
/// Of a study, `left`, `right` and `chosen` are places among its methods, `object` and `group` those among its own with others
/// after them; `counted` leaves out controls, repeats, and whoever is `excluded`. Participants are counted from 1, as in tables:
/// what they are called in a file goes nowhere.
///
/// # Panics
/// If the answers were read for another study, or for a column that is not one of [`COLUMNS`].
pub(crate) fn answers(
    study: Option<&Study>,
    responses: &Responses,
    excluded: &BTreeSet<usize>,
    columns: &[&str],
) -> LongFrame {
    let questions = &responses.questions;
    let (mut objects, mut groups) = (Names::default(), Names::default());
    if let Some(study) = study {
        study.file.objects.iter().for_each(|object| _ = objects.place(&object.id));
        study.groups.iter().for_each(|group| _ = groups.place(&group.id));
    }
    let object: Vec<Option<u32>> = questions.iter().map(|question| objects.place(&question.object)).collect();
    let group: Vec<Option<u32>> = questions.iter().map(|question| groups.place(&question.group)).collect();
    let (item, items) = match study {
        Some(study) => {
            let ids = study.method_ids().iter().map(ToString::to_string).collect();
            (method_of_item(study, responses).into_iter().map(|method| method as u32).collect(), ids)
        }
        None => ((0..responses.items.len() as u32).collect::<Vec<u32>>(), responses.items.clone()),
    };
    let asked = |answer: &Answer| match study {
        Some(study) => is_asked(study, answer),
        None => questions[answer.question as usize].is_comparison(),
    };
    // Where a file does not say which item was on which side, its order means nothing.
    let seen = |answer: &Answer| {
        let listed = answer.left == questions[answer.question as usize].left;
        match responses.sides_recorded || listed {
            true => [answer.left, answer.right],
            false => [answer.right, answer.left],
        }
    };
    let choice = |answer: &Answer| match seen(answer)[0] == answer.left {
        true => answer.choice,
        false => answer.choice.swapped(),
    };
    // Names of steps only where people answered in them.
    let steps: Vec<Step> = match responses.has_steps() {
        true => Step::ALL.into(),
        false => Choice::ALL.map(Step::from).into(),
    };
    let step = |answer: &Answer| {
        let own = Step { choice: choice(answer), much: answer.much };
        steps.iter().position(|&step| step == own).map(|place| place as u32)
    };
    let all = || responses.answers.iter();
    let place = |name: &str, of: &dyn Fn(&Answer) -> Option<u32>| {
        UInt32Chunked::from_iter_options(name.into(), all().map(of)).into_column()
    };
    let truth = |name: &str, of: &dyn Fn(&Answer) -> bool| {
        let values: BooleanChunked = all().map(of).collect();
        values.with_name(name.into()).into_column()
    };
    let seconds = || all().map(|answer| answer.rt_ms.map(|ms| f64::from(ms) / 1e3));
    let column = |&name: &&str| match name {
        "participant" => place(name, &|answer| Some(answer.participant + 1)),
        "question" => place(name, &|answer| Some(answer.question)),
        "object" => place(name, &|answer| object[answer.question as usize]),
        "group" => place(name, &|answer| group[answer.question as usize]),
        "role" => place(name, &|answer| Some(questions[answer.question as usize].role as u32)),
        "left" => place(name, &|answer| Some(item[seen(answer)[0] as usize])),
        "right" => place(name, &|answer| Some(item[seen(answer)[1] as usize])),
        "choice" => place(name, &step),
        "chosen" => place(name, &|answer| answer.chosen().map(|chosen| item[chosen as usize])),
        "sides_recorded" => truth(name, &|_| responses.sides_recorded),
        "place" => place(name, &|answer| answer.order),
        "seconds" => Float64Chunked::from_iter_options(name.into(), seconds()).into_column(),
        "counted" => {
            truth(name, &|answer| asked(answer) && !excluded.contains(&(answer.participant as usize)))
        }
        other => panic!("{other} is no column of answers"),
    };
    let frame = DataFrame::new(responses.answers.len(), columns.iter().map(column).collect());
    let frame = frame.expect("columns of one length, each with its own name");
    let texts = vec![
        ("question", questions.iter().map(|question| question.id.clone()).collect()),
        ("object", objects.0),
        ("group", groups.0),
        ("role", ROLES.map(|(_, name)| name.to_owned()).to_vec()),
        ("left", Vec::clone(&items)),
        ("right", Vec::clone(&items)),
        ("choice", steps.iter().map(|step| step.name().to_owned()).collect()),
        ("chosen", items),
    ];
    LongFrame { name: "answers", frame, texts }
}

/// Roles as forms and the long format call them, each at the place of its number.
const ROLES: [(Role, &str); 4] = [
    (Role::Training, "training"),
    (Role::Comparison, "comparison"),
    (Role::Control, "control"),
    (Role::Repeat, "repeat"),
];

/// Names and their places; an empty one has none.
#[derive(Default)]
struct Names(Vec<String>);

impl Names {
    fn place(&mut self, name: &str) -> Option<u32> {
        if name.is_empty() {
            return None;
        }
        let found = self.0.iter().position(|known| known == name);
        let place = found.unwrap_or_else(|| {
            self.0.push(name.to_owned());
            self.0.len() - 1
        });
        Some(place as u32)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_roles_are_their_places() {
        for (place, (role, _)) in ROLES.into_iter().enumerate() {
            assert_eq!(role as usize, place);
        }
    }
}
