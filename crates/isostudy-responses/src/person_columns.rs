//! What a file says of people beside their answers, such as their experience: columns by participant.
//!
//! The file may be one of persons, with a row for each, or the long format itself, with a row for each answer: a column has one value
//! for one person in either.

use crate::decode::archive;
use crate::decode::records::{Record, is_blank, trim};
use crate::decode::source::Source;
use crate::decode::text;
use crate::error::{Fault, ReadError, number_of, shorten};
use crate::name;
use crate::read::LARGEST_FILE;
use crate::value::{Participant, PersonColumn};
use crate::words::{is_na, normalise};
use isostudy_table::formula::unescape;
use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};

/// Columns that were read, and whom they are about.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PersonColumns {
    /// The columns, in the order in which they were asked for.
    pub columns: Vec<PersonColumn>,
    /// Participants who are in the file.
    pub known: usize,
    /// People in the file who are no participants.
    pub others: usize,
}

/// Why columns of people cannot be read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PersonColumnsError {
    /// The file cannot be read, or its text is damaged.
    #[error(transparent)]
    File(#[from] ReadError),
    /// A column is not there.
    #[error("{}: row {row}: the header has no column {name}; it has {header}", file.display())]
    NoColumn {
        /// The file.
        file: PathBuf,
        /// Row of the header.
        row: u64,
        /// The column.
        name: String,
        /// The titles that are there.
        header: String,
    },
    /// One person has two values.
    #[error(
        "{}: row {row}: {participant} has {value}, and \"{first_value}\" in row {first}; a person has one value",
        file.display()
    )]
    TwoValues {
        /// The file.
        file: PathBuf,
        /// Row of the second value.
        row: u64,
        /// Row of the first.
        first: u64,
        /// The person.
        participant: String,
        /// The column and the second value.
        value: String,
        /// The first value.
        first_value: String,
    },
    /// Nobody in it answered.
    #[error("{}: none of its {people} is a participant of the answers; the ids must be the same", file.display())]
    Nobody {
        /// The file.
        file: PathBuf,
        /// How many people it has.
        people: String,
    },
}

/// Reads columns of a CSV file with a column `participant`, for those who answered.
///
/// Empty cells and `NA` say nothing. People who did not answer are counted and left out. The order of rows and columns does not matter.
///
/// # Errors
/// See [`PersonColumnsError`]: it names file and row.
pub fn read_person_columns(
    path: &Path,
    wanted: &[String],
    participants: &[Participant],
) -> Result<PersonColumns, PersonColumnsError> {
    let failed = |source: std::io::Error| ReadError::File { file: path.into(), source };
    let bytes = isostudy_foreign::bytes(path, LARGEST_FILE).map_err(|error| failed(error.into()))?;
    parse_person_columns(&bytes, path, wanted, participants)
}

/// As [`read_person_columns`], from the file's content; `path` names it in messages.
///
/// # Errors
/// As there.
pub fn parse_person_columns(
    bytes: &[u8],
    path: &Path,
    wanted: &[String],
    participants: &[Participant],
) -> Result<PersonColumns, PersonColumnsError> {
    let content = |fault: Fault| ReadError::Content { file: path.into(), fault: Box::new(fault) };
    if archive::is_zip(bytes) {
        let fault = Fault::Archive("a zip file or workbook: save its columns of people as CSV".into());
        return Err(content(fault).into());
    }
    let (decoded, _) = text::decode(bytes).map_err(content)?;
    if is_blank(&decoded) {
        return Err(content(Fault::Empty).into());
    }
    let (separator, rest, _) = text::separator(&decoded, None).map_err(content)?;
    let source = Source::Text { text: rest, separator };
    let head = source.head().map_err(content)?;
    let (header_row, header) = &head[0];
    let find = |name: &str| {
        let place = header.iter().position(|title| normalise(title) == normalise(name));
        place.ok_or_else(|| PersonColumnsError::NoColumn {
            file: path.into(),
            row: *header_row,
            name: shorten(name),
            header: header.iter().map(|title| shorten(trim(title))).collect::<Vec<_>>().join(", "),
        })
    };
    let person = find("participant")?;
    let places: Vec<usize> = wanted.iter().map(|name| find(name)).collect::<Result<_, _>>()?;
    let by_id: HashMap<&str, usize> =
        participants.iter().enumerate().map(|(place, of)| (of.id.as_str(), place)).collect();
    let blank = |name: &String| PersonColumn { name: name.clone(), values: vec![None; participants.len()] };
    let mut columns: Vec<PersonColumn> = wanted.iter().map(blank).collect();
    // By column and participant, the row that said it.
    let mut said = vec![vec![0_u64; participants.len()]; wanted.len()];
    let mut is_known = vec![false; participants.len()];
    let mut others: HashSet<String> = HashSet::new();
    let mut two: Option<PersonColumnsError> = None;
    let visited = source.each(|record| {
        if record.row <= *header_row || record.is_blank() {
            return Ok(());
        }
        let (expected, found) = (header.len(), record.cells.len());
        let beyond = record.cells.iter().skip(expected).any(|cell| !is_blank(cell));
        if beyond || found < expected {
            return Err(Fault::CellCount { row: record.row, expected, found });
        }
        let id = cell(record, person, "participant")?;
        let Some(&participant) = by_id.get(id) else {
            others.insert(id.to_owned());
            return Ok(());
        };
        is_known[participant] = true;
        for (place, &column) in places.iter().enumerate() {
            let value = cell(record, column, &wanted[place])?;
            if value.is_empty() || is_na(value) {
                continue;
            }
            let known = &mut columns[place].values[participant];
            match known {
                None => {
                    *known = Some(value.to_owned());
                    said[place][participant] = record.row;
                }
                Some(first) if first == value => {}
                Some(first) => {
                    two.get_or_insert(PersonColumnsError::TwoValues {
                        file: path.into(),
                        row: record.row,
                        first: said[place][participant],
                        participant: shorten(id),
                        value: format!("{} \"{}\"", shorten(&wanted[place]), shorten(value)),
                        first_value: shorten(first),
                    });
                }
            }
        }
        Ok(())
    });
    visited.map_err(content)?;
    if let Some(two) = two {
        return Err(two);
    }
    let known = is_known.into_iter().filter(|known| *known).count();
    if known == 0 {
        let people = number_of(others.len(), "participant");
        return Err(PersonColumnsError::Nobody { file: path.into(), people });
    }
    Ok(PersonColumns { columns, known, others: others.len() })
}

