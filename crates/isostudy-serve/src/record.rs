//! What participants send, and when it is refused.

use crate::screen::{LONGEST_MS, Screen};
use isostudy_design::config::AnswerKind;
use isostudy_design::forms::FormEntry;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Answers about a person by the ids of the questions.
pub type About = BTreeMap<String, String>;

/// Longest identifier of a panel.
const LONGEST_ID: usize = 64;

/// What was answered, as shown: any answer of any [`Way`](isostudy_design::config::Way) to ask.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "&'static str")]
pub enum Choice {
    /// The left half; in five steps, it is better.
    L,
    /// No preference, or none of several.
    Np,
    /// The right half; in five steps, it is better.
    R,
    /// The left half is much better.
    Ll,
    /// The right half is much better.
    Rr,
    /// A step of a scale, or a place among several, from 1 to 9.
    Number(u8),
}

/// What numbers are in files.
const DIGITS: [&str; 9] = ["1", "2", "3", "4", "5", "6", "7", "8", "9"];

impl Choice {
    /// `L`, `NP`, `R`, `LL`, `RR`, or a digit.
    pub fn code(self) -> &'static str {
        match self {
            Self::L => "L",
            Self::Np => "NP",
            Self::R => "R",
            Self::Ll => "LL",
            Self::Rr => "RR",
            Self::Number(number) => DIGITS[usize::from(number).clamp(1, DIGITS.len()) - 1],
        }
    }

    /// The choice with this code.
    pub fn of_code(code: &str) -> Option<Self> {
        let words = [Self::L, Self::Np, Self::R, Self::Ll, Self::Rr];
        let digit = DIGITS.iter().position(|digit| *digit == code);
        let number = digit.map(|place| Self::Number(place as u8 + 1));
        words.into_iter().find(|choice| choice.code() == code).or(number)
    }

    /// Whether it is one of these answers.
    pub fn is_of(self, answers: &[AnswerKind]) -> bool {
        answers.iter().any(|of| of.code == self.code())
    }
}

impl TryFrom<String> for Choice {
    type Error = String;

    fn try_from(code: String) -> Result<Self, String> {
        Self::of_code(&code).ok_or_else(|| format!("{code:?} is no answer"))
    }
}

impl From<Choice> for &'static str {
    fn from(choice: Choice) -> Self {
        choice.code()
    }
}

/// One answer.
#[derive(Debug, Clone, PartialEq)]
pub struct Answer {
    /// Place in the form, from 1, training included.
    pub order: u32,
    /// Code name of the pair that was shown.
    pub stimulus: String,
    /// What was chosen, as shown.
    pub choice: Choice,
    /// Milliseconds from the moment the pair was on the screen.
    pub rt_ms: u32,
    /// On what it was given, where that was recorded.
    pub screen: Option<Screen>,
    /// How often it was changed, where the study lets people go back.
    pub change: u32,
}

/// Why something that was sent is refused; nothing has changed.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Refusal {
    /// No participant has this token.
    #[error("this questionnaire is not known here; reload the page")]
    UnknownToken,
    /// The form has no such question.
    #[error("place {0} is no question of this form")]
    UnknownPlace(u32),
    /// The form shows something else there.
    #[error("place {0} of this form shows another pair")]
    OtherStimulus(u32),
    /// A place before it has no answer yet.
    #[error("place {given} cannot be answered before place {next}")]
    OutOfOrder {
        /// The place that was answered.
        given: u32,
        /// The first without an answer.
        next: u32,
    },
    /// There is another answer already.
    #[error("place {0} has been answered otherwise")]
    Answered(u32),
    /// Questions are left.
    #[error("{0} questions have no answer yet")]
    Unfinished(u32),
    /// More than a day.
    #[error("rt_ms: at most {LONGEST_MS}")]
    TooLong,
    /// An identifier with other characters or too many.
    #[error("{0}: 1 to {LONGEST_ID} letters, digits, hyphens or underscores")]
    BadIdentifier(&'static str),
    /// The study does not ask it about people.
    #[error("the study does not ask that about people")]
    UnknownQuestion,
    /// No answer that the question takes.
    #[error("the question takes no such answer")]
    NoSuchValue,
    /// As many as can be.
    #[error("the study is full")]
    Full,
    /// As many as can be have begun and not answered.
    #[error("too many people have begun and not answered yet; try again in some minutes")]
    Crowded,
}

impl Refusal {
    /// Its name, for the page.
    pub fn id(&self) -> &'static str {
        match self {
            Self::UnknownToken => "unknown-token",
            Self::UnknownPlace(_) => "unknown-place",
            Self::OtherStimulus(_) => "other-stimulus",
            Self::OutOfOrder { .. } => "out-of-order",
            Self::Answered(_) => "answered",
            Self::Unfinished(_) => "unfinished",
            Self::TooLong => "too-long",
            Self::BadIdentifier(_) => "bad-identifier",
            Self::UnknownQuestion => "unknown-question",
            Self::NoSuchValue => "no-such-value",
            Self::Full => "full",
            Self::Crowded => "crowded",
        }
    }
}

/// The first place of a form that is a question, from 1.
pub fn first_place(form: &FormEntry) -> u32 {
    form.training.len() as u32 + 1
}

/// Whether an answer is one of those that can be given, and fits a form of which this many questions have been answered; an answer to one of those is judged by the
/// caller, who knows it.
///
/// # Errors
/// [`Refusal`].
pub fn check(
    answer: &Answer,
    answers: &[AnswerKind],
    form: &FormEntry,
    answered: u32,
) -> Result<(), Refusal> {
    let first = first_place(form);
    let question = answer.order.checked_sub(first).and_then(|place| form.questions.get(place as usize));
    let shown = question.ok_or(Refusal::UnknownPlace(answer.order))?;
    if *shown != answer.stimulus {
        return Err(Refusal::OtherStimulus(answer.order));
    }
    if !answer.choice.is_of(answers) {
        return Err(Refusal::NoSuchValue);
    }
    if answer.rt_ms > LONGEST_MS {
        return Err(Refusal::TooLong);
    }
    let next = first + answered;
    if answer.order > next { Err(Refusal::OutOfOrder { given: answer.order, next }) } else { Ok(()) }
}

/// What a panel such as Prolific adds to the address of a study.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Identifiers {
    /// `PROLIFIC_PID`.
    pub prolific_pid: Option<String>,
    /// `STUDY_ID`.
    pub study_id: Option<String>,
    /// `SESSION_ID`.
    pub session_id: Option<String>,
}

impl Identifiers {
    /// Whether there are any.
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }

    /// Name and value of each.
    pub fn named(&self) -> [(&'static str, Option<&str>); 3] {
        [
            ("PROLIFIC_PID", self.prolific_pid.as_deref()),
            ("STUDY_ID", self.study_id.as_deref()),
            ("SESSION_ID", self.session_id.as_deref()),
        ]
    }

    /// # Errors
    /// If one is empty, too long, or holds anything but letters, digits, hyphens and underscores.
    pub fn check(&self) -> Result<(), Refusal> {
        let plain = |text: &str| {
            (1..=LONGEST_ID).contains(&text.len())
                && text.bytes().all(|b| b.is_ascii_alphanumeric() || b == b'-' || b == b'_')
        };
        match self.named().into_iter().find(|(_, value)| value.is_some_and(|text| !plain(text))) {
            Some((name, _)) => Err(Refusal::BadIdentifier(name)),
            None => Ok(()),
        }
    }
}
