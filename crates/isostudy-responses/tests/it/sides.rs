//! Files that do not name sides, of studies that show participants different ones.

use crate::study::{bad_cell, fault, parse_with, remarks};
use isostudy_design::Study;
use isostudy_design::forms::{KeyEntry, Questionnaire, Role};
use isostudy_responses::{Choice, Fault, Mapping, Plan, Reading};
use std::collections::BTreeMap;
use std::path::Path;

/// A study of the configs, with passages replaced.
pub(crate) fn study(name: &str, replacements: &[(&str, &str)]) -> Study {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../configs").join(name);
    // Any file that is there will do for the bunny.
    let mut text = std::fs::read_to_string(&path).unwrap().replace("../cache/bunny.ply", name);
    for (from, to) in replacements {
        assert!(text.contains(from), "{from}");
        text = text.replace(from, to);
    }
    Study::parse(&text, &path).unwrap()
}

pub(crate) fn key(study: &Study) -> Vec<KeyEntry> {
    Questionnaire::of(study).unwrap().key()
}

pub(crate) fn read(text: &str, study: &Study) -> Result<Reading, Fault> {
    let plan = Plan::of_study(study);
    isostudy_responses::parse(text.as_bytes(), Path::new("x.csv"), Some(&plan), &Mapping::default())
        .map_err(fault)
}

fn refused(text: &str, study: &Study) -> Fault {
    read(text, study).map(|reading| format!("{:?}", reading.responses.answers)).unwrap_err()
}

/// What everybody presses who likes integrated better than collapsed better than unclustered, and body-centred better than
/// simple cubic.
fn pressed(entry: &KeyEntry) -> &'static str {
    let value = |id: &str| {
        let [lattice, clustering] = id.as_bytes()[3..] else { panic!("{id}") };
        2 * b"upi".iter().position(|&c| c == clustering).unwrap() + usize::from(lattice == b'b')
    };
    match value(&entry.left).cmp(&value(&entry.right)) {
        std::cmp::Ordering::Less => "R",
        std::cmp::Ordering::Equal => "NP",
        std::cmp::Ordering::Greater => "L",
    }
}

/// One row a form with what was pressed; `columns` are the questions, empty cells what a form does not ask.
fn table(first: &str, columns: &[String], key: &[KeyEntry], row: impl Fn(usize) -> String) -> String {
    let mut cells: BTreeMap<usize, BTreeMap<&str, &str>> = BTreeMap::new();
    for entry in key {
        cells.entry(entry.form).or_default().insert(&entry.question, pressed(entry));
    }
    let mut text = format!("{first},{}\n", columns.join(","));
    for (form, cells) in cells {
        let of = columns.iter().map(|column| cells.get(column.as_str()).copied().unwrap_or(""));
        text += &format!("{},{}\n", row(form), of.collect::<Vec<_>>().join(","));
    }
    text
}

fn questions(study: &Study) -> Vec<String> {
    study.comparisons.iter().map(|comparison| comparison.question.clone()).collect()
}

/// Questions, repeats and controls of the forms, each once.
fn everything(study: &Study, key: &[KeyEntry]) -> Vec<String> {
    let mut columns = questions(study);
    for entry in key.iter().filter(|entry| entry.role != Role::Training) {
        if !columns.contains(&entry.question) {
            columns.push(entry.question.clone());
        }
    }
    columns
}

/// Every answer is about what the key says its form showed, on those sides; returns how many there are.
fn check(reading: &Reading, key: &[KeyEntry]) -> usize {
    let answers = &reading.responses;
    let shown: BTreeMap<(usize, &str), &KeyEntry> =
        key.iter().map(|entry| ((entry.form, entry.question.as_str()), entry)).collect();
    for answer in &answers.answers {
        let form = answers.participants[answer.participant as usize].form.as_deref().unwrap();
        let question = &answers.questions[answer.question as usize];
        // Controls of one id with different items are told apart by a longer name.
        let id = question.id.split(' ').next().unwrap();
        let entry = shown[&(form.parse().unwrap(), id)];
        let [left, right] = [answer.left, answer.right].map(|item| answers.items[item as usize].as_str());
        assert_eq!([left, right], [entry.left.as_str(), entry.right.as_str()], "form {form}, {id}");
        let pressed = ["L", "NP", "R"].iter().position(|&code| code == pressed(entry)).unwrap();
        assert_eq!(answer.choice, Choice::ALL[pressed]);
    }
    assert!(answers.sides_recorded);
    answers.answers.len()
}

