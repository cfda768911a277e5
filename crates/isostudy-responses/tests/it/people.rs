//! Who is who: one person under two ids, one sheet twice, and addresses that nobody is shown.

use crate::study::{export, fault, parse, parse_with, plan, read, remarks, said};
use isostudy_responses::{Duplicates, Fault, Mapping, Reading};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use std::path::Path;

const MICROSOFT: &str = "ID,Start time,Completion time,Email,Name,a,b,c\n";
const GOOGLE: &str = "Timestamp,Username,a,b,c\n";
const MONKEY: &str =
    "Respondent ID,Collector ID,Start Date,Email Address,a,b,c\n,,,,Response,Response,Response\n";
const QUALTRICS: &str = "StartDate,ResponseId,RecipientEmail,QID1,QID2,QID3,FL_1_DO\n\
    Start Date,Response ID,Recipient Email,a,b,c,FL_1 - Display Order\n";

fn keeping(duplicates: Duplicates) -> Mapping {
    Mapping { duplicates, ..Mapping::default() }
}

/// Everything that is printed or stored of a reading.
fn all_of(reading: &Reading) -> String {
    let mut long = Vec::new();
    isostudy_responses::write_long(&reading.responses, &mut long).unwrap();
    let long = String::from_utf8(long).unwrap();
    format!("{:?}\n{}\n{}\n{long}", reading.responses, reading.report, reading.report.to_csv())
}

#[test]
fn an_address_in_two_rows_is_one_person() {
    let tables = [
        (MICROSOFT, "1,8:00,8:01,a@x.org,Ann,L,NP,R\n2,9:00,9:01, A@X.org,Ann,L,NP,L\n", 2, 3, ["1", "2"]),
        (GOOGLE, "x,a@x.org,L,NP,R\ny,a@x.org,L,NP,L\n", 2, 3, ["1", "2"]),
        (MONKEY, "11,4,1/2,a@b.c,L,NP,R\n12,4,1/3,a@b.c,L,NP,L\n", 3, 4, ["11", "12"]),
        (QUALTRICS, "1/2,R_1,a@x.org,L,NP,R,\n1/3,R_2,a@x.org,L,NP,L,\n", 3, 4, ["R_1", "R_2"]),
    ];
    for (header, rows, first, second, ids) in tables {
        let text = format!("{header}{rows}");
        let refused = parse(&text).unwrap_err();
        assert_eq!(refused, Fault::DuplicateAddress { row: second, first });
        assert!(!refused.to_string().contains('@'), "{refused}");
        for (duplicates, last) in [(Duplicates::First, "b>c"), (Duplicates::Last, "b<c")] {
            let reading = parse_with(&text, &keeping(duplicates)).unwrap();
            let mut said = said(&reading);
            said.sort_unstable();
            assert_eq!(said, ["Q1 a<b", "Q2 a=c", &format!("Q3 {last}")].map(|s| format!("{} {s}", ids[0])));
            assert!(remarks(&reading).contains(&format!("{second} noted {first}")), "{}", reading.report);
            assert_eq!(reading.report.count(isostudy_responses::Kind::Rejected), 3);
            assert!(!all_of(&reading).to_lowercase().contains("@x.org"), "{}", all_of(&reading));
        }
        // Who shares an address is told apart by a declared column.
        let column = Some(header.split(',').position(|title| title.ends_with("ID") || title == "ResponseId"));
        if let Some(Some(column)) = column {
            let declared = Mapping { participant_column: Some(column + 1), ..Mapping::default() };
            assert_eq!(parse_with(&text, &declared).unwrap().responses.participants.len(), 2);
        }
    }
}

