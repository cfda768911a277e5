//! Files that no study explains.

use crate::study::{bad_cell, only_unknown, open, said};
use isostudy_responses::Fault;
use rand::SeedableRng;
use rand::seq::SliceRandom;
use rand_pcg::Pcg64;

#[test]
fn one_question_has_one_pair() {
    let header = "participant,question,left,right,choice\n";
    let two = open(&format!("{header}p,Q,A,B,left\nq,Q,B,A,left\nq,R,A,C,left\nr,Q,A,C,left\n")).unwrap_err();
    let pairs = |row, first_row| {
        let [question, pair, first_pair] = ["Q", "A and C", "A and B"].map(str::to_owned);
        Fault::TwoPairs { row, question, pair, first_row, first_pair }
    };
    assert_eq!(two, pairs(5, 2));
    // The same on another object; one pair on two objects is another matter.
    let header = "participant,question,object,left,right,choice\n";
    let on_two = open(&format!("{header}p,Q,x,A,B,left\np,Q,y,A,C,left\n")).unwrap_err();
    assert!(matches!(on_two, Fault::TwoPairs { row: 3, first_row: 2, .. }), "{on_two}");
    assert_eq!(
        open(&format!("{header}p,Q,x,A,B,left\np,Q,y,A,B,left\n")).unwrap().responses.questions.len(),
        2
    );
    let trials = "trial_type,trial_index,participant,question,left,right,response\nx,1,p,Q,A,B,left\nx,2,p,Q,A,C,left\n";
    assert_eq!(open(trials).unwrap_err(), pairs(3, 2));
}

#[test]
fn items_do_not_depend_on_the_order_of_rows() {
    let mut rows: Vec<String> = Vec::new();
    for (i, j) in (1..=12).flat_map(|i| (i + 1..=12).map(move |j| (i, j))) {
        rows.push(format!("p{i},q{i}-{j},m{j},m{i},left\n"));
    }
    let mut random = Pcg64::seed_from_u64(3);
    let want: Vec<String> = (1..=12).map(|i| format!("m{i}")).collect();
    for _ in 0..20 {
        rows.shuffle(&mut random);
        let reading = open(&format!("participant,question,left,right,choice\n{}", rows.concat())).unwrap();
        assert_eq!(reading.responses.items, want);
        for (row, said) in rows.iter().zip(said(&reading)) {
            let cells: Vec<&str> = row.split(',').collect();
            assert_eq!(said, format!("{} {} {}<{}", cells[0], cells[1], cells[2], cells[3]));
        }
        let answers = &reading.responses;
        assert!(answers.questions.iter().all(|q| q.left > q.right));
    }
}

#[test]
fn roles_are_read_and_checked() {
    let text = |rows: &str| format!("participant,question,left,right,choice,role\n{rows}");
    let reading =
        open(&text("p,Q,A,B,left,comparison\np,Q,B,A,left,Repeat\np,c,A,A,none,control\np,t,A,B,left,training\np,R,A,C,left,\n"))
            .unwrap();
    assert_eq!(said(&reading), ["p Q A<B", "p Q-r B<A", "p c A=A", "p R A<C"]);
    let comparisons: Vec<bool> = reading.responses.questions.iter().map(|q| q.is_comparison()).collect();
    assert_eq!(comparisons, [true, false, false, true]);
    let refused = open(&text("p,Q,A,B,left,student\n")).unwrap_err();
    assert_eq!(bad_cell(&refused), (2, 6, "role", "student"));
    let refused = open(&text("p,Q,A,B,left,control\n")).unwrap_err();
    assert_eq!(bad_cell(&refused), (2, 4, "right", "B"));
    // A study's question that is marked as a repeat is one.
    let planned = crate::study::parse(&text("p,Q1,a,b,left,comparison\np,Q1,a,b,left,repeat\n")).unwrap();
    assert_eq!(said(&planned), ["p Q1 a<b", "p Q1-r a<b"]);
}

#[test]
fn bad_cells_are_named_by_their_column_or_question() {
    let pwcmp = |row: &str| {
        open(&format!("observer,session,scene,condition_A,condition_B,is_A_selected\n{row}\n")).unwrap_err()
    };
    assert_eq!(only_unknown(&pwcmp("p,1,Hall,T,F,x")), (2, 6, "Hall: F-T", "x"));
    assert_eq!(bad_cell(&pwcmp("p,1,Hall,,F,1")), (2, 4, "condition_A", ""));
    let arenakit = open("model_a,model_b,winner\nm1,m2,x\n").unwrap_err();
    assert_eq!(only_unknown(&arenakit), (2, 3, "m1-m2", "x"));
}

#[test]
fn code_names_are_kept_with_the_answers() {
    let text = "participant,question,left,right,choice,stimulus\np,Q,A,B,left,tani\np,R,A,C,left,\nq,Q,B,A,left,kobu\n\
        r,Q,A,B,left,tani\n";
    let reading = open(text).unwrap();
    let answers = &reading.responses;
    let names: Vec<Option<&str>> = answers.answers.iter().map(|answer| answers.stimulus(answer)).collect();
    assert_eq!(names, [Some("tani"), None, Some("kobu"), Some("tani")]);
    assert_eq!(answers.stimuli, ["tani", "kobu"]);
    let mut long = Vec::new();
    isostudy_responses::write_long(answers, &mut long).unwrap();
    assert_eq!(open(std::str::from_utf8(&long).unwrap()).unwrap().responses, *answers);
}
