//! What a report is made of: sections of paragraphs, statements, tables and figures.

use crate::figure::Figure;
pub use crate::standing::Standing;
use isostudy_table::Table;

/// A statement with its verdict.
#[derive(Debug, Clone, PartialEq)]
pub struct Finding {
    /// What it is worth.
    pub standing: Standing,
    /// The statement, with counts, estimate, interval and test.
    pub text: String,
}

impl Finding {
    /// A statement of that worth.
    pub fn new(standing: Standing, text: impl Into<String>) -> Self {
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
