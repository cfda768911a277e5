//! The answers: one row a respondent, one column a question.

use crate::answers_error::AnswersError;
use design::Study;
use polars::prelude::*;
use polars_io::SerReader;
use polars_io::csv::read::CsvReadOptions;
use std::io::Cursor;
use std::path::Path;

/// One answer.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Choice {
    /// The left animation; `L` in the file.
    Left,
    /// No preference; `NP`.
    NoPreference,
    /// The right animation; `R`.
    Right,
}

impl Choice {
    /// The three choices, left to right.
    pub const ALL: [Self; 3] = [Self::Left, Self::NoPreference, Self::Right];

    /// How the file writes it.
    pub fn code(self) -> &'static str {
        match self {
            Self::Left => "L",
            Self::NoPreference => "NP",
            Self::Right => "R",
        }
    }

    /// The choice with this code; exact, without trimming or case folding.
    pub fn from_code(code: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|choice| choice.code() == code)
    }
}

/// Checked answers: every respondent has answered every question of the study.
#[derive(Debug, Clone)]
pub struct Answers {
    /// One column of codes a question, in the study's order whatever the file's; one row a respondent.
    pub(crate) frame: DataFrame,
}

/// Reads the study's own table: a header of question ids in any order, then cells `L`, `NP`, `R`.
///
/// A byte-order mark, CRLF line ends, quoted cells and blank lines at the end are tolerated. Nothing is dropped.
///
/// # Errors
/// The first thing that is wrong, with file, row and column: see [`AnswersError`].
pub fn read_answers(path: &Path, study: &Study) -> Result<Answers, AnswersError> {
    let bytes = std::fs::read(path).map_err(|source| AnswersError::Read { file: path.into(), source })?;
    Answers::parse(&bytes, path, study)
}

impl Answers {
    /// As [`read_answers`], from the file's content; `path` names it in errors.
    ///
    /// # Errors
    /// As for [`read_answers`].
    pub fn parse(bytes: &[u8], path: &Path, study: &Study) -> Result<Self, AnswersError> {
        let text = std::str::from_utf8(bytes).map_err(|error| {
            let row = 1 + bytes[..error.valid_up_to()].iter().filter(|&&b| b == b'\n').count() as u64;
            AnswersError::Encoding { file: path.into(), row }
        })?;
        let text = text.strip_prefix('\u{feff}').unwrap_or(text).trim_end_matches(['\r', '\n']);
        // Twice through a small file: the first pass knows lines and columns, which polars does not report.
        check(text, path, study)?;
        let table =
            |error: PolarsError| AnswersError::Table { file: path.into(), message: error.to_string() };
        let every_column_text = CsvReadOptions::default().with_infer_schema_length(Some(0));
        let frame = every_column_text
            .into_reader_with_file_handle(Cursor::new(format!("{text}\n").into_bytes()))
            .finish()
            .map_err(table)?;
        let questions = study.comparisons.iter().map(|c| c.question.as_str());
        Ok(Self { frame: frame.select(questions).map_err(table)? })
    }

    /// How many people answered.
    pub fn respondents(&self) -> usize {
        self.frame.height()
    }

    /// Everybody's answer to one question, in the file's order of people.
    ///
    /// # Panics
    /// If the study that the answers were read for has no comparison of this index.
    pub fn to_question(&self, comparison: usize) -> Vec<Choice> {
        let column = self.frame.columns()[comparison].str().expect("read as text");
        column.iter().map(|cell| cell.and_then(Choice::from_code).expect("checked when read")).collect()
    }
}

