//! Truths planted in people, who are dealt forms and answer them; the answers written as files, read, analysed, and every
//! number held against an independent computation.
//!
//! What starts from ballots does not see how a ballot came about. So this starts where people do: with the form that each of
//! them is dealt, with what stood on which side, and with a file.

mod compare;
mod designs;
mod exact;
mod expected;
mod matrix;
mod oracle;
mod people;
mod routes;
mod sentences;

use isostudy_inference::Results;
use isostudy_paper::Paper;
use isostudy_table::{Cell, Columns, Table};
use matrix::Outcome;

/// How many people a study has, unless a truth is about their number.
const PEOPLE: usize = 36;

/// Every table of a study, with those of the paper.
fn tables(results: &Results<'_>) -> Vec<Table> {
    let mut tables = isostudy_report::tables(results);
    Paper::of(results).add_tables(&mut tables);
    tables
}

/// Plants every truth in every design: `self_test_truths`, and whether every cell is right.
pub fn truths() -> (Table, bool) {
    let all = matrix::run(PEOPLE);
    (table(&all), all.iter().all(|of| of.wrong.is_empty()))
}

/// Every cell that is wrong, one line each.
pub fn wrong_cells() -> Vec<String> {
    let line = |of: &Outcome| -> Vec<String> {
        of.wrong.iter().map(|wrong| format!("{} | {} | {wrong}", of.design, of.truth)).collect()
    };
    matrix::run(PEOPLE).iter().flat_map(line).collect()
}

fn table(all: &[Outcome]) -> Table {
    let table = Columns::over(all)
        .column("design", "Design", |of| Cell::text(of.design))
        .column("truth", "Truth", |of| Cell::text(of.truth))
        .column("routes", "Ways in", |of| Cell::count(of.routes as u64))
        .column("cells", "Compared", |of| Cell::count(of.cells))
        .column("wrong", "Wrong", |of| Cell::count(of.wrong.len() as u64))
        .column("passed", "Passed", |of| Cell::text(if of.wrong.is_empty() { "yes" } else { "NO" }))
        .into_table(
            "self_test_truths",
            "Planted truths: cells of tables and numbers in sentences that are right",
        );
    table.with_note(format!(
        "{PEOPLE} people, but for one and 2000. Forms are dealt, answered by somebody of whom it is known what they prefer, written \
         as each kind of file, read and analysed. Compared with a second computation from what stood on the sides and what was \
         pressed: counts, factors, tests, worths, scales, agreement, screening, and numbers in sentences."
    ))
}

#[cfg(test)]
#[path = "../../isostudy-inference/src/fixture.rs"]
pub mod fixture;

// The fixture makes these.
#[cfg(test)]
use isostudy_inference::{Answered, Inputs};
#[cfg(test)]
mod conclusions;
#[cfg(test)]
mod coverage;
#[cfg(test)]
mod levels;
#[cfg(test)]
mod tests;
