//! The paper's contrasts by name, and those of many designs against definitions written out by themselves.

use super::*;
use crate::config::{AnalysisSection, FamilyRule};
use crate::load::tests::{cross, load, paper_with};
use crate::method::{Arrangement, Clustering, ConfigurationId, Crossed, MethodId};
use crate::study::{Comparison, Group};
use proptest::prelude::*;

fn paper() -> Study {
    paper_with("schema = 1", "schema = 1").unwrap()
}

fn of(all: &[Contrast], family: Family) -> Vec<String> {
    all.iter().filter(|c| c.family == family).map(|c| format!("{} {}", c.name, c.scope)).collect()
}

/// The paper's two factors, and the one that every study has.
const ARRANGEMENT: Factor = Factor(0);
const CLUSTERING: Factor = Factor(1);
const METHOD: Factor = Factor(2);

fn crossed(method: MethodId) -> Crossed {
    Crossed::of(method).expect("two letters")
}

/// The paper's study with other factors, objects and questions, all in one group.
fn design(arrangements: &str, clusterings: &str, objects: usize, asked: &[(usize, &str, &str)]) -> Study {
    let mut study = paper();
    let methods = |codes: &str, suffix: &str, prefix: &str| -> Vec<Crossed> {
        codes.chars().map(|c| crossed(format!("{prefix}{c}{suffix}").parse().unwrap())).collect()
    };
    let arrangements: Vec<Arrangement> =
        methods(arrangements, "u", "").iter().map(|m| m.arrangement).collect();
    let clusterings: Vec<Clustering> = methods(clusterings, "", "b").iter().map(|m| m.clustering).collect();
    cross(&mut study, &arrangements, &clusterings);
    let object = study.file.objects[0].clone();
    study.file.objects = (0..objects)
        .map(|o| {
            let mut object = object.clone();
            (object.id, object.name) = (format!("o{o}"), format!("object {o}"));
            object
        })
        .collect();
    let comparison = |(i, &(object, left, right)): (usize, &(usize, &str, &str))| {
        let id = |method: &str| format!("o{object}_{method}").parse::<ConfigurationId>().unwrap();
        Comparison { question: format!("Q{i}"), object, group: 0, left: id(left), right: id(right) }
    };
    study.comparisons = asked.iter().enumerate().map(comparison).collect();
    study.groups = vec![Group {
        id: "G".into(),
        label: "all".into(),
        members: study.method_ids(),
        comparisons: (0..asked.len()).collect(),
    }];
    study
}

#[test]
fn the_papers_contrasts() {
    let all = contrasts(&paper());
    assert_eq!(of(&all, Family::Pooled), ["U-I all", "U-P all", "P-I all", "B-S all"]);
    let groups = [
        "U-I within B",
        "U-I within S",
        "U-P within B",
        "U-P within S",
        "P-I within B",
        "P-I within S",
        "B-S within U",
        "B-S within I",
        "B-S within P",
    ];
    assert_eq!(of(&all, Family::Groups), groups);
    assert_eq!(of(&all, Family::Objects(ARRANGEMENT)), ["B-S sphere", "B-S asteroid", "B-S bunny"]);
    let by_object = of(&all, Family::Objects(CLUSTERING));
    assert_eq!((by_object.len(), by_object[1].as_str()), (9, "U-I asteroid"));
    let interactions = ["U-I B - S", "U-P B - S", "P-I B - S", "B-S U - I", "B-S U - P", "B-S I - P"];
    assert_eq!(of(&all, Family::Interactions), interactions);
    let pairs = ["B-S sphere - asteroid", "B-S sphere - bunny", "B-S asteroid - bunny"];
    assert_eq!(of(&all, Family::ObjectPairs(ARRANGEMENT)), pairs);
    assert_eq!(of(&all, Family::ObjectPairs(CLUSTERING)).len(), 9);
    assert_eq!(of(&all, Family::Methods), [""; 0]);
    assert_eq!(all.len(), 4 + 9 + 3 + 9 + 6 + 3 + 9);
    assert!(all.is_sorted_by_key(|contrast| contrast.family));
}

