use super::*;
use isostudy_design::config::AboutTime;

fn file() -> FormFile {
    let question = |id: &str, answers: Answers| AboutEntry {
        id: id.into(),
        text: format!("about_{id}"),
        answers,
        when: AboutTime::Before,
        optional: false,
        screens_out: Vec::new(),
    };
    let texts = [("about_job_1", "painter"), ("about_job_2", "=pilot"), ("about_job", "Job?")];
    let texts = texts.map(|(key, text)| (key.to_owned(), text.to_owned()));
    FormFile {
        texts: [("en".to_owned(), texts.into())].into(),
        about: vec![
            question("job", Answers::Options { count: 2, several: true }),
            question("age", Answers::Number { from: 0.0, to: 120.0 }),
            question("words", Answers::Text { longest: 100 }),
        ],
        ..crate::export::tests::empty_file()
    }
}

fn about(job: &str, age: &str, words: &str) -> About {
    [("job", job), ("age", age), ("words", words)].map(|(id, value)| (id.to_owned(), value.to_owned())).into()
}

#[test]
fn values_are_in_words_and_attention_is_counted() {
    let mut all: BTreeMap<String, About> = [("b".to_owned(), about("1;2", "30", "hello, you"))].into();
    all.insert("a".into(), [("job".to_owned(), String::new())].into());
    let attention = [("job".to_owned(), "1;2".to_owned()), ("age".to_owned(), "31".to_owned())];
    let csv = about_csv(&file(), &attention, &all);
    let expected = "participant,job,age,words,attention\na,declined,,,0 of 2\nb,painter; =pilot,30,\"hello, you\",1 of 2\n";
    assert_eq!(csv, expected);
}

#[test]
fn what_others_get_has_no_words_and_nobody_alone() {
    let mut all: BTreeMap<String, About> = BTreeMap::new();
    for person in 0..41 {
        let job = if person < 40 { "1" } else { "2" };
        let age = if person < 20 { 20 + person % 5 } else { 40 };
        all.insert(format!("name{person:02}"), about(job, &age.to_string(), "my name is Ada"));
    }
    let names = all.keys().enumerate().map(|(i, name)| (name.clone(), format!("p{i:02}"))).collect();
    let (csv, said) = shared_about_csv(&file(), &[], &all, &names);
    assert!(
        !csv.contains("Ada") && !csv.contains("name") && !csv.contains("pilot") && !csv.contains("words"),
        "{csv}"
    );
    assert!(csv.starts_with("participant,job,age\np00,painter,20 to 21\n"), "{csv}");
    let mut shared: BTreeMap<&str, usize> = BTreeMap::new();
    csv.lines().skip(1).for_each(|line| *shared.entry(line.split_once(',').unwrap().1).or_default() += 1);
    assert!(shared.values().all(|&count| count >= K), "{csv}");
    assert!(said.contains("at least 5 people") && said.contains("10 of 82 cells"), "{said}");
    let few = names_of(&all, 4);
    let (csv, said) = shared_about_csv(&file(), &[], &all, &few);
    assert!(csv.lines().skip(1).all(|line| line.ends_with(",merged,merged")), "{csv}");
    assert!(said.contains("fewer than 5"), "{said}");
}

fn names_of(all: &BTreeMap<String, About>, count: usize) -> BTreeMap<String, String> {
    all.keys().take(count).enumerate().map(|(i, name)| (name.clone(), format!("p{i}"))).collect()
}
