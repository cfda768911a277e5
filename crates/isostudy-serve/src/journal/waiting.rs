//! People who were dealt a form and have answered nothing yet. They are in memory alone: who only looks leaves no trace, and
//! whoever asks for forms without end fills nothing.

use super::GIVEN_UP_MS;
use crate::record::{About, Identifiers, Refusal};
use isostudy_design::forms::FormEntry;
use std::collections::HashMap;

/// Most who wait at a time: 40 MB. Of more, who comes last is refused; nobody is forgotten within two hours.
const MOST: usize = 100_000;

/// Somebody who was dealt a form.
#[derive(Clone)]
pub(super) struct Newcomer {
    pub(super) name: String,
    pub(super) token: String,
    pub(super) form: usize,
    /// What was chosen for this person, in the place of what the form plans.
    pub(super) chosen: Option<FormEntry>,
    pub(super) identifiers: Identifiers,
    pub(super) language: Option<String>,
    pub(super) about: About,
    pub(super) since_ms: i64,
}

/// Those who wait, by token.
pub(super) struct Waiting {
    most: usize,
    people: HashMap<String, Newcomer>,
    /// Whose first answer is not on disk yet.
    arriving: Vec<Newcomer>,
}

impl Default for Waiting {
    fn default() -> Self {
        Self { most: MOST, people: HashMap::new(), arriving: Vec::new() }
    }
}

impl Waiting {
    /// Those who wait, in no order.
    pub(super) fn iter(&self) -> impl Iterator<Item = &Newcomer> {
        self.people.values()
    }

    /// # Errors
    /// If too many wait, of whom none has given up.
    pub(super) fn add(&mut self, newcomer: Newcomer) -> Result<(), Refusal> {
        if self.people.len() >= self.most {
            self.people.retain(|_, one| newcomer.since_ms - one.since_ms < GIVEN_UP_MS);
        }
        if self.people.len() >= self.most {
            return Err(Refusal::Crowded);
        }
        self.people.insert(newcomer.token.clone(), newcomer);
        Ok(())
    }

    pub(super) fn by_token(&self, token: &str) -> Option<&Newcomer> {
        self.people.get(token)
    }

    /// Keeps an answer about somebody who waits.
    pub(super) fn add_about(&mut self, token: &str, id: &str, value: &str) {
        if let Some(newcomer) = self.people.get_mut(token) {
            newcomer.about.insert(id.into(), value.into());
        }
    }

    /// Somebody whose first answer has come, or who left, until [`Waiting::arrived`] or [`Waiting::turned_back`].
    pub(super) fn take(&mut self, token: &str) -> Option<&Newcomer> {
        let newcomer = self.people.remove(token)?;
        self.arriving.push(newcomer);
        self.arriving.last()
    }

    /// First answers are on disk.
    pub(super) fn arrived(&mut self) {
        self.arriving.clear();
    }

    /// First answers could not be written; whoever gave one still waits.
    pub(super) fn turned_back(&mut self) {
        self.people.extend(self.arriving.drain(..).map(|newcomer| (newcomer.token.clone(), newcomer)));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_too_many_the_last_is_refused_and_the_first_never_forgotten() {
        let newcomer = |token: usize, since_ms| Newcomer {
            name: String::new(),
            token: token.to_string(),
            form: 1,
            chosen: None,
            identifiers: Identifiers::default(),
            language: None,
            about: About::new(),
            since_ms,
        };
        let mut waiting = Waiting { most: 3, ..Waiting::default() };
        let mut add = |token, since_ms| waiting.add(newcomer(token, since_ms));
        assert!((0..3).all(|token| add(token, token as i64).is_ok()));
        assert_eq!(add(3, GIVEN_UP_MS - 1), Err(Refusal::Crowded));
        // The first two have given up.
        assert_eq!(add(4, GIVEN_UP_MS + 1), Ok(()));
        let mut left: Vec<&str> = waiting.iter().map(|one| one.token.as_str()).collect();
        left.sort_unstable();
        assert_eq!(left, ["2", "4"]);
        assert!(waiting.take("2").is_some() && waiting.by_token("2").is_none());
        waiting.turned_back();
        assert!(waiting.by_token("2").is_some());
    }
}
