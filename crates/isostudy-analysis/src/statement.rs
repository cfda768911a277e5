//! What a report is made of: sections of paragraphs, statements, tables and figures.

use crate::figure::Figure;
use isostudy_table::Table;

/// What a statement is worth.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Standing {
    /// It holds at the stated level.
    Holds,
    /// The opposite of what was stated is there.
    Fails,
    /// What is there is smaller than the declared margin.
    Equal,
    /// Neither a difference nor equality was shown.
    Open,
    /// No outcome of so few people could have shown anything.
    TooFew,
    /// The design does not allow an answer.
    NotAnswerable,
    /// A description, which no test judges.
    Noted,
}

impl Standing {
    /// In a word or two.
    pub fn label(self) -> &'static str {
        match self {
            Self::Holds => "holds",
            Self::Fails => "does not hold",
            Self::Equal => "equal",
            Self::Open => "open",
            Self::TooFew => "too few",
            Self::NotAnswerable => "not answerable",
            Self::Noted => "noted",
        }
    }
}

/// A statement with its verdict.
#[derive(Debug, Clone, PartialEq)]
pub struct Finding {
    /// What it is worth.
    pub standing: Standing,
    /// The statement, with counts, estimate, interval and test.
    pub text: String,
}

impl Finding {
    pub(crate) fn new(standing: Standing, text: impl Into<String>) -> Self {
        Self { standing, text: text.into() }
    }
}

/// A section.
#[derive(Debug, Clone, PartialEq)]
pub struct Section {
    /// Name for links, unique in the report.
    pub id: &'static str,
    /// Its heading.
    pub heading: &'static str,
    /// What it holds, in order.
    pub blocks: Vec<Block>,
}

/// A piece of a section.
#[derive(Debug, Clone, PartialEq)]
pub enum Block {
    /// A paragraph.
    Text(String),
    /// A statement with its verdict.
    Finding(Finding),
    /// A table.
    Table(Table),
    /// A table that need not be read at once.
    Folded(Table),
    /// A figure.
    Figure(Figure),
}
