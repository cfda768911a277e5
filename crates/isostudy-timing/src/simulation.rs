//! Runs made up from noise whose parts are known: what the verdicts are worth.

use super::*;
use crate::fixture;
use isostudy_design::record::{BenchRun, BenchSample, Counters, LoadWindow};
use isostudy_design::{ConfigurationId, Stage};
use isostudy_statistics::bootstrap::Resampling;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use std::f64::consts::TAU;
use std::ops::Range;

/// Where the noise of a run comes from; standard deviations are of logarithms.
#[derive(Clone, Copy)]
struct Noise {
    /// Of a single sample.
    sample: f64,
    /// Of a process and a configuration in it: what chance gave it stays with it.
    process: f64,
    /// The same of so many configurations, instead.
    restless: (usize, f64),
    /// Of the machine's speed from run to run; the reference work sees it.
    machine: f64,
    /// How far the speed wanders within a run, as a sine of one period.
    drift: f64,
    /// Chance of an outlier, which takes up to three times as long.
    outliers: f64,
    /// What others have of the CPU time. It is taken from us.
    others: f64,
}

const QUIET: Noise = Noise {
    sample: 0.02,
    process: 0.0,
    restless: (0, 0.0),
    machine: 0.0,
    drift: 0.0,
    outliers: 0.0,
    others: 0.0,
};

const ROUNDS: u32 = 100;
const AGAIN: u32 = 8;

struct Source {
    stream: Pcg64,
}

impl Source {
    fn uniform(&mut self) -> f64 {
        self.stream.random_range(f64::EPSILON..1.0)
    }

    /// Box and Muller.
    fn normal(&mut self) -> f64 {
        (-2.0 * self.uniform().ln()).sqrt() * (TAU * self.uniform()).cos()
    }
}

/// A run of the paper's plan: eight invocations of 12 or 13 rounds, and two of 4 that are the A/A block.
fn run(template: &BenchRun, ids: &[ConfigurationId], noise: Noise, factor: f64, seed: u64) -> BenchRun {
    let mut source = Source { stream: Pcg64::seed_from_u64(seed) };
    let mut run = BenchRun { iterations: ROUNDS, aa_iterations: AGAIN, samples: vec![], ..template.clone() };
    let measured = [0..12, 12..25, 25..37, 37..50, 50..62, 62..75, 75..87, 87..100];
    let mut invocations: Vec<(bool, Range<u32>)> =
        measured.into_iter().map(|rounds| (false, rounds)).collect();
    invocations.insert(3, (true, 0..4));
    invocations.insert(7, (true, 4..8));
    let speed = noise.machine * source.normal();
    let phase = source.uniform();
    let all = f64::from(ROUNDS + AGAIN);
    let mut round_of_run = 0.0;
    for ((aa, rounds), invocation) in invocations.into_iter().zip(0..) {
        let deviation = |place| if place < noise.restless.0 { noise.restless.1 } else { noise.process };
        let process: Vec<f64> = (0..ids.len()).map(|place| deviation(place) * source.normal()).collect();
        for iteration in rounds {
            let now = speed + noise.drift * (TAU * (round_of_run / all + phase)).sin();
            round_of_run += 1.0;
            for (place, id) in ids.iter().enumerate() {
                // From 10 ms to 400 ms, as the paper's configurations.
                let mut log = (0.01 * 1.24_f64.powi(place as i32)).ln() + now + process[place];
                log += noise.sample * source.normal() - (1.0 - noise.others).ln() + factor.ln();
                if source.uniform() < noise.outliers {
                    log += (1.0 + 2.0 * source.uniform()).ln();
                }
                let reference_s = 0.001 * (now + 0.01 * source.normal()).exp();
                let sample = sample(id, invocation, iteration, place as u32, log.exp(), reference_s);
                if aa { run.aa_samples.push(sample) } else { run.samples.push(sample) }
            }
            let (others, rounds) = (noise.others, Some((iteration, iteration)));
            run.load.push(LoadWindow {
                invocation: Some(invocation),
                rounds,
                others,
                steal: 0.0,
                load_average: None,
            });
        }
    }
    run
}

/// A sample of which only the total is known.
pub(super) fn sample(
    id: &ConfigurationId,
    invocation: u32,
    iteration: u32,
    place: u32,
    total_s: f64,
    reference_s: f64,
) -> BenchSample {
    BenchSample {
        id: id.clone(),
        invocation,
        iteration,
        place,
        allocation_s: 0.0,
        sampling_s: 0.0,
        vertex_s: 0.0,
        geometry_s: 0.0,
        clustering_s: 0.0,
        normals_s: 0.0,
        finishing_s: 0.0,
        total_s,
        reference_s: Some(reference_s),
        counters: Counters::default(),
    }
}

