//! What is wrong with a file is said, with its place; what could be read in two ways is not read.

use crate::study::{bad_cell, export, fault, only_unknown, open, parse, parse_with, plan, remarks, said};
use isostudy_responses::{Duplicates, Fault, Format, Mapping, ReadError, Unknown, UnknownCell};
use std::io::Write;
use std::path::Path;

fn error(text: &str) -> Fault {
    parse(text).map(|reading| said(&reading).join("\n")).unwrap_err()
}

/// Bytes read for the three questions, which must be refused.
fn error_of(bytes: &[u8]) -> Fault {
    fault(isostudy_responses::parse(bytes, Path::new("x"), Some(&plan()), &Mapping::default()).unwrap_err())
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
        assert_eq!(error(text), Fault::Empty);
    }
    assert_eq!(error("Q1,Q2,Q3"), Fault::NoAnswers { row: 2 });
    assert_eq!(error("Q1,Q2,Q3\n,,\n"), Fault::NoAnswers { row: 3 });
    assert_eq!(error("participant,question,left,right,choice\n"), Fault::NoAnswers { row: 2 });
    let missing =
        isostudy_responses::read(Path::new("/nowhere/x.csv"), None, &Mapping::default()).unwrap_err();
    assert!(matches!(missing, ReadError::File { file, .. } if file == Path::new("/nowhere/x.csv")));
}

#[test]
fn headers_that_do_not_fit() {
    assert_eq!(error("Q1,Q99,Q3\nL,L,L\n"), Fault::UnknownQuestion { column: 2, name: "Q99".into() });
    let twice = |first, column, name: &str| Fault::DuplicateColumn { column, first, name: name.into() };
    assert_eq!(error("Q1,Q1,Q3\nL,L,L\n"), twice(1, 2, "question Q1"));
    let missing = |name: &str| Fault::MissingColumn { name: name.into() };
    assert_eq!(error("Q1,Q3\nL,L\n"), missing("question Q2"));
    assert!(matches!(
        error("when,what\n1,2\n"),
        Fault::UnknownFormat { header, .. } if header == "\"when\", \"what\""
    ));
    assert_eq!(error("participant,question,left,left,right,choice\n"), twice(3, 4, "left"));
    assert_eq!(error("participant,question,right,choice\np,Q1,b,left\n"), missing("left"));
    assert!(matches!(open("Q1,Q2\nL,R\n").unwrap_err(), Fault::UnknownFormat { .. }));
    let google = isostudy_responses::read(&export("google.csv"), None, &Mapping::default()).unwrap_err();
    assert_eq!(fault(google), Fault::NoPlan { format: Format::GoogleForms });
}

#[test]
fn rows_that_do_not_fit() {
    assert_eq!(error("Q1,Q2,Q3\nL,L\n"), Fault::CellCount { row: 2, expected: 3, found: 2 });
    assert_eq!(error("Q1,Q2,Q3\nL,L,R,R\n"), Fault::CellCount { row: 2, expected: 3, found: 4 });
    assert_eq!(error("Q1,Q2,Q3\nL,\"L,R\n"), Fault::UnclosedQuote { row: 2, column: 2 });
    let surplus = parse("Q1,Q2,Q3\nL,L,R,,\n\nR,R,R\n\n\n").unwrap();
    assert_eq!(remarks(&surplus), ["2 noted 5 3", "3 noted"]);
    assert_eq!(surplus.responses.participants.len(), 2);
}

#[test]
fn answers_in_an_unknown_language() {
    let czech = "Timestamp,Která?,Která?,Která?\n1,Vlevo,Nic,Vpravo\n2,Vpravo,Vpravo,Vlevo\n";
    let Fault::UnknownAnswers { cells, known } = error(czech) else { panic!("not refused for its words") };
    let first = UnknownCell { row: 2, column: 2, question: "Q1".into(), raw: "Vlevo".into() };
    assert_eq!((cells.len(), &cells[0]), (6, &first));
    assert!(known.contains("en, de, fr"), "{known}");
    let read = parse_with(czech, &crate::study::synonyms("Vlevo", "Nic", "Vpravo")).unwrap();
    assert_eq!(said(&read)[..3], ["1 Q1 a<b", "1 Q2 a=c", "1 Q3 b>c"]);
}

