//! jsPsych's data, one row or JSON object a trial, and JATOS result text, which is one such array a participant.

use crate::decode::source::Source;
use crate::error::{Fault, shorten};
use crate::format::Format;
use crate::formats::layout::{Head, Header};
use crate::formats::long::{self, Columns};
use crate::mapping::Mapping;
use crate::plan::Plan;
use crate::report::{Kind, Report};
use crate::value::Responses;
use serde_json::Value;
use std::collections::HashMap;

/// Fields that say who answered, the first that is there.
const PARTICIPANT: [&str; 8] = [
    "participant",
    "participant_id",
    "subject",
    "subject_id",
    "prolific_pid",
    "worker_id",
    "workerid",
    "run_id",
];
/// Name of the field that counts runs in JSON.
const RUN: &str = "(run)";

/// The format of text that begins as JSON does; `None` for anything else. Several values are several runs: JATOS.
pub(crate) fn json_format(text: &str, declared: Option<Format>) -> Option<Format> {
    let json = text.trim_start().starts_with(['[', '{']);
    match declared {
        Some(Format::JsPsych | Format::Jatos) if json => declared,
        None if json => {
            let mut values = serde_json::Deserializer::from_str(text).into_iter::<serde::de::IgnoredAny>();
            let several = values.next().is_some_and(|value| value.is_ok()) && values.next().is_some();
            Some(if several { Format::Jatos } else { Format::JsPsych })
        }
        _ => None,
    }
}

/// Reads JSON as the table that jsPsych would make of it: one row a trial, from row 2 on, one column a field as they come.
///
/// # Errors
/// JSON that does not parse or is not made of trials, and whatever is wrong with the trials.
pub(crate) fn read_json(
    text: &str,
    plan: Option<&Plan>,
    mapping: &Mapping,
    report: &mut Report,
) -> Result<Responses, Fault> {
    let mut header = vec![RUN.to_owned()];
    let mut number: HashMap<String, usize> = HashMap::new();
    let mut rows = vec![Vec::new()];
    let mut runs = serde_json::Deserializer::from_str(text).into_iter::<Value>();
    let mut run = 0;
    while let Some(value) = runs.next() {
        let row = 1 + text.as_bytes()[..runs.byte_offset()].iter().filter(|&&b| b == b'\n').count() as u64;
        let value = value.map_err(|error| Fault::Json {
            row: error.line() as u64,
            message: format!("not JSON: {error}"),
        })?;
        let not_trials = || Fault::Json { row, message: "expected an array of trials".into() };
        // One array of arrays is several runs as well.
        let several = |values: &Vec<Value>| !values.is_empty() && values.iter().all(Value::is_array);
        let values = match value {
            Value::Array(values) if several(&values) => values,
            value => vec![value],
        };
        for trials in values {
            run += 1;
            let trials = match trials {
                Value::Array(trials) => trials,
                object @ Value::Object(_) => vec![object],
                _ => return Err(not_trials()),
            };
            for trial in trials {
                let Value::Object(fields) = trial else { return Err(not_trials()) };
                let mut cells = vec![run.to_string()];
                for (field, value) in fields {
                    let column = *number.entry(field).or_insert_with_key(|field| {
                        header.push(field.clone());
                        header.len() - 1
                    });
                    if cells.len() <= column {
                        cells.resize(column + 1, String::new());
                    }
                    cells[column] = match value {
                        Value::Null => String::new(),
                        Value::String(text) => text,
                        other => other.to_string(),
                    };
                }
                rows.push(cells);
            }
        }
    }
    rows[0].clone_from(&header);
    read_table(&Source::Sheet(rows), &[(1, header)], plan, mapping, report)
}

/// Reads trials that have a `question`; other trials answer nothing.
///
/// # Errors
/// See [`Fault`]; also if no trial says which question it is.
pub(crate) fn read_table(
    source: &Source<'_>,
    head: &Head,
    plan: Option<&Plan>,
    mapping: &Mapping,
    report: &mut Report,
) -> Result<Responses, Fault> {
    let header = Header::of(Format::JsPsych, head);
    let find = |names: &[&str]| header.find(names);
    let question = find(&["question", "question_id"]).ok_or_else(|| {
        header
            .missing("no trial has a `question`: add it, with `left` and `right`, to the data of each trial")
    })?;
    let choice = find(&["choice", "response"])
        .ok_or_else(|| header.missing("no trial has a `choice` or `response`"))?;
    let sides = find(&["left"]).zip(find(&["right"]));
    if sides.is_none() && plan.is_none() {
        return Err(
            header.missing("trials do not say what was `left` and `right`, and there is no study that does")
        );
    }
    let declared =
        mapping.participant_column.filter(|column| (1..=header.cells.len()).contains(column)).map(|c| c - 1);
    let named = declared.or_else(|| find(&PARTICIPANT)).or_else(|| find(&[RUN]));
    let index = find(&["trial_index"]);
    let (participant, restarts) = match (named, index) {
        (Some(column), _) => (column, false),
        (None, Some(index)) => (index, true),
        (None, None) => {
            return Err(header.missing("no field says who answered; declare `participant_column`"));
        }
    };
    report.column_rule = match restarts {
        false => format!("participants by \"{}\"", shorten(&header.cells[participant])),
        true => "participants by trial_index, which starts again with each".into(),
    };
    let columns = Columns {
        sides,
        object: find(&["object"]),
        group: find(&["group"]),
        form: find(&["form"]),
        order: find(&["order", "trial_index"]),
        rt_ms: find(&["rt_ms", "rt"]),
        restarts,
        participant: Some(participant),
        question: Some(question),
        choice,
        ..Columns::default()
    };
    if sides.is_none() {
        report.row(
            Kind::Noted,
            header.row,
            "trials do not say what was left and right: taken from the study",
        );
    }
    let rows = long::Rule { escaped: false, every_row: false, ..long::Rule::LONG };
    long::read_columns(source, &header, columns, rows, plan, mapping, report)
}
