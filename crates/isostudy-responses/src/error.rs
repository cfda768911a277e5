//! What may be wrong with a file of answers.

use crate::address;
use crate::choice::Choice;
use crate::format::Format;
use isostudy_design::wording::did_you_mean;
use std::fmt;
use std::path::PathBuf;

/// Why a file of answers is refused.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReadError {
    /// The file cannot be read.
    #[error("{}: cannot be read", file.display())]
    File {
        /// The file.
        file: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },
    /// Its content will not do.
    #[error("{}: {fault}", file.display())]
    Content {
        /// The file.
        file: PathBuf,
        /// What is wrong, and where.
        fault: Box<Fault>,
    },
}

/// What is wrong with the content of a file. Rows and columns are counted from 1, as a spreadsheet counts them; JSON is
/// counted as the table that jsPsych makes of it, a trial a row and a header on top.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Fault {
    /// There is nothing in it.
    #[error("row 1: empty; expected a header and answers")]
    Empty,
    /// There is a header and nothing else.
    #[error("row {row}: no answers under the header")]
    NoAnswers {
        /// Where the first would be.
        row: u64,
    },
    /// Larger than what is read.
    #[error("{bytes} bytes; at most {limit} are read")]
    TooLarge {
        /// Its size.
        bytes: u64,
        /// The largest size.
        limit: u64,
    },
    /// Text that does not keep to its encoding.
    #[error("row {row}: not {encoding} text")]
    Encoding {
        /// The encoding that was announced or guessed.
        encoding: &'static str,
        /// The first row that is not.
        row: u64,
    },
    /// Two separators fit.
    #[error("row 1: {first:?} and {second:?} both split every row into {cells} cells; declare the separator")]
    Separators {
        /// The one.
        first: char,
        /// The other.
        second: char,
        /// Cells a row.
        cells: usize,
    },
    /// A cell's opening quote is never closed.
    #[error("row {row}, column {column}: a quote is opened and never closed")]
    UnclosedQuote {
        /// The row.
        row: u64,
        /// The column.
        column: usize,
    },
    /// A row with too few or too many cells.
    #[error("row {row}: {}; the header has {expected}", number_of(*found, "cell"))]
    CellCount {
        /// The row.
        row: u64,
        /// Cells in the header.
        expected: usize,
        /// Cells in the row.
        found: usize,
    },
    /// No format's mark is in the file.
    #[error(
        "row 1: no known format: the header begins {header}. Known formats: {formats}; name one with --format or `format`"
    )]
    UnknownFormat {
        /// The first cells, and what they lack where they are nearly a format's.
        header: String,
        /// Names of the formats.
        formats: String,
    },
    /// Marks of several formats are in the file.
    #[error("row 1: it may be {}; name the format", Readings(readings))]
    Formats {
        /// Each with what speaks for it.
        readings: Vec<(Format, String)>,
    },
    /// The declared format needs something that the file has not.
    #[error("row {row}: not {}: {missing}", format.name())]
    NotThatFormat {
        /// The declared format.
        format: Format,
        /// Where.
        row: u64,
        /// What is missing.
        missing: String,
    },
    /// A study or a mapping with questions is needed to read this format.
    #[error("{}: its questions are columns without sides; give a study file or a mapping with `pairs`", format.name())]
    NoPlan {
        /// The format.
        format: Format,
    },
    /// A question or item of the study or of the declared pairs whose name is too long.
    #[error("the study's name \"{name}\" {limit}")]
    PlannedName {
        /// The name, shortened.
        name: String,
        /// What it may be.
        limit: String,
    },
    /// A column is named as a question's and is none.
    #[error("row 1, column {column}: \"{name}\" is not a question of this study")]
    UnknownQuestion {
        /// The column.
        column: usize,
        /// Its header.
        name: String,
    },
    /// Two columns for one question, or one name for two columns.
    #[error("row 1, column {column}: {name} is already in column {first}")]
    DuplicateColumn {
        /// The second column.
        column: usize,
        /// The first column.
        first: usize,
        /// The question or column.
        name: String,
    },
    /// A question or a needed column that is not there.
    #[error("row 1: no column for {name}")]
    MissingColumn {
        /// The question or column.
        name: String,
    },
    /// Two ways to assign columns to questions.
    #[error(
        "row 1: two readings fit: {first}; or {second}. Declare `question_columns` or `first_question_column`"
    )]
    Columns {
        /// The one.
        first: String,
        /// The other.
        second: String,
    },
    /// No way to assign columns to questions.
    #[error("row 1: {reason}. Declare `question_columns` or `first_question_column`")]
    NoColumns {
        /// Why not.
        reason: String,
    },
    /// A declaration that does not fit the file.
    #[error("row 1: {key} = {value}: {limit}")]
    Declaration {
        /// The key of the mapping.
        key: &'static str,
        /// What it says.
        value: String,
        /// What it may say.
        limit: String,
    },
    /// Cells that are no answers.
    #[error("{}", UnknownCells(cells, known))]
    UnknownAnswers {
        /// All of them.
        cells: Vec<UnknownCell>,
        /// What is known.
        known: String,
    },
    /// A cell that will not do, in a column other than an answer's.
    #[error("row {row}, column {column} ({name}): \"{cell}\" {limit}")]
    Cell {
        /// The row.
        row: u64,
        /// The column.
        column: usize,
        /// The column's name.
        name: String,
        /// What the cell says.
        cell: String,
        /// What it may say.
        limit: String,
    },
    /// An answer about another pair than its question's.
    #[error("row {row}: question {question} compares {declared}, not {found}")]
    Pair {
        /// The row.
        row: u64,
        /// The question.
        question: String,
        /// Its items.
        declared: String,
        /// The row's items.
        found: String,
    },
    /// One id for two pairs, in a file without a study.
    #[error(
        "row {row}: question {question} compares {pair}, and {first_pair} in row {first_row}; give each pair a question of its own"
    )]
    TwoPairs {
        /// The second row.
        row: u64,
        /// The question.
        question: String,
        /// The items of the second row.
        pair: String,
        /// The first row.
        first_row: u64,
        /// The items of the first row.
        first_pair: String,
    },
    /// A pair that no question of the study compares, or several do, in a file that names no questions.
    #[error("row {row}: not one question of this study compares {found}")]
    NoSuchPair {
        /// The row.
        row: u64,
        /// The items, and on what.
        found: String,
    },
    /// A file without sides, of a study that shows participants different ones.
    #[error(
        "row {row}: the file does not say which item was on which side, and this study shows participants different sides. Add \
         a `form` column with the number of each participant's form; cells are then read as what was pressed. Or use the long \
         format with `left` and `right`. Answers that were turned to the study's sides, as in tables/answers.csv, are not read: \
         nobody may have seen those sides"
    )]
    NoSides {
        /// The header's row.
        row: u64,
    },
    /// A repeat or control without sides, where the study does not say them either.
    #[error(
        "row {row}: neither the file nor the study says on which sides {question} was shown; add the columns `left` and `right`"
    )]
    NoSidesOf {
        /// The row.
        row: u64,
        /// The question.
        question: String,
    },
    /// An answer to what the participant's form does not ask.
    #[error("row {row}: form {form} does not ask {question}, and here is an answer to it; is that the form?")]
    NotInForm {
        /// The row.
        row: u64,
        /// The form.
        form: String,
        /// The question.
        question: String,
    },
    /// A code name that contradicts the form.
    #[error("row {row}: stimulus {stimulus}, left to right, and form {form} asks {question} with {asked}")]
    OtherStimulus {
        /// The row.
        row: u64,
        /// The code name, and what it shows.
        stimulus: String,
        /// The form.
        form: String,
        /// The question.
        question: String,
        /// What the form shows.
        asked: String,
    },
    /// Rows that stand for more answers than are read.
    #[error("row {row}: {answers} answers so far, by their counts; at most {limit} are read")]
    TooManyAnswers {
        /// The row.
        row: u64,
        /// Answers so far, with this row's.
        answers: u64,
        /// The most that are read.
        limit: u64,
    },
    /// One participant twice.
    #[error(
        "row {row}: participant {participant} is already in row {first}; declare `duplicates` to keep the first or the last"
    )]
    DuplicateParticipant {
        /// The second row.
        row: u64,
        /// The first row.
        first: u64,
        /// The participant.
        participant: String,
    },
    /// One e-mail address twice; it is not shown.
    #[error(
        "row {row}: the e-mail address of row {first} again, so one person twice; declare `duplicates` to keep the first or the \
         last, or `participant_column` if several people share an address"
    )]
    DuplicateAddress {
        /// The second row.
        row: u64,
        /// The first row.
        first: u64,
    },
    /// One answer twice.
    #[error(
        "row {row}: {participant} has already answered {question} with the same sides in row {first}; {}",
        if *ordered {
            "give `order` if it was shown twice, or declare `duplicates`"
        } else {
            "declare `duplicates` to keep the first or the last"
        }
    )]
    DuplicateAnswer {
        /// The second row.
        row: u64,
        /// The first row.
        first: u64,
        /// The participant.
        participant: String,
        /// The question.
        question: String,
        /// Whether the format has a column for the place in the session.
        ordered: bool,
    },
    /// A participant with two forms.
    #[error("row {row}: participant {participant} has form \"{form}\" here and \"{first}\" before")]
    TwoForms {
        /// The row.
        row: u64,
        /// The participant.
        participant: String,
        /// The form in this row.
        form: String,
        /// The form before.
        first: String,
    },
    /// A zip file or workbook that cannot be read or is too large inside.
    #[error("{0}")]
    Archive(String),
    /// JSON that does not parse or is not what the format has.
    #[error("row {row}: {message}")]
    Json {
        /// The line.
        row: u64,
        /// What is wrong.
        message: String,
    },
}