#[test]
fn a_stray_word_is_refused_or_listed_as_declared() {
    let text = "Q1,Q2,Q3\nL,maybe,R\nR,R,R\n";
    assert_eq!(only_unknown(&error(text)), (2, 2, "Q2", "maybe"));
    let leave_out = Mapping { unknown: Unknown::LeaveOut, ..Mapping::default() };
    let read = parse_with(text, &leave_out).unwrap();
    assert_eq!(read.responses.answers.len(), 5);
    assert_eq!(remarks(&read), ["2:2 rejected Q2"]);
    let nothing = parse_with("Q1,Q2,Q3\n?,?,?\n", &leave_out).unwrap_err();
    assert_eq!(nothing, Fault::NoAnswers { row: 3 });
}

#[test]
fn ten_megabytes_in_a_cell() {
    let cell = "x".repeat(10 << 20);
    let refused = error(&format!("Q1,Q2,Q3\nL,{cell},R\n"));
    let (row, column, _, raw) = only_unknown(&refused);
    assert!((row, column) == (2, 2) && raw.contains("10485760"));
    let header = error(&format!("Q1,Q2,{cell}\nL,R,R\n"));
    assert!(matches!(&header, Fault::UnknownQuestion { column: 3, name } if name.contains("10485760")));
    assert!([refused, header].iter().all(|fault| fault.to_string().len() < 500));
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
        assert!(open(&table(&longest)).is_ok(), "{name}");
        let refused = open(&table(&beyond)).unwrap_err();
        let (row, at, of, cell) = bad_cell(&refused);
        assert_eq!((row, at, of), (2, column + 1, name));
        assert!(cell.starts_with("üüü") && cell.contains("201"), "{cell}");
        let huge = open(&table(&"x".repeat(10 << 20))).unwrap_err();
        assert!(bad_cell(&huge).3.contains("10485760") && huge.to_string().len() < 300, "{huge}");
    }
    for table in ["participant,Q1,Q2,Q3\nNAME,L,R,\n", "form,Q1,Q2,Q3\nNAME,L,R,\n"] {
        assert!(parse(&table.replace("NAME", &longest)).is_ok());
        let refused = error(&table.replace("NAME", &beyond));
        assert!(matches!(&refused, Fault::Cell { row: 2, column: 1, limit, .. } if limit.contains("200")));
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
    let refused = Mapping::of(&section).unwrap_err();
    assert_eq!(refused.key, "pairs");
    assert!(refused.value.contains("10000") && refused.limit.contains("200"), "{refused}");
    let pair = isostudy_responses::PlannedPair {
        question: beyond,
        left: "a".into(),
        right: "b".into(),
        object: String::new(),
        group: String::new(),
    };
    let plan = isostudy_responses::Plan::of_pairs(&[pair]).unwrap();
    let refused = isostudy_responses::parse(b"Q1\nL\n", Path::new("x"), Some(&plan), &Mapping::default());
    let refused = fault(refused.unwrap_err());
    assert!(matches!(&refused, Fault::PlannedName { name, .. } if name.starts_with("xxx")), "{refused}");
    assert!(refused.to_string().len() < 200);
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
    assert_eq!(error(text), Fault::DuplicateParticipant { row: 4, first: 2, participant: "p".into() });
    let keep = |duplicates| parse_with(text, &Mapping { duplicates, ..Mapping::default() }).unwrap();
    let first = said(&keep(Duplicates::First));
    assert_eq!(first[..3], ["p Q1 a<b", "p Q2 a<c", "p Q3 b<c"]);
    let last = keep(Duplicates::Last);
    assert_eq!(said(&last), ["p Q3 b<c", "q Q1 a>b", "q Q2 a>c", "q Q3 b>c", "p Q1 a>b", "p Q2 a>c"]);
    assert_eq!(last.report.count(isostudy_responses::Kind::Rejected), 2);

    let long = |rest: &str| format!("participant,question,left,right,choice,order\np,Q1,a,b,left,1\n{rest}");
    let again = error(&long("p,Q1,a,b,right,1\n"));
    assert!(matches!(&again, Fault::DuplicateAnswer { row: 3, first: 2, question, .. } if question == "Q1"));
    assert_eq!(parse(&long("p,Q1,a,b,right,2\n")).unwrap().responses.answers.len(), 2);
    assert_eq!(parse(&long("p,Q1,b,a,right,1\n")).unwrap().responses.answers.len(), 2);
    let forms = "participant,form,question,choice\np,A,Q1,left\np,B,Q2,left\n";
    let [participant, form, first] = ["p", "B", "A"].map(str::to_owned);
    assert_eq!(error(forms), Fault::TwoForms { row: 3, participant, form, first });
}

