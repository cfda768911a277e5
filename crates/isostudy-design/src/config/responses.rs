//! Which answers are analysed, and what their file does not say itself.

use crate::check::{Checker, ConfigError};
use serde::{Deserialize, Serialize};
use std::path::Path;

/// The answers to analyse, and what their file does not say itself.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ResponsesSection {
    /// The file: the study's own table (one row a respondent, one column a question, cells `L`, `NP` or `R`), the long
    /// format, or an export of a questionnaire.
    pub file: Option<String>,
    /// Its format; otherwise it is detected.
    pub format: Option<String>,
    /// `,`, `;`, `|` or `tab`; otherwise it is detected.
    pub separator: Option<String>,
    /// Ids of the questions in the order of their columns; otherwise the study's order.
    pub questions: Option<Vec<String>>,
    /// Columns of the questions, from 1.
    pub question_columns: Option<Vec<usize>>,
    /// Column of the first question, from 1; the others follow it.
    pub first_question_column: Option<usize>,
    /// Column of the participant's id, from 1.
    pub participant_column: Option<usize>,
    /// What the file calls the three answers, beside the built-in words.
    pub synonyms: Option<SynonymsSection>,
    /// `refuse` (default) or `leave-out`: what to do with cells that are no answers.
    pub unknown: Option<String>,
    /// `refuse` (default), `first` or `last`: which of several answers to the same counts.
    pub duplicates: Option<String>,
    /// What people were asked about each pair, where no form of the study says it.
    pub asked: Option<String>,
    /// The item whose log worth is 0, of answers without a study; otherwise the first by name. A study has
    /// [`AnalysisSection::reference`](super::AnalysisSection::reference).
    pub reference: Option<String>,
    /// How long what a question shows lasts, in seconds, above 0: nobody has seen it in less. A study's turntables say it too.
    pub shown_s: Option<f64>,
    /// The questions of answers without a study; a study has its comparisons.
    #[serde(default)]
    pub pairs: Vec<PairSection>,
}

impl ResponsesSection {
    /// Reads a file with the keys of this section alone, for answers whose study does not declare them or that have none.
    ///
    /// # Errors
    /// If it cannot be read, is not TOML, or has a key that is not one of these; `file` is not.
    pub fn load(path: &Path) -> Result<Self, ConfigError> {
        let text = crate::read::text(path)?;
        let section: Self = crate::read::parse_toml(&text, path)?;
        match &section.file {
            None => Ok(section),
            Some(file) => {
                let limit = "a mapping says how to read, not what: name the answers on the command line";
                Checker { file: path }.refuse("file", file, limit)
            }
        }
    }
}

/// Words for the three answers.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct SynonymsSection {
    /// Left.
    pub left: Vec<String>,
    /// No preference.
    pub none: Vec<String>,
    /// Right.
    pub right: Vec<String>,
}

/// A question without a study: what is shown on which side.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PairSection {
    /// The question's id, unique.
    pub question: String,
    /// Shown on the left.
    pub left: String,
    /// Shown on the right.
    pub right: String,
    /// What both are of.
    #[serde(default)]
    pub object: String,
    /// The group of things that are compared with one another.
    #[serde(default)]
    pub group: String,
}
