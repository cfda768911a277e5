//! arenakit's battles: one row an answer, `model_a, model_b, winner`, and where it is known `item_id` and `voter_id`.
//!
//! arenakit's `model_a` is the model that was shown first, which here is the left side. Its `item_id` is what two models were
//! compared on: where several pairs share one it is their object, otherwise it is the question. Rows without a voter are of
//! different people. Source: arenakit 0.1.1, `schema.py`.

use crate::collect::Ids;
use crate::decode::source::Source;
use crate::error::{Fault, shorten};
use crate::format::Format;
use crate::formats::layout::{Head, Header};
use crate::formats::long::{self, Columns};
use crate::mapping::Mapping;
use crate::plan::Plan;
use crate::report::Report;
use crate::value::Responses;

const COLUMNS: [&str; 5] = ["model_a", "model_b", "winner", "item_id", "voter_id"];

/// Reads every row under the header.
///
/// # Errors
/// See [`Fault`].
pub(crate) fn read(
    source: &Source<'_>,
    head: &Head,
    plan: Option<&Plan>,
    mapping: &Mapping,
    report: &mut Report,
) -> Result<Responses, Fault> {
    let header = Header::of(Format::Arenakit, head);
    let participant = mapping.participant(header.cells.len())?.or_else(|| header.find(&["voter_id"]));
    header.note_others(participant, &COLUMNS, report);
    report.column_rule = match participant {
        Some(column) => format!("participants by \"{}\"", shorten(&header.cells[column])),
        None => "no voters: every answer is another person's".into(),
    };
    let question = header.find(&["item_id"]);
    let columns = Columns {
        participant,
        question,
        sides: Some((header.needed(&["model_a"])?, header.needed(&["model_b"])?)),
        choice: header.needed(&["winner"])?,
        ..Columns::default()
    };
    let mut own = mapping.clone();
    let list = |words: [&str; 3]| words.map(str::to_owned);
    let words =
        [list(["a", "model_a", "left"]), list(["tie", "draw", "tie"]), list(["b", "model_b", "right"])];
    own.words.declare(words.each_ref().map(|words| &words[..])).expect("no word twice");
    let ids = if question.is_some() { Ids::Scene } else { Ids::MadeUp };
    let rule = long::Rule { ordered: false, ids, ..long::Rule::LONG };
    long::read_columns(source, &header, columns, rule, plan, &own, report)
}
