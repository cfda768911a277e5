//! From answers to counts: the long table and what is counted over it.

use crate::answers::{Answers, Choice};
use crate::inputs::Inputs;
use design::{Method, Study};
use polars::prelude::*;

/// How often each choice was made in one question.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct QuestionCount {
    /// Answers for the left side.
    pub left: u64,
    /// Answers without preference.
    pub none: u64,
    /// Answers for the right side.
    pub right: u64,
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
    pub fn of(answers: &Answers, study: &Study) -> PolarsResult<Self> {
        let long = long_table(answers, study)?;
        Ok(Self {
            respondents: answers.respondents(),
            rows: count_choices(long.clone(), study)?,
            questions: count_questions(long, study)?,
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

/// One row an answer: respondent, question, choice, and what the question compares.
fn long_table(answers: &Answers, study: &Study) -> PolarsResult<LazyFrame> {
    let wide = answers.frame.clone().with_row_index("(respondent)".into(), None)?;
    let long = wide.lazy().unpivot(UnpivotArgsDSL {
        on: Some(by_name(study.comparisons.iter().map(|c| c.question.as_str()), true, false)),
        index: by_name(["(respondent)"], true, false),
        variable_name: Some("question".into()),
        value_name: Some("choice".into()),
    });
    let join = JoinArgs::new(JoinType::Inner);
    Ok(long.join(comparisons(study)?.lazy(), [col("question")], [col("question")], join))
}

/// The study's comparisons as a table; objects, groups and methods by index.
fn comparisons(study: &Study) -> PolarsResult<DataFrame> {
    let methods = study.methods();
    let index = |method: Method| methods.iter().position(|&m| m == method).expect("checked on load") as u32;
    let all = &study.comparisons;
    df!(
        "question" => all.iter().map(|c| c.question.as_str()).collect::<Vec<_>>(),
        "comparison" => (0..all.len() as u32).collect::<Vec<_>>(),
        "object" => all.iter().map(|c| c.object as u32).collect::<Vec<_>>(),
        "group" => all.iter().map(|c| c.group as u32).collect::<Vec<_>>(),
        "left" => all.iter().map(|c| index(c.left.method)).collect::<Vec<_>>(),
        "right" => all.iter().map(|c| index(c.right.method)).collect::<Vec<_>>(),
    )
}

fn count_choices(long: LazyFrame, study: &Study) -> PolarsResult<Vec<TallyRow>> {
    let chosen = when(col("choice").eq(lit(Choice::Left.code())))
        .then(col("left"))
        .when(col("choice").eq(lit(Choice::Right.code())))
        .then(col("right"))
        .otherwise(lit(NULL));
    let keys = ["(respondent)", "object", "group", "chosen"];
    let counted = long
        .with_column(chosen.alias("chosen"))
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
    let (comparison, choice) = (counted.column("comparison")?.u32()?, counted.column("choice")?.str()?);
    let answers = counted.column("answers")?.cast(&DataType::UInt64)?;
    for (i, answers) in answers.u64()?.iter().enumerate() {
        let count = &mut counts[comparison.get(i).expect("never null") as usize];
        let choice = choice.get(i).and_then(Choice::from_code).expect("checked when read");
        *match choice {
            Choice::Left => &mut count.left,
            Choice::NoPreference => &mut count.none,
            Choice::Right => &mut count.right,
        } = answers.expect("never null");
    }
    Ok(counts)
}
