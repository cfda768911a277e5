//! Rows that stand for several answers, and cells that stand for none.

use crate::study::{bad_cell, only_unknown, open, parse, parse_with, remarks, said};
use isostudy_responses::{Choice, Fault, Reading};

fn choices(reading: &Reading) -> [usize; 3] {
    let answers = &reading.responses.answers;
    Choice::ALL.map(|choice| answers.iter().filter(|answer| answer.choice == choice).count())
}

#[test]
fn a_count_is_so_many_people() {
    let text =
        "participant,question,left,right,choice,count\n,q,A,B,left,30\n,q,A,B,right,11\n,q,A,B,none,4\n";
    let reading = open(text).unwrap();
    assert_eq!(choices(&reading), [30, 4, 11]);
    let people = &reading.responses.participants;
    assert_eq!(people.len(), 45);
    let mut ids: Vec<&str> = people.iter().map(|person| person.id.as_str()).collect();
    assert_eq!([ids[0], ids[29], ids[30]], ["row 2.1", "row 2.30", "row 3.1"]);
    ids.sort_unstable();
    ids.dedup();
    assert_eq!(ids.len(), 45);
    let of: Vec<u32> = reading.responses.answers.iter().map(|answer| answer.participant).collect();
    assert_eq!(of, (0..45).collect::<Vec<_>>());
    assert_eq!(remarks(&reading), ["1 noted 45"]);

    // Neither the participant nor the question need have a column.
    let bare = open("left,right,choice,count\nA,B,left,30\nB,A,left,11\nA,B,none,4\n").unwrap();
    assert_eq!(choices(&bare), [41, 4, 0]);
    let ids: Vec<&str> = bare.responses.questions.iter().map(|q| q.id.as_str()).collect();
    assert_eq!(ids, ["A-B"]);
    // With a study too.
    let planned = parse("question,left,right,choice,count\nQ1,b,a,left,3\n").unwrap();
    assert_eq!(said(&planned), ["row 2.1 Q1 b<a", "row 2.2 Q1 b<a", "row 2.3 Q1 b<a"]);
}

/// Stigler's (1994) counts of citations among four journals of statistics, as R's BradleyTerry2 has them in `citations`: ties
/// aside, each row is a pair with the wins of either.
#[test]
fn a_table_of_wins_becomes_rows_with_counts() {
    let text = "left,right,choice,count\nBiometrika,Comm Statist,left,730\nBiometrika,Comm Statist,right,33\n\
        Biometrika,JASA,left,498\nBiometrika,JASA,right,320\nBiometrika,JRSS-B,left,221\nBiometrika,JRSS-B,right,284\n\
        Comm Statist,JASA,left,68\nComm Statist,JASA,right,813\nComm Statist,JRSS-B,left,17\n\
        Comm Statist,JRSS-B,right,276\nJASA,JRSS-B,left,142\nJASA,JRSS-B,right,325\n";
    let reading = open(text).unwrap();
    let answers = &reading.responses;
    assert_eq!(answers.items, ["Biometrika", "Comm Statist", "JASA", "JRSS-B"]);
    let wins = |item: u32| answers.answers.iter().filter(|answer| answer.chosen() == Some(item)).count();
    assert_eq!([0, 1, 2, 3].map(wins), [730 + 498 + 221, 33 + 68 + 17, 320 + 813 + 142, 284 + 276 + 325]);
    assert_eq!(answers.participants.len(), answers.answers.len());
}

#[test]
fn who_is_named_answers_once() {
    let text =
        "participant,question,left,right,choice,count\np,q,A,B,left,1\n,q,A,B,right,2\np,r,A,C,none,0\n";
    let reading = open(text).unwrap();
    assert_eq!(said(&reading), ["p q A<B", "row 3.1 q A>B", "row 3.2 q A>B"]);
    assert_eq!(remarks(&reading), ["4 noted 0", "1 noted 2"]);
    let twice = open(&text.replace("left,1", "left,2")).unwrap_err();
    assert_eq!(bad_cell(&twice), (2, 6, "count", "2"));
    for count in ["", "-1", "1.5", "many"] {
        let refused = open(&text.replace("right,2", &format!("right,{count}"))).unwrap_err();
        assert_eq!(bad_cell(&refused), (3, 6, "count", count));
    }
    // Without a count, nobody is nobody.
    let empty = open("participant,question,left,right,choice\n,q,A,B,left\n").unwrap_err();
    assert_eq!(bad_cell(&empty), (2, 1, "participant", ""));
    // Somebody else's name is not taken.
    let named =
        open("participant,question,left,right,choice,count\n,q,A,B,left,2\nrow 2.2,q,A,B,left,1\n").unwrap();
    assert_eq!(said(&named), ["row 2.1 q A<B", "row 2.2' q A<B", "row 2.2 q A<B"]);
}

