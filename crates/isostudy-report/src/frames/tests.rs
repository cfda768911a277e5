use super::*;
use crate::data::frames;
use crate::fixture::{self, Everything};
use isostudy_design::Study;
use isostudy_design::record::BenchSample;
use isostudy_inference::inputs::Inputs;
use isostudy_inference::tally::{QuestionCount, Tally};
use isostudy_responses::Choice;
use std::collections::BTreeMap;

fn texts(long: &LongFrame, name: &str) -> Vec<Option<String>> {
    let column = long.frame.column(name).unwrap();
    match long.texts.iter().find(|(of, _)| *of == name) {
        Some((_, texts)) => {
            column.u32().unwrap().iter().map(|place| Some(texts[place? as usize].clone())).collect()
        }
        None => column.str().unwrap().iter().map(|text| text.map(str::to_owned)).collect(),
    }
}

fn said(long: &LongFrame, name: &str) -> Vec<String> {
    texts(long, name).into_iter().map(|text| text.unwrap_or_else(|| "-".into())).collect()
}

fn truths(long: &LongFrame, name: &str) -> Vec<bool> {
    long.frame.column(name).unwrap().bool().unwrap().iter().map(Option::unwrap).collect()
}

#[test]
fn the_same_inputs_give_the_same_bytes() {
    let bytes = || -> Vec<(&str, Vec<u8>)> {
        let all = Everything::of(fixture::study());
        frames(&all.inputs()).iter().map(|frame| (frame.name, frame.to_parquet().unwrap())).collect()
    };
    let (first, second) = (bytes(), bytes());
    assert_eq!(first.iter().map(|(name, _)| *name).collect::<Vec<_>>(), ["answers", "meshes", "times"]);
    assert_eq!(first, second);
    assert!(first.iter().all(|(_, bytes)| bytes.starts_with(b"PAR1") && bytes.ends_with(b"PAR1")));
}

#[test]
fn what_has_no_rows_has_no_frame() {
    let study = fixture::study();
    let inputs = Inputs {
        study: &study,
        meshes: &[],
        bench: None,
        chunks: &[],
        stored: &[],
        answers: None,
        left_out: &[],
    };
    assert!(frames(&inputs).is_empty());
}

/// Somebody who saw the first pair mirrored, then as listed in another session; and somebody with neither place nor time.
#[test]
fn an_answer_is_on_the_sides_that_were_shown() {
    let study = fixture::study();
    let first = &study.comparisons[0];
    let (left, right) = (&first.left, &first.right);
    let text = format!(
        "participant,order,question,left,right,choice,rt_ms\n\
         anna@example.org,3,Q1,{right},{left},left,1500\nbo,,Q1,{left},{right},none,\n"
    );
    let answers = fixture::parse(&text, &study);
    let long = super::answers(Some(&study), &answers, &BTreeSet::from([1]), &COLUMNS);
    let methods = [left.method.to_string(), right.method.to_string()];
    assert_eq!(said(&long, "left"), [methods[1].clone(), methods[0].clone()]);
    assert_eq!(said(&long, "right"), methods);
    assert_eq!(said(&long, "choice"), ["left", "none"]);
    assert_eq!(said(&long, "chosen"), [methods[1].as_str(), "-"]);
    assert_eq!(said(&long, "object"), vec![study.file.objects[first.object].id.clone(); 2]);
    assert_eq!(said(&long, "group"), vec![study.groups[first.group].id.clone(); 2]);
    let number = |name: &str| long.frame.column(name).unwrap().u32().unwrap().iter().collect::<Vec<_>>();
    assert_eq!((number("participant"), number("place")), (vec![Some(1), Some(2)], vec![Some(3), None]));
    let seconds: Vec<Option<f64>> = long.frame.column("seconds").unwrap().f64().unwrap().iter().collect();
    assert_eq!(seconds, [Some(1.5), None]);
    assert_eq!(
        (truths(&long, "counted"), truths(&long, "sides_recorded")),
        (vec![true, false], vec![true, true])
    );
    let bytes = long.to_parquet().unwrap();
    assert!(!bytes.windows(4).any(|part| part == b"anna"), "people's names stay in their file");
}

/// Where nobody knows the sides, they are the listed ones, and the choice goes with them.
#[test]
fn unknown_sides_are_the_listed_ones() {
    let study = fixture::study();
    let mut answers = fixture::answers(&study);
    let mirrored = &mut answers.answers[0];
    (mirrored.left, mirrored.right, mirrored.choice) = (mirrored.right, mirrored.left, Choice::Left);
    answers.sides_recorded = false;
    let long = super::answers(Some(&study), &answers, &BTreeSet::new(), &COLUMNS);
    let comparison = &study.comparisons[answers.answers[0].question as usize];
    assert_eq!(said(&long, "left")[0], comparison.left.method.to_string());
    assert_eq!(said(&long, "choice")[0], "right");
    assert_eq!(said(&long, "chosen")[0], comparison.right.method.to_string());
    assert!(truths(&long, "sides_recorded").iter().all(|recorded| !recorded));
}

