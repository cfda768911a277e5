//! How what is wrong, and what was done, is worded. Other tests assert variants, places and numbers; words stand in
//! `messages.txt` alone, which is compared as a whole. `ISOSTUDY_BLESS=1` writes it anew; its difference is then read before it is
//! committed.

use crate::study::{export, parse_with, plan, synonyms};
use isostudy_responses::{
    Duplicates, Fault, Format, Mapping, MappingError, ReadError, Responses, SidesSource, Unknown,
    UnknownCell, WriteError,
};
use std::fmt::Write;
use std::path::Path;

/// Each fault once.
fn faults() -> Vec<Fault> {
    let text = str::to_owned;
    let cell = |row, raw: &str| UnknownCell { row, column: 2, question: text("Q1"), raw: text(raw) };
    let again = |ordered| {
        let [participant, question] = ["p", "Q1"].map(text);
        Fault::DuplicateAnswer { row: 4, first: 2, participant, question, ordered }
    };
    vec![
        Fault::Empty,
        Fault::NoAnswers { row: 2 },
        Fault::TooLarge { bytes: 20, limit: 10 },
        Fault::Encoding { encoding: "UTF-8", row: 2 },
        Fault::Separators { first: ',', second: ';', cells: 2 },
        Fault::UnclosedQuote { row: 2, column: 3 },
        Fault::CellCount { row: 2, expected: 3, found: 1 },
        Fault::UnknownFormat { header: text("\"when\", \"what\""), formats: text("table, long") },
        Fault::Formats { readings: vec![(Format::Long, text("a mark")), (Format::Table, text("another"))] },
        Fault::NotThatFormat { format: Format::Long, row: 1, missing: text("no `choice`") },
        Fault::NoPlan { format: Format::GoogleForms },
        Fault::PlannedName { name: text("xxx"), limit: text("is too long") },
        Fault::UnknownQuestion { column: 2, name: text("Q99") },
        Fault::DuplicateColumn { column: 2, first: 1, name: text("question Q1") },
        Fault::MissingColumn { name: text("left") },
        Fault::Columns { first: text("columns 2 to 4"), second: text("columns 3 to 5") },
        Fault::NoColumns { reason: text("2 columns for 3 questions") },
        Fault::Declaration { key: "question_columns", value: text("9"), limit: text("the file has 3") },
        Fault::UnknownAnswers { cells: vec![cell(2, "Vlevo")], known: text("words in en") },
        Fault::UnknownAnswers {
            cells: (2..9).map(|row| cell(row, "?")).collect(),
            known: text("words in en"),
        },
        Fault::Cell { row: 2, column: 3, name: text("count"), cell: text("-1"), limit: text("is no count") },
        Fault::Pair { row: 2, question: text("Q1"), declared: text("a and b"), found: text("a and c") },
        Fault::TwoPairs {
            row: 5,
            question: text("Q1"),
            pair: text("a and c"),
            first_row: 2,
            first_pair: text("a and b"),
        },
        Fault::NoSuchPair { row: 2, found: text("a and b on Sphere") },
        Fault::NoSides { row: 1 },
        Fault::NoSidesOf { row: 2, question: text("Q1-r") },
        Fault::NotInForm { row: 2, form: text("1"), question: text("Q1") },
        Fault::OtherStimulus {
            row: 2,
            stimulus: text("kobu shows b and a"),
            form: text("1"),
            question: text("Q1"),
            asked: text("a and b"),
        },
        Fault::TooManyAnswers { row: 3, answers: 20, limit: 10 },
        Fault::DuplicateParticipant { row: 4, first: 2, participant: text("p") },
        Fault::DuplicateAddress { row: 4, first: 2 },
        again(true),
        again(false),
        Fault::TwoForms { row: 3, participant: text("p"), form: text("B"), first: text("A") },
        Fault::Archive(text("a zip file that is damaged")),
        Fault::Json { row: 2, message: text("not JSON") },
    ]
}

/// Files that are refused for a reason that stands in a fault's field.
const REFUSED: [&str; 13] = [
    "Q1,Q2,Q3\nL,maybe,R\n",
    "Timestamp,Q2,x,y\n1,Left,Left,Left\n",
    "Timestamp,w,w,w,w\n1,Left,Left,Left,Right\n",
    "Timestamp,x,y\n1,Left,why\n",
    "record_id,Q1,Q2,Q3,Q4\n1,yes,left,none,right\n2,yes,right,right,none\n",
    "record_id,lastpage,submitdate,Q1,Q2,Q3\n1,,,Left,Left,Left\n",
    "when,what\n1,2\n",
    "[1, 2]",
    "participant,question,left,right,choice,role\np,Q1,a,b,left,student\n",
    "participant,question,left,right,choice\np,,a,b,left\n",
    "participant,question,left,right,choice,count\np,Q1,a,b,left,2\n",
    "participant,question,left,right,choice,count\n,Q1,a,b,left,many\n",
    "participant,question,left,right,choice,count\n,Q1,a,b,left,99999999999\n",
];

