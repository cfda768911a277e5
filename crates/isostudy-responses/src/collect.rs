//! Gathers answers from any reader and checks what holds for all of them.

use crate::address;
use crate::choice::Step;
use crate::error::{Fault, UnknownCell, shorten};
use crate::mapping::{Mapping, Unknown};
use crate::plan::Plan;
use crate::report::{Kind, Report};
use crate::screen::{Screen, ScreenId};
use crate::value::{Answer, Participant, Question, StimulusId};
use crate::words::is_of;
use isostudy_design::config::Way;
use isostudy_design::forms::Role;
use std::collections::{BTreeMap, HashMap};
use std::ops::Range;

mod finish;

/// Most answers that rows with a `count` may stand for.
pub const MOST_COUNTED: u64 = 10_000_000;

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
    Step(Step),
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

/// What a file without a study calls a question.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Ids {
    /// One pair: another pair under the same id is a mistake.
    OnePair,
    /// Something that several pairs may show, and that is their object then.
    Scene,
    /// Made up from the pair.
    MadeUp,
}

/// What a row asks, where no plan has it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Asking<'a> {
    pub(crate) id: &'a str,
    pub(crate) object: &'a str,
    pub(crate) group: &'a str,
    pub(crate) sides: [u32; 2],
    pub(crate) role: Role,
}