#[test]
fn exports_with_somebody_twice() {
    let path = export("microsoft_twice.csv");
    let refused = isostudy_responses::read(&path, Some(&plan()), &Mapping::default()).unwrap_err();
    assert_eq!(fault(refused), Fault::DuplicateAddress { row: 4, first: 2 });
    let first = read("microsoft_twice.csv", &keeping(Duplicates::First));
    let ids: Vec<&str> = first.responses.participants.iter().map(|p| p.id.as_str()).collect();
    assert_eq!(ids, ["1", "2", "4"]);
    // The same time and the same 3 answers as row 3.
    assert!(remarks(&first).iter().any(|remark| remark == "5 noted 3 3"), "{}", first.report);
    let long = read("long_addresses.csv", &Mapping::default());
    let want = ["row 2' Q1 a<b", "row 2' Q2 a=c", "row 2 Q1 b>a", "row 5 Q1 a>b", "row 2' Q3 b>c"];
    assert_eq!(said(&long), want);
    assert!(!all_of(&first).contains('@') && !all_of(&long).contains('@'));
}

#[test]
fn nobody_is_no_address() {
    for nobody in ["", "anonymous", "anonym", "Anonyme", "anónimo", "-"] {
        let rows = format!("1,8:00,8:01,{nobody},,L,NP,R\n2,9:00,9:01,{nobody},,L,NP,R\n");
        let reading = parse(&format!("{MICROSOFT}{rows}")).unwrap();
        assert_eq!(reading.responses.participants.len(), 2, "{nobody}");
        assert!(reading.report.remarks.is_empty(), "{}", reading.report);
    }
}

#[test]
fn a_column_that_people_were_asked_for_counts_as_well() {
    let text = "Timestamp,a,b,c,Your e-mail address\nx,L,L,L,a@x.org\ny,R,R,R,a@x.org\n";
    assert_eq!(parse(text).unwrap().responses.participants.len(), 2);
    let text = text.replace("Your e-mail address", "Your email address *");
    assert_eq!(parse(&text).unwrap_err(), Fault::DuplicateAddress { row: 3, first: 2 });
}

#[test]
fn an_id_goes_before_an_address() {
    let rows = "1,8:00,,a@x.org,,L,L,L\n2,9:00,,b@x.org,,R,R,R\n2,10:00,,a@x.org,,R,R,L\n";
    let text = format!("{MICROSOFT}{rows}");
    let again = Fault::DuplicateParticipant { row: 4, first: 3, participant: "2".into() };
    assert_eq!(parse(&text).unwrap_err(), again);
    let first = parse_with(&text, &keeping(Duplicates::First)).unwrap();
    assert_eq!(said(&first)[3..], ["2 Q1 a>b", "2 Q2 a>c", "2 Q3 b>c"]);
}

#[test]
fn rows_that_are_there_twice_are_noted() {
    let twice = "Timestamp,w,w,w\nx,Left,Right,No preference\ny,R,R,R\nx,Left,Right,No preference\n";
    let reading = parse(twice).unwrap();
    assert_eq!(reading.responses.participants.len(), 3);
    assert_eq!(remarks(&reading), ["4 noted 3 2"]);
    for other in ["z,Left,Right,No preference", "x,Left,Right,Right"] {
        let text = twice.replace("\ny,R,R,R\nx,Left,Right,No preference", &format!("\n{other}"));
        assert!(parse(&text).unwrap().report.remarks.is_empty(), "{other}");
    }
    // Of one person's copies one is left out already.
    let ids = format!("{MICROSOFT}1,8:00,,,,L,R,L\n1,8:00,,,,L,R,L\n");
    let addresses = format!("{MICROSOFT}1,8:00,,a@x.org,,L,R,L\n2,8:00,,a@x.org,,L,R,L\n");
    for text in [ids, addresses] {
        let first = parse_with(&text, &keeping(Duplicates::First)).unwrap();
        assert_eq!(first.responses.answers.len(), 3);
        assert!(!remarks(&first).iter().any(|remark| remark.ends_with("noted 3 2")), "{}", first.report);
    }
    // Two answers, or no time, are the same by chance.
    let few = parse("Timestamp,w,w,w\nx,Left,Right,\nx,Left,Right,\n").unwrap();
    assert_eq!(remarks(&few), ["2 noted 1 1 3 Q3", "3 noted 2 1 3 Q3"], "{}", few.report);
    assert!(parse("Q1,Q2,Q3\nL,L,L\nL,L,L\n").unwrap().report.remarks.is_empty());
}