/// Of so many pairs of runs, how many have no verdict at all, and how many verdicts of each kind there are.
fn pairs(noises: [Noise; 2], factor: f64, count: u64) -> (u64, [u64; 2]) {
    let study = fixture::study();
    let template = fixture::bench(&study);
    let ids: Vec<ConfigurationId> = study.configurations.iter().map(|c| c.id.clone()).collect();
    let (mut silent, mut verdicts) = (0, [0; 2]);
    for pair in 0..count {
        let a = run(&template, &ids, noises[0], 1.0, 2 * pair);
        let b = run(&template, &ids, noises[1], factor, 2 * pair + 1);
        let comparison = compare(&a, &b, Vec::new());
        let is = |verdict| move |row: &&Row| row.judgement.verdict == verdict;
        let slower = comparison.of_stage(Stage::Total).filter(is(Verdict::Slower)).count() as u64;
        let faster = comparison.of_stage(Stage::Total).filter(is(Verdict::Faster)).count() as u64;
        silent += u64::from(slower + faster == 0);
        verdicts[0] += slower;
        verdicts[1] += faster;
    }
    (silent, verdicts)
}

/// 19 times in 20 at least, two runs of one build have no verdict on any of 18 configurations.
#[test]
fn one_build_is_not_told_from_itself() {
    let models = [
        ("samples alone", QUIET),
        ("much noise", Noise { sample: 0.2, ..QUIET }),
        ("processes as noisy as samples", Noise { process: 0.02, ..QUIET }),
        ("processes fifteen times as noisy", Noise { sample: 0.002, process: 0.03, ..QUIET }),
        ("one is restless", Noise { process: 0.005, restless: (1, 0.06), ..QUIET }),
        (
            "one is restless, samples quiet",
            Noise { sample: 0.005, process: 0.005, restless: (1, 0.06), ..QUIET },
        ),
        ("two are restless", Noise { process: 0.005, restless: (2, 0.1), ..QUIET }),
        ("six are restless", Noise { process: 0.01, restless: (6, 0.05), ..QUIET }),
        (
            "six are restless, samples quiet",
            Noise { sample: 0.005, process: 0.01, restless: (6, 0.05), ..QUIET },
        ),
        ("processes half as noisy", Noise { process: 0.01, ..QUIET }),
        ("another hour, another speed", Noise { machine: 0.05, process: 0.005, ..QUIET }),
        ("drift", Noise { drift: 0.03, process: 0.005, ..QUIET }),
        ("outliers", Noise { outliers: 0.1, process: 0.01, ..QUIET }),
        (
            "everything",
            Noise {
                sample: 0.03,
                process: 0.01,
                machine: 0.05,
                drift: 0.03,
                outliers: 0.05,
                others: 0.02,
                ..QUIET
            },
        ),
    ];
    for (name, noise) in models {
        let (silent, verdicts) = pairs([noise; 2], 1.0, 200);
        println!("{name}: {silent} of 200 without a verdict, {verdicts:?}");
        assert!(silent >= 190, "{name}: {silent} of 200, {verdicts:?}");
    }
}

/// The machine quiet in one run and busy in the other: the same build takes up to five times as long.
#[test]
fn a_busy_machine_is_no_slower_build() {
    for others in [0.1, 0.3, 0.5, 0.8] {
        let busy = Noise { others, sample: 0.05, process: 0.01, ..QUIET };
        let (silent, verdicts) = pairs([Noise { process: 0.01, ..QUIET }, busy], 1.0, 60);
        assert!(silent >= 57, "{others}: {silent} of 60, {verdicts:?}");
    }
}

#[test]
fn a_slower_build_is_caught() {
    let caught = |noise: Noise, factor| pairs([noise; 2], factor, 40).1;
    let [slower, faster] = caught(QUIET, 1.1);
    assert!(slower >= 40 * 18 * 95 / 100 && faster == 0, "10 % at 2 % noise: {slower} of 720");
    let [slower, faster] = caught(Noise { process: 0.005, outliers: 0.05, drift: 0.02, ..QUIET }, 1.1);
    assert!(slower >= 40 * 18 * 90 / 100 && faster == 0, "with outliers and drift: {slower} of 720");
    let [slower, faster] = caught(Noise { sample: 0.2, ..QUIET }, 1.4);
    assert!(slower >= 40 * 18 * 90 / 100 && faster == 0, "40 % at 20 % noise: {slower} of 720");
    let [slower, faster] = caught(Noise { sample: 0.1, process: 0.05, ..QUIET }, 1.35);
    assert!(slower >= 40 * 18 * 90 / 100 && faster == 0, "35 % at 5 % between processes: {slower} of 720");
    let [slower, faster] = caught(QUIET, 1.0 / 1.1);
    assert!(faster >= 40 * 18 * 95 / 100 && slower == 0, "a faster one: {faster} of 720");
}

