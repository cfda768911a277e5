//! One export of each tool, with its quirks, read as people have them. All were written for this test.

use crate::study::{fault, read, remarks, said, synonyms};
use isostudy_responses::{Fault, Format, Mapping};

/// What the two people of most exports answered.
fn both(first: &str, second: &str, seconds: usize) -> Vec<String> {
    let of = |who: &str, signs: [&str; 3]| {
        [("Q1", "a", "b"), ("Q2", "a", "c"), ("Q3", "b", "c")]
            .iter()
            .zip(signs)
            .map(|((question, left, right), sign)| format!("{who} {question} {left}{sign}{right}"))
            .collect::<Vec<_>>()
    };
    let mut all = of(first, ["<", "=", ">"]);
    all.extend(of(second, [">", ">", "="]).into_iter().take(seconds));
    all
}

#[test]
fn surveys_are_detected_and_read() {
    use Format::*;
    for (name, format, answers) in [
        ("table.csv", Table, both("1", "2", 3)),
        ("google.csv", GoogleForms, both("1", "2", 2)),
        ("google.csv.zip", GoogleForms, both("1", "2", 2)),
        ("google_sheet_de.csv", GoogleForms, both("1", "2", 3)),
        ("google_27.csv", GoogleForms, both("1", "2", 3)),
        ("microsoft.csv", MicrosoftForms, both("1", "2", 3)),
        ("microsoft_de.csv", MicrosoftForms, both("1", "2", 3)),
        ("microsoft.xlsx", MicrosoftForms, both("1", "2", 2)),
        ("microsoft_inline.xlsx", MicrosoftForms, both("1", "2", 3)),
        ("qualtrics.csv", Qualtrics, both("R_1", "R_2", 2)),
        ("qualtrics_utf16.tsv", Qualtrics, both("R_1", "R_2", 2)),
        ("qualtrics_legacy.csv", Qualtrics, both("R_1", "R_2", 3)),
        ("limesurvey.csv", LimeSurvey, both("7", "8", 2)),
        ("limesurvey_text.csv", LimeSurvey, both("1", "2", 3)),
        ("surveymonkey.csv", SurveyMonkey, both("11842", "11843", 3)),
    ] {
        let reading = read(name, &Mapping::default());
        assert_eq!(reading.report.format, format, "{name}");
        assert_eq!(said(&reading), answers, "{name}\n{}", reading.report);
        // Declaring what was detected changes nothing.
        let declared = Mapping { format: Some(format), ..Mapping::default() };
        assert_eq!(read(name, &declared).responses, reading.responses, "{name}");
        assert!(reading.responses.sides_recorded);
    }
}

#[test]
fn the_rules_that_fired_are_said() {
    for (name, rules) in [
        ("table.csv", ["header", "separator \",\"", "by their ids"]),
        ("google.csv.zip", ["\"Timestamp\"", "Which is smoother_.csv", "columns 3 to 5"]),
        ("google_sheet_de.csv", ["\"Zeitstempel\"", "UTF-8", "by their names"]),
        ("microsoft_de.csv", ["ID and \"Startzeit\"", "Windows-1252", "columns 7, 9, 10"]),
        ("microsoft.xlsx", ["ID and \"Start time\"", "first sheet (\"Form1\")", "columns 7 to 9"]),
        ("qualtrics_utf16.tsv", ["{\"ImportId\"", "UTF-16", "by position"]),
        ("jspsych.json", ["JSON", "UTF-8", "participants by"]),
        ("jatos.txt", ["JSON", "UTF-8", "participants by"]),
        ("limesurvey.csv", ["submitdate", "separator \";\"", "by their names"]),
    ] {
        let report = read(name, &Mapping::default()).report.to_string();
        for rule in rules {
            assert!(report.contains(rule), "{rule} is not in: {report}");
        }
    }
}

