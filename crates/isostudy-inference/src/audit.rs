//! Probes for defects that make a study's answers say something else than people meant.
//!
//! Each probe looks for one defect and leaves alone what another one explains better: a pair whose two orders contradict
//! each other is a matter for the key, and then none for sides or objects. That every probe finds its own defect and no
//! other is proved by [`self_test`](crate::self_test) on simulated studies.
//!
//! What a design cannot show is said to be not answerable, with the reason; it is never taken for the absence of a defect.

mod copies;
mod dealt;
mod interaction;
mod labels;
mod side;
mod stimuli;
mod swapped;
mod turned;

pub use dealt::Dealt;

use crate::ballots::BallotGroup;
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
    /// What was seen, with numbers, or why nothing can be seen.
    pub evidence: String,
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

/// Why nothing about sides can be seen.
const NO_SIDES: &str = "the file does not say which item was on which side";

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
    fn tested(probe: Probe, p: f64, evidence: String) -> Self {
        let finding = if p < ALARM { Finding::Found } else { Finding::NotFound };
        Self { probe, finding, p: Some(p), evidence }
    }

    fn not_answerable(probe: Probe, reason: &str) -> Self {
        let evidence = format!("not answerable here, because {reason}");
        Self { probe, finding: Finding::NotAnswerable, p: None, evidence }
    }
}

/// Of many names, the first few.
fn list(names: &[String]) -> String {
    const MOST: usize = 5;
    match names.len() {
        0..=MOST => names.join(", "),
        n => format!("{} and {} more", names[..MOST].join(", "), n - MOST),
    }
}

/// See [`outlying_respondents`].
fn outlying_respondent(ballots: &[ShownBallot]) -> Report {
    let agreeing: Vec<_> = screening(ballots).iter().map(Screening::with_majority).collect();
    let judged = outlying_respondents(&agreeing);
    let Some(least) = judged.first() else {
        let reason = "fewer than five people decided ten questions on which the others have a majority";
        return Report::not_answerable(Probe::OutlyingRespondent, reason);
    };
    let name = |outlying: &isostudy_statistics::Outlying| {
        format!(
            "respondent {} agrees with the others' majority on {:.0} %",
            outlying.participant + 1,
            100.0 * outlying.agreement
        )
    };
    let outlying: Vec<_> = judged.iter().filter(|outlying| outlying.p < ALARM).collect();
    let others: Vec<f64> =
        judged.iter().filter(|outlying| outlying.p >= ALARM).map(|outlying| outlying.agreement).collect();
    let (low, high) = others.iter().fold((1.0_f64, 0.0_f64), |(low, high), &a| (low.min(a), high.max(a)));
    let range = format!("everybody else on {:.0} to {:.0} %", 100.0 * low, 100.0 * high);
    let evidence = match outlying.is_empty() {
        true => format!("agreement with the others' majority is {:.0} to {:.0} %", 100.0 * low, 100.0 * high),
        false => format!("{}; {range}", list(&outlying.into_iter().map(name).collect::<Vec<_>>())),
    };
    Report::tested(Probe::OutlyingRespondent, least.p, evidence)
}

/// See [`separation`].
fn separated(groups: &[BallotGroup]) -> Report {
    let shows_two = |group: &&BallotGroup| group.ballots.iter().any(|b| b.left() != b.right());
    let compared: Vec<&BallotGroup> = groups.iter().filter(shows_two).collect();
    if compared.is_empty() {
        return Report::not_answerable(Probe::Separation, "nothing was compared");
    }
    let judged: Vec<(Separation, &str)> =
        compared.iter().filter_map(|group| Some((worths(group)?, group.name.as_str()))).collect();
    if judged.is_empty() {
        let reason = "nobody ever decided between two items, so that there are no worths";
        return Report::not_answerable(Probe::Separation, reason);
    }
    let names = |of: Separation| -> Vec<String> {
        judged
            .iter()
            .filter(|(separation, _)| *separation == of)
            .map(|(_, name)| (*name).to_owned())
            .collect()
    };
    let (separated, apart) = (names(Separation::Separated), names(Separation::Disconnected));
    let held = names(Separation::HeldByTies);
    let mut evidence = Vec::new();
    if !separated.is_empty() {
        let items = "some items never won against the others: worths are penalised";
        evidence.push(format!("{} {items}", within(&separated)));
    }
    if !apart.is_empty() {
        let items = "some items were never compared with the others: there are no worths";
        evidence.push(format!("{} {items}", within(&apart)));
    }
    if !held.is_empty() {
        evidence.push(format!("{} ties alone keep the worths finite", within(&held)));
    }
    match judged.len() {
        _ if !evidence.is_empty() => {}
        1 => evidence.push("every item won against the others".into()),
        all => evidence.push(format!("every item won against the others in all {all} groups")),
    }
    match compared.len() - judged.len() {
        0 => {}
        1 => evidence.push("in 1 group nobody ever decided".into()),
        none => evidence.push(format!("in {none} groups nobody ever decided")),
    }
    let finding = if separated.is_empty() { Finding::NotFound } else { Finding::Found };
    Report { probe: Probe::Separation, finding, p: None, evidence: evidence.join("; ") }
}

/// `in group trees`, `in groups trees, cakes`.
fn within(groups: &[String]) -> String {
    format!("in {} {}", if groups.len() == 1 { "group" } else { "groups" }, list(groups))
}

/// How a group's answers leave its worths; `None` if none of them decides anything.
fn worths(group: &BallotGroup) -> Option<Separation> {
    let pairs = Pairs::of(group.items.len(), &group.ballots);
    (pairs.ties() < pairs.answers()).then(|| separation(&pairs))
}

#[cfg(test)]
mod tests;