/// Counted one by one, with some answers turned and some not given.
#[test]
fn tallies_are_those_of_the_answers() {
    let study = fixture::study();
    let mut answers = fixture::answers(&study);
    let mut place = 0;
    answers.answers.retain(|_| {
        place += 1;
        place % 7 != 3
    });
    for (i, answer) in answers.answers.iter_mut().enumerate() {
        answer.choice = Choice::ALL[i * i % 3];
        if i % 5 == 0 {
            (answer.left, answer.right) = (answer.right, answer.left);
        }
    }
    let mut questions = vec![QuestionCount::default(); study.comparisons.len()];
    let mut rows = BTreeMap::new();
    let mut methods = BTreeMap::new();
    for answer in &answers.answers {
        let comparison = &study.comparisons[answer.question as usize];
        let chosen = answer.chosen().map(|item| study.configurations[item as usize].id.method);
        let count = &mut questions[answer.question as usize];
        match answers.declared_choice(answer) {
            Choice::Left => count.left += 1,
            Choice::NoPreference => count.none += 1,
            Choice::Right => count.right += 1,
        }
        let key = (comparison.object, comparison.group, chosen.map(|method| study.place(method)));
        *rows.entry((answer.participant, key)).or_insert(0) += 1;
        *methods.entry(key).or_insert(0) += 1;
    }
    let place =
        |study: &Study, chosen: Option<isostudy_design::MethodId>| chosen.map(|method| study.place(method));
    let tally = Tally::of(&answers, &study);
    assert_eq!(tally.questions, questions);
    let found: Vec<_> = tally
        .rows
        .iter()
        .map(|r| ((r.respondent, (r.object as usize, r.group as usize, place(&study, r.chosen))), r.answers))
        .collect();
    assert_eq!(found, rows.into_iter().collect::<Vec<_>>());
    let found: Vec<_> =
        tally.methods.iter().map(|m| ((m.object, m.group, place(&study, m.chosen)), m.answers)).collect();
    assert_eq!(found, methods.into_iter().collect::<Vec<_>>());
}

#[test]
fn what_a_method_does_not_have_is_missing() {
    let study = fixture::study();
    let mut records = fixture::meshes(&study);
    records.reverse();
    let last = records.last_mut().unwrap();
    (last.counts.tetrahedra, last.counts.discarded_triangles) = (None, None);
    last.quality.radius_ratio.count = 0;
    let id = last.id.to_string();
    let long = super::meshes::meshes(&study, &records);
    assert_eq!(long.height(), 54);
    let own = said(&long, "id").iter().position(|of| *of == id).unwrap();
    assert_eq!(said(&long, "purpose")[own], "benchmark");
    let whole = |name: &str| long.frame.column(name).unwrap().i64().unwrap().get(own);
    assert_eq!([whole("tetrahedra"), whole("discarded_triangles")], [None, None]);
    assert_eq!(whole("radius_ratio_count"), Some(0));
    let number = |name: &str| long.frame.column(name).unwrap().f64().unwrap().get(own);
    assert_eq!(number("radius_ratio_mean"), None);
    assert!(number("area_mean").is_some());
    assert_eq!(whole("triangles"), Some(records.last().unwrap().counts.triangles as i64));
    // In the study's order, whatever order they came in.
    let order: Vec<String> = study.configurations.iter().map(|c| c.id.to_string()).collect();
    let found: Vec<String> = said(&long, "id")[..18].to_vec();
    assert_eq!(found, order.into_iter().filter(|id| found.contains(id)).collect::<Vec<_>>());
}

#[test]
fn the_second_block_comes_last_and_is_named() {
    let study = fixture::study();
    let mut run = fixture::bench(&study);
    let again = BenchSample { invocation: 4, reference_s: Some(0.25), ..run.samples[3].clone() };
    run.aa_samples.push(again.clone());
    let long = super::times::times(&run);
    assert_eq!(long.height(), run.samples.len() + 1);
    let last = long.height() - 1;
    assert_eq!((said(&long, "block")[last].as_str(), said(&long, "block")[0].as_str()), ("aa", "measured"));
    assert_eq!(said(&long, "id")[last], again.id.to_string());
    let number = |name: &str, row| long.frame.column(name).unwrap().f64().unwrap().get(row);
    assert_eq!([number("total_s", last), number("reference_s", last)], [Some(again.total_s), Some(0.25)]);
    assert_eq!(number("reference_s", 0), None);
}
