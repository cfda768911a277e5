//! From answers to counts.

use crate::frames;
use design::{MethodId, Study};
use polars::prelude::*;
use responses::Responses;
use std::collections::BTreeSet;

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
        let frame = frames::answers(Some(study), answers, &BTreeSet::new()).frame;
        let counted =
            Counted { study, methods: study.method_ids(), answers: frame.lazy().filter(col("counted")) };
        let added = "columns of numbers, all of one length";
        Self {
            respondents: answers.participants.len(),
            rows: counted.by_respondent().expect(added),
            questions: counted.by_question().expect(added),
            methods: counted.by_method().expect(added),
        }
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

/// The answers that count, as a frame.
struct Counted<'a> {
    study: &'a Study,
    methods: Vec<MethodId>,
    answers: LazyFrame,
}

impl Counted<'_> {
    /// Numbers of answers that are alike in these columns, ordered by them; nothing comes before anything.
    fn alike<const N: usize>(&self, keys: [&str; N]) -> PolarsResult<Vec<([Option<u32>; N], u32)>> {
        let by = keys.map(col);
        let counts = self.answers.clone().group_by(by).agg([len().alias("answers")]);
        let counts = counts.sort(keys, SortMultipleOptions::default()).collect()?;
        let answers = counts.column("answers")?.u32()?;
        let columns: Vec<&UInt32Chunked> =
            keys.iter().map(|key| counts.column(key)?.u32()).collect::<PolarsResult<_>>()?;
        let row = |i: usize| (std::array::from_fn(|key| columns[key].get(i)), answers.get(i).unwrap_or(0));
        Ok((0..counts.height()).map(row).collect())
    }

    fn method(&self, place: Option<u32>) -> Option<MethodId> {
        place.map(|place| self.methods[place as usize])
    }

    fn by_respondent(&self) -> PolarsResult<Vec<TallyRow>> {
        let alike = self.alike(["participant", "object", "group", "chosen"])?;
        let row = |([participant, object, group, chosen], answers): ([Option<u32>; 4], u32)| {
            let chosen = self.method(chosen);
            Some(TallyRow { respondent: participant? - 1, object: object?, group: group?, chosen, answers })
        };
        Ok(alike.into_iter().filter_map(row).collect())
    }

    fn by_question(&self) -> PolarsResult<Vec<QuestionCount>> {
        let mut questions = vec![QuestionCount::default(); self.study.comparisons.len()];
        for ([question, chosen], answers) in self.alike(["question", "chosen"])? {
            let Some(question) = question.map(|question| question as usize) else { continue };
            let count = &mut questions[question];
            *match self.method(chosen) {
                None => &mut count.none,
                Some(method) if method == self.study.comparisons[question].left.method => &mut count.left,
                Some(_) => &mut count.right,
            } += u64::from(answers);
        }
        Ok(questions)
    }

    fn by_method(&self) -> PolarsResult<Vec<MethodCount>> {
        let row = |([object, group, chosen], answers): ([Option<u32>; 3], u32)| {
            let (object, group) = (object? as usize, group? as usize);
            Some(MethodCount { object, group, chosen: self.method(chosen), answers: answers.into() })
        };
        Ok(self.alike(["object", "group", "chosen"])?.into_iter().filter_map(row).collect())
    }
}
