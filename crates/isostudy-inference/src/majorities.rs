//! Who answers with the others and who against them, and what becomes of the tests without the latter.

use crate::ballots::BallotGroup;
use crate::hypotheses::{self, Hypothesis};
use isostudy_design::Study;
use isostudy_statistics::{DeclaredBallot, Screening, ShownBallot, screening};
use std::collections::BTreeSet;

/// Fewer comparable answers than this say nothing about a person.
const COMPARABLE: u64 = 6;

/// Everybody beside the majority of the others.
pub struct Majorities {
    /// What was seen of everybody's answers that count.
    pub seen: Vec<Screening>,
    /// Every hypothesis that was tested, by its place, without those who answer against the majority more often than with it; single
    /// questions are left out. Empty where nobody does, or where most do: majorities are then by an answer or two.
    pub without_outlying: Vec<(usize, Hypothesis)>,
}

impl Majorities {
    /// Of answers, their groups, and what was tested on them.
    pub fn of(
        study: Option<&Study>,
        shown: &[ShownBallot],
        declared: &[DeclaredBallot],
        groups: &[BallotGroup],
        tested: &[Hypothesis],
    ) -> Self {
        let mut found = Self { seen: screening(shown), without_outlying: Vec::new() };
        let [against, with] = found.judged();
        if against.is_empty() || against.len() > with.len() {
            return found;
        }
        let people: BTreeSet<usize> = against.iter().map(|(of, _)| of.participant).collect();
        let keep = |person: usize| !people.contains(&person);
        let again = match study {
            Some(study) => {
                let kept = declared.iter().filter(|b| keep(b.participant()));
                let look = tested.iter().find_map(|of| of.look.as_ref());
                hypotheses::of_study(study, &kept.copied().collect::<Vec<_>>(), look)
            }
            None => {
                let some = |group: &BallotGroup| BallotGroup {
                    ballots: group.ballots.iter().filter(|b| keep(b.participant())).copied().collect(),
                    ..group.clone()
                };
                hypotheses::of_groups(&groups.iter().map(some).collect::<Vec<_>>())
            }
        };
        let is_meant = |of: &Hypothesis| !of.is_question() && of.is_tested();
        let pairs = tested.iter().enumerate().filter(|(_, with)| is_meant(with)).filter_map(|(i, with)| {
            let mut others = again.iter().filter(|of| is_meant(of));
            Some((i, others.find(|other| with.is_about_the_same(other))?.clone()))
        });
        found.without_outlying = pairs.collect();
        found
    }

    /// Everybody who can be judged, with the share of answers that side with the majority: those below a half, and the others.
    pub fn judged(&self) -> [Vec<(&Screening, f64)>; 2] {
        let enough = self.seen.iter().filter(|of| of.comparable >= COMPARABLE);
        let (against, with) =
            enough.filter_map(|of| Some((of, of.agreement()?))).partition(|(_, share)| *share < 0.5);
        [against, with]
    }
}