#[test]
fn a_table_with_forms_has_the_sides_that_people_saw() {
    for (name, replacements, asked) in [
        ("balanced.toml", &[][..], 36 * 27),
        ("balanced.toml", &[("order = \"latin-square\"", "order = \"shuffled\"")], 36 * 27),
        ("balanced.toml", &[("max_questions = 32", "max_questions = 14")], 36 * 9),
        ("two-methods.toml", &[], 24 * 2),
    ] {
        let study = study(name, replacements);
        let key = key(&study);
        let text = table("participant,form", &questions(&study), &key, |form| format!("p{form},{form}"));
        let reading = read(&text, &study).unwrap();
        assert_eq!(check(&reading, &key), asked, "{name}");
        // Everybody chose the better one: unanimous, and nothing else, whichever way round it was shown.
        let chosen: std::collections::BTreeSet<(u32, Option<u32>)> =
            reading.responses.answers.iter().map(|answer| (answer.question, answer.chosen())).collect();
        assert_eq!(chosen.len(), study.comparisons.len());
        // What a form does not ask is not missing.
        assert_eq!(remarks(&reading), [""; 0]);
    }
}

#[test]
fn repeats_and_controls_may_have_columns() {
    let study = study("balanced.toml", &[]);
    let key = key(&study);
    let columns = everything(&study, &key);
    let text = table("participant,form", &columns, &key, |form| format!("p{form},{form}"));
    let reading = read(&text, &study).unwrap();
    assert_eq!(check(&reading, &key), 36 * 32);
    let answers = &reading.responses;
    let of = |role: Role| answers.questions.iter().filter(move |question| question.role == role);
    assert_eq!([Role::Comparison, Role::Repeat, Role::Control].map(|role| of(role).count()), [27, 3, 2]);
    assert!(of(Role::Repeat).all(|q| q.id.ends_with("-r") && !q.group.is_empty() && !q.object.is_empty()));
    let training = text.replacen("control-1", "training-1", 1);
    assert_eq!(read(&training, &study).unwrap().responses.answers.len(), 36 * 31);
}

#[test]
fn exports_with_a_form_column_are_read_by_it() {
    let study = study("balanced.toml", &[]);
    let key = key(&study);
    for (first, row) in [
        ("Timestamp,Form", "t,"),
        ("Respondent ID,Collector ID,form", "9NUMBER,1,"),
        ("record_id,FORM", "NUMBER,"),
        ("ID,Start time,Completion time,Email,Name,form", "NUMBER,8:00,8:01,,,"),
        ("id,submitdate,lastpage,startlanguage,seed,form", "NUMBER,2024,3,en,1,"),
    ] {
        let text = table(first, &questions(&study), &key, |form| {
            format!("{}{form}", row.replace("NUMBER", &form.to_string()))
        });
        let reading = read(&text, &study).unwrap();
        assert_eq!(check(&reading, &key), 36 * 27, "{first}");
        let without = table(first.rsplit_once(',').unwrap().0, &questions(&study), &key, |form| {
            row.replace("NUMBER", &form.to_string()).trim_end_matches(',').to_owned()
        });
        let refused = refused(&without, &study);
        assert!(matches!(refused, Fault::NoSides { .. }), "{first}: {refused}");
    }
}

#[test]
fn tables_without_forms_are_refused_with_what_to_add() {
    let study = study("balanced.toml", &[]);
    let key = key(&study);
    let text = table("participant", &questions(&study), &key, |form| format!("p{form}"));
    for text in [
        text.as_str(),
        "participant,question,choice\np,Q1,L\n",
        "trial_type,trial_index,participant,question,response\nx,1,p,Q1,L\n",
    ] {
        assert_eq!(refused(text, &study), Fault::NoSides { row: 1 });
    }
    let table = |form: &str| {
        refused(&table("participant,form", &questions(&study), &key, |n| format!("p{n},{form}")), &study)
    };
    let not = |refused: Fault, form: &str| {
        assert_eq!(bad_cell(&refused), (2, 2, "form", form));
        assert!(matches!(refused, Fault::Cell { limit, .. } if limit.contains("1 to 36") != form.is_empty()));
    };
    for cell in ["A", "0", "37", "-1", "1.5", "99999999999999999999999", ""] {
        not(table(cell), cell);
    }
    let long = |row: &str| refused(&format!("participant,form,question,choice\n{row}\n"), &study);
    not(long("p,40,Q1,L"), "40");
    not(long("p,,Q1,L"), "");
}

