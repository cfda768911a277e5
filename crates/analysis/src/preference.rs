//! The paper's preference factors, in exact fractions.
//!
//! The factor of a method in a comparison group is the share of *all* answers to the group's questions that chose it,
//! no-preference answers included (Costen 2026, section on the questionnaire). A method that appears in only some of
//! the group's questions can therefore not reach 1: its [cap](GroupFactor::cap) in a three-method group is 2/3.
//! The overall factor of a method is the sum of its group factors, and mixes these scales.

use crate::fraction::Fraction;
use crate::tally::{QuestionCount, Tally};
use design::{Arrangement, Clustering, Comparison, Method, Study};

/// Answers that chose something, ties, and all answers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Share {
    /// Answers for it.
    pub wins: u64,
    /// Answers without preference to the same questions.
    pub ties: u64,
    /// All answers to these questions.
    pub answers: u64,
}

impl Share {
    /// `wins / answers`, in 0..=1.
    ///
    /// # Panics
    /// If there are no answers.
    pub fn factor(&self) -> Fraction {
        Fraction::new(self.wins.into(), self.answers.into())
    }
}

/// One method within one comparison group.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct GroupFactor {
    /// Index of the group.
    pub group: usize,
    /// The method.
    pub method: Method,
    /// Its share of the group's answers; `ties` are the whole group's.
    pub share: Share,
    /// Answers to the group's questions that show the method: what it could have won.
    pub appearances: u64,
}

impl GroupFactor {
    /// The largest factor possible: appearances over answers.
    pub fn cap(&self) -> Fraction {
        Fraction::new(self.appearances.into(), self.share.answers.into())
    }

    /// Wins over appearances: the same scale in every group.
    pub fn appearance_share(&self) -> Option<Fraction> {
        (self.appearances > 0).then(|| Fraction::new(self.share.wins.into(), self.appearances.into()))
    }
}

/// Every member of every group, in the study's order, over the objects that `counts` picks.
///
/// Groups without a question on these objects are left out.
pub fn group_factors(study: &Study, tally: &Tally, counts: impl Fn(usize) -> bool) -> Vec<GroupFactor> {
    let mut factors = Vec::new();
    for (g, group) in study.groups.iter().enumerate() {
        let answers = tally.count(|row| row.group == g && counts(row.object));
        if answers == 0 {
            continue;
        }
        let ties = tally.count(|row| row.group == g && counts(row.object) && row.chosen.is_none());
        for &method in &group.members {
            let wins = tally.count(|row| row.group == g && counts(row.object) && row.chosen == Some(method));
            let shows = |&&c: &&usize| {
                let comparison = &study.comparisons[c];
                counts(comparison.object)
                    && (comparison.left.method == method || comparison.right.method == method)
            };
            let shown = group.comparisons.iter().filter(shows);
            let appearances = shown.map(|&c| tally.questions[c].answers()).sum();
            factors.push(GroupFactor { group: g, method, share: Share { wins, ties, answers }, appearances });
        }
    }
    factors
}

/// The sum of each method's group factors, in the study's order; methods in no group are left out.
pub fn overall(study: &Study, factors: &[GroupFactor]) -> Vec<(Method, Fraction)> {
    let sum = |method: Method| {
        let of = factors.iter().filter(|f| f.method == method).map(|f| f.share.factor());
        of.reduce(|sum, factor| sum + factor).map(|sum| (method, sum))
    };
    study.methods().into_iter().filter_map(sum).collect()
}

/// What a margin of the overall table is taken over.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Margin {
    /// The methods of one arrangement.
    Arrangement(Arrangement),
    /// The methods of one clustering.
    Clustering(Clustering),
}

impl Margin {
    /// Whether the method counts towards it.
    pub fn holds(self, method: Method) -> bool {
        match self {
            Self::Arrangement(arrangement) => method.arrangement == arrangement,
            Self::Clustering(clustering) => method.clustering == clustering,
        }
    }

