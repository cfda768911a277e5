//! What things are called in a sentence.

use super::evidence::Evidence;
use isostudy_design::contrast::Over;
use isostudy_design::{Level, Study};
use isostudy_inference::hypotheses::{Hypothesis, On, Target};
use isostudy_statistics::Side;

/// A level as a noun: `edge collapse`, `the body-centred lattice`.
pub(super) fn level(study: &Study, level: Level) -> String {
    study.level(level).phrase.clone()
}

/// A side.
pub(super) fn side(side: Side) -> &'static str {
    match side {
        Side::Left => "left",
        Side::Right => "right",
    }
}

/// Where, with a space before it: ` on the body-centred lattice`, ` without clustering`.
pub(super) fn within(study: &Study, level: Level) -> String {
    format!(" {}", study.level(level).within)
}

/// The answers that a contrast goes over, with a space before it; nothing for all of them.
pub(super) fn over(study: &Study, over: Over) -> String {
    match over {
        Over::All => String::new(),
        Over::Within(level) => within(study, level),
        Over::Object(object) => format!(" on the {}", study.file.objects[object].name),
        Over::Difference(a, b) => format!("{} rather than{}", within(study, a), within(study, b)),
        Over::ObjectDifference(a, b) => {
            let [a, b] = [a, b].map(|object| study.file.objects[object].name.as_str());
            format!(" on the {a} rather than on the {b}")
        }
    }
}

/// The group, with a space before it; nothing if there is but one.
pub(super) fn in_group(evidence: &Evidence<'_>, group: &str) -> String {
    if evidence.groups.len() > 1 { format!(" in group {group}") } else { String::new() }
}

/// An item of a scale: of one over a factor's levels the level in words, whose code reads as another word; else its own name.
pub(super) fn item(study: Option<&Study>, group: &str, item: &str) -> String {
    let level = study.and_then(|study| study.level_named(group, item));
    level.map_or_else(|| item.to_owned(), |level| level.phrase.clone())
}

/// The objects on which two items are compared, with a space before it; nothing for all of them.
pub(super) fn on_object(on: &On) -> String {
    match on {
        On::All => String::new(),
        On::Object(object) => format!(" on {object}"),
        On::Difference([one, other]) => format!(" on {one} rather than on {other}"),
    }
}

/// What is compared with what, and where: `edge collapse against no clustering on the simple cubic lattice`.
pub(super) fn hypothesis(evidence: &Evidence<'_>, hypothesis: &Hypothesis) -> String {
    match (&hypothesis.target, evidence.study) {
        (Target::Contrast { levels, over }, Some(study)) => {
            let [first, second] = levels.map(|level| self::level(study, level));
            format!("{first} against {second}{}", self::over(study, *over))
        }
        (Target::Items { first, second, group, on }, _) => {
            format!("{first} against {second}{}{}", on_object(on), in_group(evidence, group))
        }
        _ => format!("question {}", hypothesis.scope),
    }
}
