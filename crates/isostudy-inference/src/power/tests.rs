use super::*;
use crate::fixture;
use crate::hypotheses;
use isostudy_design::config::{FamilyRule, FormsSection};
use isostudy_statistics::simulation::Population;
use isostudy_statistics::{DeclaredBallot, Preference};
use rand::RngExt;

/// Level of the tests of these studies.
const ALPHA: f64 = 0.05;

/// The paper's 27 comparisons, dealt to participants with sides balanced.
fn study() -> Study {
    let mut study = fixture::study();
    let forms: &mut FormsSection = study.file.forms.as_mut().unwrap();
    forms.sides = isostudy_design::config::SideRule::Balanced;
    study
}

fn assumptions(studies: u64) -> Assumptions {
    Assumptions {
        participants: vec![18, 36],
        shares: vec![0.60, 0.69, 0.77],
        person_sd: 1.0,
        object_sd: 0.0,
        ties: 0.3,
        studies,
        seed: 3,
    }
}

#[test]
fn as_simulated_independently() {
    // By questions: N = 18, N = 36 at shares 0.60, 0.69, 0.77; an independent simulation in Python, two decimals.
    let expected: [(usize, [[f64; 3]; 2]); 3] = [
        (1, [[0.07, 0.19, 0.39], [0.14, 0.37, 0.71]]),
        (3, [[0.11, 0.42, 0.78], [0.28, 0.76, 0.99]]),
        (9, [[0.23, 0.71, 0.96], [0.48, 0.97, 1.00]]),
    ];
    let assumptions = assumptions(1000);
    let all = power(&study(), &assumptions, &|| ()).unwrap();
    for (questions, powers) in expected {
        for (n, powers) in assumptions.participants.iter().zip(powers) {
            for (share, expected) in assumptions.shares.iter().zip(powers) {
                let of_kind = |p: &&Power| (p.questions, p.participants, p.share) == (questions, *n, *share);
                let found: Vec<&Power> = all.iter().filter(of_kind).collect();
                // All contrasts of a kind are alike; the mean is nearer the truth than each, and is given the error of one.
                let mean = found.iter().map(|p| p.power).sum::<f64>() / found.len() as f64;
                let error = (expected * (1.0 - expected) / assumptions.studies as f64).sqrt();
                let off = (mean - expected).abs();
                assert!(off <= 3.0 * error + 0.005, "{questions} {n} {share}: {mean} against {expected}");
            }
        }
    }
}

/// Chance that the sign test of one answer each rejects in favour of the first, added up over all ways to answer.
fn exactly([first, _, second]: [f64; 3], participants: u64) -> f64 {
    let ln_choose = |n: u64, k: u64| {
        ((n - k + 1)..=n).map(|i| (i as f64).ln()).sum::<f64>()
            - (1..=k).map(|i| (i as f64).ln()).sum::<f64>()
    };
    let tie = 1.0 - first - second;
    let mut sum = 0.0;
    for decided in 0..=participants {
        for wins in 0..=decided {
            let counts = BTreeMap::from([(1, wins), (-1, decided - wins)]);
            if 2 * wins > decided && sign_flip_of_counts(&counts).p() <= ALPHA {
                let ways = ln_choose(participants, decided) + ln_choose(decided, wins);
                let chance = first.powi(wins as i32) * second.powi((decided - wins) as i32);
                sum += ways.exp() * chance * tie.powi((participants - decided) as i32);
            }
        }
    }
    sum
}

#[test]
fn single_questions_have_their_exact_power() {
    let assumptions = Assumptions { studies: 2000, object_sd: 0.7, ..assumptions(0) };
    let all = power(&study(), &assumptions, &|| ()).unwrap();
    for &share in &assumptions.shares {
        let ahead = (share / (1.0 - share)).ln();
        let population = Population { worths: vec![ahead, 0.0], sd: 1.0, ..Population::indifferent(2, 0.0) };
        for &n in &assumptions.participants {
            // Over objects by Simpson's rule, as over people within.
            let (mut sum, mut total) = (0.0, 0.0);
            for i in -20..=20 {
                let z = f64::from(i) / 5.0;
                let weight = (-0.5 * z * z).exp();
                let shifted = Population { worths: vec![ahead + 0.7 * z, 0.0], ..population.clone() };
                sum += weight * exactly(shifted.chances((0, 1), 0), n as u64);
                total += weight;
            }
            let expected = sum / total;
            let own =
                all.iter().filter(|p| (p.family.as_str(), p.participants, p.share) == (QUESTIONS, n, share));
            let error = (expected * (1.0 - expected) / assumptions.studies as f64).sqrt();
            for power in own {
                // 27 questions, three shares, two numbers: four errors leave one in a hundred runs.
                assert!((power.power - expected).abs() <= 4.0 * error, "{power:?} against {expected}");
            }
        }
    }
}

#[test]
fn without_an_effect_no_more_than_the_level() {
    let none = Assumptions { shares: vec![0.5], ..assumptions(2000) };
    for power in power(&study(), &none, &|| ()).unwrap() {
        assert!(power.power <= ALPHA + 4.0 * (ALPHA * (1.0 - ALPHA) / 2000.0).sqrt(), "{power:?}");
        assert!(power.adjusted <= power.power);
    }
}

#[test]
fn the_same_on_any_number_of_threads() {
    let run = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| power(&study(), &assumptions(40), &|| ()).unwrap())
    };
    assert_eq!(run(1), run(3));
}

