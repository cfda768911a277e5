//! Files that the page lets participants download where there is no server.

use crate::export::Given;
use crate::record::{Answer, Choice};
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
}

#[derive(Deserialize)]
struct File {
    study: String,
    answers: Vec<Row>,
}

/// Why a download cannot be read.
#[derive(Debug, thiserror::Error)]
pub enum DownloadError {
    /// Not CSV with the page's columns.
    #[error("{0}")]
    Csv(#[from] csv::Error),
    /// Not the page's JSON.
    #[error("{0}")]
    Json(#[from] serde_json::Error),
    /// Answers to something else.
    #[error("holds answers to study {0}")]
    OtherStudy(String),
}

/// The answers of one download, CSV or JSON by their first character.
///
/// # Errors
/// [`DownloadError`].
pub fn read(text: &str, study: &str) -> Result<Vec<Given>, DownloadError> {
    let rows: Vec<Row> = if text.trim_start().starts_with('{') {
        let file: File = serde_json::from_str(text)?;
        if file.study != study {
            return Err(DownloadError::OtherStudy(file.study));
        }
        file.answers
    } else {
        csv::Reader::from_reader(text.trim_start_matches('\u{feff}').as_bytes())
            .deserialize()
            .collect::<Result<_, _>>()?
    };
    let given = |Row { participant, form, order, stimulus, choice, rt_ms }| Given {
        participant,
        form,
        answer: Answer { order, stimulus, choice, rt_ms },
    };
    Ok(rows.into_iter().map(given).collect())
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

    const CSV: &str = "participant,form,order,stimulus,choice,rt_ms,answered\r\nab,2,2,tani,NP,812,2026-11-21T10:00:00Z\r\n";

    #[test]
    fn csv_and_json_are_the_same_answers() {
        let json = r#"{"schema":1,"study":"s","participant":"ab","form":2,"started":"x","finished":"y","answers":[
            {"participant":"ab","form":2,"order":2,"stimulus":"tani","choice":"NP","rt_ms":812,"answered":"z"}]}"#;
        let (csv, json) = (read(CSV, "s").unwrap(), read(json, "s").unwrap());
        assert_eq!(csv, json);
        assert_eq!(csv[0].answer.choice, Choice::Np);
        let mut all = BTreeMap::new();
        assert_eq!(add(&mut all, csv), Ok(0));
        assert_eq!(add(&mut all, json), Ok(1));
        let other = read(&CSV.replace("NP", "L"), "s").unwrap();
        assert_eq!(add(&mut all, other), Err(Contradiction { participant: "ab".into(), order: 2 }));
        assert_eq!(all.len(), 1);
    }

    #[test]
    fn what_is_not_a_download_says_where() {
        let wrong = |text: &str| read(text, "s").unwrap_err().to_string();
        assert!(
            wrong(&CSV.replace("NP", "maybe")).contains("record 1"),
            "{}",
            wrong(&CSV.replace("NP", "maybe"))
        );
        assert!(wrong("a,b\n1,2\n").contains("missing field"));
        assert_eq!(wrong(r#"{"study":"t","answers":[]}"#), "holds answers to study t");
    }
}