/// The whole file, cell by cell; `text` has no byte-order mark and no blank end.
fn check(text: &str, path: &Path, study: &Study) -> Result<(), AnswersError> {
    let file = || path.to_path_buf();
    if let Some(blank) = text.lines().position(|line| line.trim().is_empty()) {
        return Err(AnswersError::BlankRow { file: file(), row: blank as u64 + 1 });
    }
    let mut rows = csv::ReaderBuilder::new()
        .has_headers(false)
        .flexible(true)
        .from_reader(text.as_bytes())
        .into_records();
    let Some(header) = rows.next() else { return Err(AnswersError::Empty { file: file() }) };
    let header = header.expect("text in memory, already known to be UTF-8");
    for (i, name) in header.iter().enumerate() {
        if !study.comparisons.iter().any(|c| c.question == name) {
            return Err(AnswersError::UnknownQuestion { file: file(), column: i + 1, name: name.into() });
        }
        if let Some(first) = header.iter().take(i).position(|earlier| earlier == name) {
            let (column, first) = (i + 1, first + 1);
            return Err(AnswersError::DuplicateQuestion { file: file(), column, first, name: name.into() });
        }
    }
    if let Some(missing) = study.comparisons.iter().find(|c| header.iter().all(|name| name != c.question)) {
        return Err(AnswersError::MissingQuestion { file: file(), name: missing.question.clone() });
    }
    let mut respondents = 0;
    for row in rows {
        let cells = row.expect("text in memory, already known to be UTF-8");
        let row = cells.position().map_or(0, csv::Position::line);
        if cells.len() != header.len() {
            let (expected, found) = (header.len(), cells.len());
            return Err(AnswersError::CellCount { file: file(), row, expected, found });
        }
        if let Some(i) = cells.iter().position(|cell| Choice::from_code(cell).is_none()) {
            let (question, cell) = (header[i].into(), cells[i].into());
            return Err(AnswersError::UnknownChoice { file: file(), row, column: i + 1, question, cell });
        }
        respondents += 1;
    }
    if respondents == 0 {
        return Err(AnswersError::NoAnswers { file: file() });
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture;

    /// The paper's answers, with a change, read again.
    fn read_changed(change: impl Fn(String) -> String) -> Result<Answers, AnswersError> {
        let study = fixture::study();
        let text = std::fs::read_to_string(study.responses.as_deref().unwrap()).unwrap();
        Answers::parse(change(text.replace("\r\n", "\n")).as_bytes(), Path::new("answers.csv"), &study)
    }

    fn error(change: impl Fn(String) -> String) -> String {
        read_changed(change).map(|_| ()).unwrap_err().to_string()
    }

    fn replace_line(text: &str, line: usize, with: impl Fn(&str) -> String) -> String {
        let changed = text.lines().enumerate().map(|(i, l)| if i + 1 == line { with(l) } else { l.into() });
        changed.collect::<Vec<_>>().join("\n")
    }

    #[test]
    fn tolerates_marks_line_ends_quotes_and_blank_ends() {
        let plain = read_changed(|text| text).unwrap();
        assert_eq!(plain.respondents(), 18);
        use Choice::{Left, NoPreference, Right};
        // Q3 on the sphere: 0 left, 12 right, 6 none, beginning none, none, right, right.
        assert_eq!(plain.to_question(2)[..4], [NoPreference, NoPreference, Right, Right]);
        assert_eq!(plain.to_question(6).iter().filter(|&&c| c == Left).count(), 16);
        let changes: [fn(String) -> String; 4] = [
            |text| format!("\u{feff}{text}"),
            |text| text.replace('\n', "\r\n"),
            |text| format!("{text}\n\r\n"),
            |text| text.replace("NP", "\"NP\"").replacen("Q1,", "\"Q1\",", 1),
        ];
        for change in changes {
            assert!(read_changed(change).unwrap().frame.equals(&plain.frame));
        }
    }

    #[test]
    fn names_row_and_column() {
        let got = error(|text| replace_line(&text, 1, |line| line.replacen("Q2", "Q99", 1)));
        assert_eq!(got, "answers.csv: row 1, column 2: \"Q99\" is not a question of this study");
        let got = error(|text| replace_line(&text, 1, |line| line.replacen("Q2,", "Q1,", 1)));
        assert_eq!(got, "answers.csv: row 1, column 2: question Q1 is already in column 1");
        let got =
            error(|text| text.lines().map(|l| &l[..l.rfind(',').unwrap()]).collect::<Vec<_>>().join("\n"));
        assert_eq!(got, "answers.csv: row 1: no column for question Q27");
        let got = error(|text| replace_line(&text, 4, |line| line.replacen("R,R", "R,r", 1)));
        assert_eq!(got, "answers.csv: row 4, column 2 (Q2): \"r\" is not an answer; write L, NP or R");
        let got = error(|text| replace_line(&text, 5, |line| format!(",{}", &line[2..])));
        assert_eq!(got, "answers.csv: row 5, column 1 (Q1): \"\" is not an answer; write L, NP or R");
        let got = error(|text| replace_line(&text, 19, |line| format!("{line},R")));
        assert_eq!(got, "answers.csv: row 19: 28 cells; the header has 27");
        let got = error(|text| replace_line(&text, 3, |_| "R,R".into()));
        assert_eq!(got, "answers.csv: row 3: 2 cells; the header has 27");
        let got = error(|text| replace_line(&text, 7, |_| String::new()));
        assert_eq!(got, "answers.csv: row 7: blank row inside the table");
    }

    #[test]
    fn refuses_files_without_answers() {
        assert_eq!(
            error(|_| String::new()),
            "answers.csv: row 1: empty; expected a header with the study's question ids"
        );
        assert_eq!(error(|_| "\u{feff}\r\n".into()), error(|_| String::new()));
        let got = error(|text| text.lines().next().unwrap().into());
        assert_eq!(got, "answers.csv: row 2: no answers under the header");
        let study = fixture::study();
        let got = Answers::parse(b"Q1\n\xff\n", Path::new("answers.csv"), &study).unwrap_err().to_string();
        assert_eq!(got, "answers.csv: row 2: not UTF-8 text");
        let got = read_answers(Path::new("/nowhere/answers.csv"), &study).unwrap_err().to_string();
        assert!(got.starts_with("/nowhere/answers.csv: cannot be read"), "{got}");
    }
}
