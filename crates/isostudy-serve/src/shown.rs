//! What was shown to whom, as JSON: for a researcher who has to answer for it.

use crate::export::{Given, Key};
use crate::journal::Departures;
use crate::screen::Screen;
use isostudy_design::forms::{FormFile, KeyEntry, Language};
use serde::Serialize;
use std::collections::BTreeMap;

#[derive(Serialize)]
struct Shown<'a> {
    schema: u32,
    study: &'a str,
    /// Digest of the forms.
    forms: &'a str,
    departures: Departures,
    contact: Option<&'a str>,
    ethics: Option<&'a str>,
    least_age: Option<u32>,
    retention_days: Option<u32>,
    /// What the page said, in each language.
    languages: Vec<Language>,
    people: Vec<Person<'a>>,
}

#[derive(Serialize)]
struct Person<'a> {
    participant: &'a str,
    form: usize,
    language: &'a str,
    pairs: Vec<Pair<'a>>,
}

/// A pair that was answered; the key's words where it knows the pair.
#[derive(Serialize)]
struct Pair<'a> {
    order: u32,
    stimulus: &'a str,
    question: Option<&'a str>,
    object: Option<&'a str>,
    left: Option<&'a str>,
    right: Option<&'a str>,
    /// Where people do not compare two: all that was shown.
    #[serde(skip_serializing_if = "Option::is_none")]
    shown: Option<&'a str>,
    changed: u32,
    screen: Option<Screen>,
}

/// Every pair that somebody answered, with what stood on which side and on what screen, and all words of the page. What was chosen is
/// not in it. `languages` has those of participants by name; who has none read the first.
///
/// # Panics
/// Never: names and numbers can be written.
pub fn json<'a>(
    file: &'a FormFile,
    digest: &'a str,
    given: &'a [Given],
    key: &'a [KeyEntry],
    languages: &'a BTreeMap<String, String>,
    departures: Departures,
) -> String {
    let known = Key::of(key);
    let first = file.languages.first().map_or("en", String::as_str);
    let pair = |given: &'a Given| -> Option<&'a KeyEntry> {
        known.entry(given.form, given.answer.order, &given.answer.stimulus)
    };
    let person = |of: &'a [Given]| {
        let pairs = of.iter().map(|one| {
            let shown = pair(one);
            Pair {
                order: one.answer.order,
                stimulus: &one.answer.stimulus,
                question: shown.map(|entry| entry.question.as_str()),
                object: shown.map(|entry| entry.object.as_str()),
                left: shown.map(|entry| entry.left.as_str()).filter(|side| !side.is_empty()),
                right: shown.map(|entry| entry.right.as_str()).filter(|side| !side.is_empty()),
                shown: shown.map(|entry| entry.shown.as_str()).filter(|all| !all.is_empty()),
                changed: one.answer.change,
                screen: one.answer.screen,
            }
        });
        (of[0].form, pairs.collect::<Vec<_>>())
    };
    let people = given.chunk_by(|a, b| a.participant == b.participant).map(|of| {
        let (form, pairs) = person(of);
        let participant = of[0].participant.as_str();
        let language = languages.get(participant).map_or(first, String::as_str);
        Person { participant, form, language, pairs }
    });
    let shown = Shown {
        schema: 1,
        study: &file.study,
        forms: digest,
        departures,
        contact: file.contact.as_deref(),
        ethics: file.ethics.as_deref(),
        least_age: file.least_age,
        retention_days: file.retention_days,
        languages: file.spoken(),
        people: people.collect(),
    };
    serde_json::to_string_pretty(&shown).expect("names and numbers alone") + "\n"
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::record::{Answer, Choice};
    use isostudy_design::forms::Role;

    #[test]
    fn everybody_has_what_stood_on_each_side_and_no_choice() {
        let given = |participant: &str, order: u32| Given {
            participant: participant.into(),
            form: 2,
            answer: Answer {
                order,
                stimulus: format!("q{order}"),
                choice: Choice::R,
                rt_ms: 7,
                screen: None,
                change: order - 2,
            },
        };
        let key = [2, 3].map(|order: usize| KeyEntry {
            form: 2,
            order,
            stimulus: "q2".into(),
            role: Role::Comparison,
            question: "Q1".into(),
            object: "ball".into(),
            group: "g".into(),
            left: "s_a".into(),
            right: "s_b".into(),
            shown: String::new(),
        });
        let file = crate::export::tests::empty_file();
        let languages = [("b".to_owned(), "ar".to_owned())].into();
        let departures = Departures { withdrawn: 3, ..Departures::default() };
        let given = [given("a", 2), given("a", 3), given("b", 2)];
        let text = json(&file, "d", &given, &key, &languages, departures);
        let shown: serde_json::Value = serde_json::from_str(&text).unwrap();
        assert_eq!(
            (&shown["departures"]["withdrawn"], &shown["people"][0]["language"]),
            (&3.into(), &"en".into())
        );
        assert_eq!(shown["people"][1]["language"], "ar");
        let pairs = &shown["people"][0]["pairs"];
        assert_eq!(
            (&pairs[0]["left"], &pairs[0]["right"], &pairs[0]["changed"]),
            (&"s_a".into(), &"s_b".into(), &0.into())
        );
        // The key shows something else there.
        assert_eq!((&pairs[1]["left"], &pairs[1]["changed"]), (&serde_json::Value::Null, &1.into()));
        assert_eq!(shown["languages"][0]["texts"]["go_on"], "Go on");
        let keys: Vec<&String> = pairs[0].as_object().unwrap().keys().collect();
        assert_eq!(keys, ["changed", "left", "object", "order", "question", "right", "screen", "stimulus"]);
    }
}