/// Files that are read, with remarks.
const REMARKED: [&str; 9] = [
    "Q1,Q2,Q3\nL,L,R,,\n\nR,R,R\n\n\n",
    "participant,Q1,Q2,Q3\np,L,NA,R\nq,na,NP, NA \n",
    "participant,question,left,right,choice,order,rt_ms\np,Q1,a,b,left,NA,NA\np,Q2,a,c,NA,first,soon\n",
    "participant,question,left,right,choice,count\np,Q1,a,b,left,1\n,Q1,a,b,right,2\np,Q2,a,c,none,0\n",
    "question,left,right,choice,count,order,rt_ms\nQ1,a,b,left,2,3,812\nQ1,a,b,left,1,4,900\n",
    "participant,question,left,right,choice,input,mood\np,Q1,a,b,left,mouth,good\n",
    "Timestamp,w,w,w\nx,Left,Right,Left\ny,R,R,R\nx,Left,Right,Left\n",
    "Timestamp,Username,a,b,c\nx,a@x.org,L,NP,R\ny,a@x.org,L,NP,L\n",
    "observer,session,scene,condition_A,condition_B,is_A_selected\np,1,,a,b,1\np,2,,a,c,1\np,1,,a,b,0\n",
];

#[test]
fn messages_are_worded_as_in_their_file() {
    let mut said = String::from("# Faults\n");
    let line = |said: &mut String, what: &dyn std::fmt::Display| writeln!(said, "{what}").unwrap();
    let faults = faults();
    faults.iter().for_each(|fault| line(&mut said, fault));
    let source = include_str!("../../src/error.rs");
    let (_, declared) = source.split_once("pub enum Fault {").unwrap();
    let listed = faults.iter().map(std::mem::discriminant).collect::<std::collections::HashSet<_>>();
    assert_eq!(listed.len(), declared.matches("#[error(").count(), "a fault is not listed here");

    said += "\n# Other errors\n";
    let file = Path::new("a.csv");
    let source = std::io::Error::other("disk on fire");
    line(&mut said, &ReadError::File { file: file.into(), source });
    line(&mut said, &ReadError::Content { file: file.into(), fault: Box::new(Fault::Empty) });
    let [value, limit] = ["\"fish\"", "must be one of table, long"].map(str::to_owned);
    line(&mut said, &MappingError { key: "format", value, limit });
    line(&mut said, &WriteError::Ties { format: "pwcmp", ties: 3 });

    said += "\n# Where sides come from\n";
    let sources = [SidesSource::InFile, SidesSource::FromCodeNames, SidesSource::FromForms];
    for source in
        sources.into_iter().chain([SidesSource::AsListed, SidesSource::NoSides, SidesSource::Unknown])
    {
        line(&mut said, &format_args!("{}: {}", source.name(), source.sentence()));
    }
    let counted = Responses { without_participant: 2, ..Responses::default() };
    line(&mut said, &counted.assumptions()[1]);

    said += "\n# Files that are refused\n";
    for text in REFUSED {
        line(&mut said, &parse_with(text, &Mapping::default()).map(|_| text).unwrap_err());
    }

    said += "\n# Files that are read\n";
    let lenient = Mapping { unknown: Unknown::LeaveOut, duplicates: Duplicates::First, ..Mapping::default() };
    for text in REMARKED {
        line(&mut said, &parse_with(text, &lenient).unwrap().report);
    }
    let mut exports: Vec<_> =
        std::fs::read_dir(export("")).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    exports.sort();
    for name in exports {
        let mapping = match name.to_str() {
            Some("jspsych.csv") => synonyms("0", "1", "2"),
            Some("redcap.csv") => synonyms("1", "2", "3"),
            _ => Mapping::default(),
        };
        let bytes = std::fs::read(export("").join(&name)).unwrap();
        let mapping = Mapping { duplicates: Duplicates::First, ..mapping };
        let reading = isostudy_responses::parse(&bytes, Path::new(&name), Some(&plan()), &mapping);
        line(&mut said, &reading.unwrap().report);
    }

    let golden = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/it/messages.txt");
    if std::env::var_os("ISOSTUDY_BLESS").is_some_and(|value| value == "1") {
        std::fs::write(&golden, &said).unwrap();
    }
    let expected = std::fs::read_to_string(&golden).unwrap();
    for (expected, said) in expected.lines().zip(said.lines()) {
        assert_eq!(said, expected, "messages.txt; ISOSTUDY_BLESS=1 writes it anew");
    }
    assert_eq!(said, expected, "messages.txt; ISOSTUDY_BLESS=1 writes it anew");
}