#[test]
fn blocks_ask_each_participant_a_part() {
    let mut study = study();
    study.file.forms.as_mut().unwrap().max_questions = 9;
    let whole = power(&self::study(), &assumptions(300), &|| ()).unwrap();
    let blocks = power(&study, &assumptions(300), &|| ()).unwrap();
    let sum = |all: &[Power]| all.iter().map(|p| p.power).sum::<f64>();
    assert!(sum(&blocks) < 0.8 * sum(&whole));
    study.file.forms = None;
    assert_eq!(power(&study, &assumptions(1), &|| ()), None);
}

#[test]
fn what_is_found_is_what_was_assumed() {
    // Objects differ much more than the assumed preference: half of them favour the other.
    let chance =
        Assumptions { shares: vec![0.501], object_sd: 3.0, participants: vec![200], ..assumptions(400) };
    let all = power(&study(), &chance, &|| ()).unwrap();
    for power in all.iter().filter(|p| p.family == "objects") {
        assert!((0.3..0.55).contains(&power.power), "{power:?}");
    }
    let certain = Power { power: 1.0, adjusted: 0.0, studies: 10, ..all[0].clone() };
    assert!(certain.errors().into_iter().all(|error| error > 0.05 && error < 0.15), "{:?}", certain.errors());
}

/// A study is tested as the analysis tests it: the same contrasts, families, scores and p, whatever people answer.
#[test]
fn power_and_analysis_test_the_same() {
    let mut random = stream(5, 0);
    for (max_questions, rule, primary) in [
        (27, FamilyRule::ByKind, ""),
        (27, FamilyRule::One, "B-S"),
        (9, FamilyRule::ByKind, "U-I within B"),
        (9, FamilyRule::One, "B-S U - I"),
        (7, FamilyRule::One, ""),
        (4, FamilyRule::One, "U-P sphere - bunny"),
    ] {
        let mut study = study();
        study.file.forms.as_mut().unwrap().max_questions = max_questions;
        study.file.analysis.families = rule;
        study.file.analysis.primary =
            Some(primary.to_owned()).filter(|name| !name.is_empty()).into_iter().collect();
        let setting = Setting::of(&study).unwrap();
        for people in [2, 5, 14] {
            let mut ballots = Vec::new();
            let mut counts: Vec<BTreeMap<i64, u64>> = vec![BTreeMap::new(); setting.targets.len()];
            for person in 0..people {
                let block = person % setting.blocks.len();
                let mut signs = vec![0; setting.questions.len()];
                for &question in &setting.blocks[block] {
                    let preference = [Preference::First, Preference::Neither, Preference::Second]
                        [random.random_range(0..3)];
                    signs[question] = preference.sign();
                    ballots.push(DeclaredBallot::new(person, question, [0, 1], preference));
                }
                for (target, counts) in setting.targets.iter().zip(&mut counts) {
                    let asked = &target.weights[block];
                    if !asked.is_empty() {
                        *counts
                            .entry(asked.iter().map(|&(q, weight)| weight * signs[q]).sum())
                            .or_default() += 1;
                    }
                }
            }
            ballots.sort_by_key(|ballot| (ballot.question(), ballot.participant()));
            let tests = counts.iter().map(|of| (!of.is_empty()).then(|| sign_flip_of_counts(of).p()));
            let p: Vec<Option<f64>> = tests.collect();
            let adjusted = setting.adjusted(&p);
            let analysed = hypotheses::of_study(&study, &ballots);
            let told = setting.targets.iter().filter(|target| target.told).count();
            let plain = analysed.iter().filter(|of| !of.scope.contains(" - "));
            assert_eq!(told, plain.count(), "{max_questions} {rule:?}");
            for (i, target) in setting.targets.iter().enumerate() {
                let same = |of: &&hypotheses::Hypothesis| {
                    (of.family.as_str(), &of.contrast, &of.scope)
                        == (target.family.as_str(), &target.contrast, &target.scope)
                };
                let of = analysed.iter().find(same).unwrap();
                let name = format!("{} {} {} of {people}", target.family, target.contrast, target.scope);
                let expected = of.is_tested().then(|| of.test.sign_flip.p());
                assert_eq!(p[i], expected, "{name}");
                assert_eq!(adjusted[i], expected.map(|_| of.adjusted), "{name}");
            }
        }
    }
}

/// Questions that differ in both letters are contrasts of their own, and count as in the analysis.
#[test]
fn methods_that_differ_in_both_factors_have_power_too() {
    let mut study = study();
    for comparison in &mut study.comparisons {
        if comparison.group == 2 {
            let lattice = &comparison.left.method.as_str()[..1];
            comparison.left.method = format!("{lattice}i").parse().unwrap();
        }
    }
    let all = power(&study, &assumptions(100), &|| ()).unwrap();
    let families: Vec<&str> = all.iter().map(|power| power.family.as_str()).collect();
    assert!(["methods", "objects-method"].iter().all(|family| families.contains(family)), "{families:?}");
    let questions = all.iter().filter(|power| power.family == QUESTIONS).count();
    assert_eq!(questions, 27 * 2 * 3);
}

#[test]
fn a_stricter_study_finds_less() {
    let mut study = study();
    let sum = |study: &Study| -> [f64; 2] {
        let all = power(study, &assumptions(200), &|| ()).unwrap();
        [
            all.iter().map(|p| p.power).sum(),
            all.iter().filter(|p| p.family != QUESTIONS).map(|p| p.adjusted).sum(),
        ]
    };
    let usual = sum(&study);
    study.file.analysis.families = FamilyRule::One;
    let one_family = sum(&study);
    assert!(one_family[0] == usual[0] && one_family[1] < usual[1], "{usual:?} {one_family:?}");
    study.file.analysis.level = 0.005;
    assert!(sum(&study)[0] < usual[0]);
}
