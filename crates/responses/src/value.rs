//! Answers, read and checked: one value an answer, whatever file they came from.

use crate::choice::Choice;

/// Everybody's answers, in long form.
///
/// # Guarantees
/// Every index is in range. Nobody gave two answers to one question with the same item on the left, unless they say that
/// they were shown at different places. Every participant has an answer.
#[derive(Debug, Clone, PartialEq)]
pub struct Responses {
    /// Who answered, in the file's order.
    pub participants: Vec<Participant>,
    /// What was asked: a study's questions in its order, then those that only the file has.
    pub questions: Vec<Question>,
    /// Names of what was shown: a study's configurations in its order, or whatever the file names.
    pub items: Vec<String>,
    /// The answers, in the file's order. Questions that somebody did not answer are not here.
    pub answers: Vec<Answer>,
    /// Whether the file says, or the study declares, which item was on which side. If not, `left` and `right` of an
    /// answer are in no particular order, and nothing about sides can be told.
    pub sides_recorded: bool,
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
}

impl Question {
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
    /// At which place in the session it was shown, if recorded.
    pub order: Option<u32>,
    /// Milliseconds until the answer, if recorded; finite and not negative.
    pub rt_ms: Option<f32>,
}

impl Answer {
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
    /// The choice with the sides that the question declares: of an answer to a pair shown mirrored, the mirror image.
    pub fn declared_choice(&self, answer: &Answer) -> Choice {
        let question = &self.questions[answer.question as usize];
        if answer.left == question.left { answer.choice } else { answer.choice.swapped() }
    }
}
