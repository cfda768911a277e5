use super::*;
use crate::{Answered, Preferences, fixture};
use isostudy_statistics::{Model, Pairs, fit};

/// What a column says of a participant.
type Column<'a> = (&'a str, &'a dyn Fn(usize) -> Option<String>);

/// The paper's answers with columns of people, of whom the study asks for these.
fn with(columns: &[Column<'_>], numbers: usize) -> (Study, Answered) {
    let mut study = fixture::study();
    let names: Vec<String> = columns.iter().map(|(name, _)| (*name).into()).collect();
    let (subgroups, covariates) = names.split_at(columns.len() - numbers);
    (study.file.analysis.subgroups, study.file.analysis.covariates) = (subgroups.into(), covariates.into());
    let mut responses = fixture::answers(&study);
    responses.people = columns
        .iter()
        .map(|(name, of)| PersonColumn { name: (*name).into(), values: (0..18).map(of).collect() })
        .collect();
    let answered = Answered::of(&study, responses).unwrap();
    (study, answered)
}

fn find<'a>(found: &'a [Attributed<'a>], group: &str, column: &str) -> &'a Attributed<'a> {
    found.iter().find(|of| of.group.name == group && of.column == column).unwrap()
}

#[test]
fn halves_and_a_number_of_the_papers_people() {
    // The values of `isostudy-statistics/src/attribute/tests.rs` and `person_model/tests.rs`, from NumPy and R.
    let half = |i: usize| Some(if i < 9 { "early" } else { "late" }.into());
    let place = |i: usize| Some((i + 1).to_string());
    let (study, answered) = with(&[("half", &half), ("place", &place)], 1);
    let preferences = Preferences::of_study(&study, &answered);
    let found = &preferences.attributed;
    assert_eq!(found.len(), 2 * preferences.groups.len());
    let of = find(found, "clustering", "half");
    let test = of.test.as_ref().unwrap();
    assert!((test.statistic - 11.468_114_694_902).abs() < 1e-8, "{test:?}");
    let Worths::Groups(groups) = &of.worths else { panic!("groups") };
    assert_eq!(groups.iter().map(|of| (of.name, of.people)).collect::<Vec<_>>(), [("early", 9), ("late", 9)]);
    let early: Vec<_> = of.group.ballots.iter().filter(|b| b.participant() < 9).copied().collect();
    let want = fit(Model::Davidson, &Pairs::of(3, &early)).unwrap().log_worths;
    assert_eq!(groups[0].scale.as_ref().unwrap().fit.log_worths, want);
    let of = find(found, "clustering", "place");
    let Worths::Number(number) = &of.worths else { panic!("a number") };
    let number = number.as_ref().as_ref().unwrap();
    assert_eq!((number.mean, of.test.as_ref().unwrap().degrees), (9.5, 2));
    // The slope of R is for ten places; items there are none, collapse, integrated.
    let [from, to] = ["U", "I"].map(|name| of.group.items.iter().position(|item| item == name).unwrap());
    let slope = number.model.slope(0, to, from).unwrap();
    assert!((slope.estimate / number.sd * 10.0 - -0.852_669_739_492).abs() < 1e-8, "{slope:?}");
    // Corrected over everything that is tested.
    let least = found.iter().filter_map(|of| of.test.as_ref().ok()).map(|test| test.p).fold(1.0, f64::min);
    let tests = found.iter().filter(|of| of.test.is_ok()).count() as f64;
    let adjusted = found.iter().filter_map(|of| of.adjusted).fold(1.0, f64::min);
    assert!((adjusted - (tests * least).min(1.0)).abs() < 1e-12);
}

#[test]
fn what_cannot_be_tested_says_why() {
    let same = |_: usize| Some("yes".into());
    let own = |i: usize| Some(format!("p{i}"));
    let word = |i: usize| Some(if i == 3 { "old".into() } else { "1,5".into() });
    let nobody = |_: usize| None;
    let (study, answered) = with(&[("same", &same), ("own", &own), ("word", &word), ("nobody", &nobody)], 2);
    let preferences = Preferences::of_study(&study, &answered);
    let why = |column: &str| *find(&preferences.attributed, "all", column).test.as_ref().unwrap_err();
    assert_eq!(why("same"), NoTest::OneGroup);
    // Eighteen groups of one are groups; nobody's worths can be told from so few answers, and the test still has its level.
    assert!(find(&preferences.attributed, "all", "own").test.is_ok());
    assert_eq!(why("word"), NoTest::NoNumber);
    assert_eq!(why("nobody"), NoTest::OneGroup);
    assert!(preferences.attributed.iter().all(|of| of.test.is_ok() == of.adjusted.is_some()));
}

#[test]
fn numbers_have_a_point_or_a_comma() {
    assert_eq!(number(None), Some(None));
    assert_eq!(
        [number(Some("1.5")), number(Some("1,5")), number(Some("-2"))],
        [1.5, 1.5, -2.0].map(|x| Some(Some(x)))
    );
    assert_eq!([number(Some("old")), number(Some("inf")), number(Some("1,500,000"))], [None; 3]);
}