#[test]
fn pairs_that_are_not_the_studys() {
    let row = |row: &str| error(&format!("participant,question,left,right,choice\n{row}\n"));
    let other = |found: &str| {
        let [question, declared, found] = ["Q1", "a and b", found].map(str::to_owned);
        Fault::Pair { row: 2, question, declared, found }
    };
    assert_eq!(row("p,Q1,a,c,left"), other("a and c"));
    assert_eq!(row("p,Q1,a,a,left"), other("a and a"));
    assert_eq!(bad_cell(&row("p,Q9,a,b,left")), (2, 2, "question", "Q9"));
    assert_eq!(bad_cell(&row("p,,a,b,left")), (2, 2, "question", ""));
}

#[test]
fn two_readings_show_both() {
    // Four columns of answers for three questions.
    let both = |text: &str| match error(text) {
        Fault::Columns { first, second } => (first, second),
        other => panic!("{other}"),
    };
    let (first, second) = both("Timestamp,w,w,w,w\n1,Left,Left,Left,Right\n");
    assert!(first.contains("columns 2 to 4") && second.contains("columns 3 to 5"), "{first}; {second}");
    // The tool's own numbering says something else than the positions.
    let shifted = "record_id,Q1,Q2,Q3,Q4\n1,yes,left,none,right\n2,yes,right,right,none\n";
    let (first, second) = both(shifted);
    assert!(first.contains("columns 2 to 4") && first.contains("column 2 (\"Q1\")"), "{first}");
    assert!(second.contains("columns 3 to 5"), "{second}");
    let (first, second) = both("Timestamp,Q2,x,y\n1,Left,Left,Left\n");
    assert!(first.contains("column 2 is Q2") && second.contains("Q1"), "{first}; {second}");
    let Fault::Formats { readings } = error("record_id,lastpage,submitdate,Q1,Q2,Q3\n1,,,Left,Left,Left\n")
    else {
        panic!("two formats fit")
    };
    let formats: Vec<Format> = readings.into_iter().map(|(format, _)| format).collect();
    assert_eq!(formats, [Format::LimeSurvey, Format::RedCap]);
    assert!(matches!(
        error("Timestamp,x,y\n1,Left,why\n"),
        Fault::NoColumns { reason } if reason.contains("3 questions") && reason.contains("column 2;")
    ));
    let separators = Fault::Separators { first: ',', second: ';', cells: 2 };
    assert_eq!(error("Q1,Q2;Q3\nL,R;L\n"), separators);
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
    let declared = |mapping: Mapping| match read(mapping).unwrap_err() {
        Fault::Declaration { key, value, .. } => (key, value),
        other => panic!("{other}"),
    };
    assert_eq!(declared(beyond), ("first_question_column", "4".into()));
    let twice = Mapping { question_columns: Some(vec![2, 2, 3]), ..Mapping::default() };
    assert_eq!(declared(twice).0, "question_columns");
    let alien = Mapping { questions: Some(vec!["Q9".into()]), ..Mapping::default() };
    assert_eq!(declared(alien), ("questions", "Q9".into()));
}

