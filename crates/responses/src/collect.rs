//! Gathers answers from any reader and checks what holds for all of them.

use crate::address;
use crate::choice::Choice;
use crate::error::{Fault, UnknownCell, shorten};
use crate::mapping::{Duplicates, Mapping, Unknown};
use crate::name;
use crate::plan::Plan;
use crate::report::{Kind, Report};
use crate::value::{Answer, Participant, Question, Responses};
use std::collections::HashMap;

/// Names by number, and numbers by name.
#[derive(Debug, Default)]
pub(crate) struct Index {
    pub(crate) names: Vec<String>,
    numbers: HashMap<String, u32>,
}

impl Index {
    pub(crate) fn number(&mut self, name: &str) -> u32 {
        if let Some(&number) = self.numbers.get(name) {
            return number;
        }
        let number = self.names.len() as u32;
        self.names.push(name.to_owned());
        self.numbers.insert(name.to_owned(), number);
        number
    }
}

/// What a cell with an answer says.
pub(crate) enum Reply {
    Choice(Choice),
    Blank,
    /// Not an answer, and to be left out or refused.
    Unknown,
}

/// Where something stands; the column is counted from 0.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Place {
    pub(crate) row: u64,
    pub(crate) column: usize,
}

/// Answers as they come.
pub(crate) struct Collector<'a> {
    pub(crate) mapping: &'a Mapping,
    pub(crate) report: &'a mut Report,
    participants: Vec<Participant>,
    by_id: HashMap<String, u32>,
    /// Participants whose id is an e-mail address, and named by a row instead.
    unnamed: Vec<u32>,
    /// Whether a place in the order makes a second answer one to a second showing.
    pub(crate) shown_again: bool,
    questions: Vec<Question>,
    by_pair: HashMap<[u32; 5], u32>,
    ids: Index,
    labels: Index,
    pub(crate) items: Index,
    answers: Vec<Answer>,
    /// The row of each answer.
    rows: Vec<u64>,
    unknown: Vec<UnknownCell>,
    /// What cells were found to mean; there are few different ones.
    replies: HashMap<String, Option<(Choice, bool)>>,
}

impl<'a> Collector<'a> {
    pub(crate) fn new(plan: Option<&Plan>, mapping: &'a Mapping, report: &'a mut Report) -> Self {
        let mut items = Index::default();
        plan.iter().flat_map(|plan| plan.items()).for_each(|item| {
            items.number(item);
        });
        Self {
            mapping,
            report,
            participants: Vec::new(),
            by_id: HashMap::new(),
            unnamed: Vec::new(),
            shown_again: true,
            questions: plan.map_or(Vec::new(), |plan| plan.questions().to_vec()),
            by_pair: HashMap::new(),
            ids: Index::default(),
            labels: Index::default(),
            items,
            answers: Vec::new(),
            rows: Vec::new(),
            unknown: Vec::new(),
            replies: HashMap::new(),
        }
    }

    /// What a cell means; repairs and refusals are written down.
    pub(crate) fn reply(&mut self, cell: &str, place: Place, question: &str) -> Reply {
        /// Other cells are looked up anew each time.
        const REMEMBERED: usize = 4096;
        if self.mapping.words.is_blank(cell) {
            return Reply::Blank;
        }
        let found = match self.replies.get(cell) {
            Some(found) => *found,
            None => {
                let plain = cell.trim_end().trim_end_matches(';');
                let found = self.mapping.words.choice(plain).map(|choice| {
                    // What is the same but for case stands there literally.
                    (choice, plain != cell || crate::words::normalise(cell) != cell.to_lowercase())
                });
                if self.replies.len() < REMEMBERED {
                    self.replies.insert(cell.to_owned(), found);
                }
                found
            }
        };
        match found {
            Some((choice, repaired)) => {
                if repaired {
                    let action = format!("read as {}", choice.name());
                    self.report.cell(Kind::Repaired, place.row, place.column, cell, action);
                }
                Reply::Choice(choice)
            }
            None => {
                if self.mapping.unknown == Unknown::LeaveOut {
                    let action = format!("not an answer to {question}: left out");
                    self.report.cell(Kind::Rejected, place.row, place.column, cell, action);
                } else {
                    self.unknown.push(UnknownCell {
                        row: place.row,
                        column: place.column + 1,
                        question: shorten(question),
                        raw: shorten(cell),
                    });
                }
                Reply::Unknown
            }
        }
    }

    /// The participant with this id, new or known. E-mail addresses are not kept: they lead to people.
    ///
    /// # Errors
    /// If a known one had another form.
    pub(crate) fn participant(&mut self, id: &str, form: Option<&str>, row: u64) -> Result<u32, Fault> {
        // Files go participant by participant.
        let last =
            self.participants.last().filter(|last| last.id == id).map(|_| self.participants.len() as u32 - 1);
        let last = last.filter(|last| self.unnamed.last() != Some(last));
        let address = address::folded(id);
        let key = address.as_deref().unwrap_or(id);
        let known = last.or_else(|| self.by_id.get(key).copied());
        if let Some(known) = known {
            let first = &self.participants[known as usize].form;
            if first.as_deref() != form {
                return Err(Fault::TwoForms {
                    row,
                    participant: shorten(id),
                    form: shorten(form.unwrap_or("")),
                    first: shorten(first.as_deref().unwrap_or("")),
                });
            }
            return Ok(known);
        }
        let number = self.participants.len() as u32;
        let name = if address.is_some() { format!("row {row}") } else { id.to_owned() };
        if address.is_some() {
            if self.unnamed.is_empty() {
                let action =
                    "e-mail addresses are not kept as ids: participants are named by their first row";
                self.report.row(Kind::Noted, row, action);
            }
            self.unnamed.push(number);
        }
        self.participants.push(Participant { id: name, form: form.map(str::to_owned) });
        self.by_id.insert(key.to_owned(), number);
        Ok(number)
    }

