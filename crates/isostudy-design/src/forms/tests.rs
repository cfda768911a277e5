//! Balance, proved on designs and numbers of participants drawn at random.

use super::*;
use crate::config::FormsSection;
use crate::load::tests::paper_with;
use crate::method::MethodId;
use proptest::prelude::*;
use std::collections::{BTreeMap, BTreeSet};

/// The paper's study with another questionnaire, and only some of its comparisons.
fn study(kept: impl Fn(usize) -> bool, section: FormsSection) -> Study {
    let mut study = paper_with("schema = 1", "schema = 1").unwrap();
    let mut index = 0..;
    study.comparisons.retain(|_| kept(index.next().expect("endless")));
    study.file.forms = Some(section);
    study
}

fn balanced(participants: u32, controls: u32, repeats: u32, max_questions: u32) -> FormsSection {
    FormsSection {
        prompt: "Which?".into(),
        way: Default::default(),
        choices: ["left", "none", "right"].map(String::from).into(),
        participants,
        sides: SideRule::Balanced,
        order: OrderRule::LatinSquare,
        names: crate::config::ShownNames::CodeNames,
        controls,
        repeats,
        max_questions,
        training: Vec::new(),
        consent: "Yes".into(),
        instructions: "Look".into(),
        page_scale: 1,
        choices_stacked: None,
        steps: 7,
        ends: None,
        none: false,
        min_surface_px: None,
        web_mb: 40,
        completion: None,
        languages: vec!["en".into()],
        texts: Default::default(),
        texts_files: Default::default(),
        about: Vec::new(),
        free_text: false,
        comment: false,
        contact: None,
        ethics: None,
        least_age: None,
        retention_days: None,
        panel: crate::config::Panel::Prolific,
        completion_withdrawn: None,
        completion_screened: None,
        completion_full: None,
        per_form: None,
        go_back: false,
        adaptive: false,
        stimulus: Default::default(),
        three: None,
    }
}

/// Counts whose largest and smallest differ by at most one.
fn even(counts: impl IntoIterator<Item = i64>) -> bool {
    let counts: Vec<i64> = counts.into_iter().collect();
    counts.iter().max().zip(counts.iter().min()).is_none_or(|(most, least)| most - least <= 1)
}

/// Every choice of `count` of `all`.
fn choices(all: &[usize], count: usize) -> Box<dyn Iterator<Item = Vec<usize>> + '_> {
    if count == 0 {
        return Box::new(std::iter::once(Vec::new()));
    }
    Box::new((0..all.len()).flat_map(move |i| {
        choices(&all[i + 1..], count - 1).map(move |mut rest| {
            rest.push(all[i]);
            rest
        })
    }))
}