#[test]
fn what_is_not_taken_as_it_stands_is_listed() {
    let of = |name: &str| remarks(&read(name, &Mapping::default()));
    // `3 noted 2 1 3 Q3`: in row 3, participant 2 left 1 of 3 questions unanswered, which is Q3.
    assert_eq!(of("google.csv"), ["1:2 noted", "3:3 repaired", "3 noted 2 1 3 Q3"]);
    assert_eq!(of("google_sheet_de.csv"), ["1:6 noted"]);
    assert_eq!(of("microsoft.csv"), ["3:7 repaired"]);
    assert_eq!(of("microsoft.xlsx"), ["3 noted 2 1 3 Q3"]);
    assert_eq!(of("qualtrics.csv"), ["4:3 rejected", "6:6 noted R_2", "6 noted R_2 1 3 Q3"]);
    assert_eq!(of("limesurvey.csv"), ["3:2 noted 8", "3 noted 8 1 3 Q3"]);
    assert_eq!(of("surveymonkey.csv"), ["2:13 noted"]);
}

#[test]
fn the_order_of_questions_is_recovered() {
    let reading = read("qualtrics.csv", &Mapping::default());
    let orders: Vec<_> = reading.responses.answers.iter().map(|answer| answer.order).collect();
    assert_eq!(orders, [Some(2), Some(3), Some(1), Some(1), Some(2)]);
}

#[test]
fn a_table_with_ids_and_forms() {
    let reading = read("table_ids.csv", &Mapping::default());
    assert_eq!(said(&reading), ["p1 Q3 b>c", "p1 Q1 a<b", "p1 Q2 a=c", "p2 Q1 a>b", "p2 Q2 a>c"]);
    let forms: Vec<_> = reading.responses.participants.iter().map(|p| p.form.as_deref()).collect();
    assert_eq!(forms, [Some("A"), Some("B")]);
    assert_eq!(remarks(&reading), ["3 noted p2 1 3 Q3"]);
}

#[test]
fn the_long_format_keeps_sides_order_time_controls_and_repeats() {
    let reading = read("long.csv", &Mapping::default());
    let want = ["p1 Q1 a<b", "p1 Q2 a=c", "p1 Q3 b>c", "p2 Q1 a>b", "p2 Q1 b<a", "p2 check a<a"];
    assert_eq!(said(&reading), want);
    let answers = &reading.responses.answers;
    let times: Vec<_> = answers.iter().map(|a| (a.order, a.rt_ms)).collect();
    assert_eq!(
        times[..4],
        [(Some(2), Some(812.5)), (Some(1), None), (Some(3), Some(1500.0)), (Some(1), Some(700.5))]
    );
    assert!(reading.responses.questions[3].is_control());
    let declared = |i: usize| reading.responses.declared_choice(&answers[i]);
    assert_eq!(
        (declared(3), declared(4)),
        (isostudy_responses::Choice::Right, isostudy_responses::Choice::Right)
    );
    assert_eq!(remarks(&reading), ["5:6 repaired"]);
    // Without a plan the file says the same.
    let alone =
        isostudy_responses::read(&crate::study::export("long.csv"), None, &Mapping::default()).unwrap();
    assert_eq!(said(&alone), want);
    assert_eq!(alone.responses.questions.len(), 4);
}

/// What the questionnaire's own export has beside the answers is known; another column is noted.
#[test]
fn the_questionnaires_own_columns_are_no_surprise() {
    let remarked = |extra: &str| {
        let text = format!(
            "participant,question,left,right,choice,role,stimulus{extra}\np1,Q1,a,b,L,comparison,tani{extra}\n"
        );
        let path = std::path::Path::new("answers.csv");
        remarks(&isostudy_responses::parse(text.as_bytes(), path, None, &Mapping::default()).unwrap())
    };
    assert_eq!(remarked(""), [""; 0]);
    assert_eq!(remarked(",mood"), ["1:8 noted"]);
}

