//! What somebody may want of a mesh, in words.

use crate::region;
use isostudy_design::{MethodId, Study};
use isostudy_inference::conclusions::{About, Verdict};
use isostudy_inference::decision::{Goal, Pick};
use isostudy_inference::inputs::Inputs;
use isostudy_inference::results::Results;
use isostudy_timing::beside_other_work;

/// Ties of more methods are counted, not named.
pub(crate) const TIED: usize = 4;

/// The words for a purpose.
pub(crate) struct Words {
    /// Before a colon.
    pub(crate) heading: &'static str,
    /// Its number with its unit, `{}` for the number.
    pub(crate) unit: &'static str,
    /// After *You want*.
    pub(crate) phrase: &'static str,
    /// What the number is, with `{}` for it.
    pub(crate) says: &'static str,
}

/// What was judged of a pick: on which of its objects somebody is the best.
pub(crate) fn judged<'r, 'a>(results: &'r Results<'a>) -> Vec<&'r Pick<'a>> {
    let is_judged = |place: usize| {
        let found = results.conclusions.about(About::Take(place, 0));
        found.is_some_and(|of| matches!(of.verdict, Verdict::Best { .. }))
    };
    let picks = results.decision.picks.iter().enumerate();
    picks.filter(|(place, _)| is_judged(*place)).map(|(_, pick)| pick).collect()
}

/// The methods that the choices name, each once, in the order of the choices: the best, and those that are not told apart from it.
pub fn named_by_choices(results: &Results<'_>) -> Vec<MethodId> {
    let mut named: Vec<MethodId> = Vec::new();
    for pick in judged(results) {
        let alike =
            pick.on.iter().filter(|best| best.alike.len() < TIED).flat_map(|best| best.alike.iter().copied());
        for id in std::iter::once(pick.method.id).chain(alike) {
            if !named.contains(&id) {
                named.push(id);
            }
        }
    }
    named
}

/// Why times decide nothing, in a sentence; `None` where they do.
pub(crate) fn busy(inputs: &Inputs<'_>) -> Option<String> {
    let why = inputs.bench.and_then(beside_other_work)?;
    Some(format!(
        "Times decide nothing here, because the run was {why}. Run it again on a machine that is left alone."
    ))
}

/// What a purpose is called.
pub(crate) fn words(goal: Goal) -> Words {
    let [heading, unit, phrase, says] = match goal {
        Goal::Preferred => [
            "most liked",
            "{}",
            "the look that people like most",
            "worth {}, in log-odds above the mean of all methods",
        ],
        Goal::Fastest => ["shortest time", "{} ms", "the shortest time", "{} ms"],
        Goal::Chunk => ["shortest chunk", "{} ms", "the shortest time for a chunk", "{} ms"],
        Goal::Edit => ["shortest edit", "{} ms", "the shortest time for an edit, in chunks", "{} ms"],
        Goal::StoredFastest => {
            ["shortest time from stored samples", "{} ms", "the shortest time from stored samples", "{} ms"]
        }
        Goal::StoredChunk => [
            "shortest chunk from stored samples",
            "{} ms",
            "the shortest time for a chunk from stored samples",
            "{} ms",
        ],
        Goal::StoredEdit => [
            "shortest edit from stored samples",
            "{} ms",
            "the shortest time for an edit from stored samples",
            "{} ms",
        ],
        Goal::Closest => ["smallest mean error", "{}", "the smallest mean error", "{} cube edges"],
        Goal::ClosestPerTriangle => [
            "the same with as many triangles",
            "{}",
            "the smallest mean error with as many triangles",
            "{} cube edges",
        ],
        Goal::SharpEdges => {
            ["sharp edges kept", "{}", "sharp edges kept: the smallest mean error at them", "{} cube edges"]
        }
        Goal::Regular => {
            ["most regular triangles", "{}", "the most regular triangles", "mean radius ratio {}"]
        }
        Goal::Faultless => [
            "shortest time without a fault",
            "{} ms",
            "the shortest time to a manifold without intersections",
            "{} ms",
        ],
        Goal::Topology => [
            "the same with the samples' topology",
            "{} ms",
            "the same with the topology of the interpolated samples",
            "{} ms",
        ],
    };
    Words { heading, unit, phrase, says }
}

/// What stands before a colon: where objects have regions, it says which part is judged.
pub(crate) fn heading(study: &Study, goal: Goal) -> String {
    with_part(words(goal).heading, study, goal)
}

/// The phrase after *You want*, likewise.
pub(crate) fn phrase(study: &Study, goal: Goal) -> String {
    with_part(words(goal).phrase, study, goal)
}

fn with_part(text: &str, study: &Study, goal: Goal) -> String {
    let is_of_part =
        matches!(goal, Goal::Closest | Goal::ClosestPerTriangle | Goal::SharpEdges | Goal::Regular);
    match region::alone(study).filter(|_| is_of_part) {
        Some(alone) => format!("{text}, {alone}"),
        None => text.into(),
    }
}
