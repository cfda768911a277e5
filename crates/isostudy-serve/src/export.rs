//! Answers joined with the key: the long format that `isostudy analyse` reads.

use crate::record::Answer;
use crate::screen;
use isostudy_design::config::Way;
use isostudy_design::forms::{ANY_FORM, KeyEntry};
use serde::Serialize;
use std::collections::HashMap;

/// An answer and whose it is.
#[derive(Debug, Clone, PartialEq)]
pub struct Given {
    /// The participant's name in the answers: random, and never an identifier of a panel.
    pub participant: String,
    /// The form's number, from 1.
    pub form: usize,
    /// What was answered.
    pub answer: Answer,
}

/// A line of the long format.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Line<'a> {
    participant: &'a str,
    form: usize,
    order: u32,
    question: &'a str,
    object: &'a str,
    group: &'a str,
    sides: Vec<&'a str>,
    choice: &'static str,
    rt_ms: u32,
    role: &'a isostudy_design::forms::Role,
    stimulus: &'a str,
    screen: [String; screen::COLUMNS.len()],
}

/// An answer that the key does not fit.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error(
    "participant {participant}, form {form}, place {order}: the study shows {shown} there, the answer is to {stimulus}; was the study file changed?"
)]
pub struct OtherStudy {
    participant: String,
    form: usize,
    order: u32,
    shown: String,
    stimulus: String,
}

/// Each answer with what its key says was shown, in the order given.
///
/// # Errors
/// The first answer to something that the key does not know.
pub fn lines<'a>(given: &'a [Given], key: &'a [KeyEntry]) -> Result<Vec<Line<'a>>, OtherStudy> {
    let known = Key::of(key);
    let line = |given: &'a Given| {
        let Given { participant, form, answer } = given;
        let entry = known.at(*form, answer.order);
        match known.entry(*form, answer.order, &answer.stimulus) {
            None => Err(OtherStudy {
                participant: participant.clone(),
                form: *form,
                order: answer.order,
                shown: entry.map_or_else(|| "nothing".into(), |entry| entry.stimulus.clone()),
                stimulus: answer.stimulus.clone(),
            }),
            Some(entry) => Ok(Line {
                participant,
                form: *form,
                order: answer.order,
                question: &entry.question,
                object: &entry.object,
                group: &entry.group,
                sides: match entry.shown.as_str() {
                    "" => vec![&entry.left, &entry.right],
                    shown => vec![shown],
                },
                choice: answer.choice.code(),
                rt_ms: answer.rt_ms,
                role: &entry.role,
                stimulus: &answer.stimulus,
                screen: screen::cells(answer.screen.as_ref()),
            }),
        }
    };
    given.iter().map(line).collect()
}

/// The key, to look things up in.
pub(crate) struct Key<'a> {
    places: HashMap<(usize, usize), &'a KeyEntry>,
    /// What may be shown in any form, by code name.
    anywhere: HashMap<&'a str, &'a KeyEntry>,
}

impl<'a> Key<'a> {
    pub(crate) fn of(key: &'a [KeyEntry]) -> Self {
        let (anywhere, placed): (Vec<&KeyEntry>, Vec<&KeyEntry>) =
            key.iter().partition(|entry| entry.form == ANY_FORM);
        Self {
            places: placed.into_iter().map(|entry| ((entry.form, entry.order), entry)).collect(),
            anywhere: anywhere.into_iter().map(|entry| (entry.stimulus.as_str(), entry)).collect(),
        }
    }

    /// What a form plans for a place.
    fn at(&self, form: usize, order: u32) -> Option<&'a KeyEntry> {
        self.places.get(&(form, order as usize)).copied()
    }

    /// What the stimulus of an answer shows; `None` if the study shows it to nobody there.
    pub(crate) fn entry(&self, form: usize, order: u32, stimulus: &str) -> Option<&'a KeyEntry> {
        let planned = self.at(form, order).filter(|entry| entry.stimulus == stimulus);
        planned.or_else(|| self.anywhere.get(stimulus).copied())
    }
}

/// Lines as CSV with a header, `\n` at the ends, and no formula to a spreadsheet: names come from files that a participant has had
/// in hand.
pub fn csv<T: Serialize>(lines: &[T], header: &[&str]) -> String {
    let writer = || csv::WriterBuilder::new().has_headers(false).from_writer(Vec::new());
    let write = || -> Result<String, Box<dyn std::error::Error>> {
        let (mut plain, mut safe) = (writer(), writer());
        lines.iter().try_for_each(|line| plain.serialize(line))?;
        safe.write_record(header)?;
        let plain = plain.into_inner()?;
        for record in csv::ReaderBuilder::new().has_headers(false).from_reader(&plain[..]).records() {
            safe.write_record(record?.iter().map(|cell| isostudy_table::formula::escape(cell).into_owned()))?;
        }
        Ok(String::from_utf8(safe.into_inner()?)?)
    };
    write().expect("memory takes everything, and texts are UTF-8")
}

/// The columns of [`Line`]: of pairs both sides, else all that was shown.
pub fn header(way: Way) -> Vec<&'static str> {
    let all = isostudy_responses::LONG_WRITTEN_WITH_SCREENS.into_iter();
    match way.is_of_pairs() {
        true => all.collect(),
        false => all
            .filter(|name| *name != "left")
            .map(|name| if name == "right" { SHOWN } else { name })
            .collect(),
    }
}

/// The column of what was shown, where people do not compare two.
const SHOWN: &str = isostudy_responses::SHOWN_COLUMN;

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use isostudy_design::forms::FormFile;

    /// A study that shows nothing, in English.
    pub(crate) fn empty_file() -> FormFile {
        FormFile {
            schema: 1,
            study: "trial".into(),
            title: "Trial".into(),
            prompt: "Which?".into(),
            way: isostudy_design::config::Way::Pairs,
            choices: ["Left", "None", "Right"].map(Into::into).into(),
            choices_stacked: None,
            steps: 7,
            ends: None,
            none: false,
            min_surface_px: None,
            languages: vec!["en".into()],
            texts: std::collections::BTreeMap::new(),
            consent: "Yes".into(),
            instructions: "Look".into(),
            about: Vec::new(),
            contact: None,
            ethics: None,
            least_age: None,
            retention_days: None,
            go_back: false,
            stimulus: Default::default(),
            loop_ms: 100,
            page_scale: 1,
            forms: Vec::new(),
        }
    }

    #[test]
    fn nothing_becomes_a_formula_and_everything_comes_back() {
        let names = ["=1+1", "+1", "-2", "@SUM(A1)", "'quoted'", "plain", "a,b", "two\nlines", "\"q\""];
        let rows: Vec<_> = names.iter().map(|name| (name, 812)).collect();
        let text = csv(&rows, &["participant", "rt_ms"]);
        assert!(text.starts_with(
            "participant,rt_ms\n'=1+1,812\n'+1,812\n'-2,812\n'@SUM(A1),812\n''quoted',812\nplain,812\n"
        ));
        let mut reader = csv::Reader::from_reader(text.as_bytes());
        let back: Vec<String> = reader
            .records()
            .map(|row| isostudy_table::formula::unescape(&row.unwrap()[0]).to_owned())
            .collect();
        assert_eq!(back, names);
    }
}
