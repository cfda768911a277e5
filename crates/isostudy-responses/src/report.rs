//! What was done to a file while it was read.

use crate::error::shorten;
use crate::format::Format;
use crate::sides::SidesSource;
use std::fmt;
use std::path::PathBuf;

/// How a file was read, and everything in it that was not taken as it stands.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Report {
    /// The file.
    pub file: PathBuf,
    /// The format that it was read as.
    pub format: Format,
    /// The rule by which that format was found.
    pub format_rule: String,
    /// Encoding and separator, and how they were found.
    pub text_rule: String,
    /// How columns were assigned to questions; empty where rows name their question.
    pub column_rule: String,
    /// How it is known which item was on which side; [`SidesSource::sentence`] says it.
    pub sides: SidesSource,
    /// Cells and rows that were repaired, rejected or passed over.
    pub remarks: Vec<Remark>,
}

/// One cell or row that was not taken as it stands. Rows and columns are counted from 1.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Remark {
    /// The row; in JSON the trial, counted from 2.
    pub row: u64,
    /// The column, or the field in JSON; `None` is the whole row.
    pub column: Option<usize>,
    /// What stands there, shortened; empty for whole rows.
    pub raw: String,
    /// Whether anything was lost.
    pub kind: Kind,
    /// What was done.
    pub action: String,
}

/// What became of a cell or row.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Kind {
    /// It was read as something that is not literally there.
    Repaired,
    /// It is not among the answers.
    Rejected,
    /// It was taken, and somebody may want to know.
    Noted,
}

impl Kind {
    /// The name in lists.
    pub fn name(self) -> &'static str {
        match self {
            Self::Repaired => "repaired",
            Self::Rejected => "rejected",
            Self::Noted => "noted",
        }
    }
}

impl Report {
    /// How many remarks there are of a kind.
    pub fn count(&self, kind: Kind) -> usize {
        self.remarks.iter().filter(|remark| remark.kind == kind).count()
    }

    /// `file,row,column,kind,raw,action` as CSV, one line a remark; cells are escaped as in the long format.
    pub fn to_csv(&self) -> String {
        let mut writer = csv::Writer::from_writer(Vec::new());
        let file = self.file.display().to_string();
        let in_memory = "writing to memory";
        writer.write_record(["file", "row", "column", "kind", "raw", "action"]).expect(in_memory);
        for Remark { row, column, raw, kind, action } in &self.remarks {
            let column = column.map_or(String::new(), |column| column.to_string());
            let row = row.to_string();
            let cells = [file.as_str(), &row, &column, kind.name(), raw, action];
            writer
                .write_record(cells.map(|cell| isostudy_table::formula::escape(cell).into_owned()))
                .expect(in_memory);
        }
        String::from_utf8(writer.into_inner().expect(in_memory)).expect("made of text")
    }

    pub(crate) fn cell(&mut self, kind: Kind, row: u64, column: usize, raw: &str, action: impl Into<String>) {
        let raw = shorten(raw);
        self.remarks.push(Remark { row, column: Some(column + 1), raw, kind, action: action.into() });
    }

    /// Notes blank rows that turned out to be inside the table, and forgets them.
    pub(crate) fn blank_rows(&mut self, rows: &mut Option<(u64, u64)>) {
        match rows.take() {
            None => {}
            Some((first, last)) if first == last => {
                self.row(Kind::Noted, first, "blank row inside the table")
            }
            Some((first, last)) => {
                self.row(Kind::Noted, first, format!("blank rows inside the table, down to row {last}"));
            }
        }
    }

    pub(crate) fn row(&mut self, kind: Kind, row: u64, action: impl Into<String>) {
        self.remarks.push(Remark { row, column: None, raw: String::new(), kind, action: action.into() });
    }
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{}: {} ({}); {}",
            self.file.display(),
            self.format.name(),
            self.format_rule,
            self.text_rule
        )?;
        if !self.column_rule.is_empty() {
            write!(f, "; {}", self.column_rule)?;
        }
        write!(f, "; sides: {}", self.sides.name())?;
        for Remark { row, column, raw, kind, action } in &self.remarks {
            write!(f, "\n{}: row {row}", self.file.display())?;
            if let Some(column) = column {
                write!(f, ", column {column}: \"{raw}\"")?;
            }
            write!(f, ": {}: {action}", kind.name())?;
        }
        Ok(())
    }
}