/// Sum over configurations of the square of how often they appear.
fn uneven(study: &Study, comparisons: &[usize]) -> usize {
    let shown: Vec<&ConfigurationId> =
        comparisons.iter().flat_map(|&i| [&study.comparisons[i].left, &study.comparisons[i].right]).collect();
    // Pairs of equal ones, in either order, each with itself included.
    shown.iter().map(|a| shown.iter().filter(|b| a == *b).count()).sum()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn forms_are_balanced_for_any_design_and_any_number_of_participants(
        mask in 1u32..(1 << 27),
        participants in 1u32..150,
        controls in 0u32..6,
        repeats in 0u32..4,
        room in 4u32..40,
    ) {
        let count = mask.count_ones();
        let repeats = repeats.min(count / count.div_ceil(room));
        let section = balanced(participants, controls, repeats, controls + repeats + room);
        let study = study(|i| mask >> i & 1 == 1, section);
        let questionnaire = Questionnaire::of(&study).unwrap();
        let forms = questionnaire.planned();

        // Sides of each comparison, places of each, appearances of each; all over participants.
        let mut lead: BTreeMap<&str, i64> = BTreeMap::new();
        let mut places: BTreeMap<(usize, &str), Vec<i64>> = BTreeMap::new();
        let mut shown: BTreeMap<&str, i64> = study.comparisons.iter().map(|c| (c.question.as_str(), 0)).collect();
        let mut sizes = BTreeSet::new();
        for form in &forms {
            let asked = form.trials.len();
            prop_assert_eq!(asked, questionnaire.questions(form.participant));
            sizes.insert(asked);
            for (place, trial) in form.trials.iter().enumerate() {
                let key = (form.block, trial.question.as_str());
                places.entry(key).or_insert_with(|| vec![0; asked])[place] += 1;
                if trial.role == Role::Comparison {
                    let listed = &study.comparisons[trial.comparison.unwrap()];
                    let as_listed = listed.left == trial.shown[0] && listed.right == trial.shown[1];
                    let swapped = listed.left == trial.shown[1] && listed.right == trial.shown[0];
                    prop_assert!(as_listed || swapped);
                    *lead.entry(&trial.question).or_default() += if as_listed { 1 } else { -1 };
                    *shown.get_mut(trial.question.as_str()).unwrap() += 1;
                }
            }
        }
        prop_assert!(lead.values().all(|lead| lead.abs() <= 1), "{lead:?}");
        if (participants as usize).is_multiple_of(2 * questionnaire.blocks()) {
            prop_assert!(lead.values().all(|&lead| lead == 0), "{lead:?}");
        }
        prop_assert!(places.values().all(|counts| even(counts.iter().copied())), "{places:?}");
        prop_assert!(even(shown.values().copied()), "{shown:?}");
        prop_assert!(even(sizes.iter().map(|&size| size as i64)), "{sizes:?}");

        for form in &forms {
            let of = |role: Role| form.trials.iter().filter(move |trial| trial.role == role);
            prop_assert_eq!(of(Role::Control).count(), controls as usize);
            prop_assert_eq!(of(Role::Repeat).count(), repeats as usize);
            prop_assert!(of(Role::Control).all(|trial| trial.shown[0] == trial.shown[1]));
            let different: BTreeSet<_> = form.trials.iter().map(|trial| (trial.role, &trial.shown[0], &trial.shown[1])).collect();
            prop_assert_eq!(different.len(), form.trials.len(), "nothing twice");
            let mut of_controls: BTreeMap<MethodId, i64> = study.method_ids().into_iter().map(|m| (m, 0)).collect();
            of(Role::Control).for_each(|trial| *of_controls.entry(trial.shown[0].method).or_default() += 1);
            prop_assert!(even(of_controls.values().copied()), "{of_controls:?}");
            if questionnaire.blocks() == 1 {
                let repeated: Vec<usize> = of(Role::Repeat).filter_map(|trial| trial.comparison).collect();
                let all: Vec<usize> = (0..study.comparisons.len()).collect();
                let least = choices(&all, repeats as usize).map(|chosen| uneven(&study, &chosen)).min();
                prop_assert_eq!(Some(uneven(&study, &repeated)), least);
            }

            let mut method_lead: BTreeMap<MethodId, i64> = BTreeMap::new();
            let mut pair_lead: BTreeMap<(MethodId, MethodId), i64> = BTreeMap::new();
            for trial in of(Role::Comparison) {
                let (left, right) = (trial.shown[0].method, trial.shown[1].method);
                *method_lead.entry(left).or_default() += 1;
                *method_lead.entry(right).or_default() -= 1;
                *pair_lead.entry((left.min(right), left.max(right))).or_default() += if left < right { 1 } else { -1 };
            }
            prop_assert!(method_lead.values().all(|lead| lead.abs() <= 1), "{method_lead:?}");
            prop_assert!(pair_lead.values().all(|lead| lead.abs() <= 1), "{pair_lead:?}");

            let place = |wanted: &Trial, role: Role| form.trials.iter().position(|trial| {
                trial.role == role && trial.comparison == wanted.comparison
            });
            for repeat in of(Role::Repeat) {
                let (again, first) = (place(repeat, Role::Repeat).unwrap(), place(repeat, Role::Comparison).unwrap());
                prop_assert!(again.abs_diff(first) >= form.trials.len() / 2);
                let original = &form.trials[first];
                prop_assert_eq!((&original.shown[0], &original.shown[1]), (&repeat.shown[1], &repeat.shown[0]));
            }
        }
    }
}