#[test]
fn differences_weigh_both_parts_alike() {
    let all = contrasts(&paper());
    for contrast in &all {
        let sum: i64 = contrast.weights.values().sum();
        if contrast.is_difference() {
            // Every question of the paper shows the first on the left, so the two means cancel.
            assert_eq!((sum, contrast.parts.len()), (0, 2), "{contrast}");
        } else {
            assert!(contrast.weights.values().all(|&weight| weight == 1), "{contrast}");
            assert_eq!(contrast.parts, std::slice::from_ref(&contrast.weights));
        }
    }
    let weights = |name: &str| {
        let found = all.iter().find(|c| c.to_string() == name).unwrap();
        found.weights.values().copied().collect::<Vec<_>>()
    };
    assert_eq!(weights("B-S U - I"), [1, -1, 1, -1, 1, -1]);
    assert_eq!(weights("U-I sphere - bunny"), [1, 1, -1, -1]);
    // Three questions on one object against two on the other, one of them listed the other way round.
    let asked = [(0, "bu", "su"), (0, "bi", "si"), (0, "bp", "sp"), (1, "bu", "su"), (1, "si", "bi")];
    let uneven = contrasts(&design("bs", "uip", 2, &asked));
    let pair = uneven.iter().find(|c| c.to_string() == "B-S object 0 - object 1").unwrap();
    assert_eq!(pair.weights.values().copied().collect::<Vec<_>>(), [2, 2, 2, -3, 3]);
    assert_eq!(pair.parts[1], [(3, 1), (4, -1)].into());
}

#[test]
fn one_hypothesis_is_counted_once() {
    // One arrangement: "within B" is the pooled contrast. One object: so is that object's.
    let study = design("b", "ui", 1, &[(0, "bu", "bi")]);
    let names = |study: &Study| contrasts(study).iter().map(ToString::to_string).collect::<Vec<_>>();
    assert_eq!(names(&study), ["U-I"]);
    // Two objects: their difference is there once, not once for each.
    assert_eq!(
        names(&load("two-methods.toml")),
        ["U-I", "U-I sphere", "U-I asteroid", "U-I sphere - asteroid"]
    );
    // What the one object is asked within one clustering alone is told by the clustering.
    let study = design("bs", "ui", 2, &[(0, "bu", "su"), (1, "si", "bi")]);
    assert_eq!(names(&study), ["B-S", "B-S within U", "B-S within I", "B-S U - I"]);
}

#[test]
fn three_arrangements_interact_in_pairs() {
    let asked = [(0, "bu", "bp"), (0, "su", "sp"), (0, "mp", "mu")];
    let all = contrasts(&design("bsm", "up", 1, &asked));
    assert_eq!(of(&all, Family::Interactions), ["U-P B - S", "U-P B - M", "U-P S - M"]);
    assert_eq!(all.iter().find(|c| c.scope == "B - M").unwrap().weights, [(0, 1), (2, 1)].into());
}

#[test]
fn of_many_objects_no_two_are_held_against_each_other() {
    let pairs = |objects: usize| {
        let asked: Vec<(usize, &str, &str)> = (0..objects).map(|o| (o, "bu", "bi")).collect();
        let all = contrasts(&design("b", "ui", objects, &asked));
        assert_eq!(of(&all, Family::Objects(CLUSTERING)).len(), objects);
        of(&all, Family::ObjectPairs(CLUSTERING)).len()
    };
    assert_eq!([pairs(2), pairs(PAIRED_OBJECTS), pairs(PAIRED_OBJECTS + 1)], [1, 190, 0]);
}

#[test]
fn methods_that_differ_in_both_factors_are_tested_as_methods() {
    let asked = [(0, "bu", "si"), (1, "si", "bu"), (1, "bi", "su"), (0, "bu", "bi")];
    let study = design("bs", "ui", 2, &asked);
    let all = contrasts(&study);
    let names: Vec<(&str, String)> = all.iter().map(|c| (c.family_name.as_str(), c.to_string())).collect();
    let expected = [
        ("pooled", "U-I"),
        ("methods", "bu-si"),
        ("methods", "bi-su"),
        ("objects-method", "bu-si object 0"),
        ("objects-method", "bu-si object 1"),
        ("object-pairs-method", "bu-si object 0 - object 1"),
    ];
    assert_eq!(names, expected.map(|(family, name)| (family, name.to_owned())));
    assert_eq!(all[1].weights, [(0, 1), (1, -1)].into());
    assert_eq!(study.level(all[1].levels[0]).label, "body-centred, none");
}

