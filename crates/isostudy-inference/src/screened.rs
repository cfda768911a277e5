//! The tests with everybody, and without those who broke a rule: nobody is left out silently.

use crate::answered::Answered;
use crate::ballots::{BallotGroup, declared};
use crate::hypotheses::{self, Hypothesis};
use isostudy_design::Study;
use isostudy_statistics::{DeclaredBallot, Flag, Protocol, Screening};
use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};

/// What careless answering would show in of one participant, and the rules that are broken.
#[derive(Debug, Clone)]
pub struct Respondent {
    /// What was seen.
    pub seen: Screening,
    /// The rules that the answers break.
    pub flags: Vec<Flag>,
}

impl Respondent {
    /// Everybody of whom something was seen, by what screening can use.
    pub fn all(seen: Vec<Screening>, protocol: &Protocol<'_>) -> Vec<Self> {
        seen.into_iter().map(|seen| Self { flags: seen.flags(protocol), seen }).collect()
    }
}

/// The tests without those who broke one rule.
#[derive(Debug, Clone)]
pub struct WithoutBreakers {
    /// The rule; `None` is any of them.
    pub rule: Option<Flag>,
    /// Who broke it.
    pub people: BTreeSet<usize>,
    /// Every test that somebody has a score in, with everybody; and without them, if anybody is left.
    pub tests: Vec<(Hypothesis, Option<Hypothesis>)>,
}

/// The tests that are decided otherwise without those who broke a rule.
#[derive(Debug, Clone, Default)]
pub struct Changes<'a> {
    /// They hold in the other direction.
    pub turned: Vec<&'a Hypothesis>,
    /// They hold with everybody alone. Fewer people show less, so that this alone is no sign of carelessness.
    pub undecided: Vec<&'a Hypothesis>,
    /// They hold without those people alone.
    pub decided: Vec<&'a Hypothesis>,
}

impl Changes<'_> {
    /// How many there are.
    pub fn number(&self) -> usize {
        self.turned.len() + self.undecided.len() + self.decided.len()
    }
}

impl WithoutBreakers {
    /// Whether anybody is left whose answers can be tested.
    pub fn leaves_somebody(&self) -> bool {
        self.tests.iter().any(|(_, without)| without.is_some())
    }

    /// What is decided otherwise; nothing where nobody is left.
    pub fn changes(&self) -> Changes<'_> {
        let mut changes = Changes::default();
        if !self.leaves_somebody() {
            return changes;
        }
        for (with, without) in &self.tests {
            let without = without.as_ref().filter(|of| of.differs());
            match (with.differs(), without) {
                (true, Some(other)) if with.test.mean * other.test.mean < 0.0 => changes.turned.push(with),
                (true, None) => changes.undecided.push(with),
                (false, Some(_)) => changes.decided.push(with),
                (true, Some(_)) | (false, None) => {}
            }
        }
        changes
    }
}

/// Every contrast of a study with everybody, those included whom the study leaves out; single questions are left out.
pub fn of_study(study: &Study, answers: &Answered, respondents: &[Respondent]) -> Vec<WithoutBreakers> {
    let everyone = match answers.excluded.is_empty() {
        true => Cow::Borrowed(&answers.declared),
        false => Cow::Owned(declared(study, &answers.everyone(study))),
    };
    screened(
        respondents,
        || hypotheses::of_contrasts(study, &everyone, answers.look.as_ref()),
        |keep| {
            let kept: Vec<DeclaredBallot> =
                everyone.iter().filter(|b| keep(b.participant())).copied().collect();
            hypotheses::of_contrasts(study, &kept, answers.look.as_ref())
        },
    )
}

/// Every pair of items, group by group.
pub fn of_groups(groups: &[BallotGroup], respondents: &[Respondent]) -> Vec<WithoutBreakers> {
    screened(
        respondents,
        || hypotheses::of_groups(groups),
        |keep| {
            let kept = |group: &BallotGroup| BallotGroup {
                ballots: group.ballots.iter().filter(|b| keep(b.participant())).copied().collect(),
                ..group.clone()
            };
            hypotheses::of_groups(&groups.iter().map(kept).collect::<Vec<_>>())
        },
    )
}

fn screened(
    respondents: &[Respondent],
    all: impl Fn() -> Vec<Hypothesis>,
    tested: impl Fn(&dyn Fn(usize) -> bool) -> Vec<Hypothesis>,
) -> Vec<WithoutBreakers> {
    let mut broken: BTreeMap<Option<Flag>, BTreeSet<usize>> = BTreeMap::new();
    for Respondent { seen, flags } in respondents {
        let any = (!flags.is_empty()).then_some(None);
        for rule in flags.iter().copied().map(Some).chain(any) {
            broken.entry(rule).or_default().insert(seen.participant);
        }
    }
    // One rule alone says what "any" would.
    if broken.len() == 2 {
        broken.remove(&None);
    }
    if broken.is_empty() {
        return Vec::new();
    }
    let all = all();
    let without = |(rule, people): (Option<Flag>, BTreeSet<usize>)| {
        let others = tested(&|participant| !people.contains(&participant));
        // What nobody answered at all does not come out otherwise without anybody.
        let tests = all.iter().filter(|with| with.is_tested()).map(|with| {
            let without = others.iter().find(|other| with.is_about_the_same(other));
            (with.clone(), without.filter(|other| other.is_tested()).cloned())
        });
        WithoutBreakers { rule, tests: tests.collect(), people }
    };
    broken.into_iter().map(without).collect()
}
