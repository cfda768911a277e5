use super::*;
use isostudy_inference::{BallotGroup, models};
use isostudy_statistics::{Outcome, ShownBallot};

fn tables_of(groups: &[BallotGroup]) -> [Table; 2] {
    model_tables(&models::of_groups(groups, true), true)
}

fn cell(table: &Table, keys: &[(&str, &str)], column: &str) -> Cell {
    let index = |name: &str| table.columns.iter().position(|c| c.name == name).unwrap();
    let holds = |row: &&Vec<Cell>| keys.iter().all(|(name, value)| row[index(name)].in_full() == *value);
    let found: Vec<&Vec<Cell>> = table.rows.iter().filter(holds).collect();
    assert_eq!(found.len(), 1, "{keys:?}");
    found[0][index(column)].clone()
}

#[track_caller]
fn close(cell: Cell, want: f64) {
    let Cell::Number(got, _) = cell else { panic!("{cell:?} is no number") };
    assert!((got - want).abs() < 1e-6, "{got} is not {want}");
}

/// One ballot a participant and letter, all on the pair 0, 1.
fn two_items(rows: &[&str]) -> BallotGroup {
    let mut ballots = Vec::new();
    for (participant, row) in rows.iter().enumerate() {
        for (question, c) in row.chars().enumerate() {
            let outcome = match c {
                'L' => Outcome::Left,
                'R' => Outcome::Right,
                _ => Outcome::Tie,
            };
            ballots.push(ShownBallot::new(participant, question, [0, 1], outcome));
        }
    }
    BallotGroup { name: "two".into(), items: vec!["a".into(), "b".into()], ballots, objects: Vec::new() }
}

#[test]
fn what_is_not_answerable_is_said_and_not_numbered() {
    let [worths, models] = tables_of(&[two_items(&["LLN", "LRN", "RLL"])]);
    let side = [("model", "davidson-side")];
    assert_eq!(cell(&models, &side, "side"), Cell::Missing);
    let remark = cell(&models, &side, "remark").in_full();
    assert!(remark.starts_with("not answerable here, because no pair was shown in both orders"), "{remark}");
    assert!(worths.rows.iter().all(|row| row[2].in_full() != "davidson-side"));
    assert_eq!(worths.rows.len(), 6);
}

#[test]
fn separated_answers_are_marked_and_have_no_interval() {
    let [worths, models] = tables_of(&[two_items(&["LLL", "LLN"])]);
    let davidson = [("model", "davidson")];
    assert_eq!(cell(&models, &davidson, "penalised"), Cell::text("yes"));
    let b = [("item", "b"), ("model", "davidson")];
    close(cell(&worths, &b, "log_worth"), -(5.5_f64 / 0.5).ln());
    assert_eq!(cell(&worths, &b, "low"), Cell::Missing);
    assert!(cell(&models, &davidson, "remark").in_full().starts_with("some items never won"));
}

#[test]
fn degenerate_groups_are_stated_results() {
    let all_ties = tables_of(&[two_items(&["NN", "N"])]);
    assert!(all_ties[0].rows.is_empty());
    assert!(all_ties[1].rows.iter().all(|row| row[10].in_full().contains("every answer was no preference")));
    let one_person = tables_of(&[two_items(&["LRN"])]);
    let b = [("item", "b"), ("model", "davidson")];
    close(cell(&one_person[0], &b, "log_worth"), 0.0);
    assert_eq!(cell(&one_person[0], &b, "clustered_se"), Cell::Missing);
    assert!(tables_of(&[]).iter().all(|table| table.rows.is_empty()));
}

#[test]
fn a_worth_that_rests_on_one_tie_has_no_error_of_clusters() {
    let mut group = two_items(&["L", "R", "", "L"]);
    group.items.push("c".into());
    group.ballots.push(ShownBallot::new(2, 1, [0, 2], Outcome::Tie));
    let [worths, _] = tables_of(&[group]);
    let of = |item: &str, column: &str| cell(&worths, &[("item", item), ("model", "davidson")], column);
    for column in ["clustered_se", "low", "high"] {
        assert_eq!(of("c", column), Cell::Missing, "{column}");
        assert_ne!(of("b", column), Cell::Missing, "{column}");
    }
    assert_eq!(of("c", "log_worth"), Cell::Number(0.0, 3));
    assert_eq!(of("a", "clustered_se"), Cell::Number(0.0, 3));
}
