//! What the tables have to say, computed again from what stood on the sides and what was pressed.
//!
//! Small, slow and obvious, and nothing of it is shared with the program but the reading of the study file: questions are
//! told apart by the letters in their ids, tests go through every pattern of signs, worths are not fitted but the printed
//! ones tried.

mod agreement;
mod counts;
mod hypotheses;
mod omnibus;
mod respondents;
mod worths;

pub(super) use agreement::triads;
pub(super) use hypotheses::{Hypothesis, hypotheses};
pub(super) use worths::{compare_scales, compare_worths};

use crate::expected::{Expected, Want};
use crate::people::Given;
use isostudy_design::Study;
use isostudy_design::forms::Role;

/// One question, by what its ids say.
#[derive(Debug, Clone)]
pub(super) struct Question {
    pub(super) id: String,
    /// The object's place in the study, and its name.
    pub(super) object: usize,
    pub(super) object_name: String,
    pub(super) group: String,
    /// Two letters: the lattice's and the clustering's.
    pub(super) left: String,
    pub(super) right: String,
    /// In what its methods differ.
    compared: Compares,
    /// Answers for the method that is listed on the left, for none, and for the other.
    counts: [u64; 3],
}

/// What a question compares.
#[derive(Debug, Clone)]
struct Compares {
    /// The one thing in which its methods differ, or `method` where they differ in both.
    factor: &'static str,
    /// The values of that, left and right: one letter, or both.
    levels: [String; 2],
    /// The value of the other thing.
    within: Option<String>,
}

impl Compares {
    fn of(left: &str, right: &str) -> Self {
        let [one, other] = [left, right].map(str::to_uppercase);
        let part = |of: &str, at: usize| of[at..=at].to_owned();
        let (factor, levels, within) = match (one[..1] == other[..1], one[1..] == other[1..]) {
            (true, _) => ("clustering", [part(&one, 1), part(&other, 1)], Some(part(&one, 0))),
            (_, true) => ("arrangement", [part(&one, 0), part(&other, 0)], Some(part(&one, 1))),
            _ => ("method", [left.to_owned(), right.to_owned()], None),
        };
        Self { factor, levels, within }
    }
}

/// A study and what is known of its answers.
#[derive(Debug)]
pub(super) struct Oracle<'a> {
    pub(super) questions: Vec<Question>,
    /// Names of the objects.
    pub(super) objects: Vec<String>,
    /// Letters of lattices and clusterings, in the study's order.
    pub(super) lattices: Vec<char>,
    pub(super) clusterings: Vec<char>,
    /// Ids and members of the groups.
    pub(super) groups: Vec<(String, Vec<String>)>,
    /// How long a turn takes.
    turn_ms: u32,
    /// Everything that was given.
    pub(super) given: &'a [Given],
    /// By person, the answers to the study's own questions, with the places of these.
    pub(super) comparisons: Vec<Vec<(usize, &'a Given)>>,
}

impl<'a> Oracle<'a> {
    pub(super) fn of(study: &Study, given: &'a [Given]) -> Self {
        let question = |c: &isostudy_design::Comparison| Question {
            id: c.question.clone(),
            object: c.object,
            object_name: study.file.objects[c.object].name.clone(),
            group: study.groups[c.group].id.clone(),
            compared: Compares::of(&c.left.method.to_string(), &c.right.method.to_string()),
            left: c.left.method.to_string(),
            right: c.right.method.to_string(),
            counts: [0; 3],
        };
        let members = |g: &isostudy_design::Group| g.members.iter().map(ToString::to_string).collect();
        let mut questions: Vec<Question> = study.comparisons.iter().map(question).collect();
        let people = given.iter().map(|given| given.person + 1).max().unwrap_or(0);
        let mut comparisons = vec![Vec::new(); people];
        for given in given.iter().filter(|given| given.shown.role == Role::Comparison) {
            let place = questions.iter().position(|question| question.id == given.shown.question);
            let place = place.expect("a comparison of the study");
            comparisons[given.person].push((place, given));
            let question = &mut questions[place];
            let chosen = given.chosen().map_or(1, |chosen| if chosen == question.left { 0 } else { 2 });
            question.counts[chosen] += 1;
        }
        Self {
            questions,
            comparisons,
            objects: study.file.objects.iter().map(|object| object.name.clone()).collect(),
            lattices: study.file.arrangements.iter().map(|a| a.code()).collect(),
            clusterings: study.file.clusterings.iter().map(|c| c.code()).collect(),
            groups: study.groups.iter().map(|g| (g.id.clone(), members(g))).collect(),
            turn_ms: study.file.turntable.loop_ms(),
            given,
        }
    }

    /// Answers to the study's own questions.
    pub(super) fn comparisons(&self) -> impl Iterator<Item = (&Question, &'a Given)> {
        self.comparisons.iter().flatten().map(|&(question, given)| (&self.questions[question], given))
    }

    /// Answers for some methods, for none and for others, over the questions that are meant.
    pub(super) fn score(&self, meant: impl Fn(&Question) -> bool, first: impl Fn(&str) -> bool) -> [u64; 3] {
        let mut sum = [0; 3];
        for question in self.questions.iter().filter(|question| meant(question)) {
            let [left, none, right] = question.counts;
            sum[if first(&question.left) { 0 } else { 2 }] += left;
            sum[1] += none;
            sum[if first(&question.right) { 0 } else { 2 }] += right;
        }
        sum
    }

    /// What every table has to say, but for the worths, which are tried and not expected.
    pub(super) fn expected(&self, thorough: bool) -> Vec<Expected> {
        let mut all = counts::expected(self);
        all.push(hypotheses::expected(self, thorough));
        all.extend([omnibus::expected(self), agreement::expected(self), respondents::expected(self)]);
        all
    }
}
