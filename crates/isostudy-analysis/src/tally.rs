//! From answers to counts.

use crate::frames;
use isostudy_design::{MethodId, Study};
use isostudy_responses::Responses;
use polars::prelude::*;
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
        let columns = ["participant", "question", "object", "group", "chosen", "counted"];
        let frame = frames::answers(Some(study), answers, &BTreeSet::new(), &columns).frame;
        let numbers = "columns of numbers, all of one length";
        let by_person = Packed::of(&frame, ["participant", "object", "group", "chosen"]).expect(numbers);
        let by_question = Packed::of(&frame, ["question", "chosen"]).expect(numbers);
        drop(frame);
        let questions = count_questions(study, by_question.counts().expect(numbers));
        Self {
            respondents: answers.participants.len(),
            rows: rows(study, by_person.counts().expect(numbers)),
            methods: by_method(study, &questions).expect(numbers),
            questions,
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

/// How many rows are alike in some columns, by what they hold.
type Counts<const N: usize> = Vec<([Option<u32>; N], u32)>;

/// Some columns of the answers that count, as one number per row: the first column weighs most, and nothing is less than anything.
///
/// Grouping millions of rows by four columns takes twenty times as long as sorting one and grouping it sorted.
struct Packed<const N: usize> {
    numbers: Vec<u64>,
    /// By column, one more than its largest digit.
    sizes: [u64; N],
}

impl<const N: usize> Packed<N> {
    fn of(frame: &DataFrame, columns: [&str; N]) -> PolarsResult<Self> {
        let mut numbers = vec![0; frame.height()];
        let mut sizes = [1; N];
        for (column, size) in columns.into_iter().zip(&mut sizes) {
            let places = frame.column(column)?.u32()?;
            *size = u64::from(places.max().unwrap_or(0)) + 2;
            for (number, place) in numbers.iter_mut().zip(places.iter()) {
                *number = *number * *size + place.map_or(0, |place| u64::from(place) + 1);
            }
        }
        let mut counted = frame.column("counted")?.bool()?.iter();
        numbers.retain(|_| counted.next().flatten() == Some(true));
        Ok(Self { numbers, sizes })
    }

    fn unpack(&self, mut number: u64) -> [Option<u32>; N] {
        let mut places = [None; N];
        for (place, size) in places.iter_mut().zip(self.sizes).rev() {
            *place = (number % size).checked_sub(1).map(|place| place as u32);
            number /= size;
        }
        places
    }

    /// The number of rows of each kind, in the order of their columns.
    fn counts(mut self) -> PolarsResult<Counts<N>> {
        let numbers = UInt64Chunked::from_vec("number".into(), std::mem::take(&mut self.numbers));
        let sorted = numbers.sort(false).into_column();
        let frame = DataFrame::new(sorted.len(), vec![sorted])?;
        // Sorted before, and grouped in that order.
        let counts = frame.group_by_stable(["number"])?.select(["number"]).count()?;
        let (numbers, answers) = (counts.column("number")?.u64()?, counts.column("number_count")?.u32()?);
        let known = numbers.iter().zip(answers.iter());
        Ok(known.filter_map(|(number, answers)| Some((self.unpack(number?), answers?))).collect())
    }
}

fn rows(study: &Study, counts: Counts<4>) -> Vec<TallyRow> {
    let methods = study.method_ids();
    let row = |([participant, object, group, chosen], answers): ([Option<u32>; 4], u32)| {
        let chosen = chosen.map(|method| methods[method as usize]);
        Some(TallyRow { respondent: participant? - 1, object: object?, group: group?, chosen, answers })
    };
    let mut rows: Vec<TallyRow> = counts.into_iter().filter_map(row).collect();
    // There may be millions, and they grew by doubling.
    rows.shrink_to_fit();
    rows
}

fn count_questions(study: &Study, counts: Counts<2>) -> Vec<QuestionCount> {
    let methods = study.method_ids();
    let mut questions = vec![QuestionCount::default(); study.comparisons.len()];
    for ([question, chosen], answers) in counts {
        let Some(question) = question.map(|question| question as usize) else { continue };
        let count = &mut questions[question];
        let left = study.comparisons[question].left.method;
        *match chosen.map(|method| methods[method as usize] == left) {
            Some(true) => &mut count.left,
            None => &mut count.none,
            Some(false) => &mut count.right,
        } += u64::from(answers);
    }
    questions
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
    )?;
    let added = added.filter(&added.column("answers")?.u64()?.gt(0))?;
    if added.height() == 0 {
        return Ok(Vec::new());
    }
    let sum = |group: DataFrame| {
        let answers = group.column("answers")?.u64()?.sum().unwrap_or(0);
        group.select(keys)?.head(Some(1)).hstack(&[Column::new("answers".into(), [answers])])
    };
    let added = added.group_by(keys)?.apply(sum)?.sort(keys, SortMultipleOptions::default())?;
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
