//! Files that the page lets participants download where there is no server.

use crate::cameras::{Track, Tracked};
use crate::export::Given;
use crate::record::{About, Answer, Choice};
use crate::screen;
use isostudy_design::config::AnswerKind;
use isostudy_design::forms::FormFile;
use serde::Deserialize;
use std::collections::BTreeMap;

/// A row of the CSV, or an answer of the JSON.
#[derive(Deserialize)]
struct Row {
    participant: String,
    form: usize,
    order: u32,
    stimulus: String,
    choice: Choice,
    rt_ms: u32,
    // What downloads of earlier versions lack; texts, since in JSON they are numbers and in CSV they are not.
    #[serde(default)]
    viewport_width: Cell,
    #[serde(default)]
    viewport_height: Cell,
    #[serde(default)]
    pixel_ratio: Cell,
    #[serde(default)]
    surface_px: Cell,
    #[serde(default)]
    layout: Cell,
    #[serde(default)]
    input: Cell,
    #[serde(default)]
    dropped: Cell,
    #[serde(default)]
    hidden_ms: Cell,
    #[serde(default)]
    shown_as: Cell,
    #[serde(default)]
    turned_deg: Cell,
    /// From where models were looked at, which JSON alone has.
    #[serde(default)]
    track: Option<Track>,
}

/// A cell of the CSV, or a value of the JSON.
#[derive(Default, Deserialize)]
#[serde(untagged)]
enum Cell {
    #[default]
    Nothing,
    Whole(u64),
    Number(f64),
    Text(String),
}

impl Cell {
    fn text(&self) -> String {
        match self {
            Self::Nothing => String::new(),
            Self::Whole(number) => number.to_string(),
            Self::Number(number) => number.to_string(),
            Self::Text(text) => text.clone(),
        }
    }
}

#[derive(Deserialize)]
struct File {
    study: String,
    answers: Vec<Row>,
    participant: Option<String>,
    /// What people said of themselves; no earlier version asked.
    about: Option<About>,
}

/// Why a download cannot be read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum DownloadError {
    /// Not CSV.
    #[error("{0}")]
    Csv(#[from] csv::Error),
    /// Not CSV with the page's columns.
    #[error(
        "line 1: is no download of the questionnaire's page. It needs the columns {}. {}",
        NEEDED.join(", "),
        lacking(missing, found)
    )]
    Columns {
        /// Columns that are needed and not there.
        missing: Vec<&'static str>,
        /// Columns that are there.
        found: Vec<String>,
    },
    /// A cell that the page would not write.
    #[error("line {line}: {column} = {value}: allowed: {allowed}")]
    Cell {
        /// The line of the file, from 1.
        line: u64,
        /// The column's name.
        column: String,
        /// What it says.
        value: String,
        /// What it may say.
        allowed: String,
    },
    /// An answer that nobody can give who is asked in the study's way.
    #[error("the answer at place {order}: choice = {value}: allowed: {allowed}")]
    Choice {
        /// Which answer.
        order: u32,
        /// What it says.
        value: &'static str,
        /// What it may say.
        allowed: String,
    },
    /// Not the page's JSON.
    #[error("{0}")]
    Json(#[from] serde_json::Error),
    /// Answers to something else.
    #[error("holds answers to study {0}")]
    OtherStudy(String),
    /// Not what the page says of a screen.
    #[error("the answer at place {order}: {why}")]
    Screen {
        /// Which answer.
        order: u32,
        /// What is wrong.
        why: String,
    },
    /// Not what the page says of cameras.
    #[error("the answer at place {order}: no page notes such cameras")]
    Cameras {
        /// Which answer.
        order: u32,
    },
}

