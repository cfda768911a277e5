//! What limits the results: display, instruction, order, sides, objects; said also where the source is silent.

use super::evidence::Evidence;
use super::{asked, sides};
use crate::words::{counted, list};

/// One line each.
pub(super) fn all(evidence: &Evidence<'_>) -> Vec<String> {
    if evidence.shown.is_empty() {
        return Vec::new();
    }
    let instruction = match evidence.study.and_then(asked::instruction) {
        Some(_) => {
            "Instruction: results are about what people were asked, and other words may give other results."
        }
        None => "Instruction: the source files do not say what people were asked.",
    };
    let display = match evidence.screens_recorded {
        true => "Display: the answers record each screen; the table of screens tests whether it matters.",
        false => "Display: the source files do not say on what screens people looked.",
    };
    let order = match (evidence.order_recorded, evidence.study.is_some_and(|s| s.file.forms.is_some())) {
        (true, _) => {
            "Order: the answers record the place of each question; the audit tests what it can tell."
        }
        (false, true) => {
            "Order: the study deals forms of different order, but the answers do not record the place of a question."
        }
        (false, false) => {
            "Order: the source files do not say in which order the questions were asked. If it was fixed, an effect of \
             order cannot be told from a preference."
        }
    };
    let side = match (evidence.sides_recorded, sides_are_confounded(evidence)) {
        (false, _) => "Sides: the source files do not say which item stood on which side.",
        (true, true) if evidence.are_repeats_exchanged() => {
            "Sides: only repeats show pairs in both orders. A liking for a side can be told from them, and each result is about a method \
             together with its side."
        }
        (true, true) => {
            "Sides: no pair was shown in both orders. So each result is about a method together with its side."
        }
        (true, false) if sides::is_probed(evidence) => {
            &format!("Sides: {}, so that a liking for a side can be told.", sides::in_both_orders(evidence))
        }
        (true, false) => &format!(
            "Sides: {}. A model with a side can tell a liking for it; the audit cannot, and says why.",
            sides::in_both_orders(evidence)
        ),
    };
    let mut lines: Vec<String> = [instruction, display, order, side].map(String::from).into();
    if let Some(study) = evidence.study {
        let names: Vec<&str> = study.file.objects.iter().map(|object| object.name.as_str()).collect();
        lines.push(format!(
            "Objects: {} ({}). No interval here covers an object that was not shown.",
            counted(names.len(), "object"),
            list(&names)
        ));
    }
    lines.push(
        "People: the source files do not say who they are, how they were found, or what they know.".into(),
    );
    lines
}

/// What limits the results most, in one line.
pub(super) fn short(evidence: &Evidence<'_>) -> String {
    let mut parts = Vec::new();
    if !evidence.left_out.is_empty() {
        let named = list(&evidence.left_out);
        parts.push(format!("Nothing is said about {named}, which failed."));
    }
    if evidence.shown.is_empty() {
        parts.push("Nothing is said about preference.".to_owned());
    } else if sides_are_confounded(evidence) {
        parts.push(
            match evidence.are_repeats_exchanged() {
                true => {
                    "Only repeats show pairs with their sides exchanged. They tell a liking for a side, not how much of a \
                     preference it makes."
                }
                false => "No pair was shown with its sides exchanged, so a preference may be one for a side.",
            }
            .to_owned(),
        );
    }
    if !evidence.shown.is_empty() && !evidence.screens_recorded {
        parts.push("Screens and lighting are not known.".to_owned());
    }
    if let Some(study) = evidence.study {
        parts.push(match study.file.objects.len() {
            1 => "Nothing here covers another object.".into(),
            n => format!("Nothing here covers other objects than these {n}."),
        });
    }
    if parts.is_empty() {
        parts.push("Nothing here covers other people than such as were asked.".to_owned());
    }
    parts.join(" ")
}

/// Whether no pair was shown in both orders of sides.
pub(super) fn sides_are_confounded(evidence: &Evidence<'_>) -> bool {
    !evidence.shown.is_empty() && !sides::sides_and_methods(evidence).is_empty()
}