#[test]
fn what_a_form_does_not_ask_cannot_be_answered() {
    let study = study("balanced.toml", &[("max_questions = 32", "max_questions = 14")]);
    let key = key(&study);
    let asked: Vec<&str> =
        key.iter().filter(|entry| entry.form == 1).map(|entry| entry.question.as_str()).collect();
    let other = questions(&study).into_iter().find(|id| !asked.contains(&id.as_str())).unwrap();
    let want = Fault::NotInForm { row: 2, form: "1".into(), question: other.clone() };
    let long = refused(&format!("participant,form,question,choice\np,1,{other},L\n"), &study);
    assert_eq!(long, want);
    let mut columns = questions(&study);
    columns.retain(|id| *id != other);
    let text = format!("form,{other},{}\n1,L{}\n", columns.join(","), ",".repeat(columns.len()));
    assert_eq!(refused(&text, &study), want);
}

/// The key's lines as rows of the long format with these columns.
fn long(columns: &str, key: &[KeyEntry]) -> String {
    let mut text = format!("{columns}\n");
    for entry in key {
        let cell = |column: &str| match column {
            "participant" => format!("p{}", entry.form),
            "form" => entry.form.to_string(),
            "order" => entry.order.to_string(),
            "question" => entry.question.clone(),
            "stimulus" => entry.stimulus.clone(),
            "left" => entry.left.clone(),
            "right" => entry.right.clone(),
            "choice" => pressed(entry).to_owned(),
            _ => panic!("{column}"),
        };
        text += &format!("{}\n", columns.split(',').map(cell).collect::<Vec<_>>().join(","));
    }
    text
}

#[test]
fn rows_without_sides_are_read_by_form_or_code_name() {
    for name in ["balanced.toml", "two-methods.toml"] {
        let study = study(name, &[]);
        let key = key(&study);
        let all = key.iter().filter(|entry| entry.role != Role::Training).count();
        let full = read(&long("participant,form,order,question,left,right,choice", &key), &study).unwrap();
        assert_eq!(check(&full, &key), all);
        for columns in [
            "participant,form,order,question,choice",
            "participant,form,order,question,choice,stimulus",
            "participant,form,order,question,left,right,choice,stimulus",
        ] {
            let reading = read(&long(columns, &key), &study).unwrap();
            assert_eq!(check(&reading, &key), all, "{columns}");
            assert_eq!(reading.responses.questions, full.responses.questions, "{columns}");
        }
        // Code names say all that forms do.
        let reading = read(&long("participant,question,choice,stimulus", &key), &study).unwrap();
        let sides = |reading: &Reading| -> Vec<[u32; 2]> {
            reading.responses.answers.iter().map(|answer| [answer.left, answer.right]).collect()
        };
        assert_eq!(sides(&reading), sides(&full));
    }
}

#[test]
fn code_names_that_contradict_are_refused() {
    let study = study("balanced.toml", &[]);
    let key = key(&study);
    let entry = key.iter().find(|entry| entry.role == Role::Comparison).unwrap();
    let mirrored =
        key.iter().find(|other| other.question == entry.question && other.left == entry.right).unwrap();
    let row = |stimulus: &str| {
        let KeyEntry { form, question, .. } = entry;
        refused(
            &format!("participant,form,question,choice,stimulus\np,{form},{question},L,{stimulus}\n"),
            &study,
        )
    };
    let KeyEntry { form, question, left, right, .. } = entry;
    let code = &mirrored.stimulus;
    let other = Fault::OtherStimulus {
        row: 2,
        stimulus: format!("{code} shows {right} and {left}"),
        form: form.to_string(),
        question: question.clone(),
        asked: format!("{left} and {right}"),
    };
    assert_eq!(row(code), other);
    assert_eq!(bad_cell(&row("qqqq")), (2, 5, "stimulus", "qqqq"));
    let other = key.iter().find(|other| other.question == "Q9").unwrap();
    let text = format!("participant,question,choice,stimulus\np,Q1,L,{}\n", other.stimulus);
    let refused = refused(&text, &study);
    assert!(
        matches!(&refused, Fault::Pair { row: 2, declared, .. } if declared == "ss_bu and ss_bi"),
        "{refused}"
    );
}

