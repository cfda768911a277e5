//! What the header of an export with one row a participant says.

use crate::error::Fault;
use crate::format::Format;
use crate::report::{Kind, Report};
use crate::words::normalise;

/// The first rows that are not blank, with their numbers.
pub(crate) type Head = [(u64, Vec<String>)];

/// The header of a format with one row an answer and columns of its own.
pub(crate) struct Header<'a> {
    pub(crate) format: Format,
    pub(crate) row: u64,
    pub(crate) cells: &'a [String],
}

impl<'a> Header<'a> {
    pub(crate) fn of(format: Format, head: &'a Head) -> Self {
        Self { format, row: head[0].0, cells: &head[0].1 }
    }

    /// The first column with one of these titles.
    pub(crate) fn find(&self, names: &[&str]) -> Option<usize> {
        let place = |name: &&str| self.cells.iter().position(|title| normalise(title) == normalise(name));
        names.iter().find_map(place)
    }

    pub(crate) fn needed(&self, names: &[&str]) -> Result<usize, Fault> {
        self.find(names).ok_or_else(|| self.missing(format!("the header has no {}", names[0])))
    }

    pub(crate) fn missing(&self, missing: impl Into<String>) -> Fault {
        Fault::NotThatFormat { format: self.format, row: self.row, missing: missing.into() }
    }

    /// Notes columns that are neither the participant's nor among those of the format.
    pub(crate) fn note_others(&self, participant: Option<usize>, known: &[&str], report: &mut Report) {
        for (column, title) in self.cells.iter().enumerate() {
            let is_known = known.iter().any(|name| normalise(name) == normalise(title));
            if participant != Some(column) && !is_known {
                report.cell(Kind::Noted, self.row, column, title, "not a column of this format: not read");
            }
        }
    }
}

/// Where things are in a file with one row a participant and one column a question. Columns are counted from 0.
#[derive(Debug, Clone, Default)]
pub(crate) struct Layout {
    /// Row of the last header line.
    pub(crate) last_header_row: u64,
    /// Headers of each column: field name, title, and what else stands above it.
    pub(crate) titles: Vec<Vec<String>>,
    /// Columns that the tool adds itself; none of them is a question.
    pub(crate) aside: Vec<usize>,
    /// The participant's id.
    pub(crate) participant: Option<usize>,
    /// The form of the questionnaire.
    pub(crate) form: Option<usize>,
    /// The e-mail address of whoever answered.
    pub(crate) addresses: Vec<usize>,
    /// When the row's answers were begun or sent in.
    pub(crate) time: Option<usize>,
    /// Columns whose cell tells previews and tests, which are no answers.
    pub(crate) preview: Vec<Sign>,
    /// Columns whose cell tells that somebody did not finish; their answers count as far as they go.
    pub(crate) unfinished: Vec<Sign>,
    /// Columns with the order in which questions were shown, as names joined by `|`.
    pub(crate) orders: Vec<usize>,
}

/// A column, and which of its cells say so.
#[derive(Debug, Clone)]
pub(crate) struct Sign {
    pub(crate) column: usize,
    pub(crate) says: fn(&str) -> bool,
    pub(crate) what: &'static str,
}

impl Layout {
    /// One header row.
    pub(crate) fn of_header(row: u64, header: &[String]) -> Self {
        let titles = header.iter().map(|title| vec![title.clone()]).collect();
        Self { last_header_row: row, titles, ..Self::default() }
    }

    /// The first header of a column.
    pub(crate) fn title(&self, column: usize) -> &str {
        self.titles[column].first().map_or("", String::as_str)
    }
}

/// A format that a header has the marks of, with the rule that says so.
#[derive(Debug)]
pub(crate) struct Detected {
    pub(crate) format: Format,
    pub(crate) rule: String,
}

pub(crate) fn is_participant(title: &str) -> bool {
    ["participant", "respondent", "id"].contains(&normalise(title).as_str())
}

pub(crate) fn is_form(title: &str) -> bool {
    normalise(title) == "form"
}

/// The layout of a study's own table.
pub(crate) fn own_table(head: &Head) -> Layout {
    let (row, header) = &head[0];
    let mut layout = Layout::of_header(*row, header);
    layout.participant = header.iter().position(|title| is_participant(title));
    layout.form = header.iter().position(|title| is_form(title));
    layout
}