/// Answers as they come.
pub(crate) struct Collector<'a> {
    pub(crate) mapping: &'a Mapping,
    pub(crate) report: &'a mut Report,
    /// Whether the file alone says what was asked.
    open: bool,
    /// How the study asks, if it says so.
    way: Option<Way>,
    pub(crate) naming: Ids,
    participants: Vec<Participant>,
    by_id: HashMap<String, u32>,
    /// Participants whose id is an e-mail address, and named by a row instead.
    unnamed: Vec<u32>,
    /// Participants whom the file does not name at all, in ranges.
    nameless: Vec<Range<u32>>,
    /// Whether a place in the order makes a second answer one to a second showing.
    pub(crate) shown_again: bool,
    /// Whether the file may give places in an order.
    pub(crate) ordered: bool,
    questions: Vec<Question>,
    by_pair: HashMap<([u32; 5], Role), u32>,
    /// The first question with an id, and its row.
    by_id_alone: HashMap<u32, (u32, u64)>,
    ids: Index,
    labels: Index,
    pub(crate) items: Index,
    stimuli: Index,
    screens: Vec<Screen>,
    /// Code names that the study lacks, with the first place of each.
    unknown_stimuli: BTreeMap<StimulusId, Place>,
    sessions: Index,
    /// The session of each answer, where a won and a lost row are a tie.
    session_of: Vec<u32>,
    answers: Vec<Answer>,
    /// The row of each answer; no file that is read has as many rows as there are numbers.
    rows: Vec<u32>,
    /// The first cell with R's mark for a missing answer, and how many there are.
    missing: Option<(Place, u64)>,
    unknown: Vec<UnknownCell>,
    /// What cells were found to mean; there are few different ones.
    replies: HashMap<String, Option<(Step, bool)>>,
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
            open: plan.is_none(),
            way: plan.and_then(Plan::way),
            naming: Ids::OnePair,
            participants: Vec::new(),
            by_id: HashMap::new(),
            unnamed: Vec::new(),
            nameless: Vec::new(),
            shown_again: true,
            ordered: false,
            questions: plan.map_or(Vec::new(), |plan| plan.questions().to_vec()),
            by_pair: HashMap::new(),
            by_id_alone: HashMap::new(),
            ids: Index::default(),
            labels: Index::default(),
            items,
            stimuli: Index::default(),
            screens: Vec::new(),
            unknown_stimuli: BTreeMap::new(),
            sessions: Index::default(),
            session_of: Vec::new(),
            answers: Vec::new(),
            rows: Vec::new(),
            missing: None,
            unknown: Vec::new(),
            replies: HashMap::new(),
        }
    }

    /// What a cell means; repairs and refusals are written down.
    pub(crate) fn reply(&mut self, cell: &str, place: Place, question: &str) -> Reply {
        /// Other cells are looked up anew each time.
        const REMEMBERED: usize = 4096;
        if self.mapping.words.is_blank(cell) {
            if self.mapping.words.is_missing(cell) {
                self.missing.get_or_insert((place, 0)).1 += 1;
            }
            return Reply::Blank;
        }
        let found = match self.replies.get(cell) {
            Some(found) => *found,
            None => {
                let plain = cell.trim_end().trim_end_matches(';');
                let step = self.mapping.words.step(plain);
                let given = step.filter(|&step| self.way.is_none_or(|way| is_of(step, way)));
                let found = given.map(|step| {
                    // What is the same but for case stands there literally.
                    (step, plain != cell || crate::words::normalise(cell) != cell.to_lowercase())
                });
                if self.replies.len() < REMEMBERED {
                    self.replies.insert(cell.to_owned(), found);
                }
                found
            }
        };
        match found {
            Some((step, repaired)) => {
                if repaired {
                    let action = format!("read as {}", step.name());
                    self.report.cell(Kind::Repaired, place.row, place.column, cell, action);
                }
                Reply::Step(step)
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
        let end = self.participants.len() as u32;
        let last = last.filter(|last| {
            self.unnamed.last() != Some(last) && self.nameless.last().is_none_or(|range| range.end != end)
        });
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

    /// So many participants of whom the file says nothing but their answer; returns the first one's number. They are named by
    /// their row.
    ///
    /// # Errors
    /// If there are too many.
    pub(crate) fn nameless(&mut self, count: u32, form: Option<&str>, row: u64) -> Result<u32, Fault> {
        let all = self.answers.len() as u64 + u64::from(count);
        if all > MOST_COUNTED {
            return Err(Fault::TooManyAnswers { row, answers: all, limit: MOST_COUNTED });
        }
        let first = self.participants.len() as u32;
        self.participants.extend((1..=count).map(|i| {
            let id = if count == 1 { format!("row {row}") } else { format!("row {row}.{i}") };
            Participant { id, form: form.map(str::to_owned) }
        }));
        self.nameless.push(first..first + count);
        Ok(first)
    }

    /// A question that no plan has, with the row that asks it. One id may stand for one pair on several objects or in several
    /// groups: these are several questions.
    ///
    /// # Errors
    /// Without a plan, if the id stands for another pair already.
    pub(crate) fn question(&mut self, asking: Asking<'_>, row: u64) -> Result<u32, Fault> {
        let Asking { id: name, object, group, sides: [left, right], role } = asking;
        let (low, high) = (left.min(right), left.max(right));
        let id = self.ids.number(name);
        let key = ([id, self.labels.number(object), self.labels.number(group), low, high], role);
        if let Some(&known) = self.by_pair.get(&key) {
            return Ok(known);
        }
        let number = self.questions.len() as u32;
        let (first, first_row) = *self.by_id_alone.entry(id).or_insert((number, row));
        if self.open && self.naming == Ids::OnePair && first != number {
            let other = &self.questions[first as usize];
            if [other.left.min(other.right), other.left.max(other.right)] != [low, high] {
                return Err(Fault::TwoPairs {
                    row,
                    question: shorten(name),
                    pair: self.pair([left, right]),
                    first_row,
                    first_pair: self.pair([other.left, other.right]),
                });
            }
        }
        let question = Question::new(name, object, group, [left, right]);
        self.questions.push(Question { role, ..question });
        self.by_pair.insert(key, number);
        Ok(number)
    }

    /// Two items as messages show them.
    fn pair(&self, items: [u32; 2]) -> String {
        let [left, right] = items.map(|item| shorten(&self.items.names[item as usize]));
        format!("{left} and {right}")
    }

    /// The id of a question.
    pub(crate) fn id_of(&self, question: u32) -> &str {
        &self.questions[question as usize].id
    }

    /// The id of a code name; `unknown` is its place if the study lacks it.
    pub(crate) fn stimulus(&mut self, name: &str, unknown: Option<Place>) -> Option<StimulusId> {
        if name.is_empty() {
            return None;
        }
        let id = StimulusId::new(self.stimuli.number(name));
        if let Some(place) = unknown {
            self.unknown_stimuli.entry(id).or_insert(place);
        }
        Some(id)
    }

    /// The id of a screen.
    pub(crate) fn screen(&mut self, screen: Screen) -> ScreenId {
        if self.screens.last() != Some(&screen) {
            self.screens.push(screen);
        }
        ScreenId::new(self.screens.len() as u32 - 1)
    }

    /// The session of the answer that comes next.
    pub(crate) fn session(&mut self, name: &str) {
        self.session_of.push(self.sessions.number(name));
    }

    pub(crate) fn answer(&mut self, answer: Answer, row: u64) {
        self.answers.push(answer);
        self.rows.push(row as u32);
    }

    /// The same answer of several participants, whose numbers follow one another.
    pub(crate) fn answers(&mut self, answer: Answer, count: u32, row: u64) {
        let of = (answer.participant..answer.participant + count)
            .map(|participant| Answer { participant, ..answer });
        self.answers.extend(of);
        self.rows.resize(self.answers.len(), row as u32);
    }
}
