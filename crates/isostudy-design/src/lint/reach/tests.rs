//! Who counts, and how small p can be, against counts of the forms themselves and the definition of Holm's correction.

use super::*;
use crate::config::FamilyRule;
use crate::contrast::Family;
use crate::forms::Role;
use crate::lint::lint;
use crate::load::tests::load;
use crate::method::{ConfigurationId, MethodId};
use crate::study::Comparison;
use proptest::prelude::*;
use std::collections::BTreeMap;

fn balanced(participants: u32, max_questions: u32) -> Study {
    let mut study = load("balanced.toml");
    let forms = study.file.forms.as_mut().unwrap();
    (forms.participants, forms.max_questions) = (participants, max_questions);
    study
}

/// The balanced study with so many questions a person.
fn blocks_of(questions: u32) -> Study {
    let mut study = balanced(36, questions);
    let forms = study.file.forms.as_mut().unwrap();
    (forms.controls, forms.repeats) = (0, 0);
    study
}

/// Two lattices without clustering, on so many objects.
fn lattices_alone(participants: u32, objects: usize) -> Study {
    let mut study = balanced(participants, objects as u32 + 5);
    let object = study.file.objects[0].clone();
    study.file.objects.clear();
    study.configurations.retain(|configuration| configuration.object < objects);
    study.comparisons.clear();
    let group = study.groups.iter().position(|group| group.id == "U").unwrap();
    for o in 0..objects {
        let mut object = object.clone();
        (object.id, object.name) = (format!("o{o}"), format!("object {o}"));
        study.file.objects.push(object);
        let [left, right] = ["su", "bu"].map(|method| ConfigurationId {
            object: format!("o{o}"),
            method: method.parse::<MethodId>().unwrap(),
        });
        study.comparisons.push(Comparison { question: format!("Q{o}"), object: o, group, left, right });
    }
    study.groups = vec![crate::Group { comparisons: (0..objects).collect(), ..study.groups[group].clone() }];
    study.comparisons.iter_mut().for_each(|comparison| comparison.group = 0);
    study
}

fn of_rule(study: &Study, rule: Rule) -> Vec<(String, String)> {
    let faults = lint(study).into_iter().filter(|fault| fault.rule == rule);
    faults.map(|fault| (fault.place, fault.evidence)).collect()
}

/// Families of nine need 2^(1-m) * 9 <= 0.05: 9 participants have 0.0352, 8 have 0.0703; those of six have 0.0469.
#[test]
fn too_few_participants() {
    assert_eq!(lint(&balanced(9, 32)), []);
    let told = |first: &str| format!("{first} and 8 more: 8 participants, 9 tests, p is at least 0.0703");
    let expected = [
        ("family groups", "U-I within B"),
        ("family objects-clustering", "U-I sphere"),
        ("family object-pairs-clustering", "U-I sphere - asteroid"),
    ];
    let expected = expected.map(|(place, first)| (place.to_owned(), told(first)));
    let mut study = balanced(8, 32);
    assert_eq!(of_rule(&study, Rule::NotEnoughParticipants), expected);
    assert_eq!(lint(&study).len(), 3, "nothing else");

    study.file.analysis.level = 0.0704;
    assert_eq!(lint(&study), []);
    study.file.analysis.families = FamilyRule::One;
    let expected = "U-I and 42 more: 8 participants, 43 tests, p is at least 0.3359".to_owned();
    assert_eq!(of_rule(&study, Rule::NotEnoughParticipants), [("family all".to_owned(), expected)]);
}

#[test]
fn a_primary_contrast_needs_fewer() {
    let mut study = balanced(6, 32);
    study.file.analysis.primary = vec!["B-S".into()];
    let of = |study: &Study, name: &str| {
        reach(study, 6).into_iter().find(|of| of.contrast.to_string() == name).unwrap()
    };
    let primary = of(&study, "B-S");
    assert_eq!((primary.family.as_str(), primary.p), ("primary", Some([0.03125, 0.03125])));
    assert_eq!(of(&study, "U-I").p, Some([0.03125, 3.0 * 0.03125]));
    study.file.analysis.primary.clear();
    assert_eq!(of(&study, "B-S").p, Some([0.03125, 4.0 * 0.03125]));
}