#[test]
fn trials_are_read_by_their_question() {
    let buttons = synonyms("0", "1", "2");
    let csv = read("jspsych.csv", &buttons);
    assert_eq!(csv.report.format, Format::JsPsych);
    assert_eq!(said(&csv), ["p1 Q1 a<b", "p1 Q2 c=a", "p1 Q3 b>c", "p2 Q1 a>b"]);
    assert_eq!(csv.responses.answers[0].rt_ms, Some(812.4));
    assert_eq!(remarks(&csv), ["1 noted 1"]);
    let json = read("jspsych.json", &Mapping::default());
    assert_eq!(said(&json), ["1 Q1 a<b", "1 Q2 c=a", "1 Q3 b>c"]);
    let jatos = read("jatos.txt", &Mapping::default());
    assert_eq!(jatos.report.format, Format::Jatos);
    assert_eq!(said(&jatos), ["1 Q1 a<b", "1 Q2 c=a", "1 Q3 b>c", "2 Q1 a>b", "2 Q2 a>c"]);
    // Which button is which only the experiment knows.
    let refused = isostudy_responses::read(
        &crate::study::export("jspsych.csv"),
        Some(&crate::study::plan()),
        &Mapping::default(),
    );
    let Fault::UnknownAnswers { cells, .. } = fault(refused.unwrap_err()) else { panic!("not its words") };
    let first = &cells[0];
    assert_eq!((first.row, first.column, &*first.question, &*first.raw), (3, 3, "Q1", "0"));
}

#[test]
fn webmushra_does_not_say_which_side_was_which() {
    let reading = read("webmushra.csv", &Mapping::default());
    assert_eq!(reading.report.format, Format::WebMushra);
    assert!(!reading.responses.sides_recorded);
    assert_eq!(said(&reading), ["row 2 Q1 a<b", "row 2 Q2 a=c", "row 2 Q3 b>c", "row 5 Q1 a>b"]);
    assert_eq!(remarks(&reading), ["2 noted", "6 noted Q2"]);
}

#[test]
fn redcap_codes_are_declared() {
    let reading = read("redcap.csv", &synonyms("1", "2", "3"));
    assert_eq!(reading.report.format, Format::RedCap);
    assert_eq!(said(&reading), ["1 Q1 a<b", "1 Q2 a=c", "1 Q3 b>c", "2 Q1 a>b", "2 Q2 a>c"]);
    // Headers and positions agree on the columns; what is missing is what the codes mean.
    let path = crate::study::export("redcap.csv");
    let refused =
        isostudy_responses::read(&path, Some(&crate::study::plan()), &Mapping::default()).unwrap_err();
    let Fault::UnknownAnswers { cells, .. } = fault(refused) else { panic!("not its words") };
    let first = &cells[0];
    assert_eq!((first.row, first.column, &*first.question, &*first.raw), (2, 5, "Q1", "1"));
    let raw: std::collections::BTreeSet<&str> = cells.iter().map(|cell| cell.raw.as_str()).collect();
    assert!(raw.into_iter().eq(["1", "2", "3"]));
    assert_eq!(remarks(&reading)[0], "3:8 noted 2");
}

#[test]
fn other_programs_comparisons_are_read() {
    let arena = read("arenakit.csv", &Mapping::default());
    assert_eq!(arena.report.format, Format::Arenakit);
    assert_eq!(said(&arena), ["p1 Q1 a<b", "p1 Q2 c=a", "p1 Q3 b>c", "p2 Q1 b<a"]);
    assert!(arena.responses.sides_recorded);
    let pwcmp = read("pwcmp.csv", &Mapping::default());
    assert_eq!(pwcmp.report.format, Format::Pwcmp);
    assert_eq!(said(&pwcmp), ["1 Q1 a<b", "1 Q3 c>b", "2 Q1 b<a"]);
    assert!(!pwcmp.responses.sides_recorded);
    for name in ["arenakit.csv", "pwcmp.csv"] {
        assert_eq!(remarks(&read(name, &Mapping::default())), [""; 0], "{name}");
    }
    let counted = read("long_counts.csv", &Mapping::default());
    let people = [
        "row 2.1 Q1 a<b",
        "row 2.2 Q1 a<b",
        "row 2.3 Q1 a<b",
        "p1 Q1-r b>a",
        "row 5.1 check c=c",
        "row 5.2 check c=c",
    ];
    assert_eq!(said(&counted), people);
}
