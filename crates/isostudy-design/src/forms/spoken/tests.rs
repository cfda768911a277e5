use super::*;
use crate::forms::Questionnaire;
use crate::load::tests::load;

/// The forms of the balanced study in these languages, and what it says in them.
fn file(languages: &[&str], own: &[(&str, &[(&str, &str)])]) -> FormFile {
    let study = load("balanced.toml");
    let texts = own.iter().map(|(lang, texts)| {
        let texts = texts.iter().map(|(key, text)| ((*key).to_owned(), (*text).to_owned()));
        ((*lang).to_owned(), texts.collect())
    });
    FormFile {
        languages: languages.iter().map(|lang| (*lang).to_owned()).collect(),
        texts: texts.collect(),
        ..Questionnaire::of(&study).unwrap().file()
    }
}

#[test]
fn what_the_study_says_stands_in_its_first_language_and_what_it_leaves_out_is_shipped() {
    let mut german = file(&["de"], &[]);
    german.prompt = "Welche?".into();
    german.choices = ["Links", "Weder noch", "Rechts"].map(Into::into).into();
    german.instructions = english()["instructions"].clone();
    german.consent = english()["consent"].clone();
    let [spoken] = &german.spoken()[..] else { panic!("one language") };
    assert_eq!((spoken.lang.as_str(), spoken.direction()), ("de", "ltr"));
    let text = |key: &str| spoken.texts[key].as_str();
    assert_eq!(
        (text("prompt"), text("left"), text("upper"), text("go_on")),
        ("Welche?", "Links", "Oben", "Weiter")
    );
    assert_eq!((text("none"), text("none_stacked")), ("Weder noch", "Weder noch"));
    assert_eq!(text("consent"), shipped("de").unwrap()["consent"]);
    assert_eq!(german.missing_texts(), []);
    // Words of its own stay where the surfaces stand, unless it says otherwise.
    german.choices = ["A", "=", "B"].map(Into::into).into();
    let texts = german.spoken().remove(0).texts;
    assert_eq!([&texts["upper"], &texts["none_stacked"], &texts["lower"]], ["A", "=", "B"]);
    german.choices_stacked = Some(["A oben", "=", "B unten"].map(Into::into).into());
    let texts = german.spoken().remove(0).texts;
    assert_eq!([&texts["upper"], &texts["none_stacked"], &texts["lower"]], ["A oben", "=", "B unten"]);
}

#[test]
fn english_without_a_word_on_languages_is_as_it_was() {
    let mut file = file(&["en"], &[]);
    file.choices = ["Left", "No preference", "Right"].map(Into::into).into();
    let texts = file.spoken().remove(0).texts;
    assert_eq!(
        [&texts["upper"], &texts["none_stacked"], &texts["lower"]],
        ["Top", "No preference", "Bottom"]
    );
    file.choices = ["Left one", "Neither", "Right"].map(Into::into).into();
    let texts = file.spoken().remove(0).texts;
    assert_eq!([&texts["upper"], &texts["none_stacked"], &texts["lower"]], ["Left one", "Neither", "Bottom"]);
    assert_eq!(file.missing_texts(), []);
}

#[test]
fn what_a_language_lacks_is_named() {
    let mut two = file(&["en", "de"], &[]);
    two.consent = english()["consent"].clone();
    two.instructions = english()["instructions"].clone();
    two.choices = ["Left", "No preference", "Right"].map(Into::into).into();
    assert_eq!(two.missing_texts(), [("de", vec!["prompt".to_owned(), "title".to_owned()])]);
    // A consent of its own is asked for in the other language too.
    two.consent = "Say yes.".into();
    two.choices[1] = "Equal".into();
    let [("de", keys)] = &two.missing_texts()[..] else { panic!("{:?}", two.missing_texts()) };
    assert_eq!(keys, &["consent", "none", "prompt", "title"]);
    let own: [(&str, &[(&str, &str)]); 1] =
        [("de", &[("consent", "Ja."), ("none", "Gleich"), ("title", "T"), ("prompt", "P")])];
    let whole = FormFile { texts: file(&["en", "de"], &own).texts, ..two };
    assert_eq!(whole.missing_texts(), []);
    // A language that nobody ships needs every key.
    let dutch = file(&["nl"], &[("nl", &[("language", "Nederlands")])]);
    let [("nl", keys)] = &dutch.missing_texts()[..] else { panic!("{:?}", dutch.missing_texts()) };
    assert!(keys.contains(&"go_on".to_owned()) && !keys.contains(&"language".to_owned()), "{keys:?}");
    assert!(!keys.contains(&"title".to_owned()), "the first language's is study.title");
    assert_eq!(dutch.spoken()[0].texts["go_on"], "Go on");
}
