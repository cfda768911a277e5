use super::*;
use crate::load::tests::{load, refused, syntax};
use crate::{ConfigError, Study};
use std::path::Path;

/// The smallest study with this section.
fn with(section: &str) -> Result<AnalysisSection, ConfigError> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../configs/two-methods.toml");
    let text = std::fs::read_to_string(&path).unwrap();
    let (text, _) = text.split_once("\n[analysis]").expect("the section is last");
    Study::parse(&format!("{text}\n{section}\n"), &path).map(|study| study.file.analysis)
}

fn day(text: &str) -> Date {
    text.parse().unwrap()
}

#[test]
fn a_study_without_the_section_has_the_defaults() {
    let section = with("").unwrap();
    assert_eq!(section, AnalysisSection::default());
    assert_eq!((section.level, section.margin, section.families), (0.05, 0.2, FamilyRule::ByKind));
    assert!(section.primary.is_empty() && section.exclude.is_empty() && !section.answers_known);
    assert_eq!(with("[analysis]").unwrap(), section);
}

#[test]
fn every_key_is_read() {
    let section = with(
        "[analysis]\ndeclared = 2026-11-21\nfirst_answer = \"2026-12-01\"\nanswers_known = false\nlevel = 0.01\nmargin = 0.3\n\
         families = \"one\"\nprimary = [\"U-I\", \"U-I sphere\"]\n\
         reference = \"bi\"\nexclude = [\"one-sided\", \"controls\", \"repeats\", \"time\", \"outlying\"]",
    );
    let expected = AnalysisSection {
        declared: Some(day("2026-11-21")),
        first_answer: Some(day("2026-12-01")),
        answers_known: false,
        level: 0.01,
        margin: 0.3,
        families: FamilyRule::One,
        primary: vec!["U-I".into(), "U-I sphere".into()],
        reference: Some("bi".into()),
        exclude: vec![
            Exclusion::OneSided,
            Exclusion::Controls,
            Exclusion::Repeats,
            Exclusion::Time,
            Exclusion::Outlying,
        ],
        stopping: None,
        people: None,
        subgroups: Vec::new(),
        covariates: Vec::new(),
    };
    assert_eq!(section.unwrap(), expected);
    assert!(with("[analysis]\ndeclared = 2026-11-21\nanswers_known = true").unwrap().answers_known);
    for edge in ["level = 0.0001", "level = 0.5", "margin = 0.999", "margin = 1e-9"] {
        assert!(with(&format!("[analysis]\n{edge}")).is_ok(), "{edge}");
    }
}

#[test]
fn what_cannot_be_meant_is_refused() {
    let long = format!("primary = [\"{}\"]", "x".repeat(65));
    for (key, told) in [
        ("level = 0.00009", "level = 9e-5"),
        ("level = 0.51", "level = 0.51"),
        ("level = nan", "level = NaN"),
        ("margin = 0.0", "margin = 0"),
        ("margin = 1.0", "margin = 1"),
        ("margin = nan", "margin = NaN"),
        ("primary = [\"B-S\", \"\"]", "primary[1] = \"\""),
        ("primary = [\" B-S\"]", "primary[0] = \" B-S\""),
        ("primary = [\"B\\nS\"]", "primary[0] = \"B\\nS\""),
        ("primary = [\"B-S\", \"U-I\", \"B-S\"]", "primary[2] = B-S"),
        ("exclude = [\"outlying\", \"outlying\"]", "exclude[1] = outlying"),
        ("answers_known = true", "answers_known = true"),
        ("declared = 2026-01-01\nfirst_answer = 2026-01-02\nanswers_known = true", "answers_known = true"),
    ] {
        assert_eq!(refused(with(&format!("[analysis]\n{key}"))), format!("analysis.{told}"));
    }
    let long = refused(with(&format!("[analysis]\n{long}")));
    assert!(long.starts_with("analysis.primary[0] = "), "{long}");
    for (key, told) in [
        ("declared = \"21.11.2026\"", "\"21.11.2026\""),
        ("declared = 2026-11-21T10:00:00", "2026-11-21T10:00:00"),
        ("first_answer = 2026-02-30", "first_answer"),
        ("families = \"two\"", "`two`"),
        ("exclude = [\"slow\"]", "`slow`"),
        ("alpha = 0.05", "`alpha`"),
    ] {
        let error = syntax(with(&format!("[analysis]\n{key}")));
        assert!(error.contains(told), "{key}: {error}");
    }
    // Letters, not bytes: long enough, though no contrast is called so.
    let letters = with(&format!("[analysis]\nprimary = [\"{}\"]", "ü".repeat(64))).unwrap_err();
    assert!(
        matches!(&letters, ConfigError::Value { limit, .. } if limit.contains("this study")),
        "{letters}"
    );
}

