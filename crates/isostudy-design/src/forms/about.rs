//! Questions about the person, as the page and the server need them.

use crate::config::{AboutKind, AboutSection, AboutTime};
use crate::texts::Texts;
use serde::{Deserialize, Serialize};

/// The id of the free comment among answers about the person.
pub const COMMENT: &str = "comment";

/// Most characters of a short text, and of the comment.
const LONGEST: [usize; 2] = [100, 800];

/// What an answer may be.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", tag = "kind")]
pub enum Answers {
    /// One of so many options, or any of them.
    Options {
        /// How many there are.
        count: u32,
        /// Whether several may be chosen.
        several: bool,
    },
    /// A number in a range.
    Number {
        /// The least.
        from: f64,
        /// The largest.
        to: f64,
    },
    /// A whole step.
    Scale {
        /// The first.
        from: u32,
        /// The last.
        to: u32,
    },
    /// Words.
    Text {
        /// Most characters.
        longest: u32,
    },
}

/// A question about the person. Its words are texts of the page: the question under [`text`](Self::text), its options and ends under
/// the same with `_1`, `_2` and so on, and `_low` and `_high`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AboutEntry {
    /// Unique; the column in the exports.
    pub id: String,
    /// Key of its words.
    pub text: String,
    /// What may be answered.
    pub answers: Answers,
    /// When it is asked.
    pub when: AboutTime,
    /// Whether it may be passed over.
    pub optional: bool,
    /// Options, counted from 1, whose people are not asked any further.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub screens_out: Vec<u32>,
}

// Ends of ranges are checked numbers, and none of them is NaN.
impl Eq for AboutEntry {}

impl AboutEntry {
    /// The question of a section, which was checked.
    pub(crate) fn of(section: &AboutSection) -> Self {
        let (from, to) = (section.from.unwrap_or(1.0), section.to.unwrap_or(7.0));
        let options = |several| Answers::Options { count: section.options.len() as u32, several };
        let (answers, text) = match section.kind {
            AboutKind::Single => (options(false), None),
            AboutKind::Multiple => (options(true), None),
            AboutKind::Number => (Answers::Number { from, to }, None),
            AboutKind::Scale => (Answers::Scale { from: from as u32, to: to as u32 }, None),
            AboutKind::Text => (Answers::Text { longest: LONGEST[0] as u32 }, None),
            AboutKind::ColourVision => (SHIPPED, Some("colour_vision")),
            AboutKind::ScreenSize => (SHIPPED, Some("screen_size")),
        };
        Self {
            id: section.id.clone(),
            text: text.map_or_else(|| key(&section.id), str::to_owned),
            answers,
            when: section.when,
            optional: section.optional,
            screens_out: section.screens_out.clone(),
        }
    }

    /// The free comment, asked last.
    pub(crate) fn comment() -> Self {
        Self {
            id: COMMENT.into(),
            text: COMMENT.into(),
            answers: Answers::Text { longest: LONGEST[1] as u32 },
            when: AboutTime::After,
            optional: true,
            screens_out: Vec::new(),
        }
    }

    /// Whether the answers can be anything: what nobody can make anonymous by merging.
    pub fn is_free(&self) -> bool {
        matches!(self.answers, Answers::Text { .. })
    }

    /// Options or steps of a value, counted as the page shows them; none of a number or a text.
    pub fn chosen(&self, value: &str) -> Vec<u32> {
        match self.answers {
            Answers::Options { .. } | Answers::Scale { .. } => {
                value.split(';').filter_map(|part| part.parse().ok()).collect()
            }
            Answers::Number { .. } | Answers::Text { .. } => Vec::new(),
        }
    }

    /// Whether a value can be an answer: empty for "rather not say", else options as `2` or `1;3`, a step, a number, or a text.
    pub fn takes(&self, value: &str) -> bool {
        if value.is_empty() {
            return true;
        }
        match self.answers {
            Answers::Options { count, several } => {
                let chosen = self.chosen(value);
                let is_written = chosen.iter().map(u32::to_string).collect::<Vec<_>>().join(";") == value;
                is_written
                    && chosen.is_sorted_by(|a, b| a < b)
                    && chosen.iter().all(|option| (1..=count).contains(option))
                    && (several || chosen.len() == 1)
            }
            Answers::Scale { from, to } => value
                .parse::<u32>()
                .is_ok_and(|step| step.to_string() == value && (from..=to).contains(&step)),
            Answers::Number { from, to } => {
                let plain = value.bytes().all(|b| b.is_ascii_digit() || b == b'.' || b == b'-');
                plain
                    && value.len() <= 20
                    && value.parse::<f64>().is_ok_and(|number| (from..=to).contains(&number))
            }
            Answers::Text { longest } => {
                let is_plain = |letter: char| !letter.is_control() || letter == '\n';
                value.chars().count() <= longest as usize && value.chars().all(is_plain)
            }
        }
    }