    /// A question that no plan has: two questions with one id and different pairs are two questions.
    pub(crate) fn question(&mut self, id: &str, object: &str, group: &str, left: u32, right: u32) -> u32 {
        let (low, high) = (left.min(right), left.max(right));
        let key = [self.ids.number(id), self.labels.number(object), self.labels.number(group), low, high];
        if let Some(&known) = self.by_pair.get(&key) {
            return known;
        }
        let number = self.questions.len() as u32;
        let (id, object, group) = (id.to_owned(), object.to_owned(), group.to_owned());
        self.questions.push(Question { id, object, group, left, right });
        self.by_pair.insert(key, number);
        number
    }

    pub(crate) fn answer(&mut self, answer: Answer, row: u64) {
        self.answers.push(answer);
        self.rows.push(row);
    }

    /// Checks what was gathered.
    ///
    /// # Errors
    /// Cells that are no answers, answers given twice, no answers at all.
    pub(crate) fn finish(mut self, sides_recorded: bool, end: u64) -> Result<Responses, Fault> {
        if !self.unknown.is_empty() {
            return Err(Fault::UnknownAnswers { cells: self.unknown, known: self.mapping.words.summary() });
        }
        for &number in &self.unnamed {
            let name = &mut self.participants[number as usize].id;
            while self.by_id.contains_key(name) {
                name.push('\'');
            }
        }
        self.check_repeats()?;
        if self.answers.is_empty() {
            return Err(Fault::NoAnswers { row: end });
        }
        self.drop_silent_participants();
        self.name_pairs();
        Ok(Responses {
            participants: self.participants,
            questions: self.questions,
            items: self.items.names,
            answers: self.answers,
            sides_recorded,
        })
    }

    /// Nobody answers a question twice, unless it was shown twice or the other way round.
    fn check_repeats(&mut self) -> Result<(), Fault> {
        let key = |i: usize| {
            let Answer { participant, question, left, .. } = self.answers[i];
            (participant, question, left)
        };
        let mut sorted: Vec<u32> = (0..self.answers.len() as u32).collect();
        sorted.sort_by_key(|&i| key(i as usize));
        let mut dropped = Vec::new();
        for same in sorted.chunk_by(|&a, &b| key(a as usize) == key(b as usize)).filter(|same| same.len() > 1)
        {
            let mut orders: Vec<Option<u32>> = same.iter().map(|&i| self.answers[i as usize].order).collect();
            orders.sort_unstable();
            orders.dedup();
            if self.shown_again && orders.len() == same.len() && orders[0].is_some() {
                continue;
            }
            let kept = match self.mapping.duplicates {
                Duplicates::Refuse => {
                    let [first, second] = [same[0], same[1]].map(|i| self.rows[i as usize]);
                    let (participant, question, _) = key(same[0] as usize);
                    return Err(Fault::DuplicateAnswer {
                        row: second,
                        first,
                        participant: shorten(&self.participants[participant as usize].id),
                        question: shorten(&self.questions[question as usize].id),
                    });
                }
                Duplicates::First => same[0],
                Duplicates::Last => same[same.len() - 1],
            };
            dropped.extend(same.iter().copied().filter(|&i| i != kept));
        }
        dropped.sort_unstable();
        for &i in &dropped {
            let question = &self.questions[self.answers[i as usize].question as usize].id;
            let action = format!("{} answered more than once: this one is left out", shorten(question));
            self.report.row(Kind::Rejected, self.rows[i as usize], action);
        }
        let mut i = 0;
        self.answers.retain(|_| {
            i += 1;
            dropped.binary_search(&(i - 1)).is_err()
        });
        Ok(())
    }

    /// Takes out participants without an answer; the reader has said so where it saw them.
    fn drop_silent_participants(&mut self) {
        let mut number = vec![u32::MAX; self.participants.len()];
        self.answers.iter().for_each(|answer| number[answer.participant as usize] = 0);
        let mut next = 0;
        let mut renumber = number.iter_mut();
        self.participants.retain(|_| {
            let own = renumber.next().expect("one a participant");
            let kept = *own == 0;
            if kept {
                *own = next;
                next += 1;
            }
            kept
        });
        self.answers.iter_mut().for_each(|answer| answer.participant = number[answer.participant as usize]);
    }

    /// Tells questions apart that share an id.
    fn name_pairs(&mut self) {
        /// Leaves room for a number.
        const CUT: usize = name::LONGEST_NAME - 20;
        let mut of_id: HashMap<String, u32> = HashMap::new();
        self.questions.iter().for_each(|q| *of_id.entry(q.id.clone()).or_default() += 1);
        for (i, question) in self.questions.iter_mut().enumerate().filter(|(_, q)| of_id[&q.id] > 1) {
            let [left, right] = [question.left, question.right].map(|item| &self.items.names[item as usize]);
            let parts = [&question.id, &question.group, &question.object].map(String::as_str);
            let parts: Vec<&str> = parts.into_iter().filter(|part| !part.is_empty()).collect();
            let full = format!("{}: {left}-{right}", parts.join(" "));
            question.id = match name::is_too_long(&full) {
                false => full,
                true => format!("{}... {}", question.id.chars().take(CUT).collect::<String>(), i + 1),
            };
        }
    }
}
