//! What people's forms call the three answers.

use crate::choice::{Choice, Step};
use isostudy_design::config::Way;
use std::collections::HashMap;

/// Words for left, no preference and right, by language; a study declares its own on top. Codes such as 1, 2, 3 are not
/// among them: which is which only the form's author knows.
const BUILT_IN: [(&str, [&[&str]; 3]); 8] = [
    ("codes", [&["l", "left"], &["np", "none"], &["r", "right"]]),
    (
        "en",
        [
            &[
                "left one",
                "the left one",
                "the left",
                "left side",
                "left animation",
                "left image",
                "left video",
            ],
            &[
                "no preference",
                "neither",
                "no difference",
                "equal",
                "both equal",
                "both are equal",
                "both are equally good",
                "the same",
                "tie",
                "i have no preference",
                "cannot decide",
                "can't decide",
                "can't tell",
            ],
            &[
                "right one",
                "the right one",
                "the right",
                "right side",
                "right animation",
                "right image",
                "right video",
            ],
        ],
    ),
    (
        "de",
        [
            &["links", "linke", "das linke", "die linke", "linke seite", "linke animation", "linkes bild"],
            &[
                "keine",
                "keine präferenz",
                "kein unterschied",
                "keins von beiden",
                "beide gleich",
                "gleich",
                "unentschieden",
            ],
            &[
                "rechts",
                "rechte",
                "das rechte",
                "die rechte",
                "rechte seite",
                "rechte animation",
                "rechtes bild",
            ],
        ],
    ),
    (
        "fr",
        [
            &["gauche", "à gauche", "celle de gauche", "celui de gauche", "l'animation de gauche"],
            &[
                "aucune",
                "aucune préférence",
                "pas de préférence",
                "sans préférence",
                "aucune différence",
                "les deux se valent",
            ],
            &["droite", "à droite", "celle de droite", "celui de droite", "l'animation de droite"],
        ],
    ),
    (
        "es",
        [
            &["izquierda", "la izquierda", "la de la izquierda", "a la izquierda", "izquierdo"],
            &[
                "ninguna",
                "sin preferencia",
                "ninguna preferencia",
                "no tengo preferencia",
                "ninguna diferencia",
            ],
            &["derecha", "la derecha", "la de la derecha", "a la derecha", "derecho"],
        ],
    ),
    (
        "nl",
        [
            &["linker", "de linker", "linkse", "de linkse", "linkerkant"],
            &["geen", "geen voorkeur", "geen verschil", "geen van beide"],
            &["rechter", "de rechter", "rechtse", "de rechtse", "rechterkant"],
        ],
    ),
    (
        "it",
        [
            &["sinistra", "a sinistra", "quella a sinistra", "quella di sinistra"],
            &["nessuna", "nessuna preferenza", "nessuna differenza", "senza preferenza"],
            &["destra", "a destra", "quella a destra", "quella di destra"],
        ],
    ),
    (
        "pt",
        [
            &["esquerda", "à esquerda", "a da esquerda", "a esquerda"],
            &["nenhuma", "sem preferência", "nenhuma preferência", "nenhuma diferença"],
            &["direita", "à direita", "a da direita", "a direita"],
        ],
    ),
];

/// Words and the choices that they mean.
#[derive(Debug, Clone)]
pub struct Words {
    known: HashMap<String, Step>,
    declared: usize,
    /// A word that stands for no answer.
    blank: Option<String>,
}

impl Default for Words {
    fn default() -> Self {
        let mut known = HashMap::new();
        for (_, lists) in BUILT_IN {
            for (choice, words) in Choice::ALL.into_iter().zip(lists) {
                known.extend(words.iter().map(|word| (word.to_string(), choice.into())));
            }
        }
        for step in Step::ALL.into_iter().filter(|step| step.much) {
            known.extend([step.code(), step.name()].map(|word| (normalise(word), step)));
        }
        Self { known, declared: 0, blank: None }
    }
}

impl Words {
    /// Adds words for left, no preference and right; they overrule built-in ones.
    ///
    /// # Errors
    /// The word that stands for two choices.
    pub fn declare(&mut self, lists: [&[String]; 3]) -> Result<(), String> {
        let mut own: HashMap<String, Step> = HashMap::new();
        for (choice, words) in Choice::ALL.into_iter().zip(lists) {
            for word in words {
                if own.insert(normalise(word), choice.into()).is_some_and(|other| other.choice != choice) {
                    return Err(word.clone());
                }
            }
        }
        self.declared += own.len();
        self.known.extend(own);
        Ok(())
    }

    /// Makes a word stand for a question left unanswered.
    pub(crate) fn declare_blank(&mut self, word: &str) {
        self.blank = Some(normalise(word));
    }

    /// Whether a cell is R's mark for a missing value, `NA` in any case, unless that is declared to be an answer.
    pub(crate) fn is_missing(&self, cell: &str) -> bool {
        is_na(cell) && !self.known.contains_key("na")
    }

    /// Whether a cell says that there is no answer.
    pub(crate) fn is_blank(&self, cell: &str) -> bool {
        crate::decode::records::is_blank(cell)
            || self.is_missing(cell)
            || self.blank.as_ref().is_some_and(|word| cell.len() < 99 && normalise(cell) == *word)
    }

