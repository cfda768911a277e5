//! webMUSHRA's paired comparisons: one row an answer, which names the reference and the other stimulus.
//!
//! Which of them was A, the left one, is drawn anew for every page and not written to the file: sides are not recorded. The answer is
//! `correct` for the reference, `incorrect` for the other, `undecided`, or `unknown` if there was none.

use crate::decode::source::Source;
use crate::error::{Fault, shorten};
use crate::format::Format;
use crate::formats::layout::Head;
use crate::formats::long::{self, Columns};
use crate::mapping::Mapping;
use crate::plan::Plan;
use crate::report::Report;
use crate::value::Responses;
use crate::words::normalise;

/// Reads every row under the header. The participant is the declared column, or the first field that the test asks for.
///
/// # Errors
/// See [`Fault`]; also if no column says who answered.
pub(crate) fn read(
    source: &Source<'_>,
    head: &Head,
    plan: Option<&Plan>,
    mapping: &Mapping,
    report: &mut Report,
) -> Result<Responses, Fault> {
    let (row, header) = &head[0];
    let find = |name: &str| {
        let missing = || Fault::NotThatFormat {
            format: Format::WebMushra,
            row: *row,
            missing: format!("the header has no {name}"),
        };
        header.iter().position(|title| normalise(title) == name).ok_or_else(missing)
    };
    let question = find("trial_id")?;
    let participant = match mapping.participant(header.len())? {
        Some(column) => column,
        None if question > 1 => 1,
        None => {
            let missing = "no column says who answered; declare `participant_column`".into();
            return Err(Fault::NotThatFormat { format: Format::WebMushra, row: *row, missing });
        }
    };
    report.column_rule =
        format!("participants by column {} (\"{}\")", participant + 1, shorten(&header[participant]));
    let columns = Columns {
        sides: Some((find("choice_reference")?, find("choice_non_reference")?)),
        rt_ms: find("choice_time").ok(),
        participant: Some(participant),
        question: Some(question),
        choice: find("choice_answer")?,
        ..Columns::default()
    };
    let mut own = mapping.clone();
    let list = |word: &str| vec![word.to_owned()];
    let words = [&list("correct"), &list("undecided"), &list("incorrect")];
    own.words.declare(words.map(Vec::as_slice)).expect("three words");
    own.words.declare_blank("unknown");
    let rows = long::Rule { sides_recorded: false, escaped: false, ordered: false, ..long::Rule::LONG };
    long::read_columns(source, (*row, header), columns, rows, plan, &own, report)
}
