//! Every hypothesis that is tested, with p adjusted within its family.

use crate::ballots::{BallotGroup, as_declared};
use design::Study;
use rayon::prelude::*;
use statistics::contrast::{Contrast, ContrastTest, Level, Over, contrasts};
use statistics::{ShownBallot, benjamini_hochberg, holm};
use std::collections::BTreeMap;

/// How p values of a family are adjusted.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Adjustment {
    /// Against any false rejection in the family.
    Holm,
    /// Against too large a share of false rejections: for what is exploratory.
    BenjaminiHochberg,
}

impl Adjustment {
    pub(crate) fn label(self) -> &'static str {
        match self {
            Self::Holm => "Holm",
            Self::BenjaminiHochberg => "Benjamini-Hochberg",
        }
    }

    pub(crate) fn possessive(self) -> &'static str {
        match self {
            Self::Holm => "Holm's",
            Self::BenjaminiHochberg => "Benjamini and Hochberg's",
        }
    }
}

/// What both adjusted p allow to say, at [`ALPHA`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Conclusion {
    /// There is a preference.
    Differs,
    /// There is one, and it is smaller than the margin.
    DiffersWithinMargin,
    /// If there is one, it is smaller than the margin.
    Equal,
    /// Neither can be said.
    Open,
}

impl Conclusion {
    pub(crate) fn label(self) -> &'static str {
        match self {
            Self::Differs => "differs",
            Self::DiffersWithinMargin => "differs, within the margin",
            Self::Equal => "equal within the margin",
            Self::Open => "open",
        }
    }
}

/// Level of every test here.
pub(crate) const ALPHA: f64 = 0.05;

/// What a hypothesis is about.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Subject {
    /// A contrast of the study.
    Contrast { levels: [Level; 2], over: Over },
    /// One question of the study, by index.
    Question(usize),
    /// Two items of a group.
    Items { group: String, first: String, second: String },
}

/// One hypothesis, tested.
#[derive(Debug, Clone)]
pub(crate) struct Hypothesis {
    /// Name of the family.
    pub(crate) family: String,
    /// What is compared, such as `U-I`.
    pub(crate) contrast: String,
    /// Over which answers, such as `within B`.
    pub(crate) scope: String,
    pub(crate) subject: Subject,
    pub(crate) test: ContrastTest,
    /// The sign-flip p, adjusted within the family.
    pub(crate) adjusted: f64,
    /// p of the test that the mean score lies within [`MARGIN`] of zero, adjusted likewise; `None` for one participant.
    pub(crate) equivalence: Option<f64>,
    pub(crate) adjustment: Adjustment,
    /// How many hypotheses the family has.
    pub(crate) family_size: usize,
}

impl Hypothesis {
    fn new(family: &str, contrast: String, scope: &str, subject: Subject, test: ContrastTest) -> Self {
        let (family, scope) = (family.into(), scope.into());
        let (adjusted, adjustment, family_size) = (1.0, Adjustment::Holm, 1);
        Self { family, contrast, scope, subject, test, adjusted, equivalence: None, adjustment, family_size }
    }

    pub(crate) fn conclusion(&self) -> Conclusion {
        match (self.adjusted <= ALPHA, self.equivalence.is_some_and(|p| p <= ALPHA)) {
            (true, false) => Conclusion::Differs,
            (true, true) => Conclusion::DiffersWithinMargin,
            (false, true) => Conclusion::Equal,
            (false, false) => Conclusion::Open,
        }
    }
}

/// Every contrast of a study, then every question. `ballots` are by question.
pub(crate) fn of_study(study: &Study, ballots: &[ShownBallot]) -> Vec<Hypothesis> {
    let mut all = of_contrasts(study, ballots);
    all.extend(of_questions(study, ballots));
    all
}

