//! Tests of preference, by family.

use isostudy_inference::hypotheses::{Hypothesis, Robustness};
use isostudy_table::{Cell, Table};

/// Every hypothesis, family by family.
pub(crate) fn tests(hypotheses: &[Hypothesis], robustness: &[Robustness]) -> Table {
    let mut table = Table::new(
        "tests",
        "Tests of preference",
        &[
            ("family", "Family"),
            ("contrast", "Contrast"),
            ("scope", "Scope"),
            ("first", "First"),
            ("no_preference", "None"),
            ("second", "Second"),
            ("net", "Net"),
            ("participants", "Participants"),
            ("p_sign_flip", "p"),
            ("p_adjusted", "p adjusted"),
            ("adjustment", "Adjustment"),
            ("p_adjusted_over_all", "p over all"),
            ("mean", "Mean score"),
            ("low", "from"),
            ("high", "to"),
            ("studentised_low", "studentised from"),
            ("studentised_high", "studentised to"),
            ("p_equivalence", "p of equivalence"),
            ("conclusion", "Conclusion"),
            ("p_without_one_low", "p without one: from"),
            ("p_without_one_high", "to"),
            ("p_binomial", "p binomial"),
            ("p_trinomial", "p trinomial"),
        ],
    );
    for (row, robustness) in hypotheses.iter().zip(robustness) {
        table.push(cells(row, robustness));
    }
    let blocks: [(&str, &[&str]); 3] = [
        (
            "Answers, and tests of no preference",
            &[
                "family",
                "contrast",
                "scope",
                "first",
                "no_preference",
                "second",
                "net",
                "participants",
                "p_sign_flip",
                "p_adjusted",
                "adjustment",
                "p_adjusted_over_all",
                "conclusion",
            ],
        ),
        (
            "Mean scores, and tests of equivalence",
            &[
                "family",
                "contrast",
                "scope",
                "mean",
                "low",
                "high",
                "studentised_low",
                "studentised_high",
                "p_equivalence",
            ],
        ),
        (
            "With one participant left out, and as if answers were independent",
            &[
                "family",
                "contrast",
                "scope",
                "p_without_one_low",
                "p_without_one_high",
                "p_binomial",
                "p_trinomial",
            ],
        ),
    ];
    table.print_in_blocks(&blocks);
    table.notes.push(
        "p: exact sign-flip test of participants' scores, two-sided. A score is the mean of a participant's answers, 1 for the \
         first and \u{2212}1 for the second; of differences it is the mean over one part less the mean over the other, \u{2212}2 to 2, \
         of those who answered something of both. Net: answers for the first minus answers for the second. Adjusted within the \
         family: Holm, for single questions Benjamini and Hochberg; over all: Holm over every test but those of single \
         questions. From and to: t interval at 95 % over participants, or, where all have one score, the means that make this \
         at least 2.5 % probable; studentised: 2000 resamples of participants; all are cut at what scores can be. Equivalence: \
         two one-sided t tests of a mean score within the margin of zero (0.2 if nothing else is declared: 60 answers to 40), \
         adjusted in the same way. Conclusion: at the study's level of both adjusted p; a large p alone is open, not equal. p \
         without one: range when each participant in turn is left out. Binomial and trinomial treat all answers as independent \
         and are there for comparison; they hold for single questions only."
            .into(),
    );
    table
}

fn cells(row: &Hypothesis, robustness: &Robustness) -> Vec<Cell> {
    let test = &row.test;
    let interval = test.interval.map(|i| i.cut(-test.reach, test.reach));
    let Robustness { studentised, without_one, binomial, trinomial } = robustness;
    let count = |o: usize| test.counts.map_or(Cell::Missing, |counts| Cell::count(counts[o]));
    vec![
        Cell::text(&row.family),
        Cell::text(&row.contrast),
        Cell::text(&row.scope),
        count(0),
        count(1),
        count(2),
        test.counts.map_or(Cell::Missing, |[first, _, second]| Cell::Count(first as i64 - second as i64)),
        Cell::count(test.participants() as u64),
        Cell::P(test.sign_flip.p(), 5),
        Cell::P(row.adjusted, 4),
        Cell::text(row.adjustment.label()),
        Cell::p(row.adjusted_over_all, 4),
        Cell::of_sum(Some(test.mean), 3),
        Cell::of_sum(interval.map(|i| i.low), 3),
        Cell::of_sum(interval.map(|i| i.high), 3),
        Cell::of_sum(studentised.map(|i| i.low), 3),
        Cell::of_sum(studentised.map(|i| i.high), 3),
        Cell::p(row.equivalence, 4),
        Cell::text(row.conclusion().label()),
        Cell::p(without_one.map(|[least, _]| least), 4),
        Cell::p(without_one.map(|[_, most]| most), 4),
        Cell::p(*binomial, 4),
        Cell::p(*trinomial, 4),
    ]
}

#[cfg(test)]
mod tests;