#[test]
fn families_of_correction() {
    let study = paper();
    let all = contrasts(&study);
    let sizes = |section: &AnalysisSection| -> Vec<(String, usize)> {
        families(&all, section).into_iter().map(|family| (family.name, family.members.len())).collect()
    };
    let named = |sizes: &[(&str, usize)]| -> Vec<(String, usize)> {
        sizes.iter().map(|&(name, size)| (name.to_owned(), size)).collect()
    };
    let mut section = AnalysisSection::default();
    let by_kind = [
        ("pooled", 4),
        ("groups", 9),
        ("objects", 3),
        ("objects-clustering", 9),
        ("interactions", 6),
        ("object-pairs", 3),
        ("object-pairs-clustering", 9),
    ];
    assert_eq!(sizes(&section), named(&by_kind));
    section.primary = ["B-S within U", "B-S"].map(String::from).into();
    assert_eq!(sizes(&section)[..3], named(&[("primary", 2), ("pooled", 3), ("groups", 8)]));
    let first = &families(&all, &section)[0];
    assert_eq!(
        first.members.iter().map(|&i| all[i].to_string()).collect::<Vec<_>>(),
        ["B-S", "B-S within U"]
    );
    section.families = FamilyRule::One;
    assert_eq!(sizes(&section), named(&[("primary", 2), ("all", 41)]));
    section.primary.clear();
    assert_eq!(sizes(&section), named(&[("all", 43)]));
}

