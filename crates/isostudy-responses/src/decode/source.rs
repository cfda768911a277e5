//! Rows of a file, whether they come from text or from a workbook.

use crate::decode::records::{Record, Records};
use crate::error::Fault;
use std::borrow::Cow;

/// A table of cells.
#[derive(Debug)]
pub(crate) enum Source<'a> {
    /// Separated text.
    Text { text: &'a str, separator: u8 },
    /// Rows of a sheet from row 1 on, without gaps.
    Sheet(Vec<Vec<String>>),
}

impl Source<'_> {
    /// Visits every row until one fails.
    pub(crate) fn each(&self, mut visit: impl FnMut(&Record<'_>) -> Result<(), Fault>) -> Result<(), Fault> {
        let mut record = Record::default();
        match self {
            Self::Text { text, separator } => {
                let mut records = Records::new(text, *separator);
                let unclosed = |at: crate::decode::records::Unclosed| Fault::UnclosedQuote {
                    row: at.row,
                    column: at.column,
                };
                while records.read(&mut record).map_err(unclosed)? {
                    visit(&record)?;
                }
            }
            Self::Sheet(rows) => {
                for (i, cells) in rows.iter().enumerate() {
                    record.row = i as u64 + 1;
                    record.cells.clear();
                    record.cells.extend(cells.iter().map(|cell| Cow::Borrowed(cell.as_str())));
                    visit(&record)?;
                }
            }
        }
        Ok(())
    }

    /// The first rows that are not blank, with their numbers; enough to know a format by.
    pub(crate) fn head(&self) -> Result<Vec<(u64, Vec<String>)>, Fault> {
        const ROWS: usize = 4;
        let mut rows = Vec::new();
        // `each` stops at an error only, so this one says that enough has been seen.
        let seen = self.each(|record| {
            if !record.is_blank() {
                rows.push((record.row, record.cells.iter().map(|cell| cell.to_string()).collect()));
            }
            if rows.len() == ROWS { Err(Fault::Empty) } else { Ok(()) }
        });
        match seen {
            Err(Fault::Empty) | Ok(()) if !rows.is_empty() => Ok(rows),
            Err(fault) => Err(fault),
            Ok(()) => Err(Fault::Empty),
        }
    }

    /// Whether rows have as many cells as were written; a sheet's rows end where the last cell with content is.
    pub(crate) fn is_text(&self) -> bool {
        matches!(self, Self::Text { .. })
    }
}