#[test]
fn the_earlier_day_of_a_first_answer_counts() {
    let section = |declared: &str, first_answer: Option<&str>| AnalysisSection {
        declared: Some(day(declared)),
        first_answer: first_answer.map(day),
        ..AnalysisSection::default()
    };
    let [declared, earlier, later] = ["2026-11-21", "2026-11-20", "2026-11-22"].map(day);
    let before = |first_answer| Declaration::BeforeAnswers { declared, first_answer };
    let after = |first_answer| Declaration::AfterAnswers { declared, first_answer };

    assert_eq!(AnalysisSection::default().declaration(Some(later)), Declaration::Undeclared);
    let undated = section("2026-11-21", None);
    assert_eq!(undated.declaration(None), Declaration::Unknown { declared });
    assert_eq!(undated.declaration(Some(later)), before(later));
    assert_eq!(undated.declaration(Some(declared)), before(declared), "on the day itself");
    assert_eq!(undated.declaration(Some(earlier)), after(Some(earlier)));
    let dated = section("2026-11-21", Some("2026-11-22"));
    assert_eq!(dated.declaration(None), before(later));
    assert_eq!(dated.declaration(Some(earlier)), after(Some(earlier)), "the answers themselves contradict");
    assert_eq!(section("2026-11-21", Some("2026-11-20")).declaration(Some(later)), after(Some(earlier)));
    let known = AnalysisSection { answers_known: true, ..undated };
    assert_eq!(known.declaration(None), after(None));
    assert_eq!(
        known.declaration(Some(later)),
        after(Some(later)),
        "who says that they were known is believed"
    );
}

#[test]
fn the_papers_choices_were_made_when_its_answers_were_known() {
    let section = load("paper.toml").file.analysis;
    let declared = day("2026-11-22");
    assert_eq!(section.declaration(None), Declaration::AfterAnswers { declared, first_answer: None });
    // What its published comparisons rest on.
    let choices = AnalysisSection { declared: None, answers_known: false, ..section };
    assert_eq!(choices, AnalysisSection::default());
    for study in ["balanced.toml", "two-methods.toml"] {
        assert_eq!(load(study).file.analysis, AnalysisSection::default(), "{study}");
    }
}

#[test]
fn the_reference_is_a_method_that_is_compared() {
    let refused = with("[analysis]\nreference = \"si\"").unwrap_err();
    let ConfigError::Value { key, value, limit, .. } = refused else { panic!("{refused}") };
    assert_eq!((&*key, &*value), ("analysis.reference", "si"));
    assert!(limit.ends_with(": bi, bu"), "{limit}");
}

#[test]
fn looks_that_nobody_could_keep_to_are_refused() {
    let with_rule = |rule: &str| with(&format!("[analysis]\nprimary = [\"U-I\"]\nstopping = {{ {rule} }}"));
    let section = with_rule("looks = [8, 24], boundary = \"obrien-fleming\"").unwrap();
    let expected = StoppingSection {
        looks: vec![8, 24],
        boundary: StoppingBoundary::OBrienFleming,
        when: StopWhen::All,
    };
    assert_eq!(section.stopping, Some(expected));
    let any = with_rule("looks = [24], boundary = \"pocock\", when = \"any\"").unwrap().stopping.unwrap();
    assert_eq!((any.boundary, any.when), (StoppingBoundary::Pocock, StopWhen::Any));
    for (looks, said) in [
        ("[]", "must be 1 to 10 numbers of participants"),
        ("[1, 24]", "must ascend from 2"),
        ("[12, 12, 24]", "must ascend from 2"),
        ("[20, 8, 24]", "must ascend from 2"),
        ("[2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 24]", "must be 1 to 10"),
        ("[8, 20]", "must end with forms.participants = 24"),
    ] {
        let error = with_rule(&format!("looks = {looks}, boundary = \"pocock\"")).unwrap_err().to_string();
        assert!(error.contains(said) && error.contains("analysis.stopping.looks"), "{looks}: {error}");
    }
    let error =
        with("[analysis]\nstopping = { looks = [24], boundary = \"pocock\" }").unwrap_err().to_string();
    assert!(error.contains("needs analysis.primary"), "{error}");
}
