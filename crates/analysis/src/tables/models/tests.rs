use super::*;
use crate::statistics::{Ballot, Outcome};

/// English Premier League 2008-9, home row against away column: H home win, D draw, A away win; teams by name, Arsenal
/// first. Data set `football` of the R package BradleyTerry2 1.1-2.
const FOOTBALL: &str = "\
-AHHAHDADHHHHHHDDHDH
D-HHADDHDAHDHDDHAHDD
AA-DADHDADDAHHHAHDDH
ADD-AAADAHHAHHHDHDHA
AHHH-DHDAHHDDHHHDHDH
DAAHD-HHADADDAHHDHHH
HHAHDA-AAHDHHHHDHHAH
AAAAADH-AHDADDAAADHA
DHHHHDDD-HDHHHDHHHDH
DDDAAADHH-HADDHDHADD
HHHHAAAHAH-AHHHHAHHH
DHHHHHHHAHH-DHHHHHHH
AHAHADAAAHDA-DDDHHDD
AAHHAHDDAHHAA-HHHDAA
HHHHAADDDHHADD-HHHAH
DADAAAHHAHAAHAH-DHAA
DAHHHADAHHHDHDHA-HHD
AADDAAHAAHHAADAHH-HH
AAHAAAHHAHHAHDHHAD-H
AAHDAHDHDAHAHHDDHHA-";

/// Every match as a ballot with the home team on the left; one participant a team's home season.
fn football() -> BallotGroup {
    let mut ballots = Vec::new();
    for (left, line) in FOOTBALL.lines().enumerate() {
        for (right, result) in line.chars().enumerate() {
            let outcome = match result {
                'H' => Outcome::Left,
                'D' => Outcome::Tie,
                'A' => Outcome::Right,
                _ => continue,
            };
            ballots.push(Ballot { participant: left, question: ballots.len(), left, right, outcome });
        }
    }
    BallotGroup {
        name: "football".into(),
        items: (0..20).map(|team| format!("team {team}")).collect(),
        ballots,
    }
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

#[test]
fn football_with_home_advantage_as_gnm_has_it() {
    // R 4.2.2, gnm 1.1-2, one row a match and outcome: gnm(y ~ X + tie + side - 1, eliminate = match, family = poisson),
    // X half credits as in GenDavidson; log-likelihood = -deviance / 2. gnm stops some 5e-8 short of the maximum.
    let [worths, models] = model_tables(&[football()]);
    let side = [("model", "davidson-side")];
    close(cell(&models, &side, "log_likelihood"), -349.663_716_215_210_2);
    close(cell(&models, &side, "ln_nu"), -0.115_936_840_087_198_2);
    close(cell(&models, &side, "side"), 0.612_464_538_852_225);
    close(cell(&models, &side, "side_se"), 0.144_537_947_342_107_1);
    let worth = |item, model, column| cell(&worths, &[("item", item), ("model", model)], column);
    close(worth("team 1", "davidson-side", "log_worth"), -0.655_057_598_087_322_6);
    close(worth("team 11", "davidson-side", "log_worth"), 1.144_518_848_847_809_3);
    close(worth("team 19", "davidson-side", "se"), 0.619_182_505_052_120_5);
    // The maximum itself, by 60 Newton steps in NumPy 2.4.6 on the probabilities written out.
    let exactly = |cell: Cell, want: f64| match cell {
        Cell::Number(got, _) => assert!((got - want).abs() < 1e-11, "{got} is not {want}"),
        other => panic!("{other:?} is no number"),
    };
    exactly(worth("team 1", "davidson-side", "log_worth"), -0.655_057_649_373_044_7);
    exactly(worth("team 19", "davidson-side", "log_worth"), -1.689_408_747_393_343_2);
    exactly(cell(&models, &side, "ln_nu"), -0.115_936_837_411_757_88);
    exactly(cell(&models, &side, "side"), 0.612_464_540_861_840_1);
    let plain = [("model", "davidson")];
    close(cell(&models, &plain, "log_likelihood"), -359.137_176_148_086_8);
    close(cell(&models, &plain, "ln_nu"), -0.161_574_708_630_048_7);
    close(worth("team 19", "davidson", "log_worth"), -1.601_468_025_715_943);
    assert_eq!(cell(&models, &plain, "remark"), Cell::text(""));
    let header = |table: &Table| table.columns.iter().map(|c| c.name.clone()).collect::<Vec<_>>().join(",");
    assert!(header(&worths).starts_with("group,item,model,log_worth,se,"));
    assert!(header(&models).starts_with("group,model,log_likelihood,ln_nu,side,"));
    assert_eq!((worths.rows.len(), models.rows.len()), (80, 4));
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
            ballots.push(Ballot { participant, question, left: 0, right: 1, outcome });
        }
    }
    BallotGroup { name: "two".into(), items: vec!["a".into(), "b".into()], ballots }
}

#[test]
fn what_is_not_answerable_is_said_and_not_numbered() {
    let [worths, models] = model_tables(&[two_items(&["LLN", "LRN", "RLL"])]);
    let side = [("model", "davidson-side")];
    assert_eq!(cell(&models, &side, "side"), Cell::Missing);
    let remark = cell(&models, &side, "remark").in_full();
    assert!(remark.starts_with("not answerable here, because no pair was shown in both orders"), "{remark}");
    assert!(worths.rows.iter().all(|row| row[2].in_full() != "davidson-side"));
    assert_eq!(worths.rows.len(), 6);
}

#[test]
fn separated_answers_are_marked_and_have_no_interval() {
    let [worths, models] = model_tables(&[two_items(&["LLL", "LLN"])]);
    let davidson = [("model", "davidson")];
    assert_eq!(cell(&models, &davidson, "penalised"), Cell::text("yes"));
    let b = [("item", "b"), ("model", "davidson")];
    close(cell(&worths, &b, "log_worth"), -(5.5_f64 / 0.5).ln());
    assert_eq!((cell(&worths, &b, "low"), cell(&worths, &b, "bca_low")), (Cell::Missing, Cell::Missing));
}

#[test]
fn degenerate_groups_are_stated_results() {
    let all_ties = model_tables(&[two_items(&["NN", "N"])]);
    assert!(all_ties[0].rows.is_empty());
    assert!(all_ties[1].rows.iter().all(|row| row[10].in_full().contains("every answer was no preference")));
    let one_person = model_tables(&[two_items(&["LRN"])]);
    let b = [("item", "b"), ("model", "davidson")];
    close(cell(&one_person[0], &b, "log_worth"), 0.0);
    assert_eq!(cell(&one_person[0], &b, "clustered_se"), Cell::Missing);
    assert!(model_tables(&[]).iter().all(|table| table.rows.is_empty()));
}
