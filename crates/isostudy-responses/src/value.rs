//! Answers, read and checked: one value an answer, whatever file they came from.

use crate::choice::{Choice, Step};
use crate::error::{number_of, shorten};
use crate::screen::{Screen, ScreenId};
use crate::sides::SidesSource;
use isostudy_design::forms::Role;
use std::num::NonZeroU32;

/// Everybody's answers, in long form.
///
/// # Guarantees
/// Every index is in range. Nobody gave two answers to one question with the same item on the left, unless they say that
/// they were shown at different places. Every participant has an answer. `sides_recorded` says that `sides` is not
/// [`SidesSource::Unknown`].
///
/// # Not guaranteed
/// Where there is no study, participants, questions and answers come in the file's order, and a question's sides are those
/// of its first row. Only `items` do not depend on the order of rows.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Responses {
    /// Who answered, in the file's order.
    pub participants: Vec<Participant>,
    /// What was asked: a study's questions in its order, then those that only the file has.
    pub questions: Vec<Question>,
    /// Names of what was shown: a study's configurations in its order, declared pairs' items as they come, or else whatever the
    /// file names, sorted by name with numbers in their order (`m2` before `m10`).
    pub items: Vec<String>,
    /// The answers, in the file's order. Questions that somebody did not answer are not here.
    pub answers: Vec<Answer>,
    /// Whether the file says, or the study declares, which item was on which side. If not, `left` and `right` of an
    /// answer are in no particular order, and nothing about sides can be told.
    pub sides_recorded: bool,
    /// How it is known which item was on which side.
    pub sides: SidesSource,
    /// Code names of what was shown, where the file has a `stimulus` column; each once, in the file's order.
    pub stimuli: Vec<String>,
    /// On what answers were given, where the file says it; neighbours on one screen share one.
    pub screens: Vec<Screen>,
    /// What people answered who did not compare two; their answers above follow from it.
    pub judged: Vec<Judged>,
    /// What is said of people beside their answers, where a study asks for it; reading answers leaves it empty.
    pub people: Vec<PersonColumn>,
    /// Answers whose participant the file does not name. Each of them has a participant of its own.
    pub without_participant: u64,
    /// Answers whose code name the study does not have; `None` if it has all, if there is no study, or if it has none itself.
    pub unknown_stimuli: Option<UnknownStimuli>,
}

/// Answers with a code name in the `stimulus` column that the study does not have.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct UnknownStimuli {
    /// The first such name, an id of [`Responses::stimuli`].
    pub first: StimulusId,
    /// Its row in the file.
    pub row: u64,
    /// How many answers have such a name.
    pub answers: u64,
}

/// Somebody who answered.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Participant {
    /// Id in the file; where it has none, the number of the row among rows with answers; where it is an e-mail address, the
    /// first row with it, such as `row 2`.
    pub id: String,
    /// Which form of the questionnaire it was, if there are several.
    pub form: Option<String>,
}

/// A column of a file by participant.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PersonColumn {
    /// Its title.
    pub name: String,
    /// What it says of each participant, in their order; `None` where it says nothing.
    pub values: Vec<Option<String>>,
}

/// One pair that was asked about.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Question {
    /// Its id.
    pub id: String,
    /// What both items are of; empty if that is not said.
    pub object: String,
    /// The group of items that are compared with one another; empty if that is not said.
    pub group: String,
    /// The item on the left, as declared or as first shown; an index into `items`.
    pub left: u32,
    /// The item on the right.
    pub right: u32,
    /// Why it was asked. Repeats and controls check answers and compare nothing of their own.
    pub role: Role,
}

impl Question {
    /// A comparison, or a control where both sides are the same.
    pub fn new(id: &str, object: &str, group: &str, [left, right]: [u32; 2]) -> Self {
        let role = if left == right { Role::Control } else { Role::Comparison };
        Self { id: id.to_owned(), object: object.to_owned(), group: group.to_owned(), left, right, role }
    }

    /// Whether it is one of the comparisons that were asked about, neither a control nor a repeat.
    pub fn is_comparison(&self) -> bool {
        self.role == Role::Comparison
    }

    /// Whether both sides are the same: a question that checks attention and compares nothing.
    pub fn is_control(&self) -> bool {
        self.left == self.right
    }
}

/// One answer of one participant, with the sides as they were shown.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Answer {
    /// Index of the participant.
    pub participant: u32,
    /// Index of the question.
    pub question: u32,
    /// The item shown on the left.
    pub left: u32,
    /// The item shown on the right.
    pub right: u32,
    /// What was chosen.
    pub choice: Choice,
    /// Whether it is much better, where people answered in five steps.
    pub much: bool,
    /// At which place in the session it was shown, if recorded.
    pub order: Option<u32>,
    /// Milliseconds until the answer, if recorded; finite and not negative.
    pub rt_ms: Option<f32>,
    /// What the file calls the pair that was shown, if it does: see [`Responses::stimulus`].
    pub stimulus: Option<StimulusId>,
    /// On what it was given, if recorded: see [`Responses::screen`].
    pub screen: Option<ScreenId>,
}