/// The analysis of six unanimous people finds the pooled contrast (p = 0.031) and leaves each of three objects open (0.094).
#[test]
fn objects_are_counted_as_the_analysis_counts_them() {
    let told = |first: &str, tests: usize, p: &str| {
        format!("{first} and {} more: 6 participants, {tests} tests, p is at least {p}", tests - 1)
    };
    let expected = |tests: usize, pairs: usize, p: &str, of_pairs: &str| {
        [
            ("family objects".to_owned(), told("S-B object 0", tests, p)),
            ("family object-pairs".to_owned(), told("S-B object 0 - object 1", pairs, of_pairs)),
        ]
    };
    let study = lattices_alone(6, 3);
    assert_eq!(of_rule(&study, Rule::NotEnoughParticipants), expected(3, 3, "0.0938", "0.0938"));
    let study = lattices_alone(6, 12);
    assert_eq!(of_rule(&study, Rule::NotEnoughParticipants), expected(12, 66, "0.3750", "1.0000"));
    // One object has no family of its own.
    assert_eq!(lint(&lattices_alone(6, 1)), []);
}

#[test]
fn blocks_that_are_too_small_for_a_difference() {
    let mut study = load("two-methods.toml");
    let forms = study.file.forms.as_mut().unwrap();
    (forms.controls, forms.repeats, forms.max_questions) = (0, 0, 1);
    let faults = of_rule(&study, Rule::UntestableComparison);
    let told = "no form asks about both parts of U-I sphere - asteroid";
    assert_eq!(faults, [("family object-pairs-clustering".to_owned(), told.to_owned())]);
    assert!(of_rule(&study, Rule::NotEnoughParticipants).is_empty(), "no number of participants would help");
    assert_eq!(of_rule(&load("two-methods.toml"), Rule::UntestableComparison), []);
    // Two questions a person hold every difference of the balanced study for somebody, one question none.
    assert_eq!(of_rule(&blocks_of(2), Rule::UntestableComparison), []);
    let families: Vec<String> =
        of_rule(&blocks_of(1), Rule::UntestableComparison).into_iter().map(|(place, _)| place).collect();
    assert_eq!(families, ["family interactions", "family object-pairs", "family object-pairs-clustering"]);
}

#[test]
fn whoever_is_dealt_no_part_does_not_count() {
    // Two of three blocks have people.
    let all = reach(&balanced(2, 14), 2);
    let on_object = |of: &&Reach| of.contrast.to_string() == "U-I sphere - asteroid";
    let of = all.iter().find(on_object).unwrap();
    assert!(of.asked && of.participants <= 1);
    let asked: usize =
        all.iter().filter(|of| of.contrast.family == Family::Pooled).map(|of| of.participants).sum();
    assert_eq!(asked, 4 * 2);
    assert_eq!(reach(&load("balanced.toml"), 0).iter().filter(|of| of.p.is_some()).count(), 0);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(30))]

    #[test]
    fn people_are_those_of_the_forms_and_p_is_holms(
        participants in 1u32..30, max_questions in 7u32..34, mask in 1u32..(1 << 27), one in any::<bool>(),
    ) {
        let mut study = balanced(participants, max_questions);
        let mut index = 0..;
        study.comparisons.retain(|_| mask >> index.next().unwrap_or(0) & 1 == 1);
        study.file.forms.as_mut().unwrap().repeats = 0;
        if one {
            study.file.analysis.families = FamilyRule::One;
        }
        let forms = Questionnaire::of(&study).unwrap().planned();
        let all = reach(&study, participants as usize);
        let mut families: BTreeMap<&str, Vec<(usize, f64)>> = BTreeMap::new();
        for (i, of) in all.iter().enumerate() {
            let counts = forms.iter().filter(|form| {
                of.contrast.parts.iter().all(|part| form.trials.iter().any(|trial| {
                    trial.role == Role::Comparison && part.contains_key(&trial.comparison.unwrap_or(usize::MAX))
                }))
            });
            let people = counts.count();
            prop_assert_eq!(of.participants, people, "{}", of.contrast);
            prop_assert!(of.asked || people == 0);
            if people > 0 {
                let p = 2.0 / 2f64.powi(people as i32);
                families.entry(&of.family).or_default().push((i, p));
            } else {
                prop_assert_eq!(of.p, None);
            }
        }
        for own in families.values() {
            for &(i, p) in own {
                // The largest of each smaller p, times how many are not smaller than it.
                let smaller = own.iter().filter(|(_, q)| *q <= p);
                let times = |q: f64| own.iter().filter(|(_, r)| *r >= q).count() as f64;
                let holm = smaller.map(|&(_, q)| (q * times(q)).min(1.0)).fold(0.0, f64::max);
                prop_assert_eq!(all[i].p, Some([p, holm]), "{}", all[i].contrast);
            }
        }
    }
}
