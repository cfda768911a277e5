//! What is known about people, as files.

use crate::anonymity::{self, K};
use crate::export::csv;
use crate::record::About;
use isostudy_design::forms::{AboutEntry, Answers, FormFile};
use isostudy_design::texts::Texts;
use std::collections::BTreeMap;

/// Cells of people: a heading, and a row for each.
type Table = (Vec<String>, Vec<Vec<String>>);

/// Columns that both files have beside the questions.
const PARTICIPANT: &str = "participant";
/// How many of the questions that check attention somebody has passed.
const ATTENTION: &str = "attention";

/// `about.csv`: a line for each person, a column for each question in words of the study's first language; `declined` where somebody
/// would rather not say. `attention` has the values of whoever reads the questions that check it; how many each person has passed is
/// the last column, if there are any.
pub fn about_csv(file: &FormFile, attention: &[(String, String)], all: &BTreeMap<String, About>) -> String {
    let questions: Vec<&AboutEntry> = file.about.iter().collect();
    let (heading, rows) = table(file, &questions, attention, all);
    let heading: Vec<&str> = heading.iter().map(String::as_str).collect();
    csv(&rows, &heading)
}

fn table(
    file: &FormFile,
    questions: &[&AboutEntry],
    attention: &[(String, String)],
    all: &BTreeMap<String, About>,
) -> Table {
    let texts = texts(file);
    let mut heading = vec![PARTICIPANT.to_owned()];
    heading.extend(questions.iter().map(|question| question.id.clone()));
    if !attention.is_empty() {
        heading.push(ATTENTION.into());
    }
    let row = |(name, about): (&String, &About)| {
        let said = |question: &&AboutEntry| {
            about.get(&question.id).map_or_else(String::new, |value| question.said(value, &texts))
        };
        let mut row = vec![name.clone()];
        row.extend(questions.iter().map(said));
        if !attention.is_empty() {
            row.push(passed(attention, about));
        }
        row
    };
    (heading, all.iter().map(row).collect())
}

fn texts(file: &FormFile) -> Texts {
    file.spoken().into_iter().next().map(|first| first.texts).unwrap_or_default()
}

/// `2 of 3`: those that were answered as by somebody who reads them, of all.
fn passed(attention: &[(String, String)], about: &About) -> String {
    let passed = attention.iter().filter(|(id, value)| about.get(id) == Some(value)).count();
    format!("{passed} of {}", attention.len())
}

/// What is known about people, for others: no words of their own, numbers as ranges, and cells merged until each combination is
/// shared by [`K`] people. `names` tells what each participant is called there. Returns the file, and a sentence on what was done.
pub fn shared_about_csv(
    file: &FormFile,
    attention: &[(String, String)],
    all: &BTreeMap<String, About>,
    names: &BTreeMap<String, String>,
) -> (String, String) {
    let questions: Vec<&AboutEntry> = file.about.iter().filter(|question| !question.is_free()).collect();
    let renamed =
        names.iter().map(|(name, shared)| (shared.clone(), all.get(name).cloned().unwrap_or_default()));
    let renamed: BTreeMap<String, About> = renamed.collect();
    let (heading, mut rows) = table(file, &questions, attention, &renamed);
    for (column, question) in (1..).zip(&questions) {
        if matches!(question.answers, Answers::Number { .. }) {
            let numbers: Vec<Option<f64>> = rows.iter().map(|row| row[column].parse().ok()).collect();
            for (row, range) in rows.iter_mut().zip(anonymity::ranges(&numbers, K)) {
                row[column] = range.unwrap_or_else(|| row[column].clone());
            }
        }
    }
    let mut cells: Vec<Vec<String>> = rows.iter().map(|row| row[1..].to_vec()).collect();
    let merged = anonymity::merge(&mut cells, K);
    for (row, cells) in rows.iter_mut().zip(cells) {
        row[1..].clone_from_slice(&cells);
    }
    let total = rows.len() * (heading.len() - 1);
    let said = format!(
        "Each combination of answers in it is shared by at least {K} people: {merged} of {total} cells are `{}`. Numbers are ranges.",
        anonymity::MERGED
    );
    let said = if rows.len() < K {
        format!("There are fewer than {K} people: all cells are `{}`.", anonymity::MERGED)
    } else {
        said
    };
    let heading: Vec<&str> = heading.iter().map(String::as_str).collect();
    (csv(&rows, &heading), said)
}

#[cfg(test)]
mod tests;