/// The answers of one download to a study's forms, CSV or JSON by their first character.
///
/// # Errors
/// [`DownloadError`].
pub fn read(text: &str, study: &FormFile) -> Result<Vec<Given>, DownloadError> {
    let rows: Vec<Row> = if text.trim_start().starts_with('{') {
        let file: File = serde_json::from_str(text)?;
        if file.study != study.study {
            return Err(DownloadError::OtherStudy(file.study));
        }
        if let Some(row) = file.answers.iter().find(|row| !row.choice.is_of(&study.answers())) {
            let (order, value) = (row.order, row.choice.code());
            return Err(DownloadError::Choice { order, value, allowed: codes(&study.answers()) });
        }
        file.answers
    } else {
        rows(text.trim_start_matches('\u{feff}'), &study.answers())?
    };
    rows.into_iter().map(given).collect()
}

/// What a download says of the person who answered: the name in the answers, and answers by the ids of the questions. CSV says nothing of
/// people.
///
/// # Errors
/// [`DownloadError`].
pub fn read_about(text: &str) -> Result<Option<(String, About)>, DownloadError> {
    if !text.trim_start().starts_with('{') {
        return Ok(None);
    }
    let File { participant, about, .. } = serde_json::from_str(text)?;
    Ok(participant.zip(about))
}

/// From where models were looked at, answer by answer. CSV does not say it.
///
/// # Errors
/// [`DownloadError`].
pub fn read_cameras(text: &str) -> Result<Vec<Tracked>, DownloadError> {
    if !text.trim_start().starts_with('{') {
        return Ok(Vec::new());
    }
    let File { answers, .. } = serde_json::from_str(text)?;
    let of = |Row { participant, form, order, stimulus, track, .. }: Row| {
        let track = track?;
        Some(match track.is_sound() {
            true => Ok(Tracked { participant, form, order, stimulus, track }),
            false => Err(DownloadError::Cameras { order }),
        })
    };
    answers.into_iter().filter_map(of).collect()
}

/// The columns that every download has had.
const NEEDED: [&str; 6] = ["participant", "form", "order", "stimulus", "choice", "rt_ms"];

/// The codes of the answers, for messages.
fn codes(answers: &[AnswerKind]) -> String {
    answers.iter().map(|of| of.code).collect::<Vec<_>>().join(", ")
}

/// The rows of a CSV.
fn rows(text: &str, answers: &[AnswerKind]) -> Result<Vec<Row>, DownloadError> {
    let mut reader = csv::Reader::from_reader(text.as_bytes());
    let header = reader.headers()?.clone();
    let missing: Vec<&str> = NEEDED.into_iter().filter(|name| header.iter().all(|of| of != *name)).collect();
    if !missing.is_empty() {
        return Err(DownloadError::Columns { missing, found: header.iter().map(str::to_owned).collect() });
    }
    let mut rows = Vec::new();
    for record in reader.records() {
        let record = record?;
        if let Some(wrong) = wrong_cell(text, answers, &header, &record) {
            return Err(wrong);
        }
        rows.push(record.deserialize(Some(&header))?);
    }
    Ok(rows)
}

/// What a file with these columns has in their place.
fn lacking(missing: &[&str], found: &[String]) -> String {
    let found = match found {
        [] => "This file is empty".to_owned(),
        _ => format!("This file has {}", found.join(", ")),
    };
    if missing.len() == NEEDED.len() { found } else { format!("Missing: {}. {found}", missing.join(", ")) }
}

/// Which cell of a row the page would not write.
fn wrong_cell(
    text: &str,
    answers: &[AnswerKind],
    header: &csv::StringRecord,
    record: &csv::StringRecord,
) -> Option<DownloadError> {
    // The reader counts a line when it has read the \n of \r\n, which it does with the record behind it.
    let line = || {
        let begin = record.position().map_or(0, |position| position.byte() as usize).min(text.len());
        let (before, rest) = text.as_bytes().split_at(begin);
        let ends =
            before.iter().filter(|&&byte| byte == b'\n').count() + usize::from(rest.first() == Some(&b'\n'));
        1 + ends as u64
    };
    let cells = header.iter().zip(record);
    let mut wrong = cells.filter_map(|(column, value)| {
        let allowed: String = match column {
            "form" | "order" | "rt_ms" if value.parse::<u32>().is_err() => "a whole number".into(),
            "choice" if Choice::of_code(value).is_none_or(|choice| !choice.is_of(answers)) => codes(answers),
            _ => return None,
        };
        Some(DownloadError::Cell { line: line(), column: column.into(), value: value.into(), allowed })
    });
    wrong.next()
}

