//! An answer that is given again: the same, late, or changed by somebody who went back.

use super::Journal;
use crate::record::{Answer, Refusal, first_place};
use rusqlite::{OptionalExtension, params};

impl Journal {
    /// Takes an answer to a place of `person` that has one. Each change has a number, from 1; what is late never replaces what is newer.
    ///
    /// # Errors
    /// If SQLite fails.
    pub(super) fn again(
        &mut self,
        person: usize,
        answer: &Answer,
        now_ms: i64,
    ) -> rusqlite::Result<Result<(), Refusal>> {
        let of = &self.people[person];
        let place = (answer.order - first_place(self.entry(of.form, &of.chosen))) as usize;
        let known: Option<u32> = self
            .answers
            .prepare_cached("SELECT number FROM changes WHERE participant = ?1 AND place = ?2")?
            .query_row(params![of.number, answer.order], |row| row.get(0))
            .optional()?;
        let known = known.unwrap_or(0);
        let is_last = place + 1 == of.choices.len() && !of.finished;
        if known > answer.change || of.choices[place] == answer.choice && known == answer.change {
            return Ok(Ok(()));
        }
        if !(self.go_back && is_last && answer.change > known) {
            return Ok(Err(Refusal::Answered(answer.order)));
        }
        let number = of.number;
        let change = "UPDATE answers SET choice = ?3, rt_ms = ?4, received_ms = ?5 WHERE participant = ?1 AND place = ?2";
        let values = params![number, answer.order, answer.choice.code(), answer.rt_ms, now_ms];
        self.answers.prepare_cached(change)?.execute(values)?;
        self.keep_screen(number, answer)?;
        self.keep_change(number, answer)?;
        self.forget_track(number, answer.order)?;
        let touch = "UPDATE participants SET last_ms = ?2 WHERE number = ?1";
        self.answers.prepare_cached(touch)?.execute(params![number, now_ms])?;
        let of = &mut self.people[person];
        of.choices[place] = answer.choice;
        of.last_ms = now_ms;
        Ok(Ok(()))
    }

    /// Writes down on what an answer was given.
    pub(super) fn keep_screen(&self, number: i64, answer: &Answer) -> rusqlite::Result<()> {
        let Some(screen) = &answer.screen else { return Ok(()) };
        let said = serde_json::to_string(screen).expect("numbers and words alone");
        let add = "INSERT OR REPLACE INTO screens VALUES (?1, ?2, ?3)";
        self.answers.prepare_cached(add)?.execute(params![number, answer.order, said]).map(drop)
    }

    /// Writes down how often an answer was changed.
    pub(super) fn keep_change(&self, number: i64, answer: &Answer) -> rusqlite::Result<()> {
        if answer.change == 0 {
            return Ok(());
        }
        let add = "INSERT OR REPLACE INTO changes VALUES (?1, ?2, ?3)";
        self.answers.prepare_cached(add)?.execute(params![number, answer.order, answer.change]).map(drop)
    }
}