#[test]
fn repeats_are_half_a_form_away_in_shuffled_order_too() {
    for (max_questions, repeats) in [(32, 3), (50, 20), (14, 3), (8, 3)] {
        let section = FormsSection { order: OrderRule::Shuffled, ..balanced(36, 2, repeats, max_questions) };
        let study = study(|_| true, section);
        let forms = Questionnaire::of(&study).unwrap().planned();
        let mut orders = BTreeSet::new();
        let mut first = BTreeSet::new();
        for form in &forms {
            let asked: Vec<&str> = form.trials.iter().map(|trial| trial.question.as_str()).collect();
            let place = |question: &str| asked.iter().position(|of| *of == question).unwrap();
            let again: Vec<&str> = asked.iter().filter_map(|question| question.strip_suffix("-r")).collect();
            assert_eq!(again.len(), repeats as usize);
            for question in again {
                let apart = place(question).abs_diff(place(&format!("{question}-r")));
                assert!(apart >= asked.len() / 2, "{apart} of {}", asked.len());
            }
            first.insert(asked[0].to_owned());
            orders.insert(asked.join(" "));
        }
        assert_eq!(orders.len(), 36, "everybody has an order of their own");
        assert!(first.len() > 10, "and any question first: {first:?}");
    }
}

#[test]
fn each_form_has_a_twin_with_all_sides_swapped() {
    for questions in [31, 32] {
        let study = study(|_| true, balanced(1, questions - 30, 3, questions));
        let questionnaire = Questionnaire::of(&study).unwrap();
        assert_eq!((questionnaire.blocks(), questionnaire.questions(0)), (1, questions as usize));
        for participant in 0..questions as usize {
            let (form, twin) =
                (questionnaire.form(participant), questionnaire.form(participant + questions as usize));
            let sides = |form: &Form| {
                form.trials.iter().map(|t| (t.shown[0].clone(), t.shown[1].clone())).collect::<Vec<_>>()
            };
            assert_ne!(form.mirrored, twin.mirrored);
            if questions % 2 == 0 {
                let swapped: Vec<_> = sides(&twin).into_iter().map(|(left, right)| (right, left)).collect();
                assert_eq!(sides(&form), swapped);
            } else {
                // With an odd number of places the twin runs the other way round.
                let mut sorted: Vec<_> =
                    sides(&twin).into_iter().map(|(left, right)| (right, left)).collect();
                let mut own = sides(&form);
                sorted.sort();
                own.sort();
                assert_eq!(own, sorted);
            }
        }
    }
}

#[test]
fn the_same_study_gives_the_same_forms_and_another_seed_others() {
    let mut study = study(|_| true, balanced(40, 2, 3, 32));
    let forms = Questionnaire::of(&study).unwrap().planned();
    assert_eq!(forms, Questionnaire::of(&study).unwrap().planned());
    assert_eq!(forms[7], Questionnaire::of(&study).unwrap().form(7), "a form does not need the others");
    study.file.study.seed += 1;
    assert_ne!(forms, Questionnaire::of(&study).unwrap().planned());
}

#[test]
fn every_pair_that_is_shown_is_listed_once() {
    let study = study(|_| true, balanced(70, 2, 3, 20));
    let questionnaire = Questionnaire::of(&study).unwrap();
    let pairs = questionnaire.pairs();
    let different: BTreeSet<_> = pairs.iter().collect();
    assert_eq!(different.len(), pairs.len());
    assert_eq!(pairs.len(), 2 * 27 + 2);
    let shown: BTreeSet<_> =
        questionnaire.planned().into_iter().flat_map(|form| form.trials).map(|t| t.shown).collect();
    assert!(shown.iter().all(|pair| different.contains(pair)));
    assert_eq!(shown.len(), pairs.len(), "enough participants see all of them");
}

