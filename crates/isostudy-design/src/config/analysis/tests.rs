use super::*;
use crate::load::tests::load;
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
    let refused = [
        ("level = 0.00009", "analysis.level = 9e-5: must lie between 0.0001 and 0.5"),
        ("level = 0.51", "analysis.level = 0.51: must lie between 0.0001 and 0.5"),
        ("level = nan", "analysis.level = NaN: must be a finite number"),
        ("margin = 0.0", "analysis.margin = 0: must be above 0 and below 1"),
        ("margin = 1.0", "analysis.margin = 1: must be above 0 and below 1"),
        ("margin = nan", "analysis.margin = NaN: must be above 0 and below 1"),
        (
            "primary = [\"B-S\", \"\"]",
            "analysis.primary[1] = \"\": must be the name of a contrast, such as B-S",
        ),
        ("primary = [\" B-S\"]", "analysis.primary[0] = \" B-S\": must be the name of a contrast"),
        ("primary = [\"B\\nS\"]", "analysis.primary[0] = \"B\\nS\": must be the name of a contrast"),
        (&long, "must be the name of a contrast, such as B-S or B-S within U: 1 to 64 letters"),
        (
            "primary = [\"B-S\", \"U-I\", \"B-S\"]",
            "analysis.primary[2] = B-S: already used by analysis.primary[0]",
        ),
        (
            "exclude = [\"outlying\", \"outlying\"]",
            "analysis.exclude[1] = outlying: already used by analysis.exclude[0]",
        ),
        ("answers_known = true", "analysis.answers_known = true: needs analysis.declared"),
        (
            "declared = 2026-01-01\nfirst_answer = 2026-01-02\nanswers_known = true",
            "analysis.answers_known = true: before analysis.first_answer = 2026-01-02 nobody knew answers",
        ),
        ("declared = \"21.11.2026\"", "\"21.11.2026\" is not a date: write year, month and day"),
        ("declared = 2026-11-21T10:00:00", "is not a date"),
        ("first_answer = 2026-02-30", "two-methods.toml"),
        ("families = \"two\"", "unknown variant `two`, expected `by-kind` or `one`"),
        ("exclude = [\"slow\"]", "unknown variant `slow`, expected one of `one-sided`, `controls`"),
        ("alpha = 0.05", "unknown field `alpha`"),
    ];
    for (key, told) in refused {
        let error = with(&format!("[analysis]\n{key}")).map(|_| ()).unwrap_err().to_string();
        assert!(error.contains(told) && error.contains("two-methods.toml"), "{key}: {error}");
    }
    // Letters, not bytes: long enough, though no contrast is called so.
    let letters = with(&format!("[analysis]\nprimary = [\"{}\"]", "ü".repeat(64))).unwrap_err();
    assert!(letters.to_string().contains("ü: is not a contrast of this study"), "{letters}");
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
    let refused = with("[analysis]\nreference = \"si\"").unwrap_err().to_string();
    let told = "two-methods.toml: analysis.reference = si: is not a method that this study compares, which are: bi, bu";
    assert!(refused.ends_with(told), "{refused}");
}