#[test]
fn archives_and_workbooks_that_are_damaged_or_too_large() {
    let sound = std::fs::read(export("microsoft.xlsx")).unwrap();
    let said_of = |bytes: &[u8]| match error_of(bytes) {
        Fault::Archive(said) => said,
        other => panic!("{other}"),
    };
    for cut in [5, 100, sound.len() / 2, sound.len() - 30] {
        assert!(said_of(&sound[..cut]).contains("damaged"), "{cut}");
    }
    let bomb = zip("bomb.csv", &vec![b'L'; 64 << 20]);
    assert!(bomb.len() < 100_000);
    let refused = said_of(&bomb);
    assert!(refused.contains("bomb.csv") && refused.contains("16777216"), "{refused}");
    assert!(said_of(&zip("picture.gif", b"GIF89a")).contains("CSV"));
    let mut two = zip::ZipWriter::new(std::io::Cursor::new(Vec::new()));
    for name in ["a.csv", "b.csv", "__MACOSX/._a.csv"] {
        two.start_file(name, zip::write::SimpleFileOptions::default()).unwrap();
    }
    let two = two.finish().unwrap().into_inner();
    assert!(said_of(&two).contains("(a.csv, b.csv)"));
}

#[test]
fn encodings_that_do_not_keep_their_promise() {
    let broken = Fault::Encoding { encoding: "UTF-8", row: 2 };
    assert_eq!(error_of(b"\xef\xbb\xbfQ1,Q2,Q3\nL,\xff,R\n"), broken);
    let deep = "[".repeat(100_000);
    for text in [&b"[{\"trial_type\": 1"[..], b"[1, 2]", deep.as_bytes()] {
        assert!(matches!(error_of(text), Fault::Json { .. }), "{}", error_of(text));
    }
}

#[test]
fn a_header_that_is_nearly_right_says_what_it_lacks() {
    let refused = |header: &str| open(&format!("{header}\na,b,c,d,e\n")).unwrap_err().to_string();
    for (header, lacks) in [
        ("participant,question,left,right,choise", "no column choice (did you mean it by \"choise\"?)"),
        ("person,left,right,choice,at", "no column participant (did you mean it by \"person\"?)"),
        ("participant,left,choice,at,on", "no column right. Known"),
        (
            "person,left,right,answer,at",
            "participant (did you mean it by \"person\"?) and no column choice (did",
        ),
    ] {
        let said = refused(header);
        assert!(
            said.contains("The long format is near, but there is no column") && said.contains(lacks),
            "{said}"
        );
    }
    assert!(!refused("when,what,why,where,who").contains("is near"));
    // Named by the user, it is held against that format.
    let mapping = Mapping { format: Some(Format::Long), ..Mapping::default() };
    let said = parse_with("participant,question,choise\na,Q1,left\n", &mapping).unwrap_err().to_string();
    assert!(said.contains("no column choice (did you mean it by \"choise\"?)"), "{said}");
}

#[test]
fn what_a_header_does_without_is_said() {
    let rule = |text: &str| open(text).unwrap().report.to_string();
    let pairs = rule("participant,left,right,choice\np,a,b,left\n");
    assert!(pairs.contains("the header has participant, left, right and choice, and no question"), "{pairs}");
    let counts = rule("left,right,choice,count\na,b,left,3\n");
    assert!(counts.contains("the header has count, left, right and choice, and no question"), "{counts}");
}

#[test]
fn an_answer_that_is_nearly_right_is_asked_about() {
    let said = open("participant,question,left,right,choice\np,q,a,b,lefft\n").unwrap_err().to_string();
    assert!(said.contains("\"lefft\" is not an answer; did you mean left? Known: "), "{said}");
}
