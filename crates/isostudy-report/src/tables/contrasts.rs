//! Tests of preference, by family.

use isostudy_inference::hypotheses::{Hypothesis, Robustness};
use isostudy_statistics::interval::Interval;
use isostudy_table::{Cell, Columns, Table};

/// A test, and what else is known of it.
type Row<'a> = (&'a Hypothesis, &'a Robustness);

fn answers((row, _): &Row<'_>, outcome: usize) -> Cell {
    row.test.counts.map_or(Cell::Missing, |counts| Cell::count(counts[outcome]))
}

fn interval((row, _): &Row<'_>) -> Option<Interval> {
    row.test.interval.map(|i| i.cut(-row.test.reach, row.test.reach))
}

/// Every hypothesis, family by family.
pub(crate) fn tests(hypotheses: &[Hypothesis], robustness: &[Robustness]) -> Table {
    let table = Columns::over(hypotheses.iter().zip(robustness))
        .column_in(&[0, 1, 2], "family", "Family", |row| Cell::text(&row.0.family))
        .column_in(&[0, 1, 2], "contrast", "Contrast", |row| Cell::text(&row.0.contrast))
        .column_in(&[0, 1, 2], "scope", "Scope", |row| Cell::text(&row.0.scope))
        .column_in(&[0], "first", "First", |row| answers(row, 0))
        .column_in(&[0], "no_preference", "None", |row| answers(row, 1))
        .column_in(&[0], "second", "Second", |row| answers(row, 2))
        .column_in(&[0], "net", "Net", |row| {
            let net = row.0.test.counts.map(|[first, _, second]| first as i64 - second as i64);
            net.map_or(Cell::Missing, Cell::Count)
        })
        .column_in(&[0], "participants", "Participants", |row| Cell::count(row.0.test.participants() as u64))
        .column_in(&[0], "p_sign_flip", "p", |row| Cell::P(row.0.test.sign_flip.p(), 5))
        .column_in(&[0], "p_adjusted", "p adjusted", |row| Cell::P(row.0.adjusted, 4))
        .column_in(&[0], "adjustment", "Adjustment", |row| Cell::text(row.0.adjustment.label()))
        .column_in(&[0], "p_adjusted_over_all", "p over all", |row| Cell::p(row.0.adjusted_over_all, 4))
        .column_in(&[1], "mean", "Mean score", |row| Cell::of_sum(Some(row.0.test.mean), 3))
        .column_in(&[1], "low", "from", |row| Cell::of_sum(interval(row).map(|i| i.low), 3))
        .column_in(&[1], "high", "to", |row| Cell::of_sum(interval(row).map(|i| i.high), 3))
        .column_in(&[1], "studentised_low", "studentised from", |row| {
            Cell::of_sum(row.1.studentised.map(|i| i.low), 3)
        })
        .column_in(&[1], "studentised_high", "studentised to", |row| {
            Cell::of_sum(row.1.studentised.map(|i| i.high), 3)
        })
        .column_in(&[1], "p_equivalence", "p of equivalence", |row| Cell::p(row.0.equivalence, 4))
        .column_in(&[0], "conclusion", "Conclusion", |row| Cell::text(row.0.conclusion().label()))
        .column_in(&[2], "p_without_one_low", "p without one: from", |row| {
            Cell::p(row.1.without_one.map(|[least, _]| least), 4)
        })
        .column_in(&[2], "p_without_one_high", "to", |row| {
            Cell::p(row.1.without_one.map(|[_, most]| most), 4)
        })
        .column_in(&[2], "p_binomial", "p binomial", |row| Cell::p(row.1.binomial, 4))
        .column_in(&[2], "p_trinomial", "p trinomial", |row| Cell::p(row.1.trinomial, 4))
        .into_blocks(
            "tests",
            "Tests of preference",
            &[
                "Answers, and tests of no preference",
                "Mean scores, and tests of equivalence",
                "With one participant left out, and as if answers were independent",
            ],
        );
    table.with_note(
        "p: exact sign-flip test of participants' scores, two-sided. A score is the mean of a participant's answers, 1 for the \
         first and \u{2212}1 for the second; of differences it is the mean over one part less the mean over the other, \u{2212}2 to 2, \
         of those who answered something of both. Net: answers for the first minus answers for the second. Adjusted within the \
         family: Holm, for single questions Benjamini and Hochberg; over all: Holm over every test but those of single \
         questions. From and to: t interval at 95 % over participants, or, where all have one score, the means that make this \
         at least 2.5 % probable; studentised: 2000 resamples of participants; all are cut at what scores can be. Equivalence: \
         two one-sided t tests of a mean score within the margin of zero (0.2 if nothing else is declared: 60 answers to 40), \
         adjusted in the same way. Conclusion: at the study's level of both adjusted p; a large p alone is open, not equal. p \
         without one: range when each participant in turn is left out. Binomial and trinomial treat all answers as independent \
         and are there for comparison; they hold for single questions only.",
    )
}

#[cfg(test)]
mod tests;