    /// A value in words: the options' texts for their numbers, `declined` for nothing.
    pub fn said(&self, value: &str, texts: &Texts) -> String {
        match self.answers {
            _ if value.is_empty() => "declined".into(),
            Answers::Options { .. } => {
                let text =
                    |option: &u32| texts.get(&format!("{}_{option}", self.text)).cloned().unwrap_or_default();
                self.chosen(value).iter().map(text).collect::<Vec<_>>().join("; ")
            }
            _ => value.into(),
        }
    }
}

/// Options on colour vision and on screens.
const SHIPPED: Answers = Answers::Options { count: 4, several: false };

/// The key of a study's own question.
fn key(id: &str) -> String {
    format!("about_{id}")
}

/// The texts of a section in the study's first language.
pub(crate) fn texts(section: &AboutSection) -> Texts {
    let key = key(&section.id);
    let mut texts: Texts = section.ask.iter().map(|ask| (key.clone(), ask.clone())).collect();
    texts.extend((1..).zip(&section.options).map(|(i, option)| (format!("{key}_{i}"), option.clone())));
    let ends = section.ends.iter().flatten().zip(["low", "high"]);
    texts.extend(ends.map(|(text, end)| (format!("{key}_{end}"), text.clone())));
    texts
}

#[cfg(test)]
mod tests {
    use super::*;

    fn section(kind: AboutKind) -> AboutSection {
        AboutSection {
            id: "work".into(),
            kind,
            ask: Some("What?".into()),
            options: ["a", "b", "c"].map(Into::into).into(),
            from: Some(2.0),
            to: Some(5.0),
            ends: Some(["no", "yes"].map(Into::into)),
            when: AboutTime::Before,
            optional: false,
            expects: None,
            screens_out: Vec::new(),
            most: Vec::new(),
        }
    }

    #[test]
    fn each_kind_takes_its_answers_and_no_others() {
        let long = "x".repeat(101);
        for (kind, right, wrong) in [
            (AboutKind::Single, &["", "1", "3"][..], &["0", "4", "1;2", "01", " 1", "a", "1;"][..]),
            (AboutKind::Multiple, &["", "2", "1;3", "1;2;3"], &["3;1", "1;1", "1;4", ";", "1;;2"]),
            (AboutKind::Number, &["", "2", "3.5", "5"], &["1.9", "5.1", "NaN", "inf", "3e0", "two"]),
            (AboutKind::Scale, &["", "2", "5"], &["1", "6", "2.5", "02"]),
            (AboutKind::Text, &["", "a painter", "with\nlines"], &[&long, "bell\u{7}"]),
            (AboutKind::ColourVision, &["", "1", "4"], &["5", "1;2"]),
            (AboutKind::ScreenSize, &["", "4"], &["0"]),
        ] {
            let entry = AboutEntry::of(&section(kind));
            assert!(right.iter().all(|value| entry.takes(value)), "{kind:?}");
            for value in wrong {
                assert!(!entry.takes(value), "{kind:?} takes {value}");
            }
        }
    }

    #[test]
    fn values_are_said_in_words() {
        let texts = texts(&section(AboutKind::Multiple));
        let keys: Vec<&str> = texts.keys().map(String::as_str).collect();
        let expected = [
            "about_work",
            "about_work_1",
            "about_work_2",
            "about_work_3",
            "about_work_high",
            "about_work_low",
        ];
        assert_eq!(keys, expected);
        let entry = AboutEntry::of(&section(AboutKind::Multiple));
        assert_eq!([entry.said("1;3", &texts), entry.said("", &texts)], ["a; c", "declined"]);
        assert_eq!(AboutEntry::of(&section(AboutKind::Number)).said("3.5", &texts), "3.5");
        let shipped = crate::texts::shipped("en").unwrap();
        let colours = AboutEntry::of(&section(AboutKind::ColourVision));
        let all: Vec<String> = (1..=4).map(|option| colours.said(&option.to_string(), shipped)).collect();
        assert!(all.iter().all(|text| !text.is_empty()), "{all:?}");
    }
}
