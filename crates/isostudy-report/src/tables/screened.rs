//! The tests with everybody, and without those who broke a rule: nobody is left out silently.

use isostudy_inference::screened::WithoutBreakers;
use isostudy_statistics::Flag;
use isostudy_table::{Cell, Table};
use std::collections::BTreeSet;

/// Each rule that somebody broke, with every test.
pub(super) fn screened(screened: &[WithoutBreakers]) -> Table {
    let mut table = Table::new(
        "screened",
        "Tests with everybody, and without those who broke a rule",
        &[
            ("rule", "Rule"),
            ("left_out", "Left out"),
            ("respondents", "Respondents"),
            ("family", "Family"),
            ("contrast", "Contrast"),
            ("scope", "Scope"),
            ("mean", "Mean score"),
            ("p_adjusted", "p adjusted"),
            ("conclusion", "Conclusion"),
            ("mean_without", "Mean score"),
            ("p_without", "p"),
            ("p_adjusted_without", "p adjusted"),
            ("conclusion_without", "Conclusion"),
        ],
    );
    for WithoutBreakers { rule, people, tests } in screened {
        for (with, without) in tests {
            let answered = without.as_ref();
            table.push(vec![
                Cell::text(rule.map_or("any", Flag::code)),
                Cell::count(people.len() as u64),
                Cell::text(numbers(people, " ")),
                Cell::text(&with.family),
                Cell::text(&with.contrast),
                Cell::text(&with.scope),
                Cell::of_sum(Some(with.test.mean), 3),
                Cell::P(with.adjusted, 4),
                Cell::text(with.conclusion().label()),
                Cell::of_sum(answered.map(|other| other.test.mean), 3),
                Cell::p(answered.map(|other| other.test.sign_flip.p()), 5),
                Cell::p(answered.map(|other| other.adjusted), 4),
                Cell::text(answered.map_or("nobody left", |other| other.conclusion().label())),
            ]);
        }
    }
    let blocks: [(&str, &[&str]); 2] = [
        (
            "With everybody",
            &[
                "rule",
                "left_out",
                "respondents",
                "family",
                "contrast",
                "scope",
                "mean",
                "p_adjusted",
                "conclusion",
            ],
        ),
        (
            "Without them",
            &[
                "rule",
                "family",
                "contrast",
                "scope",
                "mean_without",
                "p_without",
                "p_adjusted_without",
                "conclusion_without",
            ],
        ),
    ];
    table.print_in_blocks(&blocks);
    table.notes.push(
        "For each rule that somebody broke, the same tests without them; the rules are under the table of respondents. Both \
         halves are about all participants, also where other tables leave some out."
            .into(),
    );
    table
}

/// Numbers from 1, the first ten of them.
pub(crate) fn numbers(people: &BTreeSet<usize>, between: &str) -> String {
    const MOST: usize = 10;
    let first: Vec<String> = people.iter().take(MOST).map(|p| (p + 1).to_string()).collect();
    let more = people.len().saturating_sub(MOST);
    if more > 0 { format!("{} and {more} more", first.join(between)) } else { first.join(between) }
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
        let alone = hypotheses::of_study(&study, &kept);
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
