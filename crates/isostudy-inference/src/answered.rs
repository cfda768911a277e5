//! A study's answers, with what more than one table, figure or sentence is made from.

use crate::ballots::{BallotGroup, ballot_groups, ballots, declared};
use crate::hypotheses::{self, Hypothesis};
use crate::looks;
use crate::recorded::Recorded;
use crate::tally::Tally;
use isostudy_design::Study;
use isostudy_design::config::Exclusion;
use isostudy_design::contrast::contrasts;
use isostudy_responses::{Answer, Responses};
use isostudy_statistics::{DeclaredBallot, Flag, Look, ShownBallot, screening_with};
use std::borrow::Cow;
use std::collections::BTreeSet;

/// Answers that were counted and tested once, for all that is said about them.
#[derive(Debug, Clone)]
pub struct Answered {
    /// Every answer, whoever gave it.
    pub responses: Responses,
    /// Who is left out of everything below, by a rule that the study declares.
    pub excluded: BTreeSet<usize>,
    /// Their counts.
    pub tally: Tally,
    /// Answers to comparisons by question, on the sides that people saw.
    pub shown: Vec<ShownBallot>,
    /// The same answers in the same order, as the study declares its comparisons.
    pub declared: Vec<DeclaredBallot>,
    /// The items that are compared with one another, and the answers about them.
    pub groups: Vec<BallotGroup>,
    /// The look that the answers have reached, where the study may stop by one.
    pub look: Option<Look>,
    /// Every contrast, then every question.
    pub hypotheses: Vec<Hypothesis>,
}

impl Answered {
    /// Whether anybody saw a comparison other than as the study lists it.
    pub fn sides_differ(&self) -> bool {
        self.shown.iter().zip(&self.declared).any(|(shown, declared)| shown.left() != declared.first())
    }

    /// Every answer to a comparison as it was shown, those of people who are left out included.
    pub fn everyone(&self, study: &Study) -> Cow<'_, [ShownBallot]> {
        match self.excluded.is_empty() {
            true => Cow::Borrowed(&self.shown),
            false => Cow::Owned(ballots(study, &self.responses)),
        }
    }

    /// Counts and tests the answers to a study's comparisons. `None` if it has none.
    ///
    /// # Panics
    /// If the answers were read for another study; and if a contrast's answers are not those of its questions, which would
    /// make every sentence about it wrong.
    pub fn of(study: &Study, responses: Responses) -> Option<Self> {
        if study.comparisons.is_empty() {
            return None;
        }
        let excluded = excluded(study, &responses);
        let mut counting = Cow::Borrowed(&responses);
        if !excluded.is_empty() {
            let counts = |answer: &Answer| !excluded.contains(&(answer.participant as usize));
            counting.to_mut().answers.retain(counts);
        }
        let (tally, (shown, groups)) = rayon::join(
            || Tally::of(&counting, study),
            || {
                let shown = ballots(study, &counting);
                let groups = ballot_groups(study, &shown);
                (shown, groups)
            },
        );
        let declared = declared(study, &shown);
        // Whoever is left out has finished, too.
        let look = match excluded.is_empty() {
            true => looks::reached(study, &shown),
            false => looks::reached(study, &ballots(study, &responses)),
        };
        let hypotheses = hypotheses::of_study(study, &declared, look.as_ref());
        check(study, &tally, &hypotheses);
        drop(counting);
        Some(Self { responses, excluded, tally, shown, declared, groups, look, hypotheses })
    }
}

/// Who broke a rule whose breakers the study leaves out.
fn excluded(study: &Study, answers: &Responses) -> BTreeSet<usize> {
    let rules = &study.file.analysis.exclude;
    if rules.is_empty() {
        return BTreeSet::new();
    }
    let shown = ballots(study, answers);
    let recorded = Recorded::of_study(study, answers, &shown);
    let protocol = recorded.protocol();
    let breaks = |flag: &Flag| {
        rules.contains(&match flag {
            Flag::OneSided => Exclusion::OneSided,
            Flag::Controls => Exclusion::Controls,
            Flag::Repeats => Exclusion::Repeats,
            Flag::Time => Exclusion::Time,
            Flag::Outlying => Exclusion::Outlying,
        })
    };
    let screened = screening_with(recorded.ballots(), &protocol);
    let broken = screened.into_iter().filter(|seen| seen.flags(&protocol).iter().any(breaks));
    broken.map(|seen| seen.participant).collect()
}

/// A contrast's answers are those of its questions, as they are counted elsewhere.
fn check(study: &Study, tally: &Tally, hypotheses: &[Hypothesis]) {
    for contrast in contrasts(study).iter().filter(|contrast| !contrast.is_difference()) {
        let tested = hypotheses
            .iter()
            .find(|h| h.contrast == contrast.name && h.scope == contrast.scope && !h.is_question())
            .expect("every contrast is tested");
        let mut counts = [0; 3];
        for (&question, &sign) in &contrast.parts[0] {
            let of = tally.questions[question];
            let [first, second] = if sign > 0 { [of.left, of.right] } else { [of.right, of.left] };
            [first, of.none, second].into_iter().zip(&mut counts).for_each(|(own, sum)| *sum += own);
        }
        assert_eq!(
            tested.test.counts,
            Some(counts),
            "{contrast} was tested on other answers than its questions have"
        );
    }
}