    /// The one-letter code.
    pub fn code(self) -> char {
        match self {
            Self::Arrangement(arrangement) => arrangement.code(),
            Self::Clustering(clustering) => clustering.code(),
        }
    }

    /// The name in tables.
    pub fn label(self) -> &'static str {
        match self {
            Self::Arrangement(arrangement) => arrangement.label(),
            Self::Clustering(clustering) => clustering.label(),
        }
    }
}

/// Plain means of the overall factors, arrangements first, in the study's order.
pub fn margins(study: &Study, overall: &[(Method, Fraction)]) -> Vec<(Margin, Fraction)> {
    let arrangements = study.file.arrangements.iter().map(|&a| Margin::Arrangement(a));
    let clusterings = study.file.clusterings.iter().map(|&c| Margin::Clustering(c));
    let mean = |margin: Margin| {
        let of: Vec<Fraction> = overall.iter().filter(|(m, _)| margin.holds(*m)).map(|&(_, f)| f).collect();
        Fraction::mean(&of).map(|mean| (margin, mean))
    };
    arrangements.chain(clusterings).filter_map(mean).collect()
}

/// One object's answers to the questions that differ in arrangement alone.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ArrangementContest {
    /// Index of the object; `None` is all objects together.
    pub object: Option<usize>,
    /// Index of the group; `None` is all groups together.
    pub group: Option<usize>,
    /// Answers for body-centred.
    pub body_centred: u64,
    /// Answers without preference.
    pub none: u64,
    /// Answers for simple cubic.
    pub simple_cubic: u64,
}

/// Whether a question compares the body-centred with the simple cubic lattice, everything else equal.
fn is_direct(comparison: &Comparison) -> bool {
    let (left, right) = (comparison.left.method, comparison.right.method);
    let papers = |a| matches!(a, Arrangement::BodyCentred | Arrangement::SimpleCubic);
    left.clustering == right.clustering
        && left.arrangement != right.arrangement
        && papers(left.arrangement)
        && papers(right.arrangement)
}

/// How many questions compare lattices, everything else equal, and are not in [`arrangement_contests`], because one of the
/// two is another lattice.
pub fn other_arrangement_questions(study: &Study) -> usize {
    let lattices = |c: &&Comparison| {
        c.left.method.clustering == c.right.method.clustering
            && c.left.method.arrangement != c.right.method.arrangement
    };
    study.comparisons.iter().filter(lattices).filter(|c| !is_direct(c)).count()
}

/// Body-centred against simple cubic where nothing else differs: by object and group, by object, then pooled. Counted are
/// questions, whatever else their groups compare.
///
/// This is the direct evidence on arrangements; sums over clustering groups carry none, because the members of such a
/// group share their arrangement. Empty if the study never compares the two.
pub fn arrangement_contests(study: &Study, tally: &Tally) -> Vec<ArrangementContest> {
    let direct: Vec<(&Comparison, &QuestionCount)> = study
        .comparisons
        .iter()
        .zip(&tally.questions)
        .filter(|(comparison, _)| is_direct(comparison))
        .collect();
    let contest = |object: Option<usize>, group: Option<usize>| {
        let mut sum = ArrangementContest { object, group, body_centred: 0, none: 0, simple_cubic: 0 };
        let own = direct.iter().filter(|(comparison, _)| {
            object.is_none_or(|o| comparison.object == o) && group.is_none_or(|g| comparison.group == g)
        });
        for (comparison, count) in own {
            let straight = comparison.left.method.arrangement == Arrangement::BodyCentred;
            let (body, simple) = if straight { (count.left, count.right) } else { (count.right, count.left) };
            sum.body_centred += body;
            sum.none += count.none;
            sum.simple_cubic += simple;
        }
        sum
    };
    let mut contests = Vec::new();
    for object in (0..study.file.objects.len()).map(Some).chain([None]) {
        contests.extend((0..study.groups.len()).map(|g| contest(object, Some(g))));
        contests.push(contest(object, None));
    }
    contests.retain(|c| c.body_centred + c.none + c.simple_cubic > 0);
    contests
}

#[cfg(test)]
mod tests;