#[test]
fn only_what_is_beyond_both_limits_is_a_regression() {
    let study = fixture::study();
    let template = fixture::bench(&study);
    let ids: Vec<ConfigurationId> = study.configurations.iter().map(|c| c.id.clone()).collect();
    let [a, b] = [(1.0, 1), (1.2, 2)].map(|(factor, seed)| run(&template, &ids, QUIET, factor, seed));
    let regressions = |relative, absolute_s| {
        compare(&a, &b, Vec::new()).regressions(&Limits { relative, absolute_s }).len()
    };
    assert_eq!(regressions(0.05, 0.0001), 18);
    assert_eq!(regressions(0.3, 0.0001), 0);
    // A fifth of 10 ms to 400 ms is above 20 ms for those that take more than 100 ms: the last seven.
    assert_eq!(regressions(0.05, 0.02), 7);
    let better = compare(&b, &a, Vec::new());
    assert!(better.of_stage(Stage::Total).all(|row| row.judgement.verdict == Verdict::Faster));
    assert!(better.regressions(&Limits { relative: 0.0, absolute_s: 0.0 }).is_empty());
}

#[test]
fn means_and_runs_without_a_second_measurement_get_no_verdict() {
    let study = fixture::study();
    let template = fixture::bench(&study);
    let ids: Vec<ConfigurationId> = study.configurations.iter().map(|c| c.id.clone()).collect();
    let a = run(&template, &ids, QUIET, 1.0, 1);
    let mut slow = run(&template, &ids, QUIET, 2.0, 2);
    slow.aa_samples.clear();
    let reasons = |b: &BenchRun| -> Vec<&str> {
        let comparison = compare(&a, b, Vec::new());
        let mut reasons: Vec<&str> =
            comparison.of_stage(Stage::Total).map(|row| row.judgement.reason).collect();
        reasons.dedup();
        reasons
    };
    assert_eq!(reasons(&slow), ["no A/A block: the noise floor is not known"]);
    let mut published = slow.clone();
    published.imported_from = Some("a table".into());
    published.samples.retain(|sample| sample.iteration == 0);
    assert_eq!(reasons(&published), ["a single value has no interval"]);
    let comparison = compare(&a, &published, Vec::new());
    assert!(comparison.of_stage(Stage::GeometryAsPublished).count() == 18);
    assert_eq!(comparison.of_stage(Stage::Clustering).count(), 0, "published geometry has it");
    let ratio = comparison.rows[0].ratio.unwrap();
    assert!((ratio - 2.0).abs() < 0.2, "the ratio is shown nevertheless: {ratio}");
}

#[test]
fn half_a_run_that_says_otherwise_stops_a_verdict() {
    let study = fixture::study();
    let template = fixture::bench(&study);
    let ids: Vec<ConfigurationId> = study.configurations.iter().map(|c| c.id.clone()).collect();
    let a = run(&template, &ids, QUIET, 1.0, 1);
    let mut b = run(&template, &ids, QUIET, 1.3, 2);
    for sample in b.samples.iter_mut().filter(|sample| sample.iteration < 33) {
        sample.total_s *= 0.7;
    }
    let comparison = compare(&a, &b, Vec::new());
    assert!(comparison.of_stage(Stage::Total).all(|row| row.judgement.verdict == Verdict::CannotSay));
}

/// Rounds that are slow for all configurations do not blur the ratios between them.
#[test]
fn ratios_within_a_run_are_paired() {
    let study = fixture::study();
    let template = fixture::bench(&study);
    let ids: Vec<ConfigurationId> = study.configurations.iter().map(|c| c.id.clone()).collect();
    let noise = Noise { drift: 0.5, ..QUIET };
    let run = run(&template, &ids, noise, 1.0, 3);
    let floor =
        NoiseFloor { aa: [("total", ids.iter().map(|id| (id.clone(), 0.05)).collect())].into(), load: 0.0 };
    let ratios = super::ratios::ratios(&run, &floor, Resampling::default());
    let totals: Vec<&Ratio> = ratios.iter().filter(|ratio| ratio.stage == Stage::Total).collect();
    // Of each object every two of six methods.
    assert_eq!(totals.len(), 3 * 15);
    for ratio in totals {
        let place = |id| ids.iter().position(|known| known == id).unwrap() as i32;
        let truth = 1.24_f64.powi(place(&ratio.second) - place(&ratio.first));
        let interval = ratio.interval.unwrap();
        assert!((ratio.ratio / truth).ln().abs() < 0.012, "{ratio:?}");
        assert!((interval.high / interval.low).ln() < 0.03, "half of the noise is drift: {ratio:?}");
        let verdict = if truth > 1.0 { Verdict::Slower } else { Verdict::Faster };
        assert_eq!(ratio.judgement.verdict, verdict, "{ratio:?}");
    }
    assert_eq!(ratios, super::ratios::ratios(&run, &floor, Resampling::default()), "the same seed");
}