#[test]
fn primary_contrasts_must_be_there() {
    let path = load("two-methods.toml").path;
    let text = std::fs::read_to_string(&path).unwrap();
    let with = |names: &str| {
        Study::parse(&text.replace("[analysis]", &format!("[analysis]\nprimary = {names}")), &path)
    };
    assert!(with(r#"["U-I", "U-I sphere - asteroid"]"#).is_ok());
    let Err(crate::ConfigError::Value { key, value, limit, .. }) = with(r#"["U-I", "I-U"]"#) else {
        panic!("I-U is taken for a contrast")
    };
    assert_eq!((&*key, &*value), ("analysis.primary[1]", "I-U"));
    assert!(limit.ends_with(": U-I, U-I sphere, U-I asteroid, U-I sphere - asteroid"), "{limit}");
}

/// Sums of answers by their definitions, question by question. Signs are those of `A-B`, so the pair's own order does not matter.
fn scores(study: &Study, answers: &[i64], kept: impl Fn(&Comparison) -> Option<i64>) -> Option<(i64, i64)> {
    let own = study.comparisons.iter().zip(answers).filter_map(|(c, answer)| Some(kept(c)? * answer));
    let (count, sum) = own.fold((0, 0), |(count, sum), signed| (count + 1, sum + signed));
    (count > 0).then_some((sum, count))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn every_design_has_the_contrasts_that_their_definitions_give(
        arrangements in 1usize..5,
        clusterings in 1usize..3,
        objects in 1usize..5,
        asked in prop::collection::btree_map((0usize..4, 0usize..8, 0usize..8), any::<bool>(), 1..40),
        answers in prop::collection::vec(-1i64..2, 40),
    ) {
        // Clusterings that every arrangement has.
        let methods: Vec<String> =
            (0..8).map(|m| format!("{}{}", ["b", "s", "m", "f"][m % arrangements], ["u", "p"][m / 4 % clusterings])).collect();
        let mut listed: Vec<(usize, &str, &str)> = Vec::new();
        for ((object, a, b), swapped) in &asked {
            let (object, a, b) = (object % objects, methods[*a].as_str(), methods[*b].as_str());
            if a != b && !listed.contains(&(object, a, b)) && !listed.contains(&(object, b, a)) {
                listed.push(if *swapped { (object, b, a) } else { (object, a, b) });
            }
        }
        let study = design(&"bsmf"[..arrangements], &"up"[..clusterings], objects, &listed);
        let all = contrasts(&study);

        // Every question is in exactly one contrast over all answers.
        for q in 0..listed.len() {
            let whole = all.iter().filter(|c| c.over == Over::All && c.weights.contains_key(&q)).count();
            prop_assert_eq!(whole, 1);
        }
        let mut hypotheses: Vec<Vec<(usize, i64)>> = Vec::new();
        for contrast in &all {
            // Multiples of one another: equal cross products.
            let weights: Vec<(usize, i64)> = contrast.weights.iter().map(|(&q, &w)| (q, w)).collect();
            let same = |other: &Vec<(usize, i64)>| other.len() == weights.len()
                && other.iter().zip(&weights).all(|(a, b)| a.0 == b.0 && a.1 * weights[0].1 == b.1 * other[0].1);
            prop_assert!(!hypotheses.iter().any(same), "{} twice", contrast);
            hypotheses.push(weights);

            let sign = |c: &Comparison| -> Option<i64> {
                let (l, r) = (crossed(c.left.method), crossed(c.right.method));
                let factor = contrast.levels[0].factor;
                let ends = |m: Crossed| {
                    let index = match factor {
                        ARRANGEMENT => "bsmf".find(m.arrangement.code()).unwrap(),
                        CLUSTERING => "up".find(m.clustering.code()).unwrap(),
                        _ => study.methods.iter().position(|of| of.id == m.id()).unwrap(),
                    };
                    Level { factor, index }
                };
                let differ = usize::from(l.arrangement != r.arrangement) + usize::from(l.clustering != r.clustering);
                let wanted = if factor == METHOD { 2 } else { 1 };
                let [a, b] = contrast.levels;
                match [ends(l), ends(r)] {
                    _ if differ != wanted => None,
                    [x, y] if [x, y] == [a, b] => Some(1),
                    [x, y] if [x, y] == [b, a] => Some(-1),
                    _ => None,
                }
            };
            let has = |c: &Comparison, level: Level| {
                let letter = |m: MethodId| m.as_str().chars().nth(level.factor.0).unwrap();
                let wanted = ["bsmf", "up"][level.factor.0].chars().nth(level.index).unwrap();
                letter(c.left.method) == wanted && letter(c.right.method) == wanted
            };
            let part = |kept: &dyn Fn(&Comparison) -> bool| scores(&study, &answers, |c| if kept(c) { sign(c) } else { None });
            // Means of the parts times their sizes, as fractions.
            let expected = match contrast.over {
                Over::All => vec![part(&|_| true)],
                Over::Within(level) => vec![part(&|c| has(c, level))],
                Over::Object(o) => vec![part(&|c| c.object == o)],
                Over::Difference(a, b) => vec![part(&|c| has(c, a)), part(&|c| has(c, b))],
                Over::ObjectDifference(a, b) => vec![part(&|c| c.object == a), part(&|c| c.object == b)],
            };
            let expected: Vec<(i64, i64)> = expected.into_iter().map(|part| part.expect("not empty")).collect();
            let found: Vec<(i64, i64)> = contrast.parts.iter().map(|part| {
                (part.iter().map(|(&q, sign)| sign * answers[q]).sum(), part.len() as i64)
            }).collect();
            prop_assert_eq!(&found, &expected, "{}", contrast);
            let sum: i64 = contrast.weights.iter().map(|(&q, weight)| weight * answers[q]).sum();
            let scale: i64 = contrast.weights.iter().map(|(q, w)| if contrast.parts[0].contains_key(q) { w.abs() } else { 0 }).sum();
            let mean = |(sum, count): (i64, i64)| sum as f64 / count as f64;
            let difference = expected.iter().skip(1).fold(mean(expected[0]), |first, &second| first - mean(second));
            prop_assert!((sum as f64 / scale as f64 - difference).abs() < 1e-12, "{}", contrast);

            for q in 0..listed.len() {
                prop_assert_eq!(contrast.counts(|other| other == q), contrast.parts.len() == 1 && contrast.weights.contains_key(&q));
            }
            prop_assert!(contrast.counts(|_| true));
        }

        // Nothing is missing: what a definition gives is there, or another of the same questions and signs is.
        let key = |weights: &BTreeMap<usize, i64>| up_to_sign_and_scale(weights);
        let known: BTreeSet<_> = all.iter().map(|c| key(&c.weights)).collect();
        for whole in all.iter().filter(|c| c.over == Over::All) {
            for o in 0..objects {
                let own: BTreeMap<usize, i64> = whole.weights.iter().filter(|(q, _)| study.comparisons[**q].object == o)
                    .map(|(&q, &w)| (q, w)).collect();
                prop_assert!(own.is_empty() || known.contains(&key(&own)), "{} on {}", whole, o);
            }
            for level in study.levels(ARRANGEMENT).into_iter().chain(study.levels(CLUSTERING)) {
                if whole.family == Family::Methods || level.factor == whole.levels[0].factor {
                    continue;
                }
                let own: BTreeMap<usize, i64> = whole.weights.iter().filter(|(q, _)| {
                    let Comparison { left, .. } = &study.comparisons[**q];
                    study.level_of(left.method, level.factor) == Some(level)
                }).map(|(&q, &w)| (q, w)).collect();
                prop_assert!(own.is_empty() || known.contains(&key(&own)), "{} within {}", whole, study.level(level).code);
            }
        }
    }
}
