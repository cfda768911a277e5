use super::*;
use crate::fixture;
use crate::hypotheses;
use isostudy_design::config::{FamilyRule, FormsSection};
use isostudy_statistics::simulation::Population;
use isostudy_statistics::{DeclaredBallot, Preference};
use rand::RngExt;
use std::path::Path;

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
        side_biases: vec![0.0],
        person_sd: 1.0,
        object_sd: 0.0,
        ties: 0.3,
        way: Way::default(),
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
                let mean = found.iter().map(|p| p.uncorrected).sum::<f64>() / found.len() as f64;
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
                assert!((power.uncorrected - expected).abs() <= 4.0 * error, "{power:?} against {expected}");
            }
        }
    }
}

#[test]
fn forced_questions_have_their_exact_power() {
    let forced = Assumptions { way: Way::Forced, shares: vec![0.69], ..assumptions(2000) };
    let all = power(&study(), &forced, &|| ()).unwrap();
    let ahead = (0.69_f64 / 0.31).ln();
    let population = Population { worths: vec![ahead, 0.0], nu: 0.0, ..Population::indifferent(2, 1.0) };
    for &n in &forced.participants {
        let expected = exactly(population.chances((0, 1), 0), n as u64);
        let error = (expected * (1.0 - expected) / 2000.0).sqrt();
        for power in all.iter().filter(|p| (p.family.as_str(), p.participants) == (QUESTIONS, n)) {
            assert!((power.uncorrected - expected).abs() <= 4.0 * error, "{power:?} against {expected}");
        }
    }
}

#[test]
fn every_way_to_ask_keeps_its_level_and_steps_find_no_less() {
    let mean = |way: Way, share: f64, studies: u64| {
        let of = Assumptions { way, shares: vec![share], participants: vec![36], ..assumptions(studies) };
        let all = power(&study(), &of, &|| ()).unwrap();
        let own: Vec<f64> = all.iter().filter(|p| p.questions == 3).map(|p| p.uncorrected).collect();
        own.iter().sum::<f64>() / own.len() as f64
    };
    for way in Way::ALL {
        // Nine kinds of tests, and 400 studies each: a standard error of 0.004 at most if they were alike, 0.011 if one.
        let none = mean(way, 0.5, 400);
        assert!((0.03..=0.075).contains(&none), "{way:?}: {none}");
    }
    let [pairs, graded] = [Way::Pairs, Way::Graded].map(|way| mean(way, 0.69, 300));
    assert!(graded > pairs - 0.02, "{pairs} {graded}");
}

#[test]
fn without_an_effect_no_more_than_the_level() {
    let none = Assumptions { shares: vec![0.5], ..assumptions(2000) };
    for power in power(&study(), &none, &|| ()).unwrap() {
        assert!(power.uncorrected <= ALPHA + 4.0 * (ALPHA * (1.0 - ALPHA) / 2000.0).sqrt(), "{power:?}");
        assert!(power.corrected <= power.uncorrected);
    }
}

/// By people, share and liking for the left side: B-S on one object after Holm's correction over three objects, the same without it,
/// and one question without it. By NumPy 2.4.6, `default_rng(34)`, 10,000 studies a row: scores of 36 people on the sides of the
/// file that `isostudy design forms configs/balanced.toml` writes, p by convolving the signs of the scores, Holm's correction by hand.
const BY_NUMPY: [(usize, f64, f64, [f64; 3]); 12] = [
    (18, 0.60, 0.0, [0.065, 0.128, 0.070]),
    (18, 0.60, 1.5, [0.017, 0.048, 0.029]),
    (18, 0.69, 0.0, [0.299, 0.425, 0.199]),
    (18, 0.69, 1.5, [0.097, 0.195, 0.086]),
    (18, 0.77, 0.0, [0.710, 0.786, 0.416]),
    (18, 0.77, 1.5, [0.344, 0.493, 0.218]),
    (36, 0.60, 0.0, [0.165, 0.270, 0.111]),
    (36, 0.60, 1.5, [0.040, 0.102, 0.040]),
    (36, 0.69, 0.0, [0.699, 0.771, 0.379]),
    (36, 0.69, 1.5, [0.321, 0.467, 0.182]),
    (36, 0.77, 0.0, [0.979, 0.984, 0.725]),
    (36, 0.77, 1.5, [0.819, 0.867, 0.467]),
];

