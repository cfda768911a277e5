//! From answers to counts.

use crate::ballots::{is_asked, method_of_item};
use crate::inputs::Inputs;
use design::{Method, Study};
use responses::Responses;

/// Respondent, object, group, and the method chosen, which is nothing for no preference.
type Choice = (u32, u32, u32, Option<u32>);

/// How often each choice was made in one question, with the sides as the study declares them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct QuestionCount {
    /// Answers for the left side.
    pub left: u64,
    /// Answers without preference.
    pub none: u64,
    /// Answers for the right side.
    pub right: u64,
}

impl QuestionCount {
    /// All answers.
    pub fn answers(&self) -> u64 {
        self.left + self.none + self.right
    }
}

/// All answers, counted by respondent, object, group and chosen method.
#[derive(Debug, Clone)]
pub struct Tally {
    /// How many people answered.
    pub respondents: usize,
    /// Counts above zero, ordered by respondent, object, group and method (no preference first).
    pub rows: Vec<TallyRow>,
    /// One a question, in the study's order.
    pub questions: Vec<QuestionCount>,
}

/// How many answers of one respondent, in one group's questions on one object, went to one method.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TallyRow {
    /// Row of the respondent, from 0.
    pub respondent: usize,
    /// Index of the object.
    pub object: usize,
    /// Index of the comparison group.
    pub group: usize,
    /// The method chosen; `None` is no preference.
    pub chosen: Option<Method>,
    /// How many answers.
    pub answers: u64,
}

impl Tally {
    /// Counts the answers to a study's questions; controls and repeats are none.
    ///
    /// # Panics
    /// If the answers were read for another study.
    pub fn of(answers: &Responses, study: &Study) -> Self {
        let items = method_of_item(study, answers);
        let mut questions = vec![QuestionCount::default(); study.comparisons.len()];
        let mut chosen: Vec<Choice> = Vec::with_capacity(answers.answers.len());
        for answer in answers.answers.iter().filter(|answer| is_asked(study, answer)) {
            let count = &mut questions[answer.question as usize];
            *match answers.declared_choice(answer) {
                responses::Choice::Left => &mut count.left,
                responses::Choice::NoPreference => &mut count.none,
                responses::Choice::Right => &mut count.right,
            } += 1;
            let comparison = &study.comparisons[answer.question as usize];
            chosen.push((
                answer.participant,
                comparison.object as u32,
                comparison.group as u32,
                answer.chosen().map(|item| items[item as usize] as u32),
            ));
        }
        chosen.sort_unstable();
        let methods = study.methods();
        let row = |same: &[Choice]| {
            let (respondent, object, group, method) = same[0];
            let (respondent, object, group) = (respondent as usize, object as usize, group as usize);
            let chosen = method.map(|method| methods[method as usize]);
            TallyRow { respondent, object, group, chosen, answers: same.len() as u64 }
        };
        let rows = chosen.chunk_by(|a, b| a == b).map(row).collect();
        Self { respondents: answers.participants.len(), rows, questions }
    }

    /// Counts the answers, if there are any to questions.
    pub(crate) fn of_inputs(inputs: &Inputs<'_>) -> Option<Self> {
        let answers = inputs.answers.filter(|_| !inputs.study.comparisons.is_empty())?;
        Some(Self::of(answers, inputs.study))
    }

    /// The number of answers in the rows that `holds` picks.
    pub fn count(&self, holds: impl Fn(&TallyRow) -> bool) -> u64 {
        self.rows.iter().filter(|row| holds(row)).map(|row| row.answers).sum()
    }
}
