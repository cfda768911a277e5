//! What is wrong with a file is said, with its place; what could be read in two ways is not read.

use crate::study::{export, parse, parse_with, plan, remarks, said};
use isostudy_responses::{Duplicates, Mapping, Unknown};
use std::io::Write;
use std::path::Path;

fn error(text: &str) -> String {
    parse(text).map(|reading| said(&reading).join("\n")).unwrap_err()
}

/// Bytes read for the three questions, which must be refused.
fn error_of(bytes: &[u8]) -> String {
    isostudy_responses::parse(bytes, Path::new("x"), Some(&plan()), &Mapping::default())
        .unwrap_err()
        .to_string()
}

fn zip(name: &str, content: &[u8]) -> Vec<u8> {
    let mut zip = zip::ZipWriter::new(std::io::Cursor::new(Vec::new()));
    let deflated =
        zip::write::SimpleFileOptions::default().compression_method(zip::CompressionMethod::Deflated);
    zip.start_file(name, deflated).unwrap();
    zip.write_all(content).unwrap();
    zip.finish().unwrap().into_inner()
}

#[test]
fn files_without_answers() {
    for text in ["", "\u{feff}", "\r\n\n", " "] {
        assert_eq!(error(text), "x.csv: row 1: empty; expected a header and answers");
    }
    assert_eq!(error("Q1,Q2,Q3"), "x.csv: row 2: no answers under the header");
    assert_eq!(error("Q1,Q2,Q3\n,,\n"), "x.csv: row 3: no answers under the header");
    assert_eq!(
        error("participant,question,left,right,choice\n"),
        "x.csv: row 2: no answers under the header"
    );
    let missing =
        isostudy_responses::read(Path::new("/nowhere/x.csv"), None, &Mapping::default()).unwrap_err();
    assert_eq!(missing.to_string(), "/nowhere/x.csv: cannot be read");
}

#[test]
fn headers_that_do_not_fit() {
    assert_eq!(
        error("Q1,Q99,Q3\nL,L,L\n"),
        "x.csv: row 1, column 2: \"Q99\" is not a question of this study"
    );
    assert_eq!(error("Q1,Q1,Q3\nL,L,L\n"), "x.csv: row 1, column 2: question Q1 is already in column 1");
    assert_eq!(error("Q1,Q3\nL,L\n"), "x.csv: row 1: no column for question Q2");
    let unknown = error("when,what\n1,2\n");
    assert!(
        unknown.starts_with("x.csv: row 1: no known format: the header begins \"when\", \"what\""),
        "{unknown}"
    );
    let long = "participant,question,left,left,right,choice\n";
    assert_eq!(error(long), "x.csv: row 1, column 4: left is already in column 3");
    assert_eq!(error("participant,question,right,choice\np,Q1,b,left\n"), "x.csv: row 1: no column for left");
    let alone =
        isostudy_responses::parse(b"Q1,Q2\nL,R\n", Path::new("x"), None, &Mapping::default()).unwrap_err();
    assert!(alone.to_string().contains("no known format"), "{alone}");
    let google =
        isostudy_responses::read(&export("google.csv"), None, &Mapping::default()).unwrap_err().to_string();
    assert!(google.ends_with("give a study file or a mapping with `pairs`"), "{google}");
}

#[test]
fn rows_that_do_not_fit() {
    assert_eq!(error("Q1,Q2,Q3\nL,L\n"), "x.csv: row 2: 2 cells; the header has 3");
    assert_eq!(error("Q1,Q2,Q3\nL,L,R,R\n"), "x.csv: row 2: 4 cells; the header has 3");
    assert_eq!(error("Q1,Q2,Q3\nL,\"L,R\n"), "x.csv: row 2, column 2: a quote is opened and never closed");
    let surplus = parse("Q1,Q2,Q3\nL,L,R,,\n\nR,R,R\n\n\n").unwrap();
    let want =
        ["2 noted: 5 cells under 3 headers; those beyond are empty", "3 noted: blank row inside the table"];
    assert_eq!(remarks(&surplus), want);
    assert_eq!(surplus.responses.participants.len(), 2);
}

