//! People who were dealt a form and have answered nothing yet. They are in memory alone: who only looks leaves no trace, and
//! whoever asks for forms without end fills nothing.

use crate::record::Identifiers;
use std::collections::VecDeque;

/// Most who wait at a time; of more, those who came first are forgotten, and have to begin again.
const MOST: usize = 10_000;

/// Somebody who was dealt a form.
pub(super) struct Newcomer {
    pub(super) name: String,
    pub(super) token: String,
    pub(super) form: usize,
    pub(super) identifiers: Identifiers,
    pub(super) since_ms: i64,
}

/// Those who wait, in the order in which they came.
#[derive(Default)]
pub(super) struct Waiting {
    people: VecDeque<Newcomer>,
    /// Whose first answer is not on disk yet.
    arriving: Vec<Newcomer>,
}

impl Waiting {
    pub(super) fn iter(&self) -> impl Iterator<Item = &Newcomer> {
        self.people.iter()
    }

    pub(super) fn add(&mut self, newcomer: Newcomer) {
        if self.people.len() == MOST {
            self.people.pop_front();
        }
        self.people.push_back(newcomer);
    }

    pub(super) fn by_token(&self, token: &str) -> Option<&Newcomer> {
        self.people.iter().find(|newcomer| newcomer.token == token)
    }

    /// Somebody whose first answer has come, until [`Waiting::arrived`] or [`Waiting::turned_back`].
    pub(super) fn take(&mut self, token: &str) -> Option<&Newcomer> {
        let place = self.people.iter().position(|newcomer| newcomer.token == token)?;
        self.arriving.extend(self.people.remove(place));
        self.arriving.last()
    }

    /// First answers are on disk.
    pub(super) fn arrived(&mut self) {
        self.arriving.clear();
    }

    /// First answers could not be written; whoever gave one still waits.
    pub(super) fn turned_back(&mut self) {
        self.people.extend(self.arriving.drain(..));
    }
}
