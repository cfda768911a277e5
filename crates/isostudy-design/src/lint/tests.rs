//! Each rule fires on a defect planted for it, and no other rule does.

use super::*;
use crate::config::{FormsSection, ShownNames};
use crate::load::tests::{cross, load, paper_with};
use crate::method::ConfigurationId;
use crate::method::{Arrangement, Clustering};

fn balanced() -> Study {
    load("balanced.toml")
}

#[test]
fn every_rule_is_documented() {
    let page = include_str!("../../../../docs/questionnaire.md");
    for rule in Rule::ALL {
        let row = format!("\n| `{}` | {} |\n", rule.id(), rule.meaning());
        assert!(page.contains(&row), "docs/questionnaire.md has no row {row}");
    }
}

fn forms(study: &mut Study) -> &mut FormsSection {
    study.file.forms.as_mut().unwrap()
}

fn rules(faults: &[Fault]) -> Vec<Rule> {
    let mut rules: Vec<Rule> = faults.iter().map(|fault| fault.rule).collect();
    rules.dedup();
    rules
}

/// Keeps some comparisons, in the study and in its groups.
fn keep(study: &mut Study, kept: impl Fn(&crate::Comparison) -> bool) {
    study.comparisons.retain(&kept);
    for (g, group) in study.groups.iter_mut().enumerate() {
        let own = study.comparisons.iter().enumerate().filter(|(_, c)| c.group == g);
        group.comparisons = own.map(|(i, _)| i).collect();
    }
}

#[test]
fn a_balanced_study_has_no_faults() {
    assert_eq!(lint(&balanced()), []);
}

#[test]
fn a_study_that_asks_nobody_has_no_faults() {
    let mut study = balanced();
    study.file.forms = None;
    assert_eq!(lint(&study), []);
}

#[test]
fn the_original_has_the_faults_it_has() {
    let faults = lint(&paper_with("schema = 1", "schema = 1").unwrap());
    assert_eq!(rules(&faults), [Rule::SideConfounded, Rule::NoControls, Rule::NoRepeats, Rule::NamesReveal]);
    let confounded: Vec<&Fault> = faults.iter().filter(|f| f.rule == Rule::SideConfounded).collect();
    assert_eq!(confounded.len(), 9, "all nine contrasts");
    assert_eq!(confounded[0].place, "bu against bi in group B");
    assert_eq!(confounded[0].evidence, "bu on the left 54 times, on the right 0 times");
}

#[test]
fn sides_that_never_change() {
    let mut study = balanced();
    forms(&mut study).sides = SideRule::AsListed;
    let faults = lint(&study);
    assert_eq!(rules(&faults), [Rule::SideConfounded]);
    assert_eq!(faults.len(), 9);
}

/// Over the contrast 72 to 36, and in every question 36 to 0.
#[test]
fn sides_that_change_from_object_to_object_only() {
    let mut study = balanced();
    forms(&mut study).sides = SideRule::AsListed;
    for comparison in study.comparisons.iter_mut().filter(|c| c.object == 1) {
        std::mem::swap(&mut comparison.left, &mut comparison.right);
    }
    let faults = lint(&study);
    assert_eq!(rules(&faults), [Rule::SideConfounded]);
    assert_eq!(faults.len(), 9);
    let evidence = "bu on the left 72 times, on the right 36 times; always the same side in Q1 Q10 Q19";
    assert_eq!(faults[0].evidence, evidence);
}

/// The contrast as a whole has each side 24 times.
#[test]
fn a_side_for_each_question() {
    let mut study = load("two-methods.toml");
    forms(&mut study).sides = SideRule::AsListed;
    let second = &mut study.comparisons[1];
    std::mem::swap(&mut second.left, &mut second.right);
    let faults = lint(&study);
    assert_eq!(rules(&faults), [Rule::SideConfounded]);
    assert_eq!((faults.len(), faults[0].place.as_str()), (1, "bu against bi in group B"));
    let evidence = "bu on the left 24 times, on the right 24 times; always the same side in Q1 Q2";
    assert_eq!(faults[0].evidence, evidence);
}

/// One showing cannot be on both sides, an odd number not equally often on each.
#[test]
fn one_side_more_often() {
    let counts = [[6, 3], [3, 6], [4, 5], [1, 0], [2, 0], [0, 7], [0, 0]];
    let expected = [Some(Rule::SidesUnbalanced), Some(Rule::SidesUnbalanced), None, None]
        .into_iter()
        .chain([Some(Rule::SideConfounded), Some(Rule::SideConfounded), None]);
    assert!(counts.map(side_rule).into_iter().eq(expected));
}

