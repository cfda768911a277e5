//! How a study stands.

use super::departures::Departures;
use super::{GIVEN_UP_MS, Journal};
use crate::export::Key;
use isostudy_design::forms::KeyEntry;
use serde::Serialize;
use std::collections::BTreeMap;

/// Whoever has answered within this time is there now.
const RECENT_MS: i64 = 2 * 60_000;
/// The pace is that of this time.
const PACE_MS: i64 = 24 * 3_600_000;

/// How a study stands, without a word on what was chosen.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Summary {
    /// Participants of the plan.
    pub planned: usize,
    /// Participants who began, those who have answered nothing yet and have not given up among them.
    pub started: usize,
    /// Who answered all questions.
    pub finished: usize,
    /// Who have neither finished nor been silent for two hours.
    pub answering: usize,
    /// Who answered a question within the last two minutes.
    pub recent: usize,
    /// By form: number, who began and did not give up, who finished.
    pub forms: Vec<[usize; 3]>,
    /// Most people for each form.
    pub per_form: Option<u32>,
    /// Options of questions about the person that take so many people and no more.
    pub options: Vec<OptionCount>,
    /// How many have left of whom nothing is kept.
    pub departures: Departures,
    /// By number of answers that they gave: people who have not finished, and were silent for two hours.
    pub left: Vec<[usize; 2]>,
    /// Answers.
    pub answers: u64,
    /// Answers in each of the last 60 minutes, the newest last.
    pub per_minute: Vec<u64>,
    /// By question, as the key calls it: its id, answers, median time in milliseconds.
    pub questions: Vec<(String, u64, f64)>,
    /// Median time from beginning to end of those who finished, in milliseconds.
    pub median_ms: Option<f64>,
    /// When all participants of the plan will have finished at the pace of the last 24 hours, in milliseconds since 1970.
    pub expected_end_ms: Option<i64>,
}

/// An option that takes no more than so many people.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct OptionCount {
    /// Id of the question.
    pub question: String,
    /// The option, from 1.
    pub option: usize,
    /// Who chose it, and has finished or is answering.
    pub people: u32,
    /// Most of them.
    pub most: u32,
}

impl Journal {
    /// How the study stands; `key` tells which question was at which place.
    ///
    /// # Errors
    /// If SQLite fails.
    pub fn summary(&self, now_ms: i64, key: &[KeyEntry]) -> rusqlite::Result<Summary> {
        let mut forms: Vec<[usize; 3]> = (1..=self.forms.len()).map(|form| [form, 0, 0]).collect();
        let (mut started, mut answering, mut recent) = (self.people.len(), 0, 0);
        let mut left: BTreeMap<usize, usize> = BTreeMap::new();
        for person in &self.people {
            let here = now_ms - person.last_ms < GIVEN_UP_MS;
            answering += usize::from(here && !person.finished);
            recent += usize::from(now_ms - person.last_ms < RECENT_MS);
            forms[person.form - 1][1] += usize::from(here || person.finished);
            forms[person.form - 1][2] += usize::from(person.finished);
            if !here && !person.finished {
                *left.entry(person.choices.len()).or_default() += 1;
            }
        }
        for newcomer in self.waiting.iter().filter(|one| now_ms - one.since_ms < GIVEN_UP_MS) {
            started += 1;
            answering += 1;
            forms[newcomer.form - 1][1] += 1;
        }
        let known = Key::of(key);
        let mut per_minute = vec![0; 60];
        // Shorter ids first, so that Q10 follows Q9.
        let mut times: BTreeMap<(usize, &str), Vec<i64>> = BTreeMap::new();
        let mut statement = self.answers.prepare(
            "SELECT form, place, rt_ms, received_ms, stimulus FROM answers JOIN participants ON participant = number",
        )?;
        let mut rows = statement.query([])?;
        let mut answers = 0;
        while let Some(row) = rows.next()? {
            answers += 1;
            let (form, place): (i64, i64) = (row.get(0)?, row.get(1)?);
            let stimulus: String = row.get(4)?;
            if let Some(entry) = known.entry(form as usize, place as u32, &stimulus) {
                times.entry((entry.question.len(), &entry.question)).or_default().push(row.get(2)?);
            }
            let ago = (now_ms - row.get::<_, i64>(3)?).max(0) / 60_000;
            if ago < 60 {
                per_minute[59 - ago as usize] += 1;
            }
        }
        let question = |((_, id), times): ((usize, &str), Vec<i64>)| {
            (id.to_owned(), times.len() as u64, median(times).unwrap_or_default())
        };
        let (planned, finished) =
            (self.forms.len(), self.people.iter().filter(|person| person.finished).count());
        let ended = self.ended()?;
        Ok(Summary {
            planned,
            started,
            finished,
            answering,
            recent,
            forms,
            per_form: self.quotas.per_form,
            options: self.option_counts(now_ms),
            departures: self.departures()?,
            left: left.into_iter().map(|(answers, people)| [answers, people]).collect(),
            answers,
            per_minute,
            questions: times.into_iter().map(question).collect(),
            median_ms: median(ended.iter().map(|[began, ended]| ended - began).collect()),
            expected_end_ms: expected_end(&ended, planned.saturating_sub(finished), now_ms),
        })
    }

    /// Names of those who have finished, who finished first comes first.
    ///
    /// # Errors
    /// If SQLite fails.
    pub fn finished(&self) -> rusqlite::Result<Vec<String>> {
        let all = "SELECT name FROM participants WHERE finished_ms IS NOT NULL ORDER BY finished_ms, number";
        self.answers.prepare_cached(all)?.query_map([], |row| row.get(0))?.collect()
    }

    /// When each of those who have finished began and ended, in milliseconds.
    fn ended(&self) -> rusqlite::Result<Vec<[i64; 2]>> {
        let all = "SELECT started_ms, finished_ms FROM participants WHERE finished_ms IS NOT NULL";
        self.answers.prepare_cached(all)?.query_map([], |row| Ok([row.get(0)?, row.get(1)?]))?.collect()
    }
}

/// When so many more will have finished, at the pace of the last 24 hours, or since the first began if that is later. `None` if none
/// is missing, or nobody finished in that time.
fn expected_end(ended: &[[i64; 2]], missing: usize, now_ms: i64) -> Option<i64> {
    let first = ended.iter().map(|[began, _]| *began).min()?;
    let span = (now_ms - first).clamp(1, PACE_MS);
    let lately = ended.iter().filter(|[_, end]| now_ms - end < PACE_MS).count();
    let more = span as f64 * missing as f64 / lately as f64;
    (missing > 0 && lately > 0).then(|| now_ms.saturating_add(more as i64))
}

fn median(mut times: Vec<i64>) -> Option<f64> {
    times.sort_unstable();
    let half = times.len() / 2;
    let last = *times.get(half)? as f64;
    Some(if times.len() % 2 == 1 { last } else { f64::midpoint(times[half - 1] as f64, last) })
}
