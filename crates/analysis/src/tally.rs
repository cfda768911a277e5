//! From answers to counts: the long table and what is counted over it.

use crate::ballots::{is_asked, method_of_item};
use crate::inputs::Inputs;
use design::{Method, Study};
use polars::prelude::*;
use responses::{Choice, Responses};

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
    /// Counts the answers to a study's questions.
    ///
    /// # Errors
    /// What polars says; not to be expected for answers that were read for this study.
    ///
    /// # Panics
    /// If the answers were read for another study.
    pub fn of(answers: &Responses, study: &Study) -> PolarsResult<Self> {
        let long = long_table(answers, study)?;
        Ok(Self {
            respondents: answers.participants.len(),
            rows: count_choices(long.clone().lazy(), study)?,
            questions: count_questions(long.lazy(), study)?,
        })
    }

    /// Counts the answers, if there are any to questions.
    ///
    /// # Errors
    /// As [`Tally::of`].
    pub(crate) fn of_inputs(inputs: &Inputs<'_>) -> PolarsResult<Option<Self>> {
        match inputs.answers {
            Some(answers) if !inputs.study.comparisons.is_empty() => {
                Self::of(answers, inputs.study).map(Some)
            }
            _ => Ok(None),
        }
    }

    /// The number of answers in the rows that `holds` picks.
    pub fn count(&self, holds: impl Fn(&TallyRow) -> bool) -> u64 {
        self.rows.iter().filter(|row| holds(row)).map(|row| row.answers).sum()
    }
}

/// One row an answer: respondent, comparison and what it compares, the choice by declared side, the chosen method.
/// Controls and repeats are left out.
fn long_table(answers: &Responses, study: &Study) -> PolarsResult<DataFrame> {
    let items = method_of_item(study, answers);
    let asked = || answers.answers.iter().filter(|answer| is_asked(study, answer));
    let column = |of: &dyn Fn(&responses::Answer) -> u32| asked().map(of).collect::<Vec<u32>>();
    let comparison = |answer: &responses::Answer| &study.comparisons[answer.question as usize];
    let chosen = |answer: &responses::Answer| answer.chosen().map(|item| items[item as usize] as u32);
    df!(
        "respondent" => column(&|answer| answer.participant),
        "comparison" => column(&|answer| answer.question),
        "object" => column(&|answer| comparison(answer).object as u32),
        "group" => column(&|answer| comparison(answer).group as u32),
        "choice" => column(&|answer| answers.declared_choice(answer) as u32),
        "chosen" => asked().map(chosen).collect::<Vec<Option<u32>>>(),
    )
}

fn count_choices(long: LazyFrame, study: &Study) -> PolarsResult<Vec<TallyRow>> {
    let keys = ["respondent", "object", "group", "chosen"];
    let counted = long
        .group_by(keys.map(col))
        .agg([len().alias("answers")])
        .sort(keys, SortMultipleOptions::default())
        .collect()?;
    let methods = study.methods();
    let mut rows = Vec::with_capacity(counted.height());
    let [respondent, object, group, chosen] = keys.map(|key| counted.column(key).and_then(|c| c.u32()));
    let (respondent, object, group, chosen) = (respondent?, object?, group?, chosen?);
    let answers = counted.column("answers")?.cast(&DataType::UInt64)?;
    let answers = answers.u64()?;
    for i in 0..counted.height() {
        rows.push(TallyRow {
            respondent: respondent.get(i).expect("never null") as usize,
            object: object.get(i).expect("never null") as usize,
            group: group.get(i).expect("never null") as usize,
            chosen: chosen.get(i).map(|method| methods[method as usize]),
            answers: answers.get(i).expect("never null"),
        });
    }
    Ok(rows)
}

fn count_questions(long: LazyFrame, study: &Study) -> PolarsResult<Vec<QuestionCount>> {
    let counted =
        long.group_by([col("comparison"), col("choice")]).agg([len().alias("answers")]).collect()?;
    let mut counts = vec![QuestionCount::default(); study.comparisons.len()];
    let (comparison, choice) = (counted.column("comparison")?.u32()?, counted.column("choice")?.u32()?);
    let answers = counted.column("answers")?.cast(&DataType::UInt64)?;
    for (i, answers) in answers.u64()?.iter().enumerate() {
        let count = &mut counts[comparison.get(i).expect("never null") as usize];
        let choice = Choice::ALL[choice.get(i).expect("never null") as usize];
        *match choice {
            Choice::Left => &mut count.left,
            Choice::NoPreference => &mut count.none,
            Choice::Right => &mut count.right,
        } = answers.expect("never null");
    }
    Ok(counts)
}
