//! How large a liking for a side would undo a result, where methods and sides go together.

use super::Evidence;
use crate::hypotheses::{Hypothesis, Target};
use crate::words::number;
use design::contrast::Over;
use design::{Level, MethodId, Study};
use statistics::{
    FARTHEST_TIP, Pairs, Participants, ShownBallot, SideDesign, Tip, Tipping, side_design, tipping,
};

/// Beyond so many different patterns of answers it takes minutes.
const MOST_PATTERNS: usize = 5_000;
/// Of so many people nearly all have patterns of their own.
const MOST_PEOPLE: usize = 50_000;

/// Said after a result that holds; empty where sides cannot have made it, and where nothing can be said.
pub(super) fn sentence(evidence: &Evidence<'_>, hypothesis: &Hypothesis) -> String {
    let Target::Contrast { levels, over } = hypothesis.target else { return String::new() };
    let Some(study) = evidence.study.filter(|_| hypothesis.test.participants() <= MOST_PEOPLE) else {
        return String::new();
    };
    let mut items: Vec<Level> = levels.to_vec();
    let ballots = about(study, evidence.shown, over, &mut items);
    if side_design(&Pairs::of(items.len(), &ballots)) == SideDesign::Counterbalanced {
        return String::new();
    }
    let participants = Participants::of(items.len(), &ballots);
    if participants.kinds() > MOST_PATTERNS {
        return String::new();
    }
    let Some(Tipping { left, right }) = tipping(&participants, 0, 1) else {
        return " How large a liking for a side would undo it cannot be said: no answer went the other way."
            .into();
    };
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

/// The answers about levels of the same factor as `items`, which grow by those that others are compared with, everything else
/// equal; as far as a contrast goes.
fn about(study: &Study, shown: &[ShownBallot], over: Over, items: &mut Vec<Level>) -> Vec<ShownBallot> {
    let factor = items[0].factor;
    let methods = study.method_ids();
    let level = |method: MethodId| study.level_of(method, factor);
    let mut place = |level: Level| {
        items.iter().position(|&known| known == level).unwrap_or_else(|| {
            items.push(level);
            items.len() - 1
        })
    };
    let mut own = Vec::new();
    for ballot in shown {
        let [left, right] = [ballot.left(), ballot.right()].map(|item| methods[item]);
        let meant = match over {
            Over::All => true,
            Over::Within(level) => study.level_of(left, level.factor) == Some(level),
            Over::Object(object) => study.comparisons[ballot.question()].object == object,
            Over::Difference(..) | Over::ObjectDifference(..) => false,
        };
        let equal_else = factor == study.method_factor() || study.difference(left, right) == factor;
        if let (true, Some(left), Some(right)) = (meant && equal_else, level(left), level(right)) {
            own.push(ballot.with_items([place(left), place(right)]));
        }
    }
    own
}
