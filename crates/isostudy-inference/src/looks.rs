//! Looks at answers while people are still asked.

use isostudy_design::Study;
use isostudy_design::config::StoppingBoundary;
use isostudy_design::forms::Questionnaire;
use isostudy_statistics::{Boundary, Look, ShownBallot};
use std::collections::{BTreeMap, BTreeSet};

/// The look that the answers of all people have reached; `None` of a study that stops by no rule. Whoever answered as many comparisons
/// as the shortest form asks has finished.
pub fn reached(study: &Study, all: &[ShownBallot]) -> Option<Look> {
    let rule = study.file.analysis.stopping.as_ref()?;
    let questionnaire = Questionnaire::of(study)?;
    let asked = |block: usize| questionnaire.form(block).comparisons(study).len();
    let fewest = (0..questionnaire.blocks()).map(asked).min().unwrap_or(0);
    let mut answered: BTreeMap<usize, BTreeSet<usize>> = BTreeMap::new();
    for ballot in all {
        answered.entry(ballot.participant()).or_default().insert(ballot.question());
    }
    let finished = answered.values().filter(|questions| questions.len() >= fewest).count();
    let boundary = match rule.boundary {
        StoppingBoundary::OBrienFleming => Boundary::OBrienFleming,
        StoppingBoundary::Pocock => Boundary::Pocock,
    };
    Some(Look::of(boundary, &rule.looks, finished))
}
