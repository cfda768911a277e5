//! On what screens people answered, and whether it matters.

use isostudy_inference::screens::Compared;
use isostudy_table::{Cell, Columns, Table};

/// Every test that the recorded screens allow; no rows where none was recorded.
pub(crate) fn screens(compared: &[Compared]) -> Table {
    let caption = "Answers by the screen that they were given on";
    let table = Columns::over(compared)
        .column("condition", "Condition", |of| Cell::text(of.condition.name))
        .column("first", "One part", |of| Cell::text(of.condition.parts[0]))
        .column("second", "The other", |of| Cell::text(of.condition.parts[1]))
        .column("measure", "Measure", |of| Cell::text(of.measure.name()))
        .column("people_first", "People, one", |of| Cell::count(of.people[0] as u64))
        .column("people_second", "the other", |of| Cell::count(of.people[1] as u64))
        .column("answers_first", "Answers, one", |of| Cell::count(of.answers[0] as u64))
        .column("answers_second", "the other", |of| Cell::count(of.answers[1] as u64))
        .column("share_first", "Share, one", |of| Cell::number(of.shares[0], 3))
        .column("share_second", "the other", |of| Cell::number(of.shares[1], 3))
        .column("p", "p", |of| Cell::p(of.p, 5))
        .column("p_adjusted", "p adjusted", |of| Cell::p(of.adjusted, 4))
        .into_table("screens", caption);
    table.with_note(
        "Answers to comparisons, everybody's. Widths are in CSS pixels; a surface's is the largest that it had. p: exact, \
         two-sided, the person as the unit. Devices: people above the median of all people's shares less people below it, \
         among all divisions of the people into two parts of these sizes; who changed devices is of the one with most \
         answers. Dropped frames, time out of sight and turning: all draws of as many of each person's own answers. Turning: \
         whether models were turned before the answer, which people chose to do. p adjusted: Holm, over the tests of this \
         table. As most others: the answer is the one that others gave more often to the question.",
    )
}
