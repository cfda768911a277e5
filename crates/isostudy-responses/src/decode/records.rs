//! Rows of separated text, with the row numbers that a spreadsheet shows.
//!
//! Not the `csv` crate, which is written with: it skips blank lines without counting them as rows, counts lines where
//! titles have line breaks, and takes a quote that is never closed for a cell that reaches to the end of the file.

use std::borrow::Cow;

/// One row.
#[derive(Debug, Default)]
pub(crate) struct Record<'a> {
    /// Number in the file, from 1; a cell with line breaks does not count as several rows.
    pub(crate) row: u64,
    pub(crate) cells: Vec<Cow<'a, str>>,
    /// The first cell that goes on after its closing quote; the text is kept.
    pub(crate) stray: Option<usize>,
}

impl Record<'_> {
    /// A cell, empty where the row is too short.
    pub(crate) fn cell(&self, column: usize) -> &str {
        self.cells.get(column).map_or("", AsRef::as_ref)
    }

    pub(crate) fn is_blank(&self) -> bool {
        self.cells.iter().all(|cell| is_blank(cell))
    }
}

/// Whether a cell holds nothing but space.
pub(crate) fn is_blank(cell: &str) -> bool {
    cell.chars().all(is_space)
}

/// A cell without the space round it.
pub(crate) fn trim(cell: &str) -> &str {
    cell.trim_matches(is_space)
}

/// White space, byte-order marks and spaces of no width.
fn is_space(c: char) -> bool {
    c.is_whitespace() || c == '\u{feff}' || c == '\u{200b}'
}

/// A quote that is opened and never closed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Unclosed {
    pub(crate) row: u64,
    pub(crate) column: usize,
}

/// Reads rows of text one after the other.
#[derive(Debug, Clone)]
pub(crate) struct Records<'a> {
    text: &'a str,
    at: usize,
    row: u64,
    separator: u8,
}

impl<'a> Records<'a> {
    /// `separator` is an ASCII character other than a quote or a line end.
    pub(crate) fn new(text: &'a str, separator: u8) -> Self {
        Self { text, at: 0, row: 0, separator }
    }

    /// Reads the next row into `record`; false at the end of the text.
    pub(crate) fn read(&mut self, record: &mut Record<'a>) -> Result<bool, Unclosed> {
        record.cells.clear();
        record.stray = None;
        if self.at >= self.text.len() {
            return Ok(false);
        }
        self.row += 1;
        record.row = self.row;
        let bytes = self.text.as_bytes();
        loop {
            let (cell, stray) = if bytes.get(self.at) == Some(&b'"') {
                let column = record.cells.len() + 1;
                self.quoted().ok_or(Unclosed { row: self.row, column })?
            } else {
                (Cow::Borrowed(self.plain()), false)
            };
            if stray && record.stray.is_none() {
                record.stray = Some(record.cells.len());
            }
            record.cells.push(cell);
            match bytes.get(self.at) {
                None => return Ok(true),
                Some(&byte) if byte == self.separator => self.at += 1,
                Some(&byte) => {
                    self.at += 1;
                    if byte == b'\r' && bytes.get(self.at) == Some(&b'\n') {
                        self.at += 1;
                    }
                    return Ok(true);
                }
            }
        }
    }

    /// Up to the next separator or line end.
    fn plain(&mut self) -> &'a str {
        let rest = &self.text.as_bytes()[self.at..];
        let ends = |&byte: &u8| byte == self.separator || byte == b'\n' || byte == b'\r';
        let length = rest.iter().position(ends).unwrap_or(rest.len());
        let cell = &self.text[self.at..self.at + length];
        self.at += length;
        cell
    }

    /// From an opening quote up to the separator or line end after the closing one; whether anything stands between.
    fn quoted(&mut self) -> Option<(Cow<'a, str>, bool)> {
        self.at += 1;
        let mut cell = Cow::Borrowed("");
        loop {
            let length = self.text.as_bytes()[self.at..].iter().position(|&byte| byte == b'"')?;
            let part = &self.text[self.at..self.at + length];
            if cell.is_empty() {
                cell = Cow::Borrowed(part)
            } else {
                cell.to_mut().push_str(part)
            }
            self.at += length + 1;
            if self.text.as_bytes().get(self.at) != Some(&b'"') {
                break;
            }
            cell.to_mut().push('"');
            self.at += 1;
        }
        let after = self.plain();
        if !is_blank(after) {
            cell.to_mut().push_str(after);
        }
        Some((cell, !is_blank(after)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rows(text: &str, separator: u8) -> Result<Vec<(u64, Vec<String>)>, Unclosed> {
        let (mut records, mut record, mut rows) =
            (Records::new(text, separator), Record::default(), Vec::new());
        while records.read(&mut record)? {
            rows.push((record.row, record.cells.iter().map(|cell| cell.to_string()).collect()));
        }
        Ok(rows)
    }

    fn cells(text: &str) -> Vec<Vec<String>> {
        rows(text, b',').unwrap().into_iter().map(|(_, cells)| cells).collect()
    }

    #[test]
    fn quotes_line_ends_and_empty_cells() {
        assert_eq!(cells("a,b\nc,\n"), [["a", "b"], ["c", ""]]);
        assert_eq!(cells("a,b\r\nc,d"), [["a", "b"], ["c", "d"]]);
        assert_eq!(cells("a,b\rc,d\r"), [["a", "b"], ["c", "d"]]);
        assert_eq!(cells("\"a, \"\"x\"\"\",\"\"\n\"\"\"\",b\n"), [["a, \"x\"", ""], ["\"", "b"]]);
        assert_eq!(cells("5\" wide,b\n"), [["5\" wide", "b"]]);
        assert!(cells("").is_empty());
    }

    #[test]
    fn rows_are_numbered_as_a_spreadsheet_does() {
        let got = rows("\"two\nlines\";b\n\n1;2\n", b';').unwrap();
        assert_eq!(got.iter().map(|(row, _)| *row).collect::<Vec<_>>(), [1, 2, 3]);
        assert_eq!(got[0].1, ["two\nlines", "b"]);
    }

    #[test]
    fn a_quote_that_stays_open_is_no_cell() {
        assert_eq!(rows("a,b\nc,\"d\ne,f\n", b','), Err(Unclosed { row: 2, column: 2 }));
        let mut record = Record::default();
        assert!(Records::new("a,\"b\"c,d", b',').read(&mut record).unwrap());
        assert_eq!((record.stray, record.cell(1)), (Some(1), "bc"));
    }
}
