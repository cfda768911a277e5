//! Questions about the person who answers.

use super::perhaps_whole;
use serde::{Deserialize, Serialize};

/// What kind of answer a question about the person takes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum AboutKind {
    /// One of the options.
    Single,
    /// Any of the options.
    Multiple,
    /// A number in a range.
    Number,
    /// A whole step between two ends.
    Scale,
    /// A few words.
    Text,
    /// One of the shipped options on colour vision.
    ColourVision,
    /// One of the shipped options on the size of the screen.
    ScreenSize,
}

/// When a question about the person is asked.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum AboutTime {
    /// Before the first pair.
    #[default]
    Before,
    /// After the last pair.
    After,
}

/// A question about the person.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AboutSection {
    /// Unique; the column in the exports.
    pub id: String,
    /// What kind of answer it takes.
    pub kind: AboutKind,
    /// The question; shipped for those on colour vision and screen size.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ask: Option<String>,
    /// The answers to choose from.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub options: Vec<String>,
    /// Least number, or first step.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub from: Option<f64>,
    /// Largest number, or last step.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub to: Option<f64>,
    /// What the first and the last step mean.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ends: Option<[String; 2]>,
    /// When it is asked.
    #[serde(default)]
    pub when: AboutTime,
    /// Whether it may be passed over without a word.
    #[serde(default)]
    pub optional: bool,
    /// The option, counted from 1, or the step that somebody chooses who reads the question: it checks attention.
    #[serde(default, deserialize_with = "perhaps_whole", skip_serializing_if = "Option::is_none")]
    pub expects: Option<u32>,
    /// Options, counted from 1, whose people are not asked any further.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub screens_out: Vec<u32>,
    /// Most people, finished or answering, for each option in order; 0 for any number.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub most: Vec<u32>,
}
