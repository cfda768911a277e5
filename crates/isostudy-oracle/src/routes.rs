//! The ways in: one set of answers written as each kind of file that people have, and read by the program.

use super::people::{Given, Pressed};
use isostudy_design::Study;
use isostudy_design::forms::Role;
use isostudy_responses::{Mapping, Plan, Responses};
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// A kind of file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Route {
    /// One row an answer, with everything: what the page and the server give.
    Long,
    /// The same rows in another order.
    Shuffled,
    /// The long format again, as the program writes what it read.
    Converted,
    /// One row an answer, without sides, with code names.
    ByCodeName,
    /// One row an answer, without sides, with the number of the form.
    ByForm,
    /// One row a person, one column a question, with the number of the form.
    Wide,
    /// The same where everybody saw the listed sides: without the number.
    WideAsListed,
    /// The export of a survey tool, with columns and words of its own, and a mapping.
    Export,
}

impl Route {
    pub(super) const ALL: [Self; 8] = [
        Self::Long,
        Self::Shuffled,
        Self::Converted,
        Self::ByCodeName,
        Self::ByForm,
        Self::Wide,
        Self::WideAsListed,
        Self::Export,
    ];

    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Long => "long",
            Self::Shuffled => "long, rows shuffled",
            Self::Converted => "long, converted and read again",
            Self::ByCodeName => "long, sides by code name",
            Self::ByForm => "long, sides by form",
            Self::Wide => "wide, sides by form",
            Self::WideAsListed => "wide, sides as listed",
            Self::Export => "export with a mapping",
        }
    }

    /// Whether a study's answers can come this way.
    pub(super) fn is_open(self, study: &Study) -> bool {
        let forms = study.file.forms.as_ref().expect("it plans forms");
        // Without a form nobody knows what repeats and controls show.
        let bare =
            forms.sides == isostudy_design::config::SideRule::AsListed && forms.controls + forms.repeats == 0;
        self != Self::WideAsListed || bare
    }

    /// Reads the answers this way. The words are why it was not possible.
    pub(super) fn read(self, study: &Study, plan: &Plan, given: &[Given]) -> Result<Responses, String> {
        let name = |given: &Given| format!("p{:04}", given.person + 1);
        match self {
            Self::Long => parse(&long(&EVERYTHING, given, name), plan, &Mapping::default()),
            Self::Shuffled => {
                let mut rows = given.to_vec();
                // By code name first, which is an order that has nothing to do with anything.
                rows.sort_by_key(|g| (g.shown.stimulus.clone(), (g.person * 7919) % 1009, g.shown.order));
                parse(&long(&EVERYTHING, &rows, name), plan, &Mapping::default())
            }
            Self::Converted => {
                let read = Self::Long.read(study, plan, given)?;
                let mut text = Vec::new();
                isostudy_responses::write_long(&read, &mut text).map_err(|error| error.to_string())?;
                let text = String::from_utf8(text).map_err(|error| error.to_string())?;
                parse(&text, plan, &Mapping::default())
            }
            Self::ByCodeName => {
                let columns = ["participant", "order", "question", "choice", "rt_ms", "stimulus"];
                parse(&long(&columns, given, name), plan, &Mapping::default())
            }
            Self::ByForm => {
                let columns = ["participant", "form", "order", "question", "choice", "rt_ms"];
                parse(&long(&columns, given, name), plan, &Mapping::default())
            }
            Self::Wide => parse(&wide(study, given, "participant,form", name), plan, &Mapping::default()),
            Self::WideAsListed => parse(&wide(study, given, "participant", name), plan, &Mapping::default()),
            Self::Export => {
                let own = given.iter().filter(|given| given.shown.role == Role::Comparison);
                let (text, mapping) = export(study, &own.cloned().collect::<Vec<_>>());
                parse(&text, plan, &mapping)
            }
        }
    }
}

fn parse(text: &str, plan: &Plan, mapping: &Mapping) -> Result<Responses, String> {
    let reading = isostudy_responses::parse(text.as_bytes(), Path::new("answers.csv"), Some(plan), mapping);
    reading.map(|reading| reading.responses).map_err(|error| error.to_string())
}