#[test]
fn code_names_that_the_study_lacks_are_told() {
    let study = study("balanced.toml", &[]);
    let key = key(&study);
    let columns = "participant,form,order,question,left,right,choice,stimulus";
    let known = read(&long(columns, &key), &study).unwrap();
    assert!(
        known.responses.unknown_stimuli.is_none() && known.report.count(isostudy_responses::Kind::Noted) > 0
    );
    let said = known.responses.assumptions().len();

    let foreign: Vec<KeyEntry> =
        key.iter().map(|entry| KeyEntry { stimulus: "zzzz".into(), ..entry.clone() }).collect();
    let reading = read(&long(columns, &foreign), &study).unwrap();
    let answers = reading.responses.answers.len();
    let unknown = reading.responses.unknown_stimuli.unwrap();
    assert_eq!(unknown.answers, answers as u64);
    let assumptions = reading.responses.assumptions();
    assert_eq!(assumptions.len(), said + 1);
    let row = unknown.row;
    let told = [format!(" {answers} "), "\"zzzz\"".into(), format!(" {row}.")];
    assert!(told.iter().all(|part| assumptions[said].contains(part)), "{}", assumptions[said]);
    let want = format!("{row}:8 noted {}", answers - 1);
    assert!(remarks(&reading).contains(&want), "{want}");

    // One among others, after rows that are no answers; without a study, no name is unknown.
    let one =
        "participant,question,left,right,choice,stimulus\np,Q1,ss_bu,ss_bi,,aaaa\np,Q1,ss_bu,ss_bi,L,zzzz\n";
    let reading = read(one, &study).unwrap();
    assert_eq!(remarks(&reading).last().unwrap(), "3:6 noted");
    assert!(reading.responses.assumptions()[said].contains(" 1 answer "));
    assert!(
        parse_with(&one.replace("ss_bu,ss_bi", "a,b"), &Mapping::default())
            .unwrap()
            .responses
            .unknown_stimuli
            .is_none()
    );
}

#[test]
fn trials_without_sides_are_read_by_form() {
    let study = study("two-methods.toml", &[]);
    let key = key(&study);
    let mut text = "trial_type,trial_index,participant,form,question,response\n".to_owned();
    for entry in key.iter().filter(|entry| entry.role != Role::Training) {
        let KeyEntry { form, order, question, .. } = entry;
        text += &format!("x,{order},p{form},{form},{question},{}\n", pressed(entry));
    }
    let reading = read(&text, &study).unwrap();
    assert_eq!(check(&reading, &key), 24 * 6);
}

#[test]
fn listed_sides_may_be_left_out() {
    let listed = study("balanced.toml", &[("sides = \"balanced\"", "sides = \"as-listed\"")]);
    let key = key(&listed);
    // Repeats are shown the other way round, and controls show what they show: no form has to say so.
    let text = table("participant", &everything(&listed, &key), &key, |form| format!("p{form}"));
    let reading = read(&text, &listed).unwrap();
    let answers = &reading.responses;
    assert_eq!(answers.answers.len(), 36 * 32);
    for answer in &answers.answers {
        let id = &answers.questions[answer.question as usize].id;
        let entry = key.iter().find(|entry| entry.question == *id).unwrap();
        let [left, right] = [answer.left, answer.right].map(|item| answers.items[item as usize].as_str());
        assert_eq!([left, right], [entry.left.as_str(), entry.right.as_str()], "{id}");
    }
    let rows = read(&long("participant,question,choice", &key), &listed).unwrap();
    assert_eq!(rows.responses.answers.len(), 36 * 32);

    // A study without forms says nothing of repeats.
    let paper = study("paper.toml", &[]);
    let row = |row: &str| read(&format!("participant,question,choice\n{row}\n"), &paper);
    assert!(row("p,Q1,L").unwrap().responses.sides_recorded);
    let want = Fault::NoSidesOf { row: 2, question: "Q1-r".into() };
    assert_eq!(row("p,Q1-r,L").unwrap_err(), want);
    let plain = parse_with("participant,question,choice\np,Q1-r,L\n", &Mapping::default()).unwrap_err();
    assert_eq!(plain, want);
}

/// What was assumed can be said.
mod source {
    use super::*;
    use isostudy_responses::SidesSource;

    #[test]
    fn of_sides_is_known() {
        let study = study("balanced.toml", &[]);
        let key = key(&study);
        let wide = table("participant,form", &questions(&study), &key, |form| format!("p{form},{form}"));
        for (text, want) in [
            (wide, SidesSource::FromForms),
            (long("participant,form,question,choice", &key), SidesSource::FromForms),
            (long("participant,form,question,choice,stimulus", &key), SidesSource::FromCodeNames),
            (long("participant,question,left,right,choice", &key), SidesSource::InFile),
        ] {
            let reading = read(&text, &study).unwrap();
            assert_eq!((reading.responses.sides, reading.report.sides), (want, want));
            assert_eq!(reading.responses.assumptions(), [want.sentence()]);
            assert!(reading.report.to_string().contains(&format!("; sides: {}", want.name())));
        }
        let paper = super::study("paper.toml", &[]);
        let listed = read("participant,question,choice\np,Q1,L\n", &paper).unwrap();
        assert_eq!(listed.responses.sides, SidesSource::AsListed);
        assert_eq!(listed.responses.assumptions(), [SidesSource::AsListed.sentence()]);
        assert!(Plan::of_study(&paper).shows_listed_sides() && !Plan::of_study(&study).shows_listed_sides());
    }
}