    /// The choice that a cell means, of five steps the side: see [`Words::step`].
    pub fn choice(&self, cell: &str) -> Option<Choice> {
        self.step(cell).map(|step| step.choice)
    }

    /// The answer that a cell means. Case, runs of space, non-breaking space, curly quotes and a trailing ` *` do not matter.
    pub fn step(&self, cell: &str) -> Option<Step> {
        // No word is as long as this, and a cell may be.
        const LONGEST: usize = 4096;
        if cell.len() > LONGEST { None } else { self.known.get(&normalise(cell)).copied() }
    }

    /// What is known, for messages; of a study, in its way to ask.
    pub(crate) fn summary(&self, way: Option<Way>) -> String {
        let languages: Vec<&str> = BUILT_IN[1..].iter().map(|(language, _)| *language).collect();
        let declared = match self.declared {
            0 => String::new(),
            n => format!(", {n} declared"),
        };
        let steps = Step::ALL.into_iter().filter(|&step| match way {
            Some(way) => is_of(step, way),
            None => !step.much,
        });
        let (codes, names): (Vec<&str>, Vec<&str>) = steps.map(|step| (step.code(), step.name())).unzip();
        let (codes, names) = (codes.join(", "), names.join(", "));
        format!("{codes}, {names}, words in {}{declared}", languages.join(", "))
    }
}

/// Whether people who are asked in this way can answer so.
pub(crate) fn is_of(step: Step, way: Way) -> bool {
    way.answers().iter().any(|of| of.code == step.code())
}

/// Whether a cell holds what R writes for a missing value.
pub(crate) fn is_na(cell: &str) -> bool {
    crate::decode::records::trim(cell).eq_ignore_ascii_case("na")
}

/// A text as it is compared: lower case, one space between words, straight quotes, no mark of a compulsory question.
pub fn normalise(text: &str) -> String {
    let mut plain = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '\u{200b}' | '\u{2060}' | '\u{feff}' | '\u{ad}' => {}
            '‘' | '’' | '‚' | '‛' | '´' | '`' => plain.push('\''),
            '“' | '”' | '„' | '‟' | '«' | '»' => plain.push('"'),
            c if c.is_whitespace() => {
                if !plain.is_empty() && !plain.ends_with(' ') {
                    plain.push(' ');
                }
            }
            c => plain.extend(c.to_lowercase()),
        }
    }
    let plain = plain.trim_end();
    plain.strip_suffix(" *").unwrap_or(plain).trim_end().to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_word_means_two_things() {
        let mut seen: HashMap<String, Choice> = HashMap::new();
        for (language, lists) in BUILT_IN {
            for (choice, words) in Choice::ALL.into_iter().zip(lists) {
                for word in words {
                    assert_eq!(normalise(word), **word, "{language}");
                    let before = seen.insert((*word).to_owned(), choice);
                    assert!(before.is_none_or(|other| other == choice), "{word}");
                }
            }
        }
    }

    #[test]
    fn cells_are_read_as_people_write_them() {
        let words = Words::default();
        for (cell, choice) in [
            ("L", Choice::Left),
            ("np", Choice::NoPreference),
            (" Right\u{a0}", Choice::Right),
            ("LINKS", Choice::Left),
            ("Can’t  decide", Choice::NoPreference),
            ("À gauche *", Choice::Left),
            ("Sem preferência", Choice::NoPreference),
            ("\u{feff}destra", Choice::Right),
        ] {
            assert_eq!(words.choice(cell), Some(choice), "{cell}");
        }
        for cell in ["", "1", "A", "vlevo", "left right", &"left ".repeat(10_000)] {
            assert_eq!(words.choice(cell), None, "{cell}");
        }
        for (cell, value) in [("LL", 2), ("l", 1), ("none", 0), ("R", -1), (" rr ", -2), ("Much_Right", -2)] {
            assert_eq!(words.step(cell).map(Step::value), Some(value), "{cell}");
        }
    }

    #[test]
    fn na_is_missing_unless_it_is_declared() {
        let mut words = Words::default();
        assert!(["NA", "na", " Na "].into_iter().all(|cell| words.is_blank(cell) && words.is_missing(cell)));
        assert!(["NaN", "N/A", "NULL", "n a", "-"].into_iter().all(|cell| !words.is_blank(cell)));
        words.declare([&[], &["NA".to_owned()], &[]]).unwrap();
        assert!(!words.is_blank("NA") && words.choice("NA") == Some(Choice::NoPreference));
    }

    #[test]
    fn declared_words_come_first_and_may_not_contradict_each_other() {
        let mut words = Words::default();
        let list = |words: &[&str]| words.iter().map(|word| word.to_string()).collect::<Vec<_>>();
        let (left, none, right) = (list(&["Vlevo", "R"]), list(&["Nic"]), list(&["Vpravo"]));
        words.declare([&left, &none, &right]).unwrap();
        assert_eq!(words.choice("vlevo"), Some(Choice::Left));
        assert_eq!(words.choice("R"), Some(Choice::Left));
        assert_eq!(words.declare([&left, &none, &list(&["VLEVO"])]), Err("VLEVO".to_owned()));
    }
}
