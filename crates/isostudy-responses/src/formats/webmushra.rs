//! webMUSHRA's paired comparisons: one row an answer, which names the reference and the other stimulus.
//!
//! Which of them was A, the left one, is drawn anew for every page and not written to the file: sides are not recorded. The answer is
//! `correct` for the reference, `incorrect` for the other, `undecided`, or `unknown` if there was none.

use crate::decode::source::Source;
use crate::error::{Fault, shorten};
use crate::format::Format;
use crate::formats::layout::{Head, Header};
use crate::formats::long::{self, Columns};
use crate::mapping::Mapping;
use crate::plan::Plan;
use crate::report::Report;
use crate::value::Responses;

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
    let header = Header::of(Format::WebMushra, head);
    let question = header.needed(&["trial_id"])?;
    let participant = match mapping.participant(header.cells.len())? {
        Some(column) => column,
        None if question > 1 => 1,
        None => return Err(header.missing("no column says who answered; declare `participant_column`")),
    };
    report.column_rule =
        format!("participants by column {} (\"{}\")", participant + 1, shorten(&header.cells[participant]));
    let columns = Columns {
        sides: Some((header.needed(&["choice_reference"])?, header.needed(&["choice_non_reference"])?)),
        rt_ms: header.find(&["choice_time"]),
        participant: Some(participant),
        question: Some(question),
        choice: header.needed(&["choice_answer"])?,
        ..Columns::default()
    };
    let mut own = mapping.clone();
    let list = |word: &str| vec![word.to_owned()];
    let words = [&list("correct"), &list("undecided"), &list("incorrect")];
    own.words.declare(words.map(Vec::as_slice)).expect("three words");
    own.words.declare_blank("unknown");
    let rows = long::Rule { sides_recorded: false, escaped: false, ordered: false, ..long::Rule::LONG };
    long::read_columns(source, &header, columns, rows, plan, &own, report)
}
