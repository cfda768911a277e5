//! On what screens people answered, and whether it matters.

use isostudy_inference::screens::Compared;
use isostudy_table::{Cell, Table, field};

/// Every test that the recorded screens allow; no rows where none was recorded.
pub(crate) fn screens(compared: &[Compared]) -> Table {
    let fields = [
        field("condition", "Condition", |of: &&Compared| Cell::text(of.condition.name)),
        field("first", "One part", |of| Cell::text(of.condition.parts[0])),
        field("second", "The other", |of| Cell::text(of.condition.parts[1])),
        field("measure", "Measure", |of| Cell::text(of.measure.name())),
        field("people_first", "People, one", |of| Cell::count(of.people[0] as u64)),
        field("people_second", "the other", |of| Cell::count(of.people[1] as u64)),
        field("answers_first", "Answers, one", |of| Cell::count(of.answers[0] as u64)),
        field("answers_second", "the other", |of| Cell::count(of.answers[1] as u64)),
        field("share_first", "Share, one", |of| Cell::number(of.shares[0], 3)),
        field("share_second", "the other", |of| Cell::number(of.shares[1], 3)),
        field("p", "p", |of| Cell::p(of.p, 5)),
        field("p_adjusted", "p adjusted", |of| Cell::p(of.adjusted, 4)),
    ];
    let caption = "Answers by the screen that they were given on";
    let mut table = Table::of("screens", caption, &fields, compared);
    table.notes.push(
        "Answers to comparisons, everybody's. Widths are in CSS pixels; a surface's is the largest that it had. p: exact, \
         two-sided, the person as the unit. Devices: people above the median of all people's shares less people below it, \
         among all divisions of the people into two parts of these sizes; who changed devices is of the one with most \
         answers. Dropped frames and time out of sight: all draws of as many of each person's own answers. p adjusted: Holm, \
         over the tests of this table. As most others: the answer is the one that others gave more often to the question."
            .into(),
    );
    table
}
