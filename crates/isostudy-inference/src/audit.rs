//! Probes for defects that make a study's answers say something else than people meant.
//!
//! Each probe looks for one defect and leaves alone what another one explains better: a pair whose two orders contradict
//! each other is a matter for the key, and then none for sides or objects. That every probe finds its own defect and no
//! other is proved by [`self_test`](crate::self_test) on simulated studies.
//!
//! What a design cannot show is said to be not answerable, with the reason; it is never taken for the absence of a defect.

mod copies;
mod dealt;
pub mod evidence;
mod interaction;
mod labels;
mod side;
mod stimuli;
mod swapped;
mod turned;

pub use dealt::Dealt;
pub use evidence::Evidence;

use crate::ballots::BallotGroup;
use evidence::{Agreement, Reason, Separations};
use isostudy_statistics::{
    Circumstances, Pairs, Screening, Separation, ShownBallot, outlying_respondents, screening, separation,
};
use stimuli::Stimuli;

/// A probe speaks up at this p, adjusted for all that it looks at.
pub const ALARM: f64 = 0.01;

/// What is looked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Probe {
    /// Is one side chosen whatever it shows?
    Side,
    /// Does somebody answer against the others?
    OutlyingRespondent,
    /// Did somebody's answers get in twice?
    CopiedRows,
    /// Were a stimulus's sides mixed up in the key?
    SwappedKey,
    /// Do preferences depend on the object?
    ObjectInteraction,
    /// Do some items never win against the others, so that no finite worth exists?
    Separation,
}

impl Probe {
    /// Every probe.
    pub const ALL: [Self; 6] = [
        Self::Side,
        Self::OutlyingRespondent,
        Self::CopiedRows,
        Self::SwappedKey,
        Self::ObjectInteraction,
        Self::Separation,
    ];

    /// The name in files.
    pub fn code(self) -> &'static str {
        match self {
            Self::Side => "side",
            Self::OutlyingRespondent => "outlying-respondent",
            Self::CopiedRows => "copied-rows",
            Self::SwappedKey => "swapped-key",
            Self::ObjectInteraction => "object-interaction",
            Self::Separation => "separation",
        }
    }

    /// The name in print.
    pub fn label(self) -> &'static str {
        match self {
            Self::Side => "side",
            Self::OutlyingRespondent => "outlying respondent",
            Self::CopiedRows => "copied rows",
            Self::SwappedKey => "wrong key",
            Self::ObjectInteraction => "object interaction",
            Self::Separation => "separation",
        }
    }

    /// What it asks.
    pub fn question(self) -> &'static str {
        match self {
            Self::Side => "Is a side chosen whatever it shows?",
            Self::OutlyingRespondent => "Does anybody answer against the others?",
            Self::CopiedRows => "Are anybody's answers in twice?",
            Self::SwappedKey => "Were the sides of a stimulus mixed up in the key?",
            Self::ObjectInteraction => "Do preferences depend on the object?",
            Self::Separation => "Do some items never win against the others?",
        }
    }
}

/// How a probe came out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Finding {
    /// The defect is there.
    Found,
    /// Looked for and not found.
    NotFound,
    /// The design or the answers cannot tell.
    NotAnswerable,
}

impl Finding {
    /// For people.
    pub fn label(self) -> &'static str {
        match self {
            Self::Found => "found",
            Self::NotFound => "not found",
            Self::NotAnswerable => "not answerable here",
        }
    }
}

/// One probe's report.
#[derive(Debug, Clone, PartialEq)]
pub struct Report {
    /// Which probe.
    pub probe: Probe,
    /// How it came out.
    pub finding: Finding,
    /// Its p, adjusted for all that it looked at; `None` if it needs none.
    pub p: Option<f64>,
    /// What was seen, or why nothing can be seen.
    pub evidence: Evidence,
}

/// What is audited.
#[derive(Debug, Clone, Copy)]
pub struct Audited<'a> {
    /// Every answer. Participants are named by their number from 1.
    pub ballots: &'a [ShownBallot],
    /// The groups whose items are compared, with the same participants and questions.
    pub groups: &'a [BallotGroup],
    /// By question, the object on which it shows its items.
    pub scenes: &'a [usize],
    /// Names of the questions.
    pub questions: &'a [String],
    /// Names of the objects.
    pub objects: &'a [String],
    /// Whether left and right are sides.
    pub sides_recorded: bool,
    /// When and how fast each answer was given, one a ballot in the same order, or none at all.
    pub circumstances: &'a [Circumstances],
    /// What the study knows of sides, if there is a study.
    pub dealt: Option<&'a Dealt<'a>>,
}

