//! What is on disk, read into memory when the journal is opened, and again after a change that failed.

use super::{Held, Journal, Person, files};
use crate::record::{About, Choice};
use isostudy_design::forms::FormEntry;
use std::collections::HashMap;

impl Journal {
    /// Reads what is on disk into memory. Returns names with identifiers and without an answer.
    pub(super) fn read(&mut self) -> rusqlite::Result<Vec<String>> {
        self.people.clear();
        self.by_token.clear();
        self.by_identifiers.clear();
        let mut by_number = HashMap::new();
        let all = "SELECT number, name, token, form, last_ms, finished_ms FROM participants ORDER BY number";
        let mut statement = self.answers.prepare(all)?;
        let mut rows = statement.query([])?;
        while let Some(row) = rows.next()? {
            let (number, form): (i64, i64) = (row.get(0)?, row.get(3)?);
            let finished = row.get::<_, Option<i64>>(5)?.is_some();
            let person = Person {
                number,
                name: row.get(1)?,
                form: form as usize,
                chosen: None,
                choices: Vec::new(),
                last_ms: row.get(4)?,
                finished,
                about: About::new(),
            };
            by_number.insert(number, self.people.len());
            self.by_token.insert(row.get(2)?, self.people.len());
            self.people.push(person);
        }
        for (number, questions) in files::chosen(&self.answers)? {
            let person = by_number.get(&number).map(|&place| &mut self.people[place]);
            if let Some(person) = person
                && let Some(planned) = self.forms.get(person.form.wrapping_sub(1))
            {
                person.chosen = Some(FormEntry { questions, ..planned.clone() });
            }
        }
        let mut statement =
            self.answers.prepare("SELECT participant, choice FROM answers ORDER BY participant, place")?;
        let mut rows = statement.query([])?;
        while let Some(row) = rows.next()? {
            let choice: String = row.get(1)?;
            let of = by_number.get(&row.get::<_, i64>(0)?);
            if let (Some(&person), Some(choice)) = (of, Choice::of_code(&choice)) {
                self.people[person].choices.push(choice);
            }
        }
        let by_name: HashMap<String, usize> =
            self.people.iter().enumerate().map(|(i, person)| (person.name.clone(), i)).collect();
        let (mut found, mut nobodys) = (HashMap::new(), Vec::new());
        self.held = Held { participants: self.people.len() as u64, ..Held::default() };
        for (name, identifiers) in files::identities(&self.identities)? {
            if let Some(&person) = by_name.get(&name) {
                found.insert(identifiers, person);
                self.held.identities += 1;
            } else {
                nobodys.push(name);
            }
        }
        for (name, about) in files::about(&self.identities)? {
            match by_name.get(&name) {
                Some(&person) => self.people[person].about = about,
                None if nobodys.contains(&name) => {}
                None => nobodys.push(name),
            }
        }
        self.by_identifiers = found;
        self.held.answers = self.people.iter().map(|person| person.choices.len() as u64).sum();
        Ok(nobodys)
    }
}