/// Three blocks, dealt to an odd number of participants each: what is left over in each block cancels out over them.
#[test]
fn sides_are_even_over_blocks() {
    for seed in 0..20 {
        for participants in [3, 9, 27, 36] {
            let mut study = balanced();
            study.file.study.seed = seed;
            forms(&mut study).max_questions = 14;
            forms(&mut study).participants = participants;
            let faults = lint(&study);
            let about_sides: Vec<&Fault> = faults
                .iter()
                .filter(|fault| matches!(fault.rule, Rule::SideConfounded | Rule::SidesUnbalanced))
                .collect();
            assert!(about_sides.is_empty(), "{seed} {participants} {about_sides:?}");
        }
    }
}

/// A number of participants that leaves blocks unlike: in two of three blocks U, I and P have leads that follow from each other.
#[test]
fn sides_that_the_number_of_participants_leaves_uneven() {
    let mut study = balanced();
    forms(&mut study).max_questions = 14;
    let uneven = (37..42).find_map(|participants| {
        forms(&mut study).participants = participants;
        Some(lint(&study)).filter(|faults| !faults.is_empty())
    });
    let faults = uneven.expect("some number does");
    assert_eq!(rules(&faults), [Rule::SidesUnbalanced]);
    assert!(faults[0].evidence.ends_with("; a multiple of 6 participants makes them even"), "{faults:?}");
    forms(&mut study).participants = 42;
    assert_eq!(lint(&study), []);
}

#[test]
fn a_method_that_is_asked_about_less_often() {
    let mut study = balanced();
    keep(&mut study, |c| c.question != "Q3");
    let faults = lint(&study);
    assert_eq!(rules(&faults), [Rule::AppearancesUnequal]);
    assert_eq!(faults[0].place, "group B");
    assert_eq!(faults[0].evidence, "asked about as_bi 2 times, ss_bi 1 times");
}

/// A group need not be asked about every object, but on each that it is, about all of its methods.
#[test]
fn a_group_that_is_asked_about_some_objects() {
    let mut study = balanced();
    let b = study.groups.iter().position(|group| group.id == "B").unwrap();
    keep(&mut study, |c| c.group != b || c.object == 1);
    let unequal = |study: &Study| rules(&lint(study)).contains(&Rule::AppearancesUnequal);
    assert!(!unequal(&study), "{:?}", lint(&study));
    let first = study.comparisons.iter().find(|c| c.group == b).unwrap().question.clone();
    keep(&mut study, |c| c.question != first);
    assert!(unequal(&study), "{:?}", lint(&study));
}

#[test]
fn methods_that_are_never_compared() {
    let mut study = balanced();
    let clusterings =
        [Clustering::None, Clustering::Integrated, Clustering::EdgeCollapse, Clustering::IntegratedCollapse];
    cross(&mut study, &[Arrangement::BodyCentred, Arrangement::SimpleCubic], &clusterings);
    // A fourth and a fifth method of group B, compared with each other on every object and with no other.
    let extra: Vec<crate::MethodId> = vec!["bc".parse().unwrap(), "sc".parse().unwrap()];
    let b = study.groups.iter().position(|group| group.id == "B").unwrap();
    keep(&mut study, |c| c.group != b || c.question != "Q2" && c.question != "Q3");
    keep(&mut study, |c| c.group != b);
    study.groups[b].members = ["bu", "bi"].iter().map(|m| m.parse().unwrap()).chain(extra.clone()).collect();
    for (o, object) in ["ss", "as", "bs"].iter().enumerate() {
        for (left, right) in [("bu", "bi"), ("bc", "sc")] {
            let id = |method: &str| format!("{object}_{method}").parse::<ConfigurationId>().unwrap();
            study.groups[b].comparisons.push(study.comparisons.len());
            study.comparisons.push(crate::Comparison {
                question: format!("X{}", study.comparisons.len()),
                object: o,
                group: b,
                left: id(left),
                right: id(right),
            });
        }
    }
    let faults = lint(&study);
    assert_eq!(rules(&faults), [Rule::ComparisonsDisconnected]);
    assert_eq!(faults[0].evidence, "2 parts: bu bi | bc sc");
}