#[test]
fn as_judged_and_with_a_liked_side_by_numpy() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../configs/balanced.toml");
    let study = Study::load(&path).unwrap();
    let assumptions = Assumptions { side_biases: vec![0.0, 1.5], ..assumptions(2000) };
    let all = power(&study, &assumptions, &|| ()).unwrap();
    for (people, share, side, [corrected, uncorrected, question]) in BY_NUMPY {
        let of = |family: &str, contrast: &str| -> Vec<&Power> {
            let own = |p: &&Power| {
                (p.participants, p.share, p.side_bias) == (people, share, side)
                    && p.family == family
                    && p.contrast.starts_with(contrast)
            };
            all.iter().filter(own).collect()
        };
        // Three times the error of one of them, and half of the last digit.
        let is_near = |found: Vec<f64>, expected: f64| {
            let mean = found.iter().sum::<f64>() / found.len() as f64;
            let error = (expected * (1.0 - expected) / assumptions.studies as f64).sqrt();
            let place = format!("{people} {share} {side}: {mean} of {} against {expected}", found.len());
            assert!((mean - expected).abs() <= 3.0 * error + 0.0005, "{place}");
        };
        let objects = of("objects", "B-S");
        assert_eq!(objects.len(), 3);
        is_near(objects.iter().map(|p| p.corrected).collect(), corrected);
        is_near(objects.iter().map(|p| p.uncorrected).collect(), uncorrected);
        is_near(of(QUESTIONS, "bu-su").iter().map(|p| p.uncorrected).collect(), question);
    }
}

/// Balanced sides keep the level whatever side people like; sides as listed do not, and that is told.
#[test]
fn a_liked_side_finds_nothing_where_sides_are_balanced() {
    let none = Assumptions { shares: vec![0.5], side_biases: vec![1.5], ..assumptions(1000) };
    let level = ALPHA + 4.0 * (ALPHA * (1.0 - ALPHA) / 1000.0).sqrt();
    let balanced = power(&study(), &none, &|| ()).unwrap();
    assert!(balanced.iter().all(|p| p.uncorrected <= level && p.corrected <= level), "{balanced:?}");
    let mut listed = study();
    listed.file.forms.as_mut().unwrap().sides = isostudy_design::config::SideRule::AsListed;
    let wrong = power(&listed, &none, &|| ()).unwrap();
    assert!(wrong.iter().any(|p| p.participants == 36 && p.corrected > 0.5), "{wrong:?}");
}

#[test]
fn more_people_find_more_and_a_liked_side_hides() {
    let of = Assumptions {
        participants: vec![12, 24, 48, 96],
        shares: vec![0.69],
        side_biases: vec![0.0, 0.75, 1.5],
        ..assumptions(500)
    };
    let all = power(&study(), &of, &|| ()).unwrap();
    // A row per contrast and bonus, one after another by people.
    for row in all.chunks(of.participants.len()) {
        let ascends =
            |value: fn(&Power) -> f64| row.windows(2).all(|of| value(&of[0]) <= value(&of[1]) + 0.02);
        assert!(ascends(|p| p.corrected) && ascends(|p| p.uncorrected), "{row:?}");
        assert!(row[0].corrected + 0.2 < row[3].corrected || row[0].corrected > 0.8, "{row:?}");
    }
    let mean = |side: f64| {
        let own: Vec<f64> = all.iter().filter(|p| p.side_bias == side).map(|p| p.corrected).collect();
        own.iter().sum::<f64>() / own.len() as f64
    };
    assert!(
        mean(0.0) > mean(0.75) + 0.03 && mean(0.75) > mean(1.5) + 0.05,
        "{:?}",
        [0.0, 0.75, 1.5].map(mean)
    );
}

/// The spread of the paper's people is that of their conclusions.
#[test]
fn the_spread_is_that_of_the_conclusions() {
    let study = fixture::study();
    let found = spread_between_people(&study, fixture::answers(&study)).unwrap();
    assert_eq!(found.people, 18);
    let Spread { of, .. } = found;
    assert!(of.interval.low <= of.sd && of.sd <= of.interval.high, "{of:?}");
    let answered = fixture::answered(&study);
    let all = answered.groups.iter().find(|group| group.name == "all").unwrap();
    let people = isostudy_statistics::Participants::of(6, &all.ballots);
    assert_eq!(of, isostudy_statistics::heterogeneity(&people).unwrap());
    let mut nobody = fixture::answers(&study);
    nobody.answers.clear();
    assert!(spread_between_people(&study, nobody).is_err());
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
    let sum = |all: &[Power]| all.iter().map(|p| p.uncorrected).sum::<f64>();
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
        assert!((0.3..0.55).contains(&power.uncorrected), "{power:?}");
    }
    let certain = Power { uncorrected: 1.0, corrected: 0.0, studies: 10, ..all[0].clone() };
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
        let setting = Setting::of(&study, 0).unwrap();
        for people in [2, 5, 14] {
            let mut ballots = Vec::new();
            let mut counts: Vec<BTreeMap<i64, u64>> = vec![BTreeMap::new(); setting.targets.len()];
            for person in 0..people {
                let block = person % setting.blocks.len();
                let mut signs = vec![0; setting.questions.len()];
                for &Asked { question, .. } in &setting.blocks[block] {
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
            let analysed = hypotheses::of_study(&study, &ballots, None);
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
            all.iter().map(|p| p.uncorrected).sum(),
            all.iter().filter(|p| p.family != QUESTIONS).map(|p| p.corrected).sum(),
        ]
    };
    let usual = sum(&study);
    study.file.analysis.families = FamilyRule::One;
    let one_family = sum(&study);
    assert!(one_family[0] == usual[0] && one_family[1] < usual[1], "{usual:?} {one_family:?}");
    study.file.analysis.level = 0.005;
    assert!(sum(&study)[0] < usual[0]);
}
