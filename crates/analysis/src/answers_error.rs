//! What may be wrong with a file of answers.

use std::path::PathBuf;

/// Why a file of answers is refused. Rows are lines of the file, counted from 1; columns are counted from 1.
#[derive(Debug, thiserror::Error)]
pub enum AnswersError {
    /// The file cannot be read.
    #[error("{}: cannot be read", file.display())]
    Read {
        /// The file.
        file: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// The file is not UTF-8 text.
    #[error("{}: row {row}: not UTF-8 text", file.display())]
    Encoding {
        /// The file.
        file: PathBuf,
        /// The first row that is not.
        row: u64,
    },
    /// There is no header.
    #[error("{}: row 1: empty; expected a header with the study's question ids", file.display())]
    Empty {
        /// The file.
        file: PathBuf,
    },
    /// There is a header and nothing else.
    #[error("{}: row 2: no answers under the header", file.display())]
    NoAnswers {
        /// The file.
        file: PathBuf,
    },
    /// A row without text between rows with text.
    #[error("{}: row {row}: blank row inside the table", file.display())]
    BlankRow {
        /// The file.
        file: PathBuf,
        /// The row.
        row: u64,
    },
    /// A column that is not a question of the study.
    #[error("{}: row 1, column {column}: \"{name}\" is not a question of this study", file.display())]
    UnknownQuestion {
        /// The file.
        file: PathBuf,
        /// The column.
        column: usize,
        /// Its header.
        name: String,
    },
    /// Two columns for one question.
    #[error("{}: row 1, column {column}: question {name} is already in column {first}", file.display())]
    DuplicateQuestion {
        /// The file.
        file: PathBuf,
        /// The second column.
        column: usize,
        /// The first column.
        first: usize,
        /// The question.
        name: String,
    },
    /// A question of the study without a column.
    #[error("{}: row 1: no column for question {name}", file.display())]
    MissingQuestion {
        /// The file.
        file: PathBuf,
        /// The question.
        name: String,
    },
    /// A row with too few or too many cells.
    #[error("{}: row {row}: {found} cells; the header has {expected}", file.display())]
    CellCount {
        /// The file.
        file: PathBuf,
        /// The row.
        row: u64,
        /// Cells in the header.
        expected: usize,
        /// Cells in the row.
        found: usize,
    },
    /// A cell that is not an answer.
    #[error("{}: row {row}, column {column} ({question}): \"{cell}\" is not an answer; write L, NP or R", file.display())]
    UnknownChoice {
        /// The file.
        file: PathBuf,
        /// The row.
        row: u64,
        /// The column.
        column: usize,
        /// The question.
        question: String,
        /// What the cell says.
        cell: String,
    },
    /// The text is sound but the table reader refused it.
    #[error("{}: {message}", file.display())]
    Table {
        /// The file.
        file: PathBuf,
        /// What polars said.
        message: String,
    },
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::error::Error;

    #[test]
    fn a_source_is_said_once_in_the_chain() {
        let source = std::io::Error::other("disk on fire");
        let error = AnswersError::Read { file: "a.csv".into(), source };
        assert_eq!(error.to_string(), "a.csv: cannot be read");
        assert_eq!(error.source().unwrap().to_string(), "disk on fire");
        let error = crate::AnalysisError::from(polars::error::PolarsError::ComputeError("no column".into()));
        assert_eq!(error.to_string(), "counting answers");
        assert!(error.source().unwrap().to_string().contains("no column"));
    }
}
