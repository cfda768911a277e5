use super::*;
use crate::fixture;
use isostudy_inference::Preferences;
use isostudy_inference::ballots::ballots;
use isostudy_statistics::{Outcome, Protocol, ShownBallot, screening};

fn table_of(ballots: &[ShownBallot]) -> Table {
    respondents(&Respondent::all(screening(ballots), &Protocol::default()), 0, None)
}

#[test]
fn the_papers_participants() {
    let study = fixture::study();
    let table = agreement(&study, &Preferences::of_study(&study, &fixture::answered(&study)).agreement);
    let shown = table.shown_rows();
    let scopes: Vec<&str> = shown.iter().map(|row| row[0].as_str()).collect();
    assert_eq!(scopes, ["all", "B", "S", "U", "I", "P"]);
    // Alpha in both orientations, computed apart: 0.306. Triads: 108, 82 decided, 5 circular.
    assert_eq!(shown[0][1..3], ["27", "0.3062"]);
    assert_eq!(shown[0][12..15], ["108", "82", "5"]);
    // A quarter of those decided.
    assert_eq!(shown[0][16], "20.5");
    // For three items zeta is 0 for a circle, else 1.
    assert_eq!(shown[0][17..], ["82".to_owned(), format!("{:.3}", 77.0 / 82.0)]);
    let circles = |row: usize| shown[row][14].parse::<u64>().unwrap();
    assert_eq!(circles(1) + circles(2), 5);
    // Groups of two items have no triads.
    assert!(shown[3..].iter().all(|row| row[1] == "3" && row[12..].iter().all(String::is_empty)));
}

#[test]
fn respondent_sixteen_stands_out() {
    // Counted apart from this program.
    let study = fixture::study();
    let table = table_of(&ballots(&study, &fixture::answers(&study)));
    assert_eq!(table.rows.len(), 18);
    let row = &table.shown_rows()[15];
    assert_eq!(row[..4], ["16", "19", "0", "8"]);
    let agreement = |row: &[Cell]| match row[8] {
        Cell::Number(share, _) => share,
        _ => panic!("no share"),
    };
    assert_eq!(format!("{:.2}", agreement(&table.rows[15])), "0.37");
    let others = table.rows.iter().enumerate().filter(|(i, _)| *i != 15);
    assert!(others.map(|(_, row)| agreement(row)).all(|share| (0.635..0.955).contains(&share)));
}

#[test]
fn of_many_participants_those_who_break_a_rule_are_printed() {
    let of = |participant: usize| {
        let outcome = move |q: usize| {
            if participant == 7 || (participant + q).is_multiple_of(2) {
                Outcome::Left
            } else {
                Outcome::Right
            }
        };
        // Each pair is seen in both orders, so that a side can be told from a liking.
        (0..10).map(move |question| {
            let sides = if question % 4 < 2 { [0, 1] } else { [1, 0] };
            ShownBallot::new(participant, question, sides, outcome(question))
        })
    };
    let ballots: Vec<ShownBallot> = (0..201).flat_map(of).collect();
    let table = table_of(&ballots);
    assert_eq!((table.rows.len(), table.printed()[0].rows.len()), (201, 1));
    assert_eq!(table.printed()[0].shown_rows()[0][0], "8");
    assert!(table.rows[7].last().unwrap().in_full().contains("one-sided"));
    assert!(table.to_markdown().contains("Of 201 participants those who break a rule are printed, 1;"));
}
