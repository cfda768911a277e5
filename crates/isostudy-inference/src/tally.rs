//! From answers to counts.

use crate::ballots::{is_asked, method_of_item};
use isostudy_design::{MethodId, Study};
use isostudy_responses::{Answer, Responses};
use rayon::prelude::*;
use std::collections::BTreeMap;

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
        let items = method_of_item(study, answers);
        let counted = || answers.answers.iter().filter(|answer| is_asked(study, answer));
        // One number an answer: the respondent weighs most, and no preference is less than any method.
        let kinds = Kinds::of(study);
        let chosen = |answer: &Answer| answer.chosen().map(|item| items[item as usize]);
        let mut numbers: Vec<u64> = counted()
            .map(|answer| kinds.number(answer.participant, answer.question as usize, chosen(answer)))
            .collect();
        numbers.par_sort_unstable();
        let mut rows: Vec<TallyRow> =
            numbers.chunk_by(|a, b| a == b).map(|alike| kinds.row(alike[0], alike.len())).collect();
        // There may be millions, and they grew by doubling.
        rows.shrink_to_fit();
        let mut questions = vec![QuestionCount::default(); study.comparisons.len()];
        for answer in counted() {
            let left = study.place(study.comparisons[answer.question as usize].left.method);
            let count = &mut questions[answer.question as usize];
            *match chosen(answer).map(|method| method == left) {
                Some(true) => &mut count.left,
                None => &mut count.none,
                Some(false) => &mut count.right,
            } += 1;
        }
        let methods = by_method(study, &questions);
        Self { respondents: answers.participants.len(), rows, methods, questions }
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

/// Respondent, object, group and choice as one number: sorting these takes a twentieth of grouping rows by four columns.
struct Kinds<'a> {
    study: &'a Study,
    methods: Vec<MethodId>,
    /// How many objects, groups and choices there are.
    sizes: [u64; 3],
}

impl<'a> Kinds<'a> {
    fn of(study: &'a Study) -> Self {
        let methods = study.method_ids();
        let sizes = [study.file.objects.len(), study.groups.len(), methods.len() + 1].map(|size| size as u64);
        Self { study, methods, sizes }
    }

    fn number(&self, respondent: u32, question: usize, chosen: Option<usize>) -> u64 {
        let comparison = &self.study.comparisons[question];
        let places = [comparison.object, comparison.group, chosen.map_or(0, |method| method + 1)];
        let add = |number: u64, (place, size): (usize, u64)| number * size + place as u64;
        places.into_iter().zip(self.sizes).fold(respondent.into(), add)
    }

    fn row(&self, number: u64, answers: usize) -> TallyRow {
        let [objects, groups, choices] = self.sizes;
        let (number, chosen) = (number / choices, number % choices);
        let (number, group) = (number / groups, number % groups);
        TallyRow {
            respondent: (number / objects) as u32,
            object: (number % objects) as u32,
            group: group as u32,
            chosen: chosen.checked_sub(1).map(|method| self.methods[method as usize]),
            answers: answers as u32,
        }
    }
}

/// Counts of questions added up over those of one object and group.
fn by_method(study: &Study, questions: &[QuestionCount]) -> Vec<MethodCount> {
    let mut sums: BTreeMap<(usize, usize, Option<usize>), u64> = BTreeMap::new();
    for (comparison, count) in study.comparisons.iter().zip(questions) {
        let [left, right] =
            [&comparison.left, &comparison.right].map(|shown| Some(study.place(shown.method)));
        for (chosen, answers) in [(left, count.left), (None, count.none), (right, count.right)] {
            *sums.entry((comparison.object, comparison.group, chosen)).or_insert(0) += answers;
        }
    }
    let methods = study.method_ids();
    let sums = sums.into_iter().filter(|(_, answers)| *answers > 0);
    sums.map(|((object, group, chosen), answers)| MethodCount {
        object,
        group,
        chosen: chosen.map(|method| methods[method]),
        answers,
    })
    .collect()
}
