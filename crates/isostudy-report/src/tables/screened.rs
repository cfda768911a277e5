//! The tests with everybody, and without those who broke a rule: nobody is left out silently.

use crate::words::numbers;
use isostudy_inference::screened::WithoutBreakers;
use isostudy_statistics::Flag;
use isostudy_table::{Cell, Columns, Table};

/// Each rule that somebody broke, with every test.
pub(super) fn screened(screened: &[WithoutBreakers]) -> Table {
    let caption = "Tests with everybody, and without those who broke a rule";
    let rows = screened
        .iter()
        .flat_map(|of| of.tests.iter().map(move |(with, without)| (of, with, without.as_ref())));
    let table = Columns::over(rows)
        .column_in(&[0, 1], "rule", "Rule", |row| Cell::text(row.0.rule.map_or("any", Flag::code)))
        .column_in(&[0], "left_out", "Left out", |row| Cell::count(row.0.people.len() as u64))
        .column_in(&[0], "respondents", "Respondents", |row| Cell::text(numbers(&row.0.people, " ")))
        .column_in(&[0, 1], "family", "Family", |row| Cell::text(&row.1.family))
        .column_in(&[0, 1], "contrast", "Contrast", |row| Cell::text(&row.1.contrast))
        .column_in(&[0, 1], "scope", "Scope", |row| Cell::text(&row.1.scope))
        .column_in(&[0], "mean", "Mean score", |row| Cell::of_sum(Some(row.1.test.mean), 3))
        .column_in(&[0], "p_adjusted", "p adjusted", |row| Cell::P(row.1.adjusted, 4))
        .column_in(&[0], "conclusion", "Conclusion", |row| Cell::text(row.1.conclusion().label()))
        .column_in(&[1], "mean_without", "Mean score", |row| Cell::of_sum(row.2.map(|of| of.test.mean), 3))
        .column_in(&[1], "p_without", "p", |row| Cell::p(row.2.map(|of| of.test.sign_flip.p()), 5))
        .column_in(&[1], "p_adjusted_without", "p adjusted", |row| Cell::p(row.2.map(|of| of.adjusted), 4))
        .column_in(&[1], "conclusion_without", "Conclusion", |row| {
            Cell::text(row.2.map_or("nobody left", |of| of.conclusion().label()))
        })
        .into_blocks("screened", caption, &["With everybody", "Without them"]);
    table.with_note(
        "For each rule that somebody broke, the same tests without them; the rules are under the table of respondents. Both \
         halves are about all participants, also where other tables leave some out.",
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture;
    use isostudy_inference::ballots::ballot_groups;
    use isostudy_inference::screened::{Respondent, of_groups};
    use isostudy_inference::{Answered, Preferences, Recorded, hypotheses};
    use isostudy_statistics::{DeclaredBallot, screening_with};

    fn cell(table: &Table, keys: &[&str], column: &str) -> Cell {
        let place = |name: &str| table.columns.iter().position(|c| c.name == name).unwrap();
        let holds = |row: &&Vec<Cell>| {
            ["rule", "contrast", "scope"]
                .iter()
                .zip(keys)
                .all(|(name, key)| row[place(name)].in_full() == *key)
        };
        let found: Vec<&Vec<Cell>> = table.rows.iter().filter(holds).collect();
        assert_eq!(found.len(), 1, "{keys:?}");
        found[0][place(column)].clone()
    }

    #[test]
    fn the_papers_tests_without_respondent_sixteen() {
        let study = fixture::study();
        let answered = fixture::answered(&study);
        let table = screened(&Preferences::of_study(&study, &answered).screened);
        assert_eq!(table.rows.len(), 4 + 9 + 3 + 9 + 6 + 3 + 9);
        let of = |column| cell(&table, &["outlying", "B-S", "all"], column).shown();
        assert_eq!(
            (of("left_out"), of("respondents"), of("mean")),
            ("1".into(), "16".into(), "0.173".into())
        );
        // p without 16 is one end of the leave-one-out range or inside it: docs/statistics.md, 0.0063 to 0.0188.
        let Cell::P(p, _) = cell(&table, &["outlying", "B-S", "all"], "p_without") else { panic!("no p") };
        assert!((0.0062..0.0189).contains(&p), "{p}");
        let kept: Vec<DeclaredBallot> =
            answered.declared.iter().filter(|b| b.participant() != 15).copied().collect();
        let alone = hypotheses::of_study(&study, &kept, None);
        let same = alone.iter().find(|h| h.contrast == "B-S" && h.scope == "all").unwrap();
        assert_eq!(p, same.test.sign_flip.p());
        let recorded = Recorded::of_study(&study, &answered.responses, &answered.shown);
        let protocol = recorded.protocol();
        let respondents = Respondent::all(screening_with(recorded.ballots(), &protocol), &protocol);
        let pairs = screened(&of_groups(&ballot_groups(&study, &answered.shown), &respondents));
        assert!(pairs.rows.iter().any(|row| row[4].in_full() == "bu-bi"));
    }

    #[test]
    fn nobody_broke_a_rule() {
        let study = fixture::study();
        let mut answers = fixture::answers(&study);
        answers.answers.retain(|answer| answer.participant != 15);
        let answered = Answered::of(&study, answers).unwrap();
        assert!(screened(&Preferences::of_study(&study, &answered).screened).rows.is_empty());
    }
}
