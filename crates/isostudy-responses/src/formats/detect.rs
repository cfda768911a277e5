//! Which format a table of cells is in.

use crate::error::{Fault, shorten};
use crate::format::Format;
use crate::formats::layout::{Detected, Head, is_form, is_participant};
use crate::formats::long;
use crate::formats::surveys;
use crate::plan::{Plan, is_training};

/// The format with whose marks the rows begin.
///
/// # Errors
/// No format's marks, or those of several.
pub(crate) fn detect(head: &Head, plan: Option<&Plan>) -> Result<Detected, Fault> {
    let mut found: Vec<Detected> =
        Format::ALL.into_iter().filter_map(|format| mark(format, head, plan)).collect();
    match found.len() {
        1 => Ok(found.remove(0)),
        0 => fallback(head, plan),
        _ => Err(Fault::Formats { readings: found.into_iter().map(|d| (d.format, d.rule)).collect() }),
    }
}

/// What in the first rows speaks for a format.
fn mark(format: Format, head: &Head, plan: Option<&Plan>) -> Option<Detected> {
    let header = &head[0].1;
    let rule: Option<String> = match format {
        Format::Table => {
            let plan = plan?;
            let beside = |title: &String| plan.beside(title).is_some() || is_training(title);
            let own = |title: &String| {
                is_participant(title) || is_form(title) || plan.question(title).is_some() || beside(title)
            };
            let all = header.iter().all(own) && header.iter().any(|title| plan.question(title).is_some());
            all.then(|| "every header is a question's id".into())
        }
        Format::Long => long::rule(header),
        _ => return surveys::mark(format, head).map(|rule| Detected { format, rule }),
    };
    rule.map(|rule| Detected { format, rule })
}

/// A table with some of the study's questions is taken for its own, so that what is wrong with it is said.
fn fallback(head: &Head, plan: Option<&Plan>) -> Result<Detected, Fault> {
    let header = &head[0].1;
    if plan.is_some_and(|plan| header.iter().any(|title| plan.question(title).is_some())) {
        return Ok(Detected { format: Format::Table, rule: "some headers are questions' ids".into() });
    }
    let first: Vec<String> = header.iter().take(4).map(|title| format!("\"{}\"", shorten(title))).collect();
    let header = match long::nearly(header) {
        Some(missing) => format!("{}. The long format is near, but there is {missing}", first.join(", ")),
        None => first.join(", "),
    };
    Err(Fault::UnknownFormat { header, formats: Format::names() })
}