/// Every contrast of a study. `ballots` are by question.
pub(crate) fn of_contrasts(study: &Study, ballots: &[ShownBallot]) -> Vec<Hypothesis> {
    let of_contrast = |contrast: Contrast| {
        let subject = Subject::Contrast { levels: contrast.levels, over: contrast.over };
        let test = contrast.test(contrast.weights.keys().flat_map(|&question| of_one(ballots, question)));
        Hypothesis::new(contrast.family.code(), contrast.name, &contrast.scope, subject, test)
    };
    let mut all: Vec<Hypothesis> = contrasts(study).into_par_iter().map(of_contrast).collect();
    adjust(&mut all, Adjustment::Holm);
    all
}

fn of_questions(study: &Study, ballots: &[ShownBallot]) -> Vec<Hypothesis> {
    let of_question = |(q, comparison): (usize, &design::Comparison)| {
        let own = as_declared(study, of_one(ballots, q));
        let test = ContrastTest::of(own.iter().map(|b| (b.participant(), 1, b.outcome())));
        let contrast = format!("{}-{}", comparison.left.method, comparison.right.method);
        Hypothesis::new("questions", contrast, &comparison.question, Subject::Question(q), test)
    };
    let mut all: Vec<Hypothesis> = study.comparisons.par_iter().enumerate().map(of_question).collect();
    adjust(&mut all, Adjustment::BenjaminiHochberg);
    all
}

/// The ballots of one question.
fn of_one(ballots: &[ShownBallot], question: usize) -> &[ShownBallot] {
    let below = |end: usize| ballots.partition_point(|ballot| ballot.question() < end);
    &ballots[below(question)..below(question + 1)]
}

/// Every pair of items that was compared, group by group; the group is the family.
pub(crate) fn of_groups(groups: &[BallotGroup]) -> Vec<Hypothesis> {
    let mut all = Vec::new();
    for group in groups {
        for (i, first) in group.items.iter().enumerate() {
            for (j, second) in group.items.iter().enumerate().skip(i + 1) {
                let weight = |b: &ShownBallot| match (b.left(), b.right()) {
                    (l, r) if (l, r) == (i, j) => Some((b.participant(), 1, b.outcome())),
                    (l, r) if (l, r) == (j, i) => Some((b.participant(), -1, b.outcome())),
                    _ => None,
                };
                let test = ContrastTest::of(group.ballots.iter().filter_map(weight));
                if test.participants() > 0 {
                    let (first, second) = (first.clone(), second.clone());
                    let contrast = format!("{first}-{second}");
                    let subject = Subject::Items { group: group.name.clone(), first, second };
                    all.push(Hypothesis::new(&group.name, contrast, "all", subject, test));
                }
            }
        }
    }
    adjust(&mut all, Adjustment::Holm);
    all
}

fn adjust(all: &mut [Hypothesis], adjustment: Adjustment) {
    let adjusted = |p: Vec<f64>| match adjustment {
        Adjustment::Holm => holm(&p),
        Adjustment::BenjaminiHochberg => benjamini_hochberg(&p),
    };
    let mut families: BTreeMap<String, Vec<usize>> = BTreeMap::new();
    all.iter().enumerate().for_each(|(i, h)| families.entry(h.family.clone()).or_default().push(i));
    for members in families.into_values() {
        let different = adjusted(members.iter().map(|&i| all[i].test.sign_flip.p()).collect());
        let equal = |i: &usize| all[*i].test.equivalence().map(|test| test.p);
        let tested: Vec<Option<f64>> = members.iter().map(equal).collect();
        // One participant alone has no test of equivalence, and then adds none to the family.
        let mut equal = adjusted(tested.iter().flatten().copied().collect()).into_iter();
        for ((&i, different), tested) in members.iter().zip(different).zip(tested) {
            let of = &mut all[i];
            (of.adjusted, of.adjustment, of.family_size) = (different, adjustment, members.len());
            of.equivalence = tested.and_then(|_| equal.next());
        }
    }
}