/// A cell that should be an answer and is none.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct UnknownCell {
    /// The row.
    pub row: u64,
    /// The column.
    pub column: usize,
    /// The question.
    pub question: String,
    /// What the cell says, shortened.
    pub raw: String,
}

struct Readings<'a>(&'a [(Format, String)]);

impl fmt::Display for Readings<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, (format, rule)) in self.0.iter().enumerate() {
            write!(f, "{}{} ({rule})", if i > 0 { " or " } else { "" }, format.name())?;
        }
        Ok(())
    }
}

struct UnknownCells<'a>(&'a [UnknownCell], &'a str);

impl fmt::Display for UnknownCells<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        const SHOWN: usize = 5;
        for (i, UnknownCell { row, column, question, raw }) in self.0.iter().take(SHOWN).enumerate() {
            let and = if i > 0 { "; " } else { "" };
            write!(f, "{and}row {row}, column {column} ({question}): \"{raw}\" is not an answer")?;
            write!(f, "{}", did_you_mean(raw, Choice::ALL.map(Choice::name)))?;
        }
        if self.0.len() > SHOWN {
            write!(f, "; and {} more", number_of(self.0.len() - SHOWN, "cell"))?;
        }
        let mut words: Vec<&str> = Vec::new();
        for UnknownCell { raw, .. } in self.0 {
            if words.len() < SHOWN && !words.contains(&raw.as_str()) {
                words.push(raw);
            }
        }
        let words: Vec<String> = words.iter().map(|word| format!("\"{word}\"")).collect();
        // A question ends with its mark.
        let end = match self.0 {
            [only] if !did_you_mean(&only.raw, Choice::ALL.map(Choice::name)).is_empty() => "",
            _ => ".",
        };
        write!(
            f,
            "{end} Known: {}; declare what {} mean{} as `synonyms`, or `unknown = \"leave-out\"` to leave such cells out",
            self.1,
            words.join(", "),
            if words.len() == 1 { "s" } else { "" }
        )
    }
}