#[test]
fn answers_in_an_unknown_language() {
    let czech = "Timestamp,Která?,Která?,Která?\n1,Vlevo,Nic,Vpravo\n2,Vpravo,Vpravo,Vlevo\n";
    let said_of = error(czech);
    assert!(
        said_of.starts_with("x.csv: row 2, column 2 (Q1): \"Vlevo\" is not an answer; row 2, column 3"),
        "{said_of}"
    );
    assert!(
        said_of.contains("; and 1 cell more. Known") && said_of.contains("words in en, de, fr"),
        "{said_of}"
    );
    let read = parse_with(czech, &crate::study::synonyms("Vlevo", "Nic", "Vpravo")).unwrap();
    assert_eq!(said(&read)[..3], ["1 Q1 a<b", "1 Q2 a=c", "1 Q3 b>c"]);
}

#[test]
fn a_stray_word_is_refused_or_listed_as_declared() {
    let text = "Q1,Q2,Q3\nL,maybe,R\nR,R,R\n";
    assert!(error(text).contains("row 2, column 2 (Q2): \"maybe\" is not an answer. Known"));
    let leave_out = Mapping { unknown: Unknown::LeaveOut, ..Mapping::default() };
    let read = parse_with(text, &leave_out).unwrap();
    assert_eq!(read.responses.answers.len(), 5);
    assert_eq!(remarks(&read), ["2:2 rejected: not an answer to Q2: left out"]);
    let nothing = parse_with("Q1,Q2,Q3\n?,?,?\n", &leave_out).unwrap_err();
    assert_eq!(nothing, "x.csv: row 3: no answers under the header");
}

#[test]
fn ten_megabytes_in_a_cell() {
    let cell = "x".repeat(10 << 20);
    let refused = error(&format!("Q1,Q2,Q3\nL,{cell},R\n"));
    assert!(refused.contains("... (10485760 characters)\" is not an answer") && refused.len() < 500);
    let header = error(&format!("Q1,Q2,{cell}\nL,R,R\n"));
    assert!(header.contains("(10485760 characters)") && header.len() < 500);
}

#[test]
fn names_longer_than_a_name_is() {
    let (longest, beyond) =
        ("ü".repeat(isostudy_responses::LONGEST_NAME), "ü".repeat(isostudy_responses::LONGEST_NAME + 1));
    let header = "participant,question,left,right,object,group,form,choice";
    for (column, name) in header.split(',').enumerate().take(7) {
        let table = |cell: &str| {
            let mut cells = ["p", "q", "a", "b", "o", "g", "A", "left"];
            cells[column] = cell;
            format!("{header}\n{}\n", cells.join(","))
        };
        let read = |cell: &str| {
            let table = table(cell);
            isostudy_responses::parse(table.as_bytes(), Path::new("x.csv"), None, &Mapping::default())
        };
        assert!(read(&longest).is_ok(), "{name}");
        let refused = read(&beyond).unwrap_err().to_string();
        let start = format!("x.csv: row 2, column {} ({name}): \"üüü", column + 1);
        assert!(refused.starts_with(&start), "{refused}");
        assert!(refused.ends_with("... (201 characters)\" must have at most 200 characters"), "{refused}");
        let huge = read(&"x".repeat(10 << 20)).unwrap_err().to_string();
        assert!(huge.contains("(10485760 characters)") && huge.len() < 300, "{huge}");
    }
    for table in ["participant,Q1,Q2,Q3\nNAME,L,R,\n", "form,Q1,Q2,Q3\nNAME,L,R,\n"] {
        assert!(parse(&table.replace("NAME", &longest)).is_ok());
        let refused = error(&table.replace("NAME", &beyond));
        assert!(
            refused.starts_with("x.csv: row 2, column 1 (") && refused.contains("at most 200"),
            "{refused}"
        );
    }
}

#[test]
fn declared_names_longer_than_a_name_is() {
    let beyond = "x".repeat(10_000);
    let pair = isostudy_design::config::PairSection {
        question: "Q1".into(),
        left: beyond.clone(),
        right: "b".into(),
        object: String::new(),
        group: String::new(),
    };
    let section = isostudy_design::config::ResponsesSection { pairs: vec![pair], ..Default::default() };
    let refused = Mapping::of(&section).unwrap_err().to_string();
    assert!(refused.starts_with("responses.pairs = \"xxx"), "{refused}");
    assert!(refused.ends_with("(10000 characters)\": must have at most 200 characters"), "{refused}");
    let pair = isostudy_responses::PlannedPair {
        question: beyond,
        left: "a".into(),
        right: "b".into(),
        object: String::new(),
        group: String::new(),
    };
    let plan = isostudy_responses::Plan::of_pairs(&[pair]).unwrap();
    let refused = isostudy_responses::parse(b"Q1\nL\n", Path::new("x"), Some(&plan), &Mapping::default());
    let refused = refused.unwrap_err().to_string();
    assert!(refused.starts_with("x: the study's name \"xxx") && refused.len() < 200, "{refused}");
}