const EVERYTHING: [&str; 12] = [
    "participant",
    "form",
    "order",
    "question",
    "object",
    "group",
    "left",
    "right",
    "choice",
    "rt_ms",
    "role",
    "stimulus",
];

/// One row an answer.
fn long(columns: &[&str], given: &[Given], name: impl Fn(&Given) -> String) -> String {
    let mut text = columns.join(",") + "\n";
    for given in given {
        let shown = &given.shown;
        let cell = |column: &&str| match *column {
            "participant" => name(given),
            "form" => shown.form.to_string(),
            "order" => shown.order.to_string(),
            "question" => shown.question.clone(),
            "object" => shown.object.clone(),
            "group" => shown.group.clone(),
            "left" => shown.left.clone(),
            "right" => shown.right.clone(),
            "choice" => code(given.pressed).into(),
            "rt_ms" => given.rt_ms.to_string(),
            "role" => format!("{:?}", shown.role).to_lowercase(),
            "stimulus" => shown.stimulus.clone(),
            other => unreachable!("no column {other}"),
        };
        text += &(columns.iter().map(cell).collect::<Vec<_>>().join(",") + "\n");
    }
    text
}

fn code(pressed: Pressed) -> &'static str {
    match pressed {
        Pressed::Left => "L",
        Pressed::Neither => "NP",
        Pressed::Right => "R",
    }
}

/// Everything that somebody was asked, once: the study's questions in its order, then the rest.
fn questions(study: &Study, given: &[Given]) -> Vec<String> {
    let own = study.comparisons.iter().map(|comparison| comparison.question.clone());
    let mut all: Vec<String> = own.collect();
    let beside: BTreeSet<&String> =
        given.iter().map(|g| &g.shown.question).filter(|question| !all.contains(question)).collect();
    all.extend(beside.into_iter().cloned().collect::<Vec<_>>());
    all
}

/// By person, what was pressed for each question.
fn by_person(given: &[Given]) -> BTreeMap<usize, BTreeMap<&str, &Given>> {
    let mut people: BTreeMap<usize, BTreeMap<&str, &Given>> = BTreeMap::new();
    for given in given {
        people.entry(given.person).or_default().insert(&given.shown.question, given);
    }
    people
}

/// One row a person, one column a question.
fn wide(study: &Study, given: &[Given], first: &str, name: impl Fn(&Given) -> String) -> String {
    let questions = questions(study, given);
    let mut text = format!("{first},{}\n", questions.join(","));
    for own in by_person(given).values() {
        let any = own.values().next().expect("somebody who answered");
        text += &name(any);
        if first.ends_with("form") {
            text += &format!(",{}", any.shown.form);
        }
        for question in &questions {
            text += &format!(",{}", own.get(question.as_str()).map_or("", |given| code(given.pressed)));
        }
        text += "\n";
    }
    text
}

/// As Google Forms has it: a time first, questions as texts, answers as words. The study's questions alone, from last to first,
/// and nobody's name.
fn export(study: &Study, given: &[Given]) -> (String, Mapping) {
    let questions: Vec<String> = study.comparisons.iter().rev().map(|c| c.question.clone()).collect();
    let mut text = String::from("Timestamp,Form");
    questions
        .iter()
        .enumerate()
        .for_each(|(i, _)| text += &format!(",\"Pair {}: which, do you think?\"", i + 1));
    text += "\n";
    for (person, own) in by_person(given) {
        let any = own.values().next().expect("somebody who answered");
        text += &format!("2026/11/21 10:{:02}:{:02} AM,{}", person / 60 % 60, person % 60, any.shown.form);
        for question in &questions {
            text += match own.get(question.as_str()).map(|given| given.pressed) {
                None => ",",
                Some(Pressed::Left) => ",The one over there",
                Some(Pressed::Neither) => ",\"Neither, nor\"",
                Some(Pressed::Right) => ",The one right here",
            };
        }
        text += "\n";
    }
    let mut mapping =
        Mapping { questions: Some(questions), first_question_column: Some(3), ..Mapping::default() };
    let words =
        ["The one over there", "Neither, nor", "The one right here"].map(|word| vec![word.to_owned()]);
    mapping.words.declare([&words[0], &words[1], &words[2]]).expect("three words for three answers");
    (text, mapping)
}
