//! How large a liking for a side would undo a result.

use super::evidence::Evidence;
use super::names;
use crate::words::number;
use isostudy_inference::hypotheses::Hypothesis;
use isostudy_inference::tipping::Undone;
use isostudy_statistics::FARTHEST_TIP;

/// Said after a result that holds; empty where sides cannot have made it, and where nothing can be said.
pub(super) fn sentence(evidence: &Evidence<'_>, hypothesis: &Hypothesis) -> String {
    match evidence.preferences.and_then(|of| of.undone(hypothesis)) {
        None => String::new(),
        Some(Undone::CannotBeSaid) => {
            let alone = hypothesis.test.counts.is_some_and(|[first, _, second]| first == 0 || second == 0);
            let why = match alone {
                _ if hypothesis.is_difference() => {
                    "in one of the two no answer went the other way, or everybody answered alike"
                }
                true => "no answer went the other way",
                false => "everybody answered alike",
            };
            format!(" How large a liking for a side would undo it cannot be said: {why}.")
        }
        Some(Undone::By(side, at)) => format!(
            " A liking for the {} side of {} log-odds ({} % between equals) would undo it.",
            names::side(side),
            number(at, 2),
            number(100.0 / (1.0 + (-at).exp()), 0)
        ),
        Some(Undone::ByNothing) => {
            format!(" No liking for a side up to {FARTHEST_TIP} log-odds would undo it.")
        }
    }
}
