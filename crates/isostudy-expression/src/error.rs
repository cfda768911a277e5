//! What can be wrong with a formula.

use thiserror::Error;

use crate::functions::function_names;

/// Why text is no formula. Columns count characters from 1.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum ExpressionError {
    /// A character that belongs to nothing.
    #[error("column {column}: `{character}` is not part of any formula")]
    Character {
        /// Where.
        column: usize,
        /// Which.
        character: char,
    },
    /// Digits that are no number.
    #[error("column {column}: `{text}` is not a finite number")]
    Number {
        /// Where.
        column: usize,
        /// What stands there, cut after 40 characters.
        text: String,
    },
    /// A name without a meaning.
    #[error(
        "column {column}: `{name}` is not known; x, y, z, pi, tau and e are, and the functions {}",
        function_names()
    )]
    Name {
        /// Where.
        column: usize,
        /// What stands there, cut after 40 characters.
        name: String,
    },
    /// A function with the wrong number of arguments.
    #[error("column {column}: `{name}` takes {wanted}, not {given}")]
    Arguments {
        /// Where the function stands.
        column: usize,
        /// The function.
        name: String,
        /// How many there are.
        given: usize,
        /// How many there have to be.
        wanted: &'static str,
    },
    /// An argument that has to be one of certain numbers, the same everywhere.
    #[error("column {column}: {what} of `{name}` has to be {wanted}, not {found}")]
    Setting {
        /// Where the argument starts.
        column: usize,
        /// The function.
        name: String,
        /// Which argument.
        what: &'static str,
        /// What it may be.
        wanted: &'static str,
        /// What it is.
        found: String,
    },
    /// Something else than what has to follow.
    #[error("column {column}: {found} where {wanted} belongs")]
    Unexpected {
        /// Where.
        column: usize,
        /// What stands there.
        found: String,
        /// What belongs there.
        wanted: &'static str,
    },
    /// More nesting than the limit.
    #[error("column {column}: nested deeper than {limit} levels")]
    TooDeep {
        /// Where it gets too deep.
        column: usize,
        /// The limit.
        limit: usize,
    },
    /// More text than the limit.
    #[error("{bytes} bytes exceed the limit of {limit}")]
    TooLong {
        /// How much there is.
        bytes: usize,
        /// The limit.
        limit: usize,
    },
    /// The evaluator refuses it.
    #[error("the formula is too complex for the evaluator")]
    TooComplex,
    /// The same everywhere, so that there is no surface.
    #[error("the formula is {value} everywhere; x, y or z must matter")]
    Constant {
        /// The value.
        value: f32,
    },
}

/// How much of a formula is shown on either side of a column.
const EXCERPT: usize = 30;

impl ExpressionError {
    /// Where it is wrong, if it is at one place.
    pub fn column(&self) -> Option<usize> {
        match *self {
            Self::Character { column, .. }
            | Self::Number { column, .. }
            | Self::Name { column, .. }
            | Self::Arguments { column, .. }
            | Self::Setting { column, .. }
            | Self::Unexpected { column, .. }
            | Self::TooDeep { column, .. } => Some(column),
            Self::TooLong { .. } | Self::TooComplex | Self::Constant { .. } => None,
        }
    }

    /// The formula, for a message: what stands within 30 characters of the column, or else at the start, with `...` for what
    /// is left out.
    pub fn excerpt(&self, formula: &str) -> String {
        let middle = self.column().unwrap_or(1) - 1;
        let count = formula.chars().count();
        let (first, end) = (middle.saturating_sub(EXCERPT), (middle + EXCERPT).min(count));
        let shown: String = formula.chars().take(end).skip(first).collect();
        let [before, after] = [first > 0, end < count].map(|is_cut| if is_cut { "..." } else { "" });
        format!("{before}{shown}{after}")
    }
}