fn given(row: Row) -> Result<Given, DownloadError> {
    let cells = [
        row.viewport_width,
        row.viewport_height,
        row.pixel_ratio,
        row.surface_px,
        row.layout,
        row.input,
        row.dropped,
        row.hidden_ms,
        row.shown_as,
        row.turned_deg,
    ];
    let Row { participant, form, order, stimulus, choice, rt_ms, .. } = row;
    let screen = screen::of_cells(&cells.each_ref().map(Cell::text))
        .map_err(|why| DownloadError::Screen { order, why })?;
    Ok(Given { participant, form, answer: Answer { order, stimulus, choice, rt_ms, screen, change: 0 } })
}

/// Two files that contradict each other: participant and place.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("participant {participant} answered place {order} twice, and otherwise")]
pub struct Contradiction {
    participant: String,
    order: u32,
}

/// Adds what is not there yet; the CSV and the JSON of one participant are the same answers. Returns how many were.
///
/// # Errors
/// If an answer is there that says something else.
pub fn add(all: &mut BTreeMap<(String, u32), Given>, given: Vec<Given>) -> Result<usize, Contradiction> {
    let mut again = 0;
    for given in given {
        let key = (given.participant.clone(), given.answer.order);
        match all.get(&key) {
            Some(known) if *known == given => again += 1,
            Some(_) => return Err(Contradiction { participant: key.0, order: key.1 }),
            None => drop(all.insert(key, given)),
        }
    }
    Ok(again)
}

#[cfg(test)]
mod tests {
    use super::*;
    use isostudy_design::config::Way;

    fn study() -> FormFile {
        FormFile { study: "s".into(), ..crate::export::tests::empty_file() }
    }

    const CSV: &str = "participant,form,order,stimulus,choice,rt_ms,answered\r\nab,2,2,tani,NP,812,2026-11-21T10:00:00Z\r\n";

