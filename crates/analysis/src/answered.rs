//! A study's answers, with what more than one table, figure or sentence is made from.

use crate::ballots::{BallotGroup, ballot_groups, ballots};
use crate::hypotheses::{self, Hypothesis};
use crate::tally::Tally;
use design::Study;
use responses::Responses;
use statistics::ShownBallot;

/// Answers that were counted and tested once, for all that is said about them.
#[derive(Debug, Clone)]
pub struct Answered {
    pub(crate) responses: Responses,
    pub(crate) tally: Tally,
    pub(crate) ballots: Vec<ShownBallot>,
    pub(crate) groups: Vec<BallotGroup>,
    /// Every contrast, then every question.
    pub(crate) hypotheses: Vec<Hypothesis>,
}

impl Answered {
    /// Counts and tests the answers to a study's comparisons. `None` if it has none.
    ///
    /// # Panics
    /// If the answers were read for another study.
    pub fn of(study: &Study, responses: Responses) -> Option<Self> {
        if study.comparisons.is_empty() {
            return None;
        }
        let (tally, (ballots, groups)) = rayon::join(
            || Tally::of(&responses, study),
            || {
                let ballots = ballots(study, &responses);
                let groups = ballot_groups(study, &ballots);
                (ballots, groups)
            },
        );
        let hypotheses = hypotheses::of_study(study, &ballots);
        Some(Self { responses, tally, ballots, groups, hypotheses })
    }
}
