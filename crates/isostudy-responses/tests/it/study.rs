//! Three questions about three items, and short forms of what was read about them.

use isostudy_responses::{Fault, Mapping, Plan, PlannedPair, ReadError, Reading, Words};
use std::path::{Path, PathBuf};

pub(crate) fn plan() -> Plan {
    let pair = |question: &str, left: &str, right: &str| PlannedPair {
        question: question.into(),
        left: left.into(),
        right: right.into(),
        object: String::new(),
        group: String::new(),
    };
    Plan::of_pairs(&[pair("Q1", "a", "b"), pair("Q2", "a", "c"), pair("Q3", "b", "c")]).unwrap()
}

pub(crate) fn export(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/exports").join(name)
}

pub(crate) fn read(name: &str, mapping: &Mapping) -> Reading {
    isostudy_responses::read(&export(name), Some(&plan()), mapping).unwrap_or_else(|error| panic!("{error}"))
}

/// Text read for the three questions.
pub(crate) fn parse(text: &str) -> Result<Reading, Fault> {
    parse_with(text, &Mapping::default())
}

pub(crate) fn parse_with(text: &str, mapping: &Mapping) -> Result<Reading, Fault> {
    isostudy_responses::parse(text.as_bytes(), Path::new("x.csv"), Some(&plan()), mapping).map_err(fault)
}

/// Text read without a plan.
pub(crate) fn open(text: &str) -> Result<Reading, Fault> {
    isostudy_responses::parse(text.as_bytes(), Path::new("x.csv"), None, &Mapping::default()).map_err(fault)
}

/// What is wrong with a file that could be opened. How it is worded `messages.rs` says.
pub(crate) fn fault(error: ReadError) -> Fault {
    match error {
        ReadError::Content { fault, .. } => *fault,
        other => panic!("{other}"),
    }
}

/// The only cell that is no answer: row, column, question and what it says.
pub(crate) fn only_unknown(fault: &Fault) -> (u64, usize, &str, &str) {
    match fault {
        Fault::UnknownAnswers { cells, .. } if cells.len() == 1 => {
            (cells[0].row, cells[0].column, &cells[0].question, &cells[0].raw)
        }
        other => panic!("{other}"),
    }
}

/// The cell that will not do: row, column, the column's name and what it says.
pub(crate) fn bad_cell(fault: &Fault) -> (u64, usize, &str, &str) {
    match fault {
        Fault::Cell { row, column, name, cell, .. } => (*row, *column, name, cell),
        other => panic!("{other}"),
    }
}

pub(crate) fn synonyms(left: &str, none: &str, right: &str) -> Mapping {
    let [left, none, right] = [left, none, right].map(|word| vec![word.to_owned()]);
    let mut words = Words::default();
    words.declare([&left, &none, &right]).unwrap();
    Mapping { words, ..Mapping::default() }
}

/// One text an answer: participant, question, left, what was chosen, right.
pub(crate) fn said(reading: &Reading) -> Vec<String> {
    let answers = &reading.responses;
    let item = |item: u32| &answers.items[item as usize];
    let sign = |choice| match choice {
        isostudy_responses::Choice::Left => '<',
        isostudy_responses::Choice::NoPreference => '=',
        isostudy_responses::Choice::Right => '>',
    };
    let one = |a: &isostudy_responses::Answer| {
        let who = &answers.participants[a.participant as usize].id;
        let question = &answers.questions[a.question as usize].id;
        format!("{who} {question} {}{}{}", item(a.left), sign(a.choice), item(a.right))
    };
    answers.answers.iter().map(one).collect()
}

/// One text a remark: place, kind, and the numbers and ids in what is said. The words are in `messages.txt`.
pub(crate) fn remarks(reading: &Reading) -> Vec<String> {
    let one = |r: &isostudy_responses::Remark| {
        let column = r.column.map_or(String::new(), |column| format!(":{column}"));
        let words = r.action.split(|c: char| !(c.is_alphanumeric() || c == '_' || c == '-'));
        let told = words.filter(|word| word.contains(|c: char| c.is_ascii_digit()));
        let told: String = told.map(|word| format!(" {word}")).collect();
        format!("{}{column} {}{told}", r.row, r.kind.name())
    };
    reading.report.remarks.iter().map(one).collect()
}
