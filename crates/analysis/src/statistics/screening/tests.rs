use super::*;

fn ballots(rows: &[&str]) -> Vec<Ballot> {
    let outcome = |c| match c {
        'L' => Outcome::Left,
        'R' => Outcome::Right,
        _ => Outcome::Tie,
    };
    let mut all = Vec::new();
    for (participant, row) in rows.iter().enumerate() {
        for (question, c) in row.chars().enumerate().filter(|&(_, c)| c != ' ') {
            all.push(Ballot { participant, question, left: 0, right: 1, outcome: outcome(c) });
        }
    }
    all
}

#[test]
fn by_hand() {
    let screened = screening(&ballots(&["LLRN", "LRRL", "RLR ", "LLLL"]));
    let first = screened[0];
    // Others on question 1: L R L, majority left; 2: R L L, left; 3: R R L, right; the fourth is a tie of their own.
    assert_eq!((first.comparable, first.agreeing, first.longest_run), (3, 3, 2));
    assert_eq!((first.agreement(), first.one_sidedness()), (Some(1.0), Some(1.0 / 3.0)));
    // Participant 2 did not answer question 4; on question 1 the others are all left, on 2 L R L, on 3 R R L.
    assert_eq!((screened[2].answers, screened[2].comparable, screened[2].agreeing), ([1, 0, 2], 3, 2));
    assert_eq!((screened[3].longest_run, screened[3].one_sidedness()), (4, Some(1.0)));
}

#[test]
fn nothing_to_compare() {
    let alone = screening(&ballots(&["LLNL"]));
    assert_eq!((alone[0].agreement(), alone[0].longest_run), (None, 2));
    let undecided = screening(&ballots(&["NNN", "LLL"]));
    assert_eq!((undecided[0].one_sidedness(), undecided[0].agreement()), (None, None));
    assert!(screening(&[]).is_empty());
}