    #[test]
    fn csv_and_json_are_the_same_answers() {
        let json = r#"{"schema":1,"study":"s","participant":"ab","form":2,"started":"x","finished":"y","answers":[
            {"participant":"ab","form":2,"order":2,"stimulus":"tani","choice":"NP","rt_ms":812,"answered":"z"}]}"#;
        let (csv, json) = (read(CSV, &study()).unwrap(), read(json, &study()).unwrap());
        assert_eq!(csv, json);
        assert_eq!(csv[0].answer.choice, Choice::Np);
        let mut all = BTreeMap::new();
        assert_eq!(add(&mut all, csv), Ok(0));
        assert_eq!(add(&mut all, json), Ok(1));
        let other = read(&CSV.replace("NP", "L"), &study()).unwrap();
        assert_eq!(add(&mut all, other), Err(Contradiction { participant: "ab".into(), order: 2 }));
        assert_eq!(all.len(), 1);
    }

    #[test]
    fn both_kinds_say_the_same_of_the_screen() {
        let columns = crate::screen::COLUMNS.join(",");
        let csv = format!(
            "participant,form,order,stimulus,choice,rt_ms,answered,{columns}\r\n\
             ab,2,2,tani,NP,812,z,390,844,2.625,266,stacked,touch,3,40,model,91\r\nab,2,3,zeti,L,9,z,,,,,,,,,,\r\n"
        );
        let json = r#"{"schema":1,"study":"s","participant":"ab","form":2,"started":"x","finished":"y","answers":[
            {"participant":"ab","form":2,"order":2,"stimulus":"tani","choice":"NP","rt_ms":812,"answered":"z","viewport_width":390,
             "viewport_height":844,"pixel_ratio":2.625,"surface_px":266,"layout":"stacked","input":"touch","dropped":3,
             "hidden_ms":40,"shown_as":"model","turned_deg":91},
            {"participant":"ab","form":2,"order":3,"stimulus":"zeti","choice":"L","rt_ms":9,"answered":"z"}]}"#;
        let (csv, json) = (read(&csv, &study()).unwrap(), read(json, &study()).unwrap());
        assert_eq!(csv, json);
        let screen = csv[0].answer.screen.unwrap();
        assert_eq!((screen.pixel_ratio, screen.dropped, screen.hidden_ms), (2.625, 3, 40));
        assert_eq!(csv[1].answer.screen, None);
    }

    #[test]
    fn cameras_are_in_the_json_alone() {
        let json = r#"{"schema":1,"study":"s","participant":"ab","form":2,"started":"x","finished":"y","answers":[
            {"participant":"ab","form":2,"order":2,"stimulus":"tani","choice":"NP","rt_ms":812,"answered":"z",
             "track":{"hz":20,"cameras":[0,450,222,1000,51,460,222,1000]}},
            {"participant":"ab","form":2,"order":3,"stimulus":"zeti","choice":"L","rt_ms":9,"answered":"z"}]}"#;
        let found = read_cameras(json).unwrap();
        assert_eq!((found.len(), found[0].order, found[0].stimulus.as_str()), (1, 2, "tani"));
        assert_eq!(found[0].track.cameras().last(), Some((51, 46.0, 22.2, 1.0)));
        assert_eq!(read_cameras(CSV).unwrap(), []);
        assert_eq!(read(json, &study()).unwrap().len(), 2);
        let wrong = read_cameras(&json.replace("51,460", "-1,460")).unwrap_err().to_string();
        assert_eq!(wrong, "the answer at place 2: no page notes such cameras");
    }

    #[test]
    fn only_the_answers_of_the_way_to_ask_are_read() {
        let json = r#"{"schema":1,"study":"s","participant":"ab","form":2,"started":"x","finished":"y","answers":[
            {"participant":"ab","form":2,"order":2,"stimulus":"tani","choice":"NP","rt_ms":812,"answered":"z"}]}"#;
        let [forced, graded] = [Way::Forced, Way::Graded].map(|way| FormFile { way, ..study() });
        let wrong = |text: &str, of: &FormFile| read(text, of).unwrap_err().to_string();
        assert_eq!(wrong(CSV, &forced), "line 2: choice = NP: allowed: L, R");
        assert_eq!(wrong(json, &forced), "the answer at place 2: choice = NP: allowed: L, R");
        let much = |text: &str| text.replace("NP", "RR");
        assert_eq!(wrong(&much(CSV), &study()), "line 2: choice = RR: allowed: L, NP, R");
        for text in [much(CSV), much(json)] {
            assert_eq!(read(&text, &graded).unwrap()[0].answer.choice, Choice::Rr);
        }
    }

    #[test]
    fn what_is_not_a_download_says_where() {
        let wrong = |text: &str| read(text, &study()).unwrap_err().to_string();
        assert!(
            wrong(&CSV.replace("NP", "maybe")) == "line 2: choice = maybe: allowed: L, NP, R",
            "{}",
            wrong(&CSV.replace("NP", "maybe"))
        );
        let order = wrong(&format!("{CSV}ab,2,x,tani,NP,812,z\r\n"));
        assert_eq!(order, "line 3: order = x: allowed: a whole number");
        let other_column = CSV.replace("stimulus,", "pair,");
        for (other, said) in [
            ("a,b\n1,2\n", "This file has a, b"),
            (
                other_column.as_str(),
                "Missing: stimulus. This file has participant, form, order, pair, choice, rt_ms, answered",
            ),
            ("", "This file is empty"),
        ] {
            let needed = "participant, form, order, stimulus, choice, rt_ms";
            let start = format!(
                "line 1: is no download of the questionnaire's page. It needs the columns {needed}. "
            );
            assert_eq!(wrong(other), start + said);
        }
        assert_eq!(wrong(r#"{"study":"t","answers":[]}"#), "holds answers to study t");
    }
}
