//! Names that participants can read.

use super::{Fault, Rule};
use crate::config::{FormsSection, ShownNames};
use crate::method::ConfigurationId;
use crate::study::Study;

/// What tells what is shown, in what participants read: ids of questions, and texts.
///
/// Texts are searched for whole words, capitals or not: ids of configurations and names of methods and levels (but for "none") in
/// all, ids of methods in the short ones only: some of them are words, which prose is full of.
pub(super) fn names(study: &Study, section: &FormsSection) -> Vec<Fault> {
    let mut faults = Vec::new();
    let mut fault = |place: String, evidence: String| {
        faults.push(Fault { rule: Rule::NamesReveal, place, evidence });
    };
    if section.names == ShownNames::ConfigurationIds {
        let ids: Vec<String> = study.configurations.iter().map(|c| c.id.to_string()).collect();
        let evidence = format!("{} ids can be read, such as {}", ids.len(), ids[ids.len() - 1]);
        fault("forms.names".into(), evidence);
    }
    for comparison in &study.comparisons {
        let tells = |id: &&ConfigurationId| comparison.question.contains(&id.to_string());
        if let Some(id) = [&comparison.left, &comparison.right].into_iter().find(tells) {
            fault(format!("question {}", comparison.question), format!("its id names {id}"));
        }
    }
    let mut told: Vec<String> = study.configurations.iter().map(|c| c.id.to_string()).collect();
    let levels = study.factors.iter().flat_map(|factor| &factor.levels);
    told.extend(levels.map(|level| level.label.clone()).filter(|label| label != "none"));
    let codes: Vec<String> = study.method_ids().iter().map(ToString::to_string).collect();
    let short = |key: &str, text: &str| (key.to_owned(), text.to_owned(), true);
    let mut texts =
        vec![short("study.title", &study.file.study.title), short("forms.prompt", &section.prompt)];
    for (i, choice) in section.choices.iter().enumerate() {
        texts.push(short(&format!("forms.choices[{i}]"), choice));
    }
    for (key, text) in [("forms.consent", &section.consent), ("forms.instructions", &section.instructions)] {
        texts.push((key.into(), text.clone(), false));
    }
    for (lang, own) in &study.texts {
        for (key, text) in own {
            let short = !["consent", "instructions"].contains(&key.as_str());
            texts.push((format!("forms.texts.{lang}.{key}"), text.clone(), short));
        }
    }
    for (key, text, short) in texts {
        let words = words(&text);
        let names = told.iter().chain(codes.iter().filter(|_| short));
        if let Some(name) = names.into_iter().find(|name| holds(&words, name)) {
            fault(key, format!("\"{text}\" names {name}"));
        }
    }
    faults
}

/// The words of a text in small letters; underscores and digits belong to them.
fn words(text: &str) -> Vec<String> {
    let parts = text.split(|letter: char| !(letter.is_alphanumeric() || letter == '_'));
    parts.filter(|word| !word.is_empty()).map(str::to_lowercase).collect()
}

/// Whether a name's words follow each other in these; a hyphen or a space between them is the same.
fn holds(words: &[String], name: &str) -> bool {
    let name = self::words(name);
    words.windows(name.len()).any(|window| window == name)
}
