//! On what screens people answered, and whether it matters.

use isostudy_inference::screens::Compared;
use isostudy_table::{Cell, Table};

/// Every test that the recorded screens allow; no rows where none was recorded.
pub(crate) fn screens(compared: &[Compared]) -> Table {
    let mut table = Table::new(
        "screens",
        "Answers by the screen that they were given on",
        &[
            ("condition", "Condition"),
            ("first", "One part"),
            ("second", "The other"),
            ("measure", "Measure"),
            ("people_first", "People, one"),
            ("people_second", "the other"),
            ("answers_first", "Answers, one"),
            ("answers_second", "the other"),
            ("share_first", "Share, one"),
            ("share_second", "the other"),
            ("p", "p"),
            ("p_adjusted", "p adjusted"),
        ],
    );
    for of in compared {
        let [first, second] = of.condition.parts;
        let count = |count: usize| Cell::count(count as u64);
        table.push(vec![
            Cell::text(of.condition.name),
            Cell::text(first),
            Cell::text(second),
            Cell::text(of.measure.name()),
            count(of.people[0]),
            count(of.people[1]),
            count(of.answers[0]),
            count(of.answers[1]),
            Cell::number(of.shares[0], 3),
            Cell::number(of.shares[1], 3),
            Cell::p(of.p, 5),
            Cell::p(of.adjusted, 4),
        ]);
    }
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