#[test]
fn names_made_up_for_pairs_are_names() {
    // One question on two objects, all of whose names are as long as a name may be.
    let name = |c: &str| c.repeat(isostudy_responses::LONGEST_NAME);
    let row =
        |object: &str| format!("p,{},{},{},{},{},left\n", name("q"), name("a"), name("b"), object, name("g"));
    let text =
        format!("participant,question,left,right,object,group,choice\n{}{}", row(&name("o")), row("p"));
    let read =
        |text: &[u8]| isostudy_responses::parse(text, Path::new("x"), None, &Mapping::default()).unwrap();
    let reading = read(text.as_bytes());
    let ids: Vec<&str> = reading.responses.questions.iter().map(|q| q.id.as_str()).collect();
    assert!(
        ids[0] != ids[1] && ids.iter().all(|id| id.chars().count() <= isostudy_responses::LONGEST_NAME),
        "{ids:?}"
    );
    let mut long = Vec::new();
    isostudy_responses::write_long(&reading.responses, &mut long).unwrap();
    assert_eq!(said(&read(&long)), said(&reading));
}

#[test]
fn somebody_twice() {
    let text = "participant,Q1,Q2,Q3\np,L,L,L\nq,R,R,R\np,R,R,\n";
    assert!(error(text).starts_with("x.csv: row 4: participant p is already in row 2"));
    let keep = |duplicates| parse_with(text, &Mapping { duplicates, ..Mapping::default() }).unwrap();
    let first = said(&keep(Duplicates::First));
    assert_eq!(first[..3], ["p Q1 a<b", "p Q2 a<c", "p Q3 b<c"]);
    let last = keep(Duplicates::Last);
    assert_eq!(said(&last), ["p Q3 b<c", "q Q1 a>b", "q Q2 a>c", "q Q3 b>c", "p Q1 a>b", "p Q2 a>c"]);
    assert_eq!(last.report.count(isostudy_responses::Kind::Rejected), 2);

    let long = |rest: &str| format!("participant,question,left,right,choice,order\np,Q1,a,b,left,1\n{rest}");
    assert!(
        error(&long("p,Q1,a,b,right,1\n"))
            .contains("row 3: p has already answered Q1 with the same sides in row 2")
    );
    assert_eq!(parse(&long("p,Q1,a,b,right,2\n")).unwrap().responses.answers.len(), 2);
    assert_eq!(parse(&long("p,Q1,b,a,right,1\n")).unwrap().responses.answers.len(), 2);
    let forms = "participant,form,question,choice\np,A,Q1,left\np,B,Q2,left\n";
    assert_eq!(error(forms), "x.csv: row 3: participant p has form \"B\" here and \"A\" before");
}

#[test]
fn pairs_that_are_not_the_studys() {
    let row = |row: &str| error(&format!("participant,question,left,right,choice\n{row}\n"));
    assert_eq!(row("p,Q1,a,c,left"), "x.csv: row 2: question Q1 compares a and b, not a and c");
    assert_eq!(row("p,Q1,a,a,left"), "x.csv: row 2: question Q1 compares a and b, not a and a");
    let unknown = row("p,Q9,a,b,left");
    assert!(
        unknown.contains("row 2, column 2 (question): \"Q9\" is not a question of this study"),
        "{unknown}"
    );
    assert!(row("p,,a,b,left").contains("column 2 (question): \"\" must not be empty"));
}

