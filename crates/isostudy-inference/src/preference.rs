//! The paper's preference factors, in exact fractions.
//!
//! The factor of a method in a comparison group is the share of *all* answers to the group's questions that chose it,
//! no-preference answers included (Costen 2026, section on the questionnaire). A method that appears in only some of
//! the group's questions can therefore not reach 1: its [cap](GroupFactor::cap) in a three-method group is 2/3.
//! The overall factor of a method is the sum of its group factors, and mixes these scales.

use crate::fraction::Fraction;
use crate::tally::{Tally, TallyRow};
use isostudy_design::{Factor, Group, Level, MethodId, Study};
use isostudy_statistics::interval::{Interval, t_over_respondents, wilson};

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
    pub method: MethodId,
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
pub fn overall(study: &Study, factors: &[GroupFactor]) -> Vec<(MethodId, Fraction)> {
    let sum = |method: MethodId| {
        let of = factors.iter().filter(|f| f.method == method).map(|f| f.share.factor());
        of.reduce(|sum, factor| sum + factor).map(|sum| (method, sum))
    };
    study.method_ids().into_iter().filter_map(sum).collect()
}

/// In what share of the answers that showed a method it was chosen; without methods that no answer showed.
pub fn showings_won(study: &Study, factors: &[GroupFactor]) -> Vec<(MethodId, Fraction)> {
    let share = |method: MethodId| {
        let own = factors.iter().filter(|f| f.method == method);
        let (wins, shown) = own.fold((0, 0), |(w, n), f| (w + f.share.wins, n + f.appearances));
        (shown > 0).then(|| (method, Fraction::new(wins.into(), shown.into())))
    };
    study.method_ids().into_iter().filter_map(share).collect()
}

/// Plain means of the overall factors over the methods of each level of each declared factor, in the study's order.
pub fn margins(study: &Study, overall: &[(MethodId, Fraction)]) -> Vec<(Level, Fraction)> {
    let mean = |level: Level| {
        let holds = |method: MethodId| study.level_of(method, level.factor) == Some(level);
        let of: Vec<Fraction> = overall.iter().filter(|(m, _)| holds(*m)).map(|&(_, f)| f).collect();
        Fraction::mean(&of).map(|mean| (level, mean))
    };
    study.declared_factors().flat_map(|factor| study.levels(factor)).filter_map(mean).collect()
}

/// The two factors of a study that declares two, as the paper's does.
pub fn two_factors(study: &Study) -> Option<[Factor; 2]> {
    let declared: Vec<Factor> = study.declared_factors().collect();
    <[Factor; 2]>::try_from(declared).ok()
}

/// The level of a factor that all members of a group share.
pub fn shared(study: &Study, group: &Group, factor: Factor) -> Option<Level> {
    let first = study.level_of(*group.members.first()?, factor)?;
    group.members.iter().all(|&member| study.level_of(member, factor) == Some(first)).then_some(first)
}

/// "a" or "an".
pub fn article(noun: &str) -> &'static str {
    if noun.starts_with(['a', 'e', 'i', 'o', 'u']) { "an" } else { "a" }
}

/// The interval of a method's factor in a group on one object, over respondents: Wilson's where each of them gave one answer,
/// which is one in so many for the method; else the t interval of their own factors, cut at 0 and at its cap. `None` for
/// fewer than two respondents.
pub fn interval(tally: &Tally, factor: &GroupFactor, object: usize) -> Option<Interval> {
    let own = wins_of_answers(tally, factor, object);
    if own.len() > 1 && own.iter().all(|&[_, answers]| answers == 1) {
        return wilson(own.iter().map(|&[wins, _]| u64::from(wins)).sum(), own.len() as u64);
    }
    let mut scores: Vec<f64> =
        own.into_iter().map(|[wins, answers]| f64::from(wins) / f64::from(answers)).collect();
    // Sums of doubles depend on their order, and people come in any.
    scores.sort_by(f64::total_cmp);
    t_over_respondents(&scores).map(|interval| interval.cut(0.0, factor.cap().value()))
}

/// By respondent who answered any of a group's questions on one object: answers for a method, and answers.
fn wins_of_answers(tally: &Tally, factor: &GroupFactor, object: usize) -> Vec<[u32; 2]> {
    let mut own = vec![[0; 2]; tally.respondents];
    let asked = |row: &&TallyRow| (row.group as usize, row.object as usize) == (factor.group, object);
    for row in tally.rows.iter().filter(asked) {
        let [wins, answers] = &mut own[row.respondent as usize];
        *answers += row.answers;
        if row.chosen == Some(factor.method) {
            *wins += row.answers;
        }
    }
    own.retain(|&[_, answers]| answers > 0);
    own
}

#[cfg(test)]
mod tests;