#[test]
fn places_and_times_of_several_answers_are_not_read() {
    let text = "question,left,right,choice,count,order,rt_ms\nq,A,B,left,2,3,812\nq,A,B,left,1,4,900\n";
    let reading = open(text).unwrap();
    let read: Vec<_> = reading.responses.answers.iter().map(|a| (a.order, a.rt_ms)).collect();
    assert_eq!(read, [(None, None), (None, None), (Some(4), Some(900.0))]);
    assert_eq!(remarks(&reading)[0], "2 noted");
}

#[test]
fn counts_have_a_limit() {
    let rows = |second: u64| format!("left,right,choice,count\nA,B,left,1000\nA,B,right,{second}\n");
    let refused = open(&rows(isostudy_responses::MOST_COUNTED)).unwrap_err();
    assert_eq!(refused, Fault::TooManyAnswers { row: 3, answers: 10_001_000, limit: 10_000_000 });
    assert_eq!(choices(&open(&rows(99_000)).unwrap()), [1000, 0, 99_000]);
    // However large a whole number is, it is one.
    for count in ["10000001", "4000000000", "4294967296", "99999999999", "100000000000000000000"] {
        let refused = open(&format!("left,right,choice,count\nA,B,left,{count}\n")).unwrap_err();
        assert_eq!(bad_cell(&refused), (2, 4, "count", count));
        assert!(matches!(refused, Fault::Cell { limit, .. } if limit.contains("10000000")));
    }
}

#[test]
fn whether_anybody_is_named_can_be_told() {
    let names_nobody = |text: &str| open(text).unwrap().responses.names_nobody();
    assert!(names_nobody("left,right,choice,count\nA,B,left,30\nA,B,right,1\n"));
    assert!(names_nobody("participant,question,left,right,choice,count\n,q,A,B,left,2\n"));
    assert!(names_nobody("model_a,model_b,winner\nm1,m2,a\n"));
    assert!(!names_nobody("participant,question,left,right,choice,count\n,q,A,B,left,2\np,q,A,B,left,1\n"));
    assert!(!names_nobody("participant,question,left,right,choice\np,q,A,B,left\n"));
    assert!(!isostudy_responses::Responses::default().names_nobody());
}

/// Ten million answers, the most there may be.
#[test]
#[ignore = "1.5 GB: run by make test-long"]
fn the_most_answers_are_read() {
    let half = isostudy_responses::MOST_COUNTED / 2;
    let reading = open(&format!("left,right,choice,count\nA,B,left,{half}\nA,B,right,{half}\n")).unwrap();
    assert_eq!(choices(&reading), [half as usize, 0, half as usize]);
}

#[test]
fn na_is_no_answer() {
    let wide = parse("participant,Q1,Q2,Q3\np,L,NA,R\nq,na,NP, NA \n").unwrap();
    assert_eq!(said(&wide), ["p Q1 a<b", "p Q3 b>c", "q Q2 a=c"]);
    assert_eq!(remarks(&wide), ["2 noted 1 3 Q2", "3 noted 2 3 Q1 Q3", "2:3 noted 2",]);
    let long = "participant,question,left,right,choice,order,rt_ms\np,Q1,a,b,left,NA,NA\np,Q2,a,c,NA,2,5\n";
    let read = parse(long).unwrap();
    assert_eq!(said(&read), ["p Q1 a<b"]);
    assert_eq!(remarks(&read), ["3 noted Q2", "3:5 noted"]);
    // A column of answers stays one.
    let google = parse("Timestamp,w,w,w\n1,Left,NA,Right\n2,NA,NA,Left\n").unwrap();
    assert_eq!(said(&google), ["1 Q1 a<b", "1 Q3 b>c", "2 Q3 b<c"]);
    for other in ["NaN", "NULL", "N/A"] {
        let refused = parse(&format!("Q1,Q2,Q3\nL,{other},R\n")).unwrap_err();
        assert_eq!(only_unknown(&refused), (2, 2, "Q2", other));
    }
    let declared = parse_with("Q1,Q2,Q3\nL,NA,R\n", &crate::study::synonyms("x", "NA", "y")).unwrap();
    assert_eq!(said(&declared), ["1 Q1 a<b", "1 Q2 a=c", "1 Q3 b>c"]);
}