/// One answer about one item, or about several.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Judged {
    /// Index of the participant.
    pub participant: u32,
    /// The items that were shown, in the order of their places.
    pub shown: Vec<u32>,
    /// What was answered.
    pub verdict: Verdict,
    /// Whether it asks again, to check an answer.
    pub is_repeat: bool,
    /// At which place in the session it was shown.
    pub order: u32,
}

/// What was answered.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Verdict {
    /// The step of the scale that the one item got.
    Rated(u8),
    /// The item that was taken; `None` is none of them.
    Taken(Option<u32>),
}

/// The number of a name in [`Responses::stimuli`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct StimulusId(NonZeroU32);

impl StimulusId {
    /// The id of a place in [`Responses::stimuli`], counted from 0.
    ///
    /// # Panics
    /// For the last of all numbers, which no file has.
    pub fn new(place: u32) -> Self {
        Self(place.checked_add(1).and_then(NonZeroU32::new).expect("fewer stimuli than numbers"))
    }

    /// The place in [`Responses::stimuli`], counted from 0.
    pub fn place(self) -> usize {
        self.0.get() as usize - 1
    }
}

impl Answer {
    /// An answer of which nothing else is known.
    pub const fn new(participant: u32, question: u32, [left, right]: [u32; 2], choice: Choice) -> Self {
        Self {
            participant,
            question,
            left,
            right,
            choice,
            much: false,
            order: None,
            rt_ms: None,
            stimulus: None,
            screen: None,
        }
    }

    /// The answer in up to five steps, as it was shown.
    pub fn step(&self) -> Step {
        Step { choice: self.choice, much: self.much }
    }

    /// The item that was chosen; `None` is no preference.
    pub fn chosen(&self) -> Option<u32> {
        match self.choice {
            Choice::Left => Some(self.left),
            Choice::NoPreference => None,
            Choice::Right => Some(self.right),
        }
    }
}

impl Responses {
    /// What the file calls the pair that an answer is about, if it has a `stimulus` column.
    pub fn stimulus(&self, answer: &Answer) -> Option<&str> {
        answer.stimulus.map(|id| self.stimuli[id.place()].as_str())
    }

    /// On what an answer was given, if the file says it.
    pub fn screen(&self, answer: &Answer) -> Option<&Screen> {
        answer.screen.map(|id| &self.screens[id.place()])
    }

    /// Whether the file names nobody, so that each answer counts as another person's. Nothing can be said then of answers that
    /// somebody did not give, nor of anything else within a person.
    pub fn names_nobody(&self) -> bool {
        !self.answers.is_empty() && self.without_participant == self.answers.len() as u64
    }

    /// Whether anybody said that something is much better: people answered in five steps.
    pub fn has_steps(&self) -> bool {
        self.answers.iter().any(|answer| answer.much)
    }

    /// What was assumed where the file does not say it, as sentences for a report: how sides are known, whether
    /// participants are, and whether the study knows the code names.
    pub fn assumptions(&self) -> Vec<String> {
        let mut said = vec![self.sides.sentence().to_owned()];
        if self.without_participant > 0 {
            let answers = number_of(self.without_participant as usize, "answer");
            said.push(format!(
                "The file names no participant for {answers}. Each of them counts as the answer of another person."
            ));
        }
        if let Some(UnknownStimuli { first, row, answers }) = self.unknown_stimuli {
            let of = match answers {
                1 => "The code name of 1 answer is".to_owned(),
                n => format!("The code names of {n} answers are"),
            };
            let name = shorten(&self.stimuli[first.place()]);
            said.push(format!(
                "{of} not in this study; the first is \"{name}\" in row {row}. The sides of such answers were not checked by code \
                 name."
            ));
        }
        said
    }

    /// The choice with the sides that the question declares: of an answer to a pair shown mirrored, the mirror image.
    pub fn declared_choice(&self, answer: &Answer) -> Choice {
        let question = &self.questions[answer.question as usize];
        if answer.left == question.left { answer.choice } else { answer.choice.swapped() }
    }

    /// As [`Responses::declared_choice`], in up to five steps.
    pub fn declared_step(&self, answer: &Answer) -> Step {
        Step { choice: self.declared_choice(answer), much: answer.much }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_answer_is_small() {
        // Millions of them are kept.
        assert_eq!(size_of::<Answer>(), 44);
        assert_eq!(StimulusId::new(7).place(), 7);
    }
}