/// `1 row`, `2 rows`.
pub(crate) fn number_of(count: usize, noun: &str) -> String {
    format!("{count} {noun}{}", if count == 1 { "" } else { "s" })
}

/// A cell as messages quote it: one line, at most 60 characters, and no e-mail address.
pub(crate) fn shorten(cell: &str) -> String {
    const MOST: usize = 60;
    let one_line = |c: char| if c.is_control() { ' ' } else { c };
    if address::is_address(cell) {
        return "(an e-mail address)".into();
    }
    let length = cell.chars().count();
    if length <= MOST {
        return cell.chars().map(one_line).collect();
    }
    let start: String = cell.chars().take(MOST).map(one_line).collect();
    format!("{start}... ({length} characters)")
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::error::Error;

    #[test]
    fn a_source_is_said_once_in_the_chain() {
        let source = std::io::Error::other("disk on fire");
        let error = ReadError::File { file: "a.csv".into(), source };
        assert!(!error.to_string().contains("disk on fire"));
        assert_eq!(error.source().unwrap().to_string(), "disk on fire");
        let error = ReadError::Content { file: "a.csv".into(), fault: Box::new(Fault::Empty) };
        assert!(error.source().is_none());
    }

    #[test]
    fn long_cells_are_cut() {
        assert_eq!(shorten("a\nb"), "a b");
        let long = shorten(&"ä".repeat(10_000_000));
        assert!(long.ends_with("... (10000000 characters)") && long.chars().count() < 100);
    }
}
