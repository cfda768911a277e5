//! From answers to counts.

use crate::ballots::{is_asked, method_of_item};
use design::{MethodId, Study};
use polars::prelude::*;
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
    /// How many people the answers are of, those without a counted answer included.
    pub respondents: usize,
    /// Counts above zero, ordered by respondent, object, group and method (no preference first).
    pub rows: Vec<TallyRow>,
    /// One a question, in the study's order.
    pub questions: Vec<QuestionCount>,
    /// The same answers whoever gave them: counts above zero, ordered by object, group and method (no preference first).
    pub methods: Vec<MethodCount>,
}

/// How many answers to one group's questions on one object went to one method.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct MethodCount {
    /// Index of the object.
    pub object: usize,
    /// Index of the comparison group.
    pub group: usize,
    /// The method chosen; `None` is no preference.
    pub chosen: Option<MethodId>,
    /// How many answers.
    pub answers: u64,
}

/// How many answers of one respondent, in one group's questions on one object, went to one method.
///
/// Kept in 20 bytes, since there may be millions.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TallyRow {
    /// Row of the respondent, from 0.
    pub respondent: u32,
    /// Index of the object.
    pub object: u32,
    /// Index of the comparison group.
    pub group: u32,
    /// The method chosen; `None` is no preference.
    pub chosen: Option<MethodId>,
    /// How many answers.
    pub answers: u32,
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
        let methods = study.method_ids();
        let row = |same: &[Choice]| {
            let (respondent, object, group, method) = same[0];
            let chosen = method.map(|method| methods[method as usize]);
            TallyRow { respondent, object, group, chosen, answers: same.len() as u32 }
        };
        let rows = chosen.chunk_by(|a, b| a == b).map(row).collect();
        let methods = by_method(study, &questions).expect("columns of numbers, all of one length");
        Self { respondents: answers.participants.len(), rows, questions, methods }
    }

    /// How many people have an answer in the counts.
    pub fn people(&self) -> usize {
        self.rows.chunk_by(|a, b| a.respondent == b.respondent).count()
    }

    /// The number of answers in the counts that `holds` picks.
    pub fn count(&self, holds: impl Fn(&MethodCount) -> bool) -> u64 {
        self.methods.iter().filter(|count| holds(count)).map(|count| count.answers).sum()
    }
}

/// Counts of questions added up over those of one object and group.
fn by_method(study: &Study, questions: &[QuestionCount]) -> PolarsResult<Vec<MethodCount>> {
    let methods = study.method_ids();
    let place = |method: MethodId| methods.iter().position(|m| *m == method).map(|place| place as u32);
    let counts = study.comparisons.iter().zip(questions).flat_map(|(comparison, count)| {
        let chosen = [
            (place(comparison.left.method), count.left),
            (None, count.none),
            (place(comparison.right.method), count.right),
        ];
        chosen.map(|(method, answers)| (comparison.object as u32, comparison.group as u32, method, answers))
    });
    let counts: Vec<(u32, u32, Option<u32>, u64)> = counts.collect();
    let keys = ["object", "group", "chosen"];
    let added = df!(
        "object" => counts.iter().map(|count| count.0).collect::<Vec<_>>(),
        "group" => counts.iter().map(|count| count.1).collect::<Vec<_>>(),
        "chosen" => counts.iter().map(|count| count.2).collect::<Vec<_>>(),
        "answers" => counts.iter().map(|count| count.3).collect::<Vec<_>>(),
    )?
    .lazy()
    .filter(col("answers").gt(lit(0_u64)))
    .group_by(keys.map(col))
    .agg([col("answers").sum()])
    .sort(keys, SortMultipleOptions::default())
    .collect()?;
    let [object, group, chosen] = keys.map(|key| added.column(key).and_then(|column| column.u32()));
    let (object, group, chosen, answers) = (object?, group?, chosen?, added.column("answers")?.u64()?);
    let row = |i| {
        Some(MethodCount {
            object: object.get(i)? as usize,
            group: group.get(i)? as usize,
            chosen: chosen.get(i).map(|method| methods[method as usize]),
            answers: answers.get(i)?,
        })
    };
    Ok((0..added.height()).filter_map(row).collect())
}