#[test]
fn the_original_shows_everybody_the_same_sides_in_an_order_of_their_own() {
    let study = paper_with("schema = 1", "schema = 1").unwrap();
    let questionnaire = Questionnaire::of(&study).unwrap();
    let forms = questionnaire.planned();
    assert_eq!((forms.len(), forms[0].trials.len()), (18, 27));
    assert_eq!(questionnaire.pairs().len(), 27);
    for form in &forms {
        for trial in &form.trials {
            let listed = &study.comparisons[trial.comparison.unwrap()];
            assert_eq!((&trial.shown[0], &trial.shown[1]), (&listed.left, &listed.right));
        }
    }
    let orders: BTreeSet<Vec<usize>> =
        forms.iter().map(|form| form.trials.iter().map(|t| t.comparison.unwrap()).collect()).collect();
    assert_eq!(orders.len(), 18);
}

/// Three repeats have six ends, and the study six methods. Two and three blocks hold other contrasts each.
#[test]
fn repeats_favour_no_method_no_contrast_and_no_object() {
    for seed in 0..20 {
        for max_questions in [15, 20, 33] {
            let mut study = study(|_| true, balanced(6, 3, 3, max_questions));
            study.file.study.seed = seed;
            let questionnaire = Questionnaire::of(&study).unwrap();
            let (mut methods, mut objects, mut contrasts) =
                (BTreeMap::new(), BTreeMap::new(), BTreeMap::new());
            let mut configurations: BTreeMap<&ConfigurationId, i64> = BTreeMap::new();
            for trial in questionnaire.blocks.iter().flat_map(|block| &block.repeats) {
                for end in [&trial.shown[0], &trial.shown[1]] {
                    *methods.entry(end.method).or_insert(0) += 1;
                    *configurations.entry(end).or_insert(0) += 1;
                }
                *objects.entry(&trial.shown[0].object).or_insert(0) += 1;
                let ends = (trial.shown[0].method, trial.shown[1].method);
                *contrasts.entry((ends.0.min(ends.1), ends.0.max(ends.1))).or_insert(0) += 1;
            }
            let blocks = questionnaire.blocks();
            assert!(configurations.values().all(|&n| n <= blocks.min(2) as i64), "{seed} {configurations:?}");
            assert!(contrasts.len() >= 3 * blocks - usize::from(blocks > 1), "{seed} {contrasts:?}");
            if blocks == 1 {
                assert!(methods.len() == 6 && methods.into_values().all(|n| n == 1), "{seed}");
                assert!(objects.len() == 3 && objects.into_values().all(|n| n == 1), "{seed}");
            }
            let controls = &questionnaire.blocks[0].controls;
            let of_controls: BTreeSet<_> = controls.iter().map(|trial| trial.shown[0].method).collect();
            let on: BTreeSet<_> = controls.iter().map(|trial| &trial.shown[0].object).collect();
            assert_eq!((of_controls.len(), on.len()), (3, 3), "{seed}");
        }
    }
}

/// Forms that people may have answered. Digests are FNV-1a of the forms as text, taken before comparisons of several blocks were
/// dealt by a search.
#[test]
fn forms_of_one_block_are_what_they_always_were() {
    let known = [
        ("balanced.toml", 2_918_996_585_394_782_393),
        ("two-methods.toml", 10_534_533_877_068_325_237),
        ("paper.toml", 13_967_142_664_581_063_407),
    ];
    for (name, digest) in known {
        let study = crate::load::tests::load(name);
        let forms = Questionnaire::of(&study).unwrap().planned();
        let text: String = forms
            .iter()
            .flat_map(|form| &form.trials)
            .map(|t| format!("{:?} {} {} {}\n", t.role, t.question, t.shown[0], t.shown[1]))
            .collect();
        let found = text.bytes().fold(0xcbf2_9ce4_8422_2325_u64, |state, byte| {
            (state ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3)
        });
        assert_eq!(found, digest, "{name}");
    }
}
