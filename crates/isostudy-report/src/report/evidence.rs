//! What sentences are made from.

use super::asked;
use isostudy_design::Study;
use isostudy_inference::ballots::BallotGroup;
use isostudy_inference::conclusions::{Conclusion, Limit};
use isostudy_inference::hypotheses::{Hypothesis, Rules};
use isostudy_inference::inputs::Inputs;
use isostudy_inference::omnibus::Omnibus;
use isostudy_inference::scale::GroupScale;
use isostudy_inference::{Preferences, Results, audit};
use isostudy_statistics::{DeclaredBallot, ShownBallot};
use std::collections::{BTreeMap, BTreeSet};

/// What sentences are made from.
pub(super) struct Evidence<'a> {
    pub(super) study: Option<&'a Study>,
    /// What the answers say; none without answers.
    pub(super) preferences: Option<&'a Preferences<'a>>,
    /// Answers to comparisons, by the sides that people saw.
    pub(super) shown: &'a [ShownBallot],
    /// The same answers, about items.
    pub(super) declared: &'a [DeclaredBallot],
    /// How many answers were asked for: what stands on people's forms.
    pub(super) asked: usize,
    /// How many people are left out, by a rule that the study declares.
    pub(super) excluded: usize,
    /// Whether the file says which item was on which side.
    pub(super) sides_recorded: bool,
    /// Whether it says on what screens people looked.
    pub(super) screens_recorded: bool,
    /// Whether it says at which place a question was shown.
    pub(super) order_recorded: bool,
    /// The configurations that failed.
    pub(super) left_out: Vec<String>,
    /// What was assumed of the answers' file, in sentences.
    pub(super) assumptions: Vec<String>,
    pub(super) groups: &'a [BallotGroup],
    pub(super) hypotheses: &'a [Hypothesis],
    pub(super) omnibus: &'a [Omnibus],
    /// The items of each group on one scale.
    pub(super) scales: &'a [GroupScale<'a>],
}

impl<'a> Evidence<'a> {
    pub(super) fn of_study(results: &'a Results<'a>) -> Self {
        let Inputs { study, answers, left_out, .. } = results.inputs;
        Self {
            study: Some(study),
            asked: answers.map_or(0, |answered| asked::asked(study, answered)),
            left_out: left_out.iter().map(|(id, _)| id.to_string()).collect(),
            ..results.preferences.as_ref().map_or_else(Self::of_nothing, Self::of)
        }
    }

    pub(super) fn of_nothing() -> Self {
        Self {
            study: None,
            preferences: None,
            shown: &[],
            declared: &[],
            asked: 0,
            excluded: 0,
            sides_recorded: true,
            screens_recorded: false,
            order_recorded: false,
            left_out: Vec::new(),
            assumptions: Vec::new(),
            groups: &[],
            hypotheses: &[],
            omnibus: &[],
            scales: &[],
        }
    }

    pub(super) fn of(preferences: &'a Preferences<'a>) -> Self {
        let responses = preferences.responses;
        Self {
            study: preferences.study,
            preferences: Some(preferences),
            shown: &preferences.shown,
            declared: &preferences.declared,
            // Without a study nobody knows what was asked for.
            asked: preferences.shown.len(),
            excluded: preferences.excluded,
            sides_recorded: responses.sides_recorded,
            screens_recorded: !responses.screens.is_empty(),
            order_recorded: responses.answers.iter().any(|answer| answer.order.is_some()),
            left_out: Vec::new(),
            assumptions: responses.assumptions(),
            groups: preferences.groups,
            hypotheses: &preferences.hypotheses,
            omnibus: &preferences.omnibus,
            scales: &preferences.scales,
        }
    }

    /// What the probes found.
    pub(super) fn audit(&self) -> &'a [audit::Report] {
        self.preferences.map_or(&[], |of| &of.audit)
    }

    /// Whether the probes found that people favour a side.
    pub(super) fn is_side_favoured(&self) -> bool {
        self.preferences.is_some_and(Preferences::is_side_favoured)
    }

    /// Whether repeats show pairs in both orders where comparisons do not.
    pub(super) fn are_repeats_exchanged(&self) -> bool {
        let limited = |of: &Conclusion| of.is_limited(Limit::OnlyRepeatsExchange);
        self.preferences.is_some_and(|of| of.conclusions.all.iter().any(limited))
    }

    /// What decides conclusions.
    pub(super) fn rules(&self) -> Rules {
        self.study.map_or_else(Rules::default, |study| Rules::of(&study.file.analysis))
    }

    pub(super) fn participants(&self) -> usize {
        participants(self.shown)
    }

    pub(super) fn questions(&self) -> usize {
        self.shown.iter().map(|b| b.question()).collect::<BTreeSet<_>>().len()
    }
}

/// Why a scale and a test of the same two may differ.
pub(super) const WEIGHTS: &str = "People gave different numbers of answers. A worth counts every answer alike, and a test counts every \
                                 person alike, so the two may differ.";

/// Whether somebody gave more answers than another.
pub(super) fn answer_unequally(shown: &[ShownBallot]) -> bool {
    let mut given: BTreeMap<usize, usize> = BTreeMap::new();
    shown.iter().for_each(|of| *given.entry(of.participant()).or_default() += 1);
    let mut counts = given.values();
    counts.next().is_some_and(|first| counts.any(|other| other != first))
}

/// How many people gave these answers.
pub(super) fn participants(shown: &[ShownBallot]) -> usize {
    shown.iter().map(|b| b.participant()).collect::<BTreeSet<_>>().len()
}
