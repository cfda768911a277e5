use super::*;

fn ballots(rows: &[&str]) -> Vec<ShownBallot> {
    let outcome = |c| match c {
        'L' => Outcome::Left,
        'R' => Outcome::Right,
        _ => Outcome::Tie,
    };
    let mut all = Vec::new();
    for (participant, row) in rows.iter().enumerate() {
        for (question, c) in row.chars().enumerate().filter(|&(_, c)| c != ' ') {
            all.push(ShownBallot::new(participant, question, [0, 1], outcome(c)));
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

/// Participant 0: controls `left == right`, repeats of pair 0-1 in both orders, each with order and time.
fn watched(answers: &[(usize, usize, usize, Outcome, u32, f64)]) -> (Vec<ShownBallot>, Vec<Circumstances>) {
    let ballot = |&(question, left, right, outcome, ..): &(usize, usize, usize, Outcome, u32, f64)| {
        ShownBallot::new(0, question, [left, right], outcome)
    };
    let known = |&(.., order, rt): &(usize, usize, usize, Outcome, u32, f64)| Circumstances {
        order: Some(order),
        rt_ms: Some(rt),
    };
    (answers.iter().map(ballot).collect(), answers.iter().map(known).collect())
}

#[test]
fn controls_repeats_and_time() {
    use Outcome::{Left, Right, Tie};
    let (ballots, circumstances) = watched(&[
        (0, 0, 1, Left, 4, 900.0),
        (1, 1, 0, Left, 1, 700.0),
        (2, 0, 1, Left, 2, 800.0),
        (3, 2, 2, Left, 3, 500.0),
        (4, 2, 2, Tie, 5, 600.0),
        (5, 0, 0, Right, 6, 400.0),
    ]);
    // Questions 0 and 1 show the same pair on the same object in both orders; question 2 the same pair on another.
    let scenes = [7, 7, 8, 7, 7, 7];
    let protocol = Protocol {
        circumstances: &circumstances,
        scenes: &scenes,
        shown_ms: Some(650.0),
        ..Protocol::default()
    };
    let seen = screening_with(&ballots, &protocol)[0];
    assert_eq!((seen.answers, seen.controls, seen.controls_decided), ([3, 0, 0], 3, 2));
    // Left both times, with the sides swapped: the other item.
    assert_eq!((seen.repeats, seen.repeats_opposite, seen.consistency()), (1, 1, Some(0.0)));
    // In order of presentation: L L L L - R.
    assert_eq!((seen.longest_run, seen.timed, seen.time_ms), (4, 6, 3900.0));
    assert_eq!(seen.flags(&Protocol { shown_ms: Some(650.0), ..Protocol::default() }), [Flag::Controls]);
    assert_eq!(
        seen.flags(&Protocol { shown_ms: Some(650.1), ..Protocol::default() }),
        [Flag::Controls, Flag::Time]
    );
    assert_eq!(seen.flags(&Protocol::default()), [Flag::Controls]);
    // Who has to choose decides every control.
    assert_eq!(seen.flags(&Protocol { forced: true, ..Protocol::default() }), []);
    // Nothing known but the ballots: no order, no time, and no question was answered twice.
    let bare = screening(&ballots)[0];
    assert_eq!((bare.repeats, bare.timed, bare.consistency()), (0, 0, None));
    let twice = [ballots[0], ballots[0], ballots[1]];
    assert_eq!(screening(&twice)[0].repeats, 1);
}

#[test]
fn rules_by_hand() {
    let of = |answers, repeats, repeats_opposite| Screening {
        answers,
        repeats,
        repeats_opposite,
        ..Screening::default()
    };
    let telling = |answers| Screening { items_on_both_sides: true, ..of(answers, 0, 0) };
    assert_eq!(telling([10, 3, 0]).flags(&Protocol::default()), [Flag::OneSided]);
    assert_eq!(telling([9, 3, 0]).flags(&Protocol::default()), []);
    assert_eq!(of([10, 3, 0], 0, 0).flags(&Protocol::default()), []);
    let no_sides = Protocol { sides_unknown: true, ..Protocol::default() };
    assert_eq!(telling([10, 3, 0]).flags(&no_sides), []);
    assert_eq!(of([0, 0, 9], 0, 0).flags(&Protocol::default()), []);
    assert_eq!(of([20, 0, 1], 4, 2).flags(&Protocol::default()), []);
    assert_eq!(of([20, 0, 1], 3, 2).flags(&Protocol::default()), [Flag::Repeats]);
    assert_eq!(of([20, 0, 1], 1, 1).flags(&Protocol::default()), []);
    let odd = Screening { outlying_p: Some(0.009), ..Screening::default() };
    assert_eq!(odd.flags(&Protocol::default()), [Flag::Outlying]);
}

#[test]
fn agreement_is_about_items_where_sides_were_swapped() {
    // Everybody chooses item 0, on whichever side it stands.
    let ballot = |participant: usize| {
        let swapped = participant % 2 == 1;
        let (left, right) = if swapped { (1, 0) } else { (0, 1) };
        let outcome = if swapped { Outcome::Right } else { Outcome::Left };
        ShownBallot::new(participant, 0, [left, right], outcome)
    };
    let all: Vec<ShownBallot> = (0..5).map(ballot).collect();
    assert!(screening(&all).iter().all(|s| s.agreement() == Some(1.0)));
}

/// Whether pressing left at each of these pairs, all on one object, breaks the rule of one side.
fn left_throughout(pairs: &[[usize; 2]]) -> bool {
    let left = |(question, items): (usize, &[usize; 2])| ShownBallot::new(0, question, *items, Outcome::Left);
    let ballots: Vec<ShownBallot> = pairs.iter().enumerate().map(left).collect();
    let scenes = vec![0; pairs.len()];
    let protocol = Protocol { scenes: &scenes, ..Protocol::default() };
    screening_with(&ballots, &protocol)[0].flags(&protocol).contains(&Flag::OneSided)
}

#[test]
fn who_prefers_what_always_stood_there_is_not_careless() {
    let agreed = [[0, 1]; 12];
    assert!(!left_throughout(&agreed));
    // 0 before 2 before 1: an order that has the left side ahead, although 2 stood on both sides.
    assert!(!left_throughout(&[[[0, 1]; 4], [[0, 2]; 4], [[2, 1]; 4]].concat()));
    // Every item on both sides: no order does.
    assert!(left_throughout(&[[[0, 1]; 6], [[1, 0]; 6]].concat()));
    assert!(left_throughout(&[[[0, 1]; 4], [[1, 2]; 4], [[2, 0]; 4]].concat()));
    // Repeats of two pairs with the sides swapped, though item 9 stood on the right alone; one is not enough.
    let beside = |repeats: &[[usize; 2]]| [&agreed[..8], &[[2, 3], [4, 5], [0, 9]], repeats].concat();
    assert!(!left_throughout(&beside(&[])));
    assert!(!left_throughout(&beside(&[[3, 2]])));
    assert!(left_throughout(&beside(&[[3, 2], [5, 4]])));
    // Two controls decided for the same side; one, or one to each side, says nothing.
    assert!(!left_throughout(&beside(&[[7, 7]])));
    assert!(left_throughout(&beside(&[[7, 7], [7, 7]])));
    let torn =
        Screening { answers: [12, 0, 0], controls_decided: 2, controls_left: 1, ..Screening::default() };
    assert!(!torn.tells_sides());
}
