//! What a study declares about its files of answers.

use crate::error::{Fault, number_of, shorten};
use crate::format::Format;
use crate::name;
use crate::plan::PlannedPair;
use crate::words::Words;
use isostudy_design::config::ResponsesSection;

/// How a file is to be read where it does not say so itself. The default declares nothing.
#[derive(Debug, Clone, Default)]
pub struct Mapping {
    /// The format; otherwise it is detected.
    pub format: Option<Format>,
    /// The separator, an ASCII character.
    pub separator: Option<u8>,
    /// Ids of the questions in the order of their columns; otherwise all of the study's, in its order.
    pub questions: Option<Vec<String>>,
    /// The columns of the questions, from 1.
    pub question_columns: Option<Vec<usize>>,
    /// The column of the first question, from 1; the others follow it.
    pub first_question_column: Option<usize>,
    /// The column with the participant's id, from 1.
    pub participant_column: Option<usize>,
    /// Words for the three answers.
    pub words: Words,
    /// What to do with cells that are no answers.
    pub unknown: Unknown,
    /// What to do with answers given twice, and with rows of one participant or e-mail address.
    pub duplicates: Duplicates,
    /// The questions, where there is no study.
    pub pairs: Vec<PlannedPair>,
}

/// What to do with cells that are no answers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Unknown {
    /// Refuse the file, naming them all.
    #[default]
    Refuse,
    /// List them and leave them out.
    LeaveOut,
}

/// What to do with answers given twice.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Duplicates {
    /// Refuse the file.
    #[default]
    Refuse,
    /// Keep the first, list the others.
    First,
    /// Keep the last, list the others.
    Last,
}

/// A declaration that makes no sense.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("responses.{key} = {value}: {limit}")]
pub struct MappingError {
    /// The key.
    pub key: &'static str,
    /// What it says.
    pub value: String,
    /// What it may say.
    pub limit: String,
}

impl Mapping {
    /// Checks what a study file or a mapping file declares.
    ///
    /// # Errors
    /// The first key that makes no sense.
    pub fn of(section: &ResponsesSection) -> Result<Self, MappingError> {
        let refuse = |key, value: String, limit: &str| Err(MappingError { key, value, limit: limit.into() });
        let mut mapping = Self::default();
        if let Some(name) = &section.format {
            mapping.format = Some(Self::format(name)?);
        }
        mapping.separator = match section.separator.as_deref() {
            None => None,
            Some("," | ";" | "\t" | "|") => section.separator.as_ref().map(|text| text.as_bytes()[0]),
            Some("tab") => Some(b'\t'),
            Some(other) => {
                return refuse("separator", format!("{other:?}"), "must be \",\", \";\", \"|\" or \"tab\"");
            }
        };
        if let Some(seconds) = section.shown_s.filter(|s| !(s.is_finite() && *s > 0.0)) {
            return refuse("shown_s", seconds.to_string(), "must be a number of seconds above 0");
        }
        let columns = section.question_columns.iter().flatten().chain(&section.first_question_column);
        if let Some(0) = columns.chain(&section.participant_column).min() {
            return refuse("question_columns", "0".into(), "columns are counted from 1");
        }
        if section.question_columns.is_some() && section.first_question_column.is_some() {
            let limit = "must not stand beside question_columns";
            return refuse("first_question_column", format!("{:?}", section.first_question_column), limit);
        }
        mapping.questions.clone_from(&section.questions);
        mapping.question_columns.clone_from(&section.question_columns);
        (mapping.first_question_column, mapping.participant_column) =
            (section.first_question_column, section.participant_column);
        if let Some(synonyms) = &section.synonyms {
            let lists = [&synonyms.left, &synonyms.none, &synonyms.right].map(Vec::as_slice);
            if let Err(word) = mapping.words.declare(lists) {
                return refuse("synonyms", format!("{word:?}"), "stands for two answers");
            }
        }
        mapping.unknown = match section.unknown.as_deref() {
            None | Some("refuse") => Unknown::Refuse,
            Some("leave-out") => Unknown::LeaveOut,
            Some(other) => {
                return refuse("unknown", format!("{other:?}"), "must be \"refuse\" or \"leave-out\"");
            }
        };
        mapping.duplicates = match section.duplicates.as_deref() {
            None | Some("refuse") => Duplicates::Refuse,
            Some("first") => Duplicates::First,
            Some("last") => Duplicates::Last,
            Some(other) => {
                return refuse(
                    "duplicates",
                    format!("{other:?}"),
                    "must be \"refuse\", \"first\" or \"last\"",
                );
            }
        };
        for pair in &section.pairs {
            let names = [&pair.question, &pair.left, &pair.right, &pair.object, &pair.group];
            if let Some(long) = names.into_iter().find(|name| name::is_too_long(name)) {
                return refuse("pairs", format!("\"{}\"", shorten(long)), &name::limit());
            }
        }
        let pair = |pair: &isostudy_design::config::PairSection| PlannedPair {
            question: pair.question.clone(),
            left: pair.left.clone(),
            right: pair.right.clone(),
            object: pair.object.clone(),
            group: pair.group.clone(),
        };
        mapping.pairs = section.pairs.iter().map(pair).collect();
        Ok(mapping)
    }

    /// The declared column of participants, counted from 0, in a file with so many columns.
    ///
    /// # Errors
    /// If it has fewer.
    pub(crate) fn participant(&self, columns: usize) -> Result<Option<usize>, Fault> {
        match self.participant_column {
            Some(column) if !(1..=columns).contains(&column) => {
                let limit = format!("the file has {}", number_of(columns, "column"));
                Err(Fault::Declaration { key: "participant_column", value: column.to_string(), limit })
            }
            column => Ok(column.map(|column| column - 1)),
        }
    }

    /// The format with this name.
    ///
    /// # Errors
    /// If there is none.
    pub fn format(name: &str) -> Result<Format, MappingError> {
        let unknown = || MappingError {
            key: "format",
            value: format!("{name:?}"),
            limit: format!("must be one of {}", Format::names()),
        };
        Format::from_name(name).ok_or_else(unknown)
    }
}
