use super::*;
use crate::forms::{Form, Questionnaire};
use crate::load::tests::load;
use std::collections::BTreeMap;

/// The balanced study asked otherwise: six methods on three objects.
fn asked(way: Way, max_questions: u32, repeats: u32) -> Study {
    let mut study = load("balanced.toml");
    let section = study.file.forms.as_mut().unwrap();
    (section.way, section.controls) = (way, 0);
    (section.max_questions, section.repeats) = (max_questions, repeats);
    study
}

fn even(counts: impl IntoIterator<Item = usize>) -> bool {
    let counts: Vec<usize> = counts.into_iter().collect();
    counts.iter().max().zip(counts.iter().min()).is_none_or(|(most, least)| most - least <= 1)
}

fn questions(form: &Form) -> Vec<&Trial> {
    form.trials.iter().filter(|trial| trial.role == Role::Comparison).collect()
}

#[test]
fn ratings_ask_about_everything_once_in_balanced_orders_and_again_where_it_is_repeated() {
    let study = asked(Way::Ratings, 100, 3);
    let questionnaire = Questionnaire::of(&study).unwrap();
    let forms: Vec<Form> = (0..42).map(|participant| questionnaire.form(participant)).collect();
    let mut places: BTreeMap<String, Vec<usize>> = BTreeMap::new();
    for form in &forms {
        let mut own: Vec<String> = questions(form).iter().map(|trial| trial.shown[0].to_string()).collect();
        own.sort_unstable();
        own.dedup();
        assert_eq!(own.len(), 18);
        assert!(form.trials.iter().all(|trial| trial.shown.len() == 1));
        let counted: Vec<&Trial> = form.trials.iter().filter(|trial| trial.role != Role::Training).collect();
        assert_eq!((counted.len(), form.trials.len()), (21, 23));
        for (place, trial) in counted.iter().enumerate() {
            places.entry(trial.question.clone()).or_insert_with(|| vec![0; 21])[place] += 1;
            if trial.role == Role::Repeat {
                let first = counted.iter().position(|of| format!("{}-r", of.question) == trial.question);
                assert!(first.unwrap().abs_diff(place).min(21 - first.unwrap().abs_diff(place)) >= 10);
                assert_eq!(counted[first.unwrap()].shown, trial.shown);
            }
        }
        assert_eq!(form.comparisons(&study).len(), study.comparisons.len());
    }
    assert!(places.values().all(|counts| even(counts.iter().copied())), "{places:?}");
    assert_eq!(study.stimuli().len(), 18);
    assert_eq!(count(&study, Way::Ratings), 18);
}

#[test]
fn sets_have_each_method_as_often_each_two_together_and_each_at_every_place() {
    for (way, sets) in [(Way::BestOfThree, 6), (Way::BestOfFour, 3)] {
        let study = asked(way, 100, 2);
        let questionnaire = Questionnaire::of(&study).unwrap();
        assert_eq!(count(&study, way), 3 * sets);
        let form = questionnaire.form(0);
        let (mut methods, mut pairs) = (BTreeMap::new(), BTreeMap::new());
        for trial in questions(&form) {
            assert!(trial.shown.iter().all(|id| id.object == trial.shown[0].object));
            for (i, id) in trial.shown.iter().enumerate() {
                *methods.entry(id.to_string()).or_insert(0usize) += 1;
                for other in &trial.shown[i + 1..] {
                    assert_ne!(id, other);
                    let mut two = [id.to_string(), other.to_string()];
                    two.sort_unstable();
                    *pairs.entry(two).or_insert(0usize) += 1;
                }
            }
        }
        assert_eq!(methods.len(), 18);
        assert!(methods.values().all(|&n| n == sets * way.shown() / 6), "{methods:?}");
        // All 15 pairs of an object are together, none much more often than another.
        assert_eq!(pairs.len(), 45, "{pairs:?}");
        assert!(pairs.values().all(|&n| n <= 2), "{pairs:?}");
        for people in [3, 4, 7, 12] {
            let mut places: BTreeMap<(String, String), Vec<usize>> = BTreeMap::new();
            for form in (0..people).map(|participant| questionnaire.form(participant)) {
                for trial in questions(&form) {
                    for (place, id) in trial.shown.iter().enumerate() {
                        let key = (trial.question.clone(), id.to_string());
                        places.entry(key).or_insert_with(|| vec![0; way.shown()])[place] += 1;
                    }
                }
            }
            assert!(places.values().all(|counts| even(counts.iter().copied())), "{people}: {places:?}");
        }
        // Every set with each of its methods first; practice may show one more.
        let files = study.stimuli().len() - 3 * sets * way.shown();
        assert!(files <= 1, "{files} more");
        assert_eq!(form.comparisons(&study).len(), 27);
    }
}

#[test]
fn more_than_a_form_holds_is_dealt_into_blocks_that_are_alike() {
    let study = asked(Way::BestOfThree, 8, 2);
    let questionnaire = Questionnaire::of(&study).unwrap();
    assert_eq!(questionnaire.blocks(), 3);
    for block in 0..3 {
        let form = questionnaire.form(block);
        let mut objects: BTreeMap<&str, usize> = BTreeMap::new();
        questions(&form).iter().for_each(|trial| *objects.entry(&trial.shown[0].object).or_default() += 1);
        assert!(objects.len() == 3 && even(objects.values().copied()), "{objects:?}");
        assert_eq!(questionnaire.questions(block), 8);
    }
}