/// Runs every probe.
///
/// # Panics
/// If a ballot's question has no scene or name, or a scene no name; if there are circumstances, but not one a ballot.
pub fn audit(audited: &Audited<'_>) -> Vec<Report> {
    let labels = labels::look(audited);
    let stimuli = Stimuli::of(audited.ballots, audited.scenes, &labels.suspects);
    let (swapped, suspects) = swapped::probe(audited, labels, &stimuli);
    vec![
        side::probe(audited, &stimuli, &suspects),
        outlying_respondent(audited.ballots),
        copies::probe(audited.ballots, audited.circumstances),
        swapped,
        interaction::probe(audited, &suspects),
        separated(audited.groups),
    ]
}

impl Report {
    fn tested(probe: Probe, p: f64, evidence: Evidence) -> Self {
        let finding = if p < ALARM { Finding::Found } else { Finding::NotFound };
        Self { probe, finding, p: Some(p), evidence }
    }

    fn not_answerable(probe: Probe, reason: Reason) -> Self {
        Self { probe, finding: Finding::NotAnswerable, p: None, evidence: Evidence::NotAnswerable(reason) }
    }
}

impl Audited<'_> {
    fn names(&self, questions: impl IntoIterator<Item = usize>) -> Vec<String> {
        questions.into_iter().map(|question| self.questions[question].clone()).collect()
    }
}

/// See [`outlying_respondents`].
fn outlying_respondent(ballots: &[ShownBallot]) -> Report {
    let agreeing: Vec<_> = screening(ballots).iter().map(Screening::with_majority).collect();
    let judged = outlying_respondents(&agreeing);
    let Some(least) = judged.first() else {
        return Report::not_answerable(Probe::OutlyingRespondent, Reason::FewDeciders);
    };
    let outlying = judged.iter().filter(|of| of.p < ALARM).map(|of| (of.participant, of.agreement)).collect();
    let others = judged.iter().filter(|of| of.p >= ALARM).map(|of| of.agreement);
    let (low, high) = others.fold((1.0_f64, 0.0_f64), |(low, high), a| (low.min(a), high.max(a)));
    let evidence = Evidence::OutlyingRespondent(Agreement { outlying, low, high });
    Report::tested(Probe::OutlyingRespondent, least.p, evidence)
}

/// See [`separation`].
fn separated(groups: &[BallotGroup]) -> Report {
    let shows_two = |group: &&BallotGroup| group.ballots.iter().any(|b| b.left() != b.right());
    let compared: Vec<&BallotGroup> = groups.iter().filter(shows_two).collect();
    if compared.is_empty() {
        return Report::not_answerable(Probe::Separation, Reason::NothingCompared);
    }
    let judged: Vec<(Separation, &str)> =
        compared.iter().filter_map(|group| Some((worths(group)?, group.name.as_str()))).collect();
    if judged.is_empty() {
        return Report::not_answerable(Probe::Separation, Reason::NothingDecided);
    }
    let names = |of: Separation| -> Vec<String> {
        judged
            .iter()
            .filter(|(separation, _)| *separation == of)
            .map(|(_, name)| (*name).to_owned())
            .collect()
    };
    let separations = Separations {
        separated: names(Separation::Separated),
        disconnected: names(Separation::Disconnected),
        held_by_ties: names(Separation::HeldByTies),
        judged: judged.len(),
        undecided: compared.len() - judged.len(),
    };
    let finding = if separations.separated.is_empty() { Finding::NotFound } else { Finding::Found };
    Report { probe: Probe::Separation, finding, p: None, evidence: Evidence::Separation(separations) }
}

/// How a group's answers leave its worths; `None` if none of them decides anything.
fn worths(group: &BallotGroup) -> Option<Separation> {
    let pairs = Pairs::of(group.items.len(), &group.ballots);
    (pairs.ties() < pairs.answers()).then(|| separation(&pairs))
}

#[cfg(test)]
mod tests;
