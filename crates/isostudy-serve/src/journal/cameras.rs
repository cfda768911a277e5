//! From where participants looked at models that they turned: beside the answers, under the same promises.

use super::{Journal, files};
use crate::cameras::{Track, Tracked};
use crate::record::{Refusal, first_place};
use rusqlite::{OptionalExtension, params};

impl Journal {
    /// Keeps from where somebody looked before the answer at a place, whose number of changes is `change`. What belongs to an
    /// older answer is not kept, and nothing is kept twice.
    ///
    /// # Errors
    /// If SQLite fails.
    pub(crate) fn track(
        &mut self,
        token: &str,
        order: u32,
        change: u32,
        track: &Track,
    ) -> rusqlite::Result<Result<(), Refusal>> {
        let Some(&person) = self.by_token.get(token) else {
            let waits = self.newcomer(token).map(|of| Refusal::OutOfOrder {
                given: order,
                next: first_place(self.entry(of.form, &of.chosen)),
            });
            return Ok(Err(waits.unwrap_or(Refusal::UnknownToken)));
        };
        let person = &self.people[person];
        let first = first_place(self.entry(person.form, &person.chosen));
        let next = first + person.choices.len() as u32;
        if order < first {
            return Ok(Err(Refusal::UnknownPlace(order)));
        }
        if order >= next {
            return Ok(Err(Refusal::OutOfOrder { given: order, next }));
        }
        let known: Option<u32> = self
            .answers
            .prepare_cached("SELECT number FROM changes WHERE participant = ?1 AND place = ?2")?
            .query_row(params![person.number, order], |row| row.get(0))
            .optional()?;
        if known.unwrap_or(0) == change {
            let add = "INSERT OR REPLACE INTO cameras VALUES (?1, ?2, ?3)";
            self.answers.prepare_cached(add)?.execute(params![person.number, order, track.text()])?;
        }
        Ok(Ok(()))
    }

    /// Deletes from where somebody looked before an answer that is now another one.
    pub(super) fn forget_track(&self, number: i64, order: u32) -> rusqlite::Result<()> {
        let delete = "DELETE FROM cameras WHERE participant = ?1 AND place = ?2";
        self.answers.prepare_cached(delete)?.execute(params![number, order]).map(drop)
    }

    /// From where participants looked, in the order of [`Journal::given`].
    ///
    /// # Errors
    /// If SQLite fails.
    pub fn cameras(&self) -> rusqlite::Result<Vec<Tracked>> {
        files::cameras(&self.answers)
    }
}