#[test]
fn a_questionnaire_filled_in_twice_is_no_question_shown_twice() {
    // The order of the second time differs, which tells showings apart in one questionnaire alone.
    let rows = "1/2,R_1,,L,L,L,QID1|QID2|QID3\n1/3,R_1,,R,R,R,QID3|QID1|QID2\n";
    let text = format!("{QUALTRICS}{rows}");
    let again = Fault::DuplicateParticipant { row: 4, first: 3, participant: "R_1".into() };
    assert_eq!(parse(&text).unwrap_err(), again);
    let last = parse_with(&text, &keeping(Duplicates::Last)).unwrap();
    assert_eq!(said(&last), ["R_1 Q1 a>b", "R_1 Q2 a>c", "R_1 Q3 b>c"]);
}

#[test]
fn addresses_as_ids_are_neither_kept_nor_shown() {
    // `row 2` and `row 4` are somebody's own names.
    let text = "participant,question,left,right,choice\na@x.org,q,a,b,left\nrow 2,q,a,b,none\nb@x.org,q,a,b,right\n\
        A@X.ORG,r,a,b,left\nrow 4,q,a,b,left\n";
    let parse =
        |text: &str| isostudy_responses::parse(text.as_bytes(), Path::new("x"), None, &Mapping::default());
    let reading = parse(text).unwrap();
    let ids: Vec<&str> = reading.responses.participants.iter().map(|p| p.id.as_str()).collect();
    assert_eq!(ids, ["row 2'", "row 2", "row 4'", "row 4"]);
    assert!(!all_of(&reading).contains('@'), "{}", all_of(&reading));
    let twice = fault(parse(&text.replace("A@X.ORG,r", "A@X.ORG,q")).unwrap_err());
    assert!(
        matches!(&twice, Fault::DuplicateAnswer { row: 5, participant, .. } if participant == "row 2'"),
        "{twice}"
    );
    assert!(!twice.to_string().contains('@'), "{twice}");
    let declared = Mapping { participant_column: Some(2), ..Mapping::default() };
    let text = format!("{GOOGLE}x,a@x.org,L,NP,R\ny,A@x.org,L,NP,L\n");
    let refused = parse_with(&text, &declared).unwrap_err();
    assert!(matches!(&refused, Fault::DuplicateParticipant { row: 3, first: 2, .. }), "{refused}");
    assert!(!refused.to_string().contains('@'), "{refused}");
}

/// Whoever has an address counts once, whatever the order of the rows; everybody else counts a row.
#[test]
fn as_many_people_as_addresses() {
    let mut random = Pcg64::seed_from_u64(7);
    for _ in 0..300 {
        let rows = random.random_range(1..40);
        let people: Vec<u32> = (0..rows).map(|_| random.random_range(0..20)).collect();
        let mut text = MICROSOFT.to_owned();
        for (i, &person) in people.iter().enumerate() {
            let address = match person {
                0..5 => "anonymous".to_owned(),
                _ => format!("P{person}@example.org"),
            };
            let address = if random.random() { address.to_lowercase() } else { address };
            let choices = ["L", "NP", "R"].map(|_| ["L", "NP", "R"][random.random_range(0..3)]);
            text += &format!("{i},{i},,{address},,{}\n", choices.join(","));
        }
        let mut known: Vec<u32> = people.iter().copied().filter(|&person| person >= 5).collect();
        let all = known.len();
        known.sort_unstable();
        known.dedup();
        let refused = parse(&text);
        assert_eq!(refused.is_err(), known.len() < all);
        for duplicates in [Duplicates::First, Duplicates::Last] {
            let reading = isostudy_responses::parse(
                text.as_bytes(),
                Path::new("x"),
                Some(&plan()),
                &keeping(duplicates),
            );
            let reading = reading.unwrap();
            assert_eq!(reading.responses.participants.len(), people.len() - all + known.len());
            assert_eq!(reading.responses.answers.len(), 3 * reading.responses.participants.len());
            assert!(!all_of(&reading).contains('@'));
        }
    }
}
