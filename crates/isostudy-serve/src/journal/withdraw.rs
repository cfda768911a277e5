//! Answers deleted at the wish of whoever gave them, out of the databases and their logs.

use super::departures::Departure;
use super::{Journal, JournalError};
use crate::record::Refusal;
use rusqlite::Connection;

/// Letters of a token that make up the receipt: with them nobody answers in a participant's place, and nobody guesses them.
const RECEIPT: usize = 16;

/// The code with which a participant deletes answers, of a token.
pub(super) fn receipt(token: &str) -> &str {
    token.get(..RECEIPT).unwrap_or(token)
}

/// What a participant typed, without spaces and hyphens, in small letters.
fn plain(typed: &str) -> String {
    typed.chars().filter(char::is_ascii_alphanumeric).map(|letter| letter.to_ascii_lowercase()).collect()
}

impl Journal {
    /// Deletes all that is kept of whoever has this receipt code, and counts one withdrawal. What is left of it in the files is
    /// removed by [`Journal::scrub`], after the batch was committed.
    ///
    /// # Errors
    /// If SQLite fails.
    pub(crate) fn withdraw(&mut self, typed: &str) -> rusqlite::Result<Result<(), Refusal>> {
        let code = plain(typed);
        let has_code = |token: &str| code.len() == RECEIPT && receipt(token) == code;
        let found = self.by_token.iter().find(|(token, _)| has_code(token)).map(|(_, &person)| person);
        let Some(person) = found else {
            let waits = self.waiting.iter().find(|one| has_code(&one.token)).map(|one| one.token.clone());
            let Some(token) = waits else { return Ok(Err(Refusal::UnknownToken)) };
            self.waiting.take(&token);
            self.depart(Departure::Withdrawn)?;
            return Ok(Ok(()));
        };
        let (number, name) = (self.people[person].number, self.people[person].name.clone());
        self.change_identities()?;
        for table in ["identities", "about"] {
            self.identities.execute(&format!("DELETE FROM {table} WHERE participant = ?1"), [&name])?;
        }
        for table in ["answers", "screens", "changes", "cameras", "chosen", "languages"] {
            self.answers.execute(&format!("DELETE FROM {table} WHERE participant = ?1"), [number])?;
        }
        self.answers.execute("DELETE FROM participants WHERE number = ?1", [number])?;
        self.depart(Departure::Withdrawn)?;
        self.remnants = true;
        // Places in memory have moved.
        self.read()?;
        Ok(Ok(()))
    }

    /// Removes what deleted rows have left in the files. Returns whether nothing is left: somebody may be reading an older state, and
    /// then it has to be tried again.
    ///
    /// # Errors
    /// If SQLite or the disk fails; then too.
    pub(super) fn scrub(&mut self) -> rusqlite::Result<bool> {
        if self.remnants {
            let clean = [&self.answers, &self.identities].into_iter().map(rewrite);
            self.remnants = !clean.collect::<rusqlite::Result<Vec<_>>>()?.into_iter().all(|clean| clean);
        }
        Ok(!self.remnants)
    }

    /// What a server that was killed had not yet scrubbed is scrubbed at the next start.
    pub(super) fn scrub_left(&mut self) -> Result<(), JournalError> {
        let pages = |database: &Connection| database.query_row("PRAGMA freelist_count", [], |row| row.get(0));
        let left: i64 = pages(&self.answers)
            .and_then(|answers: i64| pages(&self.identities).map(|identities: i64| answers + identities))
            .map_err(|source| super::files::error(&self.folder, source))?;
        self.remnants |= left > 0;
        // A full disk is no reason not to start: it is tried again.
        drop(self.scrub());
        Ok(())
    }
}

/// Writes a database anew, row by row, and empties its log. Returns whether the log is empty.
fn rewrite(database: &Connection) -> rusqlite::Result<bool> {
    database.execute_batch("VACUUM")?;
    database
        .query_row("PRAGMA wal_checkpoint(TRUNCATE)", [], |row| row.get::<_, i64>(0))
        .map(|busy| busy == 0)
}
