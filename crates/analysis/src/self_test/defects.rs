//! Studies with one planted defect.

use crate::audit::{self, Audited, Probe, Report};
use crate::ballots::BallotGroup;
use statistics::ShownBallot;
use statistics::simulation::{Plan, Population, simulate, stream};
use std::collections::BTreeMap;

/// Participants of a planted study.
const PEOPLE: usize = 36;
/// Log-worths where people have preferences.
const WORTHS: [f64; 4] = [0.0, 1.0, 2.0, 3.0];
/// Difference between people, in logits.
const SD: f64 = 0.5;
/// How the studies are, for people.
pub(super) const DESCRIPTION: &str = "36 people, 4 items, 5 objects, 30 questions, sides counterbalanced; Davidson's model \
    with tie parameter 0.3, people 0.5 logits apart, items at 0, 1, 2, 3 logits";

/// What is wrong with a study.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Defect {
    /// Nothing, and nobody has a preference.
    NoEffect,
    /// Nothing, and preferences are strong.
    Sound,
    /// Nobody has a preference but for the left side: 0.8 logits.
    SideBias,
    /// Respondent 8 prefers everything the other way round.
    OddRespondent,
    /// Respondent 17's row is respondent 5's.
    CopiedRows,
    /// The stimulus of question 3 with the weaker item on the left has its sides swapped in the key.
    SwappedKey,
    /// On the first object preferences are the other way round.
    ObjectInteraction,
    /// One item is chosen always.
    Separation,
}

impl Defect {
    /// The studies without a defect, then every defect.
    pub const ALL: [Self; 8] = [
        Self::NoEffect,
        Self::Sound,
        Self::SideBias,
        Self::OddRespondent,
        Self::CopiedRows,
        Self::SwappedKey,
        Self::ObjectInteraction,
        Self::Separation,
    ];

    /// The probe that has to find it.
    pub fn probe(self) -> Option<Probe> {
        match self {
            Self::NoEffect | Self::Sound => None,
            Self::SideBias => Some(Probe::Side),
            Self::OddRespondent => Some(Probe::OddRespondent),
            Self::CopiedRows => Some(Probe::CopiedRows),
            Self::SwappedKey => Some(Probe::SwappedKey),
            Self::ObjectInteraction => Some(Probe::ObjectInteraction),
            Self::Separation => Some(Probe::Separation),
        }
    }

    /// For people.
    pub fn label(self) -> &'static str {
        match self {
            Self::NoEffect => "no effect",
            Self::Sound => "preferences, no defect",
            Self::SideBias => "side bias only",
            Self::OddRespondent => "one odd respondent",
            Self::CopiedRows => "copied rows",
            Self::SwappedKey => "swapped key",
            Self::ObjectInteraction => "object interaction",
            Self::Separation => "separation",
        }
    }
}

/// A simulated study.
#[derive(Debug, Clone, PartialEq)]
pub struct Planted {
    /// What was asked.
    pub plan: Plan,
    /// What was answered, as it would be read.
    pub ballots: Vec<ShownBallot>,
}

impl Planted {
    /// Runs every probe; all items are one group.
    pub fn audit(&self) -> Vec<Report> {
        let numbered = |what: &str, n: usize| (1..=n).map(|i| format!("{what}{i}")).collect::<Vec<_>>();
        let scenes = self.plan.scenes();
        let group = BallotGroup {
            name: "all".into(),
            items: numbered("item ", self.plan.items),
            ballots: self.ballots.clone(),
        };
        audit::audit(&Audited {
            ballots: &self.ballots,
            groups: &[group],
            scenes: &scenes,
            questions: &numbered("Q", self.plan.questions.len()),
            sides_recorded: true,
            objects: &numbered("object ", scenes.iter().max().map_or(0, |last| last + 1)),
        })
    }
}

/// Study number `study` with a defect. The same numbers, the same study.
pub fn planted(defect: Defect, seed: u64, study: u64) -> Planted {
    let plan = Plan::round_robin(WORTHS.len(), 5);
    let mut population = Population { worths: WORTHS.to_vec(), ..Population::indifferent(WORTHS.len(), SD) };
    match defect {
        Defect::NoEffect => population.worths.fill(0.0),
        Defect::SideBias => {
            population.worths.fill(0.0);
            population.side = 0.8;
        }
        Defect::ObjectInteraction => {
            let reversed = WORTHS.iter().rev().copied().collect();
            population.exceptions = BTreeMap::from([(0, reversed)]);
        }
        Defect::Separation => population.worths[3] = 25.0,
        _ => {}
    }
    let mut numbers = stream(seed, study);
    let mut ballots = simulate(&plan, &population, PEOPLE, &mut numbers);
    match defect {
        Defect::OddRespondent => {
            let contrary = Population { worths: WORTHS.iter().map(|l| -l).collect(), ..population };
            let own = simulate(&plan, &contrary, 8, &mut numbers);
            replace(&mut ballots, 7, own.into_iter().filter(|b| b.participant() == 7));
        }
        Defect::CopiedRows => {
            let first: Vec<ShownBallot> = ballots.iter().filter(|b| b.participant() == 4).copied().collect();
            replace(&mut ballots, 16, first.into_iter().map(|b| b.with_participant(16)));
        }
        Defect::SwappedKey => {
            // Items 1 and 4 on the first object.
            let wrong = |b: &&mut ShownBallot| b.question() == 2 && b.left() < b.right();
            ballots.iter_mut().filter(wrong).for_each(|b| *b = b.with_outcome(b.outcome().swapped()));
        }
        _ => {}
    }
    Planted { plan, ballots }
}

fn replace(ballots: &mut [ShownBallot], participant: usize, with: impl Iterator<Item = ShownBallot>) {
    ballots.iter_mut().filter(|b| b.participant() == participant).zip(with).for_each(|(b, new)| *b = new);
}
