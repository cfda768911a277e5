//! A sentence for what was found of a contrast.

use super::evidence::Evidence;
use super::{names, tipping};
use crate::standing::Standing;
use crate::statement::Finding;
use crate::words::{against, capital, p, percent, percents};
use isostudy_inference::conclusions::{Conclusion, Limit, Verdict, Why};
use isostudy_inference::glance::Row;
use isostudy_inference::hypotheses::{self, Dependence, Hypothesis, Target};

/// What was found of a contrast; things stand as in the table of contrasts, but for a preference that goes against the whole.
pub(super) fn of_contrast(evidence: &Evidence<'_>, row: &Row, found: &Conclusion) -> Finding {
    let hypothesis = &evidence.hypotheses[row.hypothesis];
    let scope = scope(evidence, hypothesis);
    let turned = found.holds() && row.is_against();
    let ([mut first, mut second], mut counts) = (row.things.each_ref(), row.answers.unwrap_or_default());
    if turned {
        std::mem::swap(&mut first, &mut second);
        counts.reverse();
    }
    let counts = against(counts);
    // A name that somebody gave stays as it is, at the head of a sentence too.
    let opening = match hypothesis.target {
        Target::Items { .. } => first.to_owned(),
        _ => capital(first),
    };
    let measured = format!("{counts}; {}, adjusted {}", share(row, turned), p(hypothesis.adjusted));
    let mut text = match &found.verdict {
        Verdict::Holds { .. } => format!("{opening} was preferred to {second}{scope}: {measured}."),
        Verdict::Equal => format!(
            "{opening} and {second}{scope} are liked alike, within the margin of {}: {measured}; {}.",
            hypothesis.rules.margin,
            equivalence(hypothesis)
        ),
        Verdict::NotJudged(Why::NobodyLeans) => format!(
            "{opening} against {second}{scope}: nobody leans either way ({counts}), so no test has anything to work on."
        ),
        Verdict::NotJudged(Why::Side) => format!(
            "{opening} against {second}{scope} is not decided: {measured}. People favour a side, and no pair was shown on both."
        ),
        Verdict::NotJudged(_) => format!(
            "{opening} against {second}{scope} is not decided: {counts}. No outcome of so few people who lean one way or the other \
             is significant (smallest possible {}).",
            p(hypothesis.least_possible())
        ),
        Verdict::Undecided | Verdict::Best { .. } => {
            format!("{opening} and {second}{scope} are not distinguished: {measured}.")
        }
    };
    text.push_str(&limits(evidence, hypothesis, found));
    Finding::new(Standing::of(found), text)
}

/// `86 % (73 to 99 %)`.
fn share(row: &Row, turned: bool) -> String {
    let share = if turned { 1.0 - row.share } else { row.share };
    let within = row.interval.map(|i| match turned {
        true => isostudy_statistics::interval::Interval { low: 1.0 - i.high, high: 1.0 - i.low },
        false => i,
    });
    within.map_or(percent(share), |within| format!("{} ({})", percent(share), percents(within)))
}

/// The answers that it goes over, with a space before it.
pub(super) fn scope(evidence: &Evidence<'_>, hypothesis: &Hypothesis) -> String {
    match (&hypothesis.target, evidence.study) {
        (Target::Contrast { over, .. }, Some(study)) => names::over(study, *over),
        (Target::Items { on, group, .. }, _) => {
            format!("{}{}", names::on_object(on), names::in_group(evidence, group))
        }
        _ => String::new(),
    }
}

fn limits(evidence: &Evidence<'_>, hypothesis: &Hypothesis, found: &Conclusion) -> String {
    let mut text = String::new();
    let averages = match hypothesis.conclusion() {
        hypotheses::Conclusion::AveragesOut => Some("The preference depends on the object"),
        hypotheses::Conclusion::HiddenBySide => Some("People favour a side"),
        _ => None,
    };
    if let Some(why) = averages {
        text.push_str(&format!(
            " The mean lies within the margin of {} of none ({}). {why}, so that does not say that they are liked alike.",
            hypothesis.rules.margin,
            equivalence(hypothesis)
        ));
    } else if found.verdict == Verdict::Undecided && hypothesis.test.sign_flip.p() <= hypothesis.rules.level {
        text.push_str(" As the only test it would have passed; among so many it does not.");
    }
    if found.is_limited(Limit::WithinMargin) {
        text.push_str(&format!(
            " That is little: the mean lies within the margin of {} of none ({}).",
            hypothesis.rules.margin,
            equivalence(hypothesis)
        ));
    }
    text.push_str(&over_all(hypothesis, found));
    if found.holds() {
        text.push_str(&tipping::sentence(evidence, hypothesis));
    }
    if let Some(shown) = dependence(evidence, hypothesis).filter(|_| averages.is_none()) {
        text.push_str(&format!(" It depends on the object ({shown})."));
    }
    text
}

/// What one correction over all tests makes of a result, where that is another.
pub(super) fn over_all(hypothesis: &Hypothesis, found: &Conclusion) -> String {
    match hypothesis.adjusted_over_all.filter(|_| found.is_limited(Limit::NotOverAll)) {
        Some(over_all) => format!(" With one correction over all tests it does not hold ({}).", p(over_all)),
        None => String::new(),
    }
}

/// What shows that a preference depends on the object, in words; `None` if nothing does.
fn dependence(evidence: &Evidence<'_>, hypothesis: &Hypothesis) -> Option<String> {
    let adjusted = match evidence.preferences?.dependence(hypothesis)? {
        Dependence::Omnibus(of) => of.adjusted,
        Dependence::Difference(of) => of.adjusted,
    };
    Some(format!("adjusted {}", p(adjusted)))
}

fn equivalence(hypothesis: &Hypothesis) -> String {
    format!("two one-sided t tests, adjusted {}", p(hypothesis.equivalence.unwrap_or(1.0)))
}
