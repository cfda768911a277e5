//! How a study stands.

use super::departures::Departures;
use super::{GIVEN_UP_MS, Journal};
use isostudy_design::forms::KeyEntry;
use serde::Serialize;
use std::collections::{BTreeMap, HashMap};

/// How a study stands, without a word on what was chosen.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Summary {
    /// Participants who began, those who have answered nothing yet and have not given up among them.
    pub started: usize,
    /// Who answered all questions.
    pub finished: usize,
    /// Who have neither finished nor been silent for two hours.
    pub answering: usize,
    /// By form: number, who began and did not give up, who finished.
    pub forms: Vec<[usize; 3]>,
    /// How many have left of whom nothing is kept.
    pub departures: Departures,
    /// Answers.
    pub answers: u64,
    /// Answers in each of the last 60 minutes, the newest last.
    pub per_minute: Vec<u64>,
    /// By question, as the key calls it: its id, answers, median time in milliseconds.
    pub questions: Vec<(String, u64, f64)>,
}

impl Journal {
    /// How the study stands; `key` tells which question was at which place.
    ///
    /// # Errors
    /// If SQLite fails.
    pub fn summary(&self, now_ms: i64, key: &[KeyEntry]) -> rusqlite::Result<Summary> {
        let mut forms: Vec<[usize; 3]> = (1..=self.forms.len()).map(|form| [form, 0, 0]).collect();
        let (mut started, mut answering) = (self.people.len(), 0);
        for person in &self.people {
            let here = now_ms - person.last_ms < GIVEN_UP_MS;
            answering += usize::from(here && !person.finished);
            forms[person.form - 1][1] += usize::from(here || person.finished);
            forms[person.form - 1][2] += usize::from(person.finished);
        }
        for newcomer in self.waiting.iter().filter(|one| now_ms - one.since_ms < GIVEN_UP_MS) {
            started += 1;
            answering += 1;
            forms[newcomer.form - 1][1] += 1;
        }
        let asked: HashMap<(usize, usize), &str> =
            key.iter().map(|line| ((line.form, line.order), line.question.as_str())).collect();
        let mut per_minute = vec![0; 60];
        // Shorter ids first, so that Q10 follows Q9.
        let mut times: BTreeMap<(usize, &str), Vec<u32>> = BTreeMap::new();
        let mut statement = self.answers.prepare(
            "SELECT form, place, rt_ms, received_ms FROM answers JOIN participants ON participant = number",
        )?;
        let mut rows = statement.query([])?;
        let mut answers = 0;
        while let Some(row) = rows.next()? {
            answers += 1;
            let (form, place): (i64, i64) = (row.get(0)?, row.get(1)?);
            if let Some(question) = asked.get(&(form as usize, place as usize)) {
                times.entry((question.len(), question)).or_default().push(row.get(2)?);
            }
            let ago = (now_ms - row.get::<_, i64>(3)?).max(0) / 60_000;
            if ago < 60 {
                per_minute[59 - ago as usize] += 1;
            }
        }
        let question =
            |((_, id), times): ((usize, &str), Vec<u32>)| (id.to_owned(), times.len() as u64, median(times));
        let questions = times.into_iter().map(question).collect();
        let finished = self.people.iter().filter(|person| person.finished).count();
        let departures = self.departures()?;
        Ok(Summary { started, finished, answering, forms, departures, answers, per_minute, questions })
    }
}

fn median(mut times: Vec<u32>) -> f64 {
    times.sort_unstable();
    let half = times.len() / 2;
    if times.len() % 2 == 1 {
        f64::from(times[half])
    } else {
        (f64::from(times[half - 1]) + f64::from(times[half])) / 2.0
    }
}