/// A cell as it was before it was made safe for spreadsheets.
fn cell<'r>(record: &'r Record<'_>, column: usize, name: &str) -> Result<&'r str, Fault> {
    let text = unescape(trim(record.cell(column)));
    match name::is_too_long(text) {
        false => Ok(text),
        true => Err(Fault::Cell {
            row: record.row,
            column: column + 1,
            name: shorten(name),
            cell: shorten(text),
            limit: name::limit(),
        }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn participants(ids: &[&str]) -> Vec<Participant> {
        ids.iter().map(|id| Participant { id: (*id).into(), form: None }).collect()
    }

    fn read(text: &str, wanted: &[&str]) -> Result<PersonColumns, String> {
        let wanted: Vec<String> = wanted.iter().map(|name| (*name).into()).collect();
        let path = Path::new("people.csv");
        let people = participants(&["ann", "bob", "cy"]);
        parse_person_columns(text.as_bytes(), path, &wanted, &people).map_err(|error| error.to_string())
    }

    fn values(of: &PersonColumn) -> Vec<&str> {
        of.values.iter().map(|value| value.as_deref().unwrap_or("-")).collect()
    }

    #[test]
    fn a_row_for_each_person_in_any_order() {
        let found =
            read("Age;participant;job\n31; cy ;NA\n\n44;ann;\"a; b\"\n9;dan;x\n", &["job", "age"]).unwrap();
        assert_eq!((found.known, found.others), (2, 1));
        assert_eq!(values(&found.columns[0]), ["a; b", "-", "-"]);
        assert_eq!(values(&found.columns[1]), ["44", "-", "31"]);
        assert_eq!(found.columns[0].name, "job");
    }

    #[test]
    fn a_row_for_each_answer_says_one_thing_of_a_person() {
        let long =
            "participant,question,choice,site\nann,1,left,A\nbob,1,none,B\nann,2,left,\nann,3,right,A\n";
        let found = read(long, &["site"]).unwrap();
        assert_eq!(values(&found.columns[0]), ["A", "B", "-"]);
        let two = format!("{long}ann,4,left,B\n");
        assert_eq!(
            read(&two, &["site"]).unwrap_err(),
            "people.csv: row 6: ann has site \"B\", and \"A\" in row 2; a person has one value"
        );
    }

    #[test]
    fn what_is_wrong_names_file_and_row() {
        let wrong = |text: &str, wanted: &str, message: &str| {
            let said = read(text, &[wanted]).unwrap_err();
            assert!(said.starts_with("people.csv") && said.contains(message), "{said}");
        };
        wrong(
            "participant,age\nann,3\n",
            "job",
            "row 1: the header has no column job; it has participant, age",
        );
        wrong("person,age\nann,3\n", "age", "no column participant");
        wrong("participant,age\nzoe,3\nyan,4\n", "age", "none of its 2 participants");
        wrong("participant,age\nann\n", "age", "row 2");
        wrong("", "age", "empty");
        wrong("PK\u{3}\u{4}abc", "age", "save its columns of people as CSV");
        wrong(&format!("participant,age\nann,{}\n", "x".repeat(100_000)), "age", "row 2");
    }
}