#[test]
fn methods_that_differ_in_two_properties() {
    let mut study = balanced();
    forms(&mut study).max_questions = 35;
    let group = study.groups.len();
    let own = study.comparisons.len()..study.comparisons.len() + 3;
    let members = ["bu", "si"].map(|method| method.parse().unwrap()).to_vec();
    let comparisons = own.collect();
    study.groups.push(crate::Group { id: "X".into(), label: "both".into(), members, comparisons });
    for (object, id) in ["ss", "as", "bs"].iter().enumerate() {
        let id = |method: &str| format!("{id}_{method}").parse::<ConfigurationId>().unwrap();
        let (question, left, right) = (format!("X{object}"), id("bu"), id("si"));
        study.comparisons.push(Comparison { question, object, group, left, right });
    }
    // Tested as methods, with families of their own.
    assert_eq!(lint(&study), []);
    let reached = reach(&study, 36);
    let families: Vec<(&str, usize)> =
        reached.iter().map(|of| (of.family.as_str(), of.participants)).collect();
    for (family, tests) in [("methods", 1), ("objects-method", 3), ("object-pairs-method", 3)] {
        assert_eq!(families.iter().filter(|of| **of == (family, 36)).count(), tests, "{family}");
    }
}

#[test]
fn no_controls_and_no_repeats() {
    let mut study = balanced();
    forms(&mut study).controls = 0;
    assert_eq!(rules(&lint(&study)), [Rule::NoControls]);
    let mut study = balanced();
    forms(&mut study).repeats = 0;
    assert_eq!(rules(&lint(&study)), [Rule::NoRepeats]);
}

#[test]
fn one_order_for_everybody() {
    let mut study = balanced();
    forms(&mut study).order = OrderRule::AsListed;
    assert_eq!(rules(&lint(&study)), [Rule::OrderFixed]);
}

#[test]
fn names_that_tell() {
    let mut study = balanced();
    forms(&mut study).names = ShownNames::ConfigurationIds;
    assert_eq!(rules(&lint(&study)), [Rule::NamesReveal]);
    let mut study = balanced();
    study.comparisons[4].question = "ss_su or not".into();
    let faults = lint(&study);
    assert_eq!(rules(&faults), [Rule::NamesReveal]);
    assert_eq!(
        (faults[0].evidence.as_str(), faults[0].remedy()),
        ("its id names ss_su", "give the question another id")
    );
}

/// Whatever participants read, in whole words: an arrangement with a space for its hyphen and a capital too.
#[test]
fn texts_that_tell() {
    type Plant = fn(&mut Study);
    let planted: [(&str, &str, Plant); 8] = [
        ("study.title", "integrated", |s| s.file.study.title = "Integrated, or not?".into()),
        ("study.title", "ss_bu", |s| s.file.study.title = "Is ss_bu better?".into()),
        ("forms.prompt", "body-centred", |s| forms(s).prompt = "Do you like Body centred surfaces?".into()),
        ("forms.prompt", "bi", |s| forms(s).prompt = "Is bi better?".into()),
        ("forms.choices[0]", "edge collapse", |s| forms(s).choices[0] = "Edge-collapse".into()),
        ("forms.choices[2]", "su", |s| forms(s).choices[2] = "su".into()),
        ("forms.consent", "simple cubic", |s| {
            forms(s).consent = "You will see\nsimple-cubic lattices.".into()
        }),
        ("forms.instructions", "as_si", |s| forms(s).instructions = "Look at AS_SI first.".into()),
    ];
    for (place, name, plant) in planted {
        let mut study = balanced();
        plant(&mut study);
        let faults = lint(&study);
        assert_eq!(rules(&faults), [Rule::NamesReveal], "{place}");
        assert!(faults.len() == 1 && faults[0].place == place, "{faults:?}");
        assert!(faults[0].evidence.ends_with(&format!(" names {name}")), "{faults:?}");
        assert_eq!(faults[0].remedy(), "say it without the names of methods and configurations");
    }
    // Parts of words, a method's letters in prose, and the clustering called none.
    let mut study = balanced();
    forms(&mut study).prompt = "Which biting, disintegrated one do you like, or none?".into();
    forms(&mut study).consent = "Si quiere, escriba su respuesta.".into();
    assert_eq!(lint(&study), []);
}