#[test]
fn two_readings_show_both() {
    // Four columns of answers for three questions.
    let four = error("Timestamp,w,w,w,w\n1,Left,Left,Left,Right\n");
    assert!(
        four.contains("two readings fit: columns 2 to 4 for the study's 3 questions; or columns 3 to 5"),
        "{four}"
    );
    // The tool's own numbering says something else than the positions.
    let shifted = "record_id,Q1,Q2,Q3,Q4\n1,yes,left,none,right\n2,yes,right,right,none\n";
    let shifted = error(shifted);
    assert!(
        shifted.contains("by names: columns 2 to 4, of which column 2 (\"Q1\") holds something else"),
        "{shifted}"
    );
    assert!(shifted.contains("by position: columns 3 to 5"), "{shifted}");
    let partly = error("Timestamp,Q2,x,y\n1,Left,Left,Left\n");
    assert!(partly.contains("column 2 is Q2 by its name; or it is Q1 by its position"), "{partly}");
    let both = error("record_id,lastpage,submitdate,Q1,Q2,Q3\n1,,,Left,Left,Left\n");
    assert!(both.contains("it may be limesurvey") && both.contains("or redcap"), "{both}");
    let few = error("Timestamp,x,y\n1,Left,why\n");
    assert!(
        few.contains("the study has 3 questions; known answers and nothing else are in column 2;"),
        "{few}"
    );
    assert!(error("Q1,Q2;Q3\nL,R;L\n").contains("',' and ';' both split every row into 2 cells"));
}

#[test]
fn declared_positions_settle_it() {
    let text = "Timestamp,w,w,w,w\n1,Left,Left,Left,Right\n";
    let read = |mapping: Mapping| parse_with(text, &mapping);
    let first = Mapping { first_question_column: Some(3), ..Mapping::default() };
    assert_eq!(said(&read(first).unwrap()), ["1 Q1 a<b", "1 Q2 a<c", "1 Q3 b>c"]);
    let columns = Mapping { question_columns: Some(vec![5, 2, 3]), ..Mapping::default() };
    assert_eq!(said(&read(columns).unwrap()), ["1 Q1 a>b", "1 Q2 a<c", "1 Q3 b<c"]);
    let questions = Some(vec!["Q3".into(), "Q1".into()]);
    let some = Mapping { questions, question_columns: Some(vec![5, 2]), ..Mapping::default() };
    assert_eq!(said(&read(some).unwrap()), ["1 Q3 b>c", "1 Q1 a<b"]);
    let beyond = Mapping { first_question_column: Some(4), ..Mapping::default() };
    assert!(read(beyond).unwrap_err().contains("first_question_column = 4: 2 columns from there on, and"));
    let twice = Mapping { question_columns: Some(vec![2, 2, 3]), ..Mapping::default() };
    assert!(read(twice).unwrap_err().contains("a column is named twice"));
    let alien = Mapping { questions: Some(vec!["Q9".into()]), ..Mapping::default() };
    assert!(read(alien).unwrap_err().contains("questions = Q9: is not a question of this study"));
}

#[test]
fn archives_and_workbooks_that_are_damaged_or_too_large() {
    let sound = std::fs::read(export("microsoft.xlsx")).unwrap();
    for cut in [5, 100, sound.len() / 2, sound.len() - 30] {
        assert!(error_of(&sound[..cut]).contains("zip file that is cut short or damaged"), "{cut}");
    }
    let bomb = zip("bomb.csv", &vec![b'L'; 64 << 20]);
    assert!(bomb.len() < 100_000);
    let refused = error_of(&bomb);
    assert!(refused.contains("bomb.csv in the zip file makes it hold more than 16777216 bytes"), "{refused}");
    assert!(error_of(&zip("picture.gif", b"GIF89a")).contains("without a CSV"));
    let mut two = zip::ZipWriter::new(std::io::Cursor::new(Vec::new()));
    for name in ["a.csv", "b.csv", "__MACOSX/._a.csv"] {
        two.start_file(name, zip::write::SimpleFileOptions::default()).unwrap();
    }
    let two = two.finish().unwrap().into_inner();
    assert!(error_of(&two).contains("several tables (a.csv, b.csv)"));
}

#[test]
fn encodings_that_do_not_keep_their_promise() {
    assert_eq!(error_of(b"\xef\xbb\xbfQ1,Q2,Q3\nL,\xff,R\n"), "x: row 2: not UTF-8 text");
    assert!(error_of(b"[{\"trial_type\": 1").contains("not JSON"));
    assert!(error_of(b"[1, 2]").contains("expected an array of trials"));
    let deep = "[".repeat(100_000);
    assert!(error_of(deep.as_bytes()).contains("not JSON"));
}
