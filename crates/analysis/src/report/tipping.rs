//! How large a liking for a side would undo a result, where methods and sides go together.

use super::Evidence;
use super::words::number;
use crate::ballots::BallotGroup;
use crate::hypotheses::{Hypothesis, Subject};
use design::contrast::{Factor, Level, Over};
use design::{Method, Study};
use statistics::{FARTHEST_TIP, Pairs, Participants, SideDesign, Tip, Tipping, side_design, tipping};

/// Beyond so many different patterns of answers it takes minutes.
const MOST_PATTERNS: usize = 5_000;

/// Said after a result that holds; empty where sides cannot have made it, and where nothing can be said.
pub(super) fn sentence(evidence: &Evidence<'_>, hypothesis: &Hypothesis) -> String {
    let Some((group, [first, second])) = evidence.study.and_then(|study| of(study, evidence, hypothesis))
    else {
        return String::new();
    };
    let items = group.items.len();
    if side_design(&Pairs::of(items, &group.ballots)) == SideDesign::Counterbalanced {
        return String::new();
    }
    let participants = Participants::of(items, &group.ballots);
    if participants.kinds() > MOST_PATTERNS {
        return String::new();
    }
    let Some(Tipping { left, right }) = tipping(&participants, first, second) else { return String::new() };
    match (left, right) {
        (Tip::At(at), _) => undone("left", at),
        (_, Tip::At(at)) => undone("right", at),
        (Tip::Beyond, Tip::Beyond) => {
            format!(" No liking for a side up to {FARTHEST_TIP} log-odds would undo it.")
        }
        _ => String::new(),
    }
}

fn undone(side: &str, at: f64) -> String {
    format!(
        " A liking for the {side} side of {} log-odds, which takes {} % of decided answers between equals, would undo it.",
        number(at, 2),
        number(100.0 / (1.0 + (-at).exp()), 0)
    )
}

/// The group in which the two levels of a contrast are items, and their places.
fn of<'e>(
    study: &Study,
    evidence: &'e Evidence<'_>,
    hypothesis: &Hypothesis,
) -> Option<(&'e BallotGroup, [usize; 2])> {
    let Subject::Contrast { levels, over } = hypothesis.subject else { return None };
    let item = |level: Level| match (over, level) {
        (Over::Within(Level::Arrangement(arrangement)), Level::Clustering(clustering)) => {
            Some(Method { arrangement, clustering }.to_string())
        }
        (Over::Within(Level::Clustering(clustering)), Level::Arrangement(arrangement)) => {
            Some(Method { arrangement, clustering }.to_string())
        }
        (Over::All, Level::Method(method)) => Some(method.to_string()),
        (Over::All, level) => Some(level.code()),
        _ => None,
    };
    let names = [item(levels[0])?, item(levels[1])?];
    let pooled = match levels[0].factor() {
        Factor::Clustering => "clustering",
        Factor::Arrangement => "arrangement",
        Factor::Method => "all",
    };
    let wanted = |group: &&BallotGroup| match over {
        Over::All => group.name == pooled,
        _ => study.groups.iter().any(|own| own.id == group.name),
    };
    evidence.groups.iter().filter(wanted).find_map(|group| {
        let place = |name: &String| group.items.iter().position(|item| item == name);
        Some((group, [place(&names[0])?, place(&names[1])?]))
    })
}