fn facts(file: &str) -> StimulusFacts {
    StimulusFacts {
        file: file.into(),
        frames: 120,
        duration_cs: 720,
        size: [512, 512],
        background: [1, 130, 129],
        camera: Some([1.2, 1.57, 0.52]),
        palette: vec![[1, 130, 129], [54, 18, 79], [242, 141, 7]],
        exposure: 0.22,
        text: Vec::new(),
    }
}

#[test]
fn stimuli_that_differ() {
    let study = balanced();
    let right = facts("lobi.gif");
    let judge = |left: StimulusFacts| lint_stimuli(&study, &[("Q1".into(), left, right.clone())]);
    assert_eq!(judge(facts("vusa.gif")), []);
    assert_eq!(judge(StimulusFacts { exposure: 0.24, ..facts("vusa.gif") }), []);
    let planted = [
        (StimulusFacts { frames: 60, ..facts("vusa.gif") }, "frames: 60 on the left, 120 on the right"),
        (StimulusFacts { duration_cs: 800, ..facts("vusa.gif") }, "duration: 800 cs"),
        (StimulusFacts { size: [256, 512], ..facts("vusa.gif") }, "size: [256, 512]"),
        (StimulusFacts { background: [0, 0, 0], ..facts("vusa.gif") }, "background: [0, 0, 0]"),
        (
            StimulusFacts { camera: Some([1.3, 1.57, 0.52]), ..facts("vusa.gif") },
            "camera: distance 1.3, field of view 1.57 rad",
        ),
        (StimulusFacts { camera: None, ..facts("vusa.gif") }, "camera: not known on the left, distance 1.2"),
        // Olive where the other is orange, as bright.
        (
            StimulusFacts { palette: vec![[1, 130, 129], [54, 18, 79], [146, 168, 7]], ..facts("vusa.gif") },
            "colours: #92a807 on the left, #f28d07 on the right",
        ),
        (
            StimulusFacts { palette: vec![[1, 130, 129], [0, 18, 79]], ..facts("vusa.gif") },
            "colours: #00124f and 1 more on the left, #36124f and 1 more on the right",
        ),
        (StimulusFacts { exposure: 0.245, ..facts("vusa.gif") }, "exposure: 0.245 on the left, 0.220 on"),
    ];
    for (left, evidence) in planted {
        let faults = judge(left);
        assert_eq!(rules(&faults), [Rule::StimuliDiffer]);
        assert!(faults.len() == 1 && faults[0].evidence.starts_with(evidence), "{faults:?}");
    }
    for told in
        [facts("ss_bi.gif"), StimulusFacts { text: vec!["made from ss_bi".into()], ..facts("vusa.gif") }]
    {
        let faults = judge(told);
        assert_eq!(rules(&faults), [Rule::NamesReveal]);
        assert!(faults[0].evidence.ends_with("names ss_bi"), "{faults:?}");
        assert!(faults[0].remedy().contains("isostudy bundle"), "{faults:?}");
    }
}

#[test]
fn every_rule_has_an_id_of_its_own_and_says_what_it_means() {
    let ids: BTreeSet<&str> = Rule::ALL.iter().map(|rule| rule.id()).collect();
    assert_eq!(ids.len(), Rule::ALL.len());
    let plain = |id: &str| id.bytes().all(|b| b.is_ascii_lowercase() || b == b'-');
    assert!(Rule::ALL.iter().all(|rule| plain(rule.id()) && rule.meaning().ends_with('.')));
}

#[test]
fn a_language_without_a_text_is_found() {
    let mut study = balanced();
    let section = forms(&mut study);
    section.languages = ["en", "fr"].map(String::from).into();
    section.choices = ["Left", "No preference", "Right"].map(String::from).into();
    let text = |text: &str| text.to_owned();
    study.texts = [(text("fr"), [(text("title"), text("Laquelle ?"))].into())].into();
    let faults = lint(&study);
    let found: Vec<(Rule, &str)> = faults.iter().map(|fault| (fault.rule, fault.place.as_str())).collect();
    assert_eq!(found, [(Rule::TextsMissing, "forms.texts.fr")]);
    assert!(
        faults[0].evidence.ends_with("prompt") && !faults[0].evidence.contains("title"),
        "{}",
        faults[0].evidence
    );
    // A text that tells what is shown is found in every language.
    study.texts.get_mut("fr").unwrap().insert(text("prompt"), text("ss_bi ou autre ?"));
    let faults = lint(&study);
    assert!(
        faults.iter().any(|f| f.rule == Rule::NamesReveal && f.place == "forms.texts.fr.prompt"),
        "{faults:?}"
    );
}
