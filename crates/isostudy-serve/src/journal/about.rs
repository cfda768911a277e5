//! Answers about the person, which decide whether somebody is asked on, and how many people the study still takes.

use super::departures::{Departure, Departures};
use super::summary::OptionCount;
use super::{GIVEN_UP_MS, Journal, files};
use crate::record::{About, Refusal};
use isostudy_design::config::AboutTime;
use isostudy_design::forms::AboutEntry;
use rusqlite::params;
use std::collections::BTreeMap;

/// What became of an answer about the person.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Taken {
    /// It is kept: in memory until the first answer to a pair, then on disk.
    Kept,
    /// Whoever says so is not asked: nothing is kept of the person.
    ScreenedOut,
    /// As many as were wanted have said so: nothing is kept of the person.
    Full,
}

impl Journal {
    /// Keeps an answer about the person; the last one to a question counts.
    ///
    /// # Errors
    /// If SQLite fails.
    pub(crate) fn about(
        &mut self,
        token: &str,
        id: &str,
        value: &str,
        now_ms: i64,
    ) -> rusqlite::Result<Result<Taken, Refusal>> {
        let Some(question) = self.questions.iter().find(|question| question.id == id) else {
            return Ok(Err(Refusal::UnknownQuestion));
        };
        if !question.takes(value) {
            return Ok(Err(Refusal::NoSuchValue));
        }
        if self.newcomer(token).is_some() {
            let left = if question.chosen(value).iter().any(|option| question.screens_out.contains(option)) {
                Some((Departure::ScreenedOut, Taken::ScreenedOut))
            } else if self.is_over(question, value, token, now_ms) {
                Some((Departure::Full, Taken::Full))
            } else {
                None
            };
            return match left {
                Some((departure, taken)) => {
                    self.waiting.take(token);
                    self.depart(departure)?;
                    Ok(Ok(taken))
                }
                None => {
                    self.waiting.add_about(token, id, value);
                    Ok(Ok(Taken::Kept))
                }
            };
        }
        let Some(&person) = self.by_token.get(token) else { return Ok(Err(Refusal::UnknownToken)) };
        let name = self.people[person].name.clone();
        self.change_identities()?;
        self.add_about(&name, id, value)?;
        let touch = "UPDATE participants SET last_ms = ?2 WHERE number = ?1";
        self.answers.prepare_cached(touch)?.execute(params![self.people[person].number, now_ms])?;
        self.people[person].last_ms = now_ms;
        self.people[person].about.insert(id.into(), value.into());
        Ok(Ok(Taken::Kept))
    }

    /// Begins a transaction of identifiers, one for all of a batch.
    pub(super) fn change_identities(&self) -> rusqlite::Result<()> {
        if !self.answers.is_autocommit() && self.identities.is_autocommit() {
            self.identities.execute_batch("BEGIN IMMEDIATE")?;
        }
        Ok(())
    }

    /// Writes down an answer about somebody.
    pub(super) fn add_about(&self, name: &str, id: &str, value: &str) -> rusqlite::Result<()> {
        let add = "INSERT OR REPLACE INTO about VALUES (?1, ?2, ?3)";
        self.identities.prepare_cached(add)?.execute(params![name, id, value]).map(drop)
    }

    /// Counts somebody of whom nothing is kept.
    pub(super) fn depart(&self, departure: Departure) -> rusqlite::Result<()> {
        let count =
            "INSERT INTO departures VALUES (?1, 1) ON CONFLICT (kind) DO UPDATE SET number = number + 1";
        self.answers.execute(count, [departure.name()]).map(drop)
    }

    /// How many have left, of each kind.
    ///
    /// # Errors
    /// If SQLite fails.
    pub(crate) fn departures(&self) -> rusqlite::Result<Departures> {
        files::departures(&self.answers)
    }

    /// The languages of participants, by their names.
    ///
    /// # Errors
    /// If SQLite fails.
    pub fn languages(&self) -> rusqlite::Result<BTreeMap<String, String>> {
        files::languages(&self.answers)
    }

    /// Answers about people, by their names.
    ///
    /// # Errors
    /// If SQLite fails.
    pub fn all_about(&self) -> rusqlite::Result<BTreeMap<String, About>> {
        files::about(&self.identities)
    }

    /// Everybody who has finished, or who is answering: the token, and what is known about the person.
    fn present(&self, now_ms: i64) -> impl Iterator<Item = (&str, &About)> {
        let of: Vec<&str> = {
            let mut tokens = vec![""; self.people.len()];
            self.by_token.iter().for_each(|(token, &person)| tokens[person] = token);
            tokens
        };
        let here = move |last_ms: i64| now_ms - last_ms < GIVEN_UP_MS;
        let people = of.into_iter().zip(&self.people);
        let people = people.filter(move |(_, person)| person.finished || here(person.last_ms));
        let waiting = self.waiting.iter().filter(move |one| here(one.since_ms));
        people
            .map(|(token, person)| (token, &person.about))
            .chain(waiting.map(|one| (one.token.as_str(), &one.about)))
    }

    /// How many people have chosen each option of a question; `but` is not counted.
    fn counts(&self, question: &AboutEntry, count: usize, but: &str, now_ms: i64) -> Vec<u32> {
        let mut counts = vec![0; count];
        for (_, about) in self.present(now_ms).filter(|(token, _)| *token != but) {
            let value = about.get(&question.id).map_or("", String::as_str);
            for option in question.chosen(value) {
                if let Some(counted) = counts.get_mut(option as usize - 1) {
                    *counted += 1;
                }
            }
        }
        counts
    }

    /// Options that take so many people and no more, with those who have chosen them.
    pub(super) fn option_counts(&self, now_ms: i64) -> Vec<OptionCount> {
        let mut all = Vec::new();
        for (id, most) in &self.quotas.options {
            let Some(question) = self.questions.iter().find(|of| of.id == *id) else { continue };
            let counts = self.counts(question, most.len(), "", now_ms);
            let limited = most.iter().zip(counts).enumerate().filter(|(_, (most, _))| **most > 0);
            all.extend(limited.map(|(place, (&most, people))| OptionCount {
                question: id.clone(),
                option: place + 1,
                people,
                most,
            }));
        }
        all
    }

    /// Whether an option of this value has all the people that were wanted.
    fn is_over(&self, question: &AboutEntry, value: &str, token: &str, now_ms: i64) -> bool {
        let Some((_, most)) = self.quotas.options.iter().find(|(id, _)| *id == question.id) else {
            return false;
        };
        let counts = self.counts(question, most.len(), token, now_ms);
        question.chosen(value).iter().any(|&option| {
            let place = option as usize - 1;
            most.get(place).is_some_and(|&most| most > 0 && counts[place] >= most)
        })
    }

    /// Whether nobody new is taken, whatever the person says: every option of a question has all its people.
    pub(super) fn is_closed(&self, now_ms: i64) -> bool {
        self.quotas.options.iter().any(|(id, most)| {
            let question = self.questions.iter().find(|of| of.id == *id && of.when == AboutTime::Before);
            question.is_some_and(|question| {
                let counts = self.counts(question, most.len(), "", now_ms);
                most.iter().zip(counts).all(|(&most, count)| most > 0 && count >= most)
            })
        })
    }
}
