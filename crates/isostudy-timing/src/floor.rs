//! How far two measurements of one and the same program may lie apart.

use super::quiet::busy_share;
use super::series::{NO_AA_BLOCK, middle};
use isostudy_design::record::{BenchRun, BenchSample};
use isostudy_design::{ConfigurationId, Stage};
use serde::Serialize;
use statrs::distribution::{ContinuousCDF, StudentsT};
use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::SQRT_2;

/// The chance that noise passes the floor somewhere among a stage's configurations (Bonferroni).
const MISSES: f64 = 0.05;
/// The standard error of a median of normal values, in standard errors of their mean.
const MEDIAN_ERROR: f64 = 1.253_314_137_315_500_1;
/// The standard deviation of normal values, in median absolute deviations.
const DEVIATION_OF_MAD: f64 = 1.482_602_218_505_602;

/// What one process can add to Q: three standard deviations. Half of four rounds are outliers now and then.
const MOST: f64 = 9.0;

/// How many degrees of freedom the pooled noise between processes counts for beside a configuration's own.
const POOLED_DEGREES: f64 = 4.0;

/// Why the machine's speed is not known. Schema 3 had the reference work on one thread.
const NO_REFERENCE: &str =
    "no reference work on as many threads in both: whether the machine was as fast is not known";

/// The logarithm of 1.05, by which runs of one program are taken to differ where no A/A block tells.
pub const ASSUMED_NOISE: f64 = 0.048_790_164_169_432;

/// Log-ratios that are no more than noise.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct NoiseFloor {
    /// Of each stage and configuration: how far the medians of two measurements of one program may lie apart because their
    /// processes differ, beyond what their rounds differ. Empty without an A/A block.
    ///
    /// A run is measured by several processes, those of the A/A block among them, and all measure the same programs. The
    /// variance between processes is the one with which Cochran's Q, with variances t² + s², is as large as its degrees of
    /// freedom (Paule & Mandel 1982); s is the standard error of a process's median that follows from how its rounds
    /// differ, and a single term of Q counts 9 at most. It is estimated over all configurations and for each, and a
    /// configuration's is the mean of both, weighted by degrees of freedom, the pooled one with 4 (a moderated variance, Smyth
    /// 2004): some configurations differ more between processes than others, and few processes say little of one. The
    /// floor is q t sqrt(2 / m) with m the processes of the measured rounds, and q the t quantile for all configurations
    /// together. Times are logarithms, in units of the reference work's in the same process.
    pub aa: BTreeMap<&'static str, BTreeMap<ConfigurationId, f64>>,
    /// What others may have added: -ln(1 - s), where s is the share of the CPU time that three rounds of four stayed below.
    pub load: f64,
}

impl NoiseFloor {
    /// The floor of a run.
    pub fn of(run: &BenchRun) -> Self {
        let aa = if run.aa_samples.is_empty() {
            BTreeMap::new()
        } else {
            let stages = Stage::parts_of(&run.samples).into_iter().chain([Stage::GeometryAsPublished]);
            stages.map(|stage| (stage.label(), floors(run, stage))).collect()
        };
        Self { aa, load: -(1.0 - busy_share(&run.load).min(0.999)).ln() }
    }

    /// Of one stage of a configuration measured twice; 0 where it takes no time.
    pub fn of_stage(&self, stage: Stage, id: &ConfigurationId) -> Option<f64> {
        Some(self.aa.get(stage.label())?.get(id).copied().unwrap_or(0.0))
    }

    /// Of one stage of two configurations of the run: rounds are compared with themselves there, and load falls on both
    /// sides alike.
    pub fn within(&self, stage: Stage, first: &ConfigurationId, second: &ConfigurationId) -> Option<f64> {
        Some(self.of_stage(stage, first)?.hypot(self.of_stage(stage, second)?) / SQRT_2)
    }

    /// The smallest and the largest of a stage.
    pub fn range(&self, stage: Stage) -> Option<(f64, f64)> {
        let floors = self.aa.get(stage.label())?.values();
        Some(floors.fold((f64::INFINITY, 0.0), |(low, high), &f| (low.min(f), high.max(f))))
    }
}

/// The median of a configuration's times in one process, and its variance; both on logarithms.
#[derive(Debug, Clone, Copy)]
struct ProcessMedian {
    log: f64,
    variance: f64,
}

fn floors(run: &BenchRun, stage: Stage) -> BTreeMap<ConfigurationId, f64> {
    let speeds = speeds(run);
    let mut configurations = BTreeMap::<&ConfigurationId, BTreeMap<u32, Vec<f64>>>::new();
    for sample in all_samples(run) {
        let time = stage.of(sample);
        // A stage that takes no time at all is the same in all.
        if time > 0.0 {
            let processes = configurations.entry(&sample.id).or_default();
            processes.entry(sample.invocation).or_default().push(time.ln() - speeds[&sample.invocation]);
        }
    }
    let medians: Vec<Vec<ProcessMedian>> = configurations.values().map(process_medians).collect();
    let pooled = variance_between(&medians);
    let measured: BTreeSet<u32> = run.samples.iter().map(|sample| sample.invocation).collect();
    let chance = MISSES / 2.0 / medians.len().max(1) as f64;
    let floor = |own: &Vec<ProcessMedian>| {
        let degrees = (own.len() - 1) as f64;
        let all = POOLED_DEGREES + degrees;
        let own = variance_between(std::slice::from_ref(own));
        let moderated = (POOLED_DEGREES * pooled + degrees * own) / all;
        let quantile = StudentsT::new(0.0, 1.0, all).expect("degrees > 0").inverse_cdf(1.0 - chance);
        quantile * (moderated * 2.0 / measured.len().max(1) as f64).sqrt()
    };
    configurations.keys().zip(&medians).map(|(id, own)| ((*id).clone(), floor(own))).collect()
}

fn all_samples(run: &BenchRun) -> impl Iterator<Item = &BenchSample> {
    run.samples.iter().chain(&run.aa_samples)
}

/// How long the reference work took in each process, a logarithm; 0 where it was not timed. Between runs that is judged on its
/// own ([`speed_shift`]).
fn speeds(run: &BenchRun) -> BTreeMap<u32, f64> {
    let mut times = BTreeMap::<u32, Vec<f64>>::new();
    for sample in all_samples(run) {
        times.entry(sample.invocation).or_default().extend(sample.reference_s.filter(|time| *time > 0.0));
    }
    let speed = |times: Vec<f64>| if times.is_empty() { 0.0 } else { middle(&times).ln() };
    times.into_iter().map(|(invocation, times)| (invocation, speed(times))).collect()
}

/// How much a sample differs from the median of its process is a matter of the configuration, and taken from all processes.
fn process_medians(processes: &BTreeMap<u32, Vec<f64>>) -> Vec<ProcessMedian> {
    let medians: Vec<(f64, usize)> = processes.values().map(|logs| (middle(logs), logs.len())).collect();
    let apart: Vec<f64> = processes
        .values()
        .zip(&medians)
        .flat_map(|(logs, (median, _))| logs.iter().map(move |log| (log - median).abs()))
        .collect();
    let error = MEDIAN_ERROR * DEVIATION_OF_MAD * middle(&apart);
    medians
        .iter()
        .map(|&(log, rounds)| ProcessMedian { log, variance: error * error / rounds as f64 })
        .collect()
}

/// The variance between processes: Q falls as it grows, so by bisection on its root.
fn variance_between(configurations: &[Vec<ProcessMedian>]) -> f64 {
    let degrees: usize = configurations.iter().map(|medians| medians.len() - 1).sum();
    let q =
        |deviation: f64| -> f64 { configurations.iter().map(|medians| cochran(medians, deviation)).sum() };
    let (mut low, mut high) = (0.0, 10.0);
    if q(low) <= degrees as f64 {
        return 0.0;
    }
    for _ in 0..60 {
        let between = 0.5 * (low + high);
        if q(between) > degrees as f64 { low = between } else { high = between }
    }
    high * high
}

/// Cochran's Q: squared distances from the weighted mean, in variances. Processes that agree to the last digit add nothing.
fn cochran(medians: &[ProcessMedian], deviation: f64) -> f64 {
    let weight = |m: &ProcessMedian| 1.0 / (m.variance + deviation * deviation).max(f64::MIN_POSITIVE);
    let total: f64 = medians.iter().map(weight).sum();
    let mean = medians.iter().map(|m| weight(m) * m.log).sum::<f64>() / total;
    medians.iter().map(|m| (weight(m) * (m.log - mean).powi(2)).min(MOST)).sum()
}

/// The log-ratio of the machines' speeds: the reference work's median time in `b` over that in `a`. `None` if one has none, or
/// did it on another number of threads.
pub(super) fn speed_shift(a: &BenchRun, b: &BenchRun) -> Option<f64> {
    let median = |run: &BenchRun| {
        let times: Vec<f64> = run.samples.iter().filter_map(|sample| sample.reference_s).collect();
        Some(middle(&times)).filter(|median| *median > 0.0)
    };
    if a.reference_threads != b.reference_threads {
        return None;
    }
    Some((median(b)? / median(a)?).ln())
}

/// Between two runs, of a stage of a configuration: the larger of their A/A floors, the larger of their loads, and by how much
/// the machine's speed changed.
///
/// # Errors
/// What is not known of the noise: unknown is not quiet.
pub(super) fn between(
    [a, b]: &[NoiseFloor; 2],
    shift: Option<f64>,
    stage: Stage,
    id: &ConfigurationId,
) -> Result<f64, &'static str> {
    let [Some(of_a), Some(of_b)] = [a, b].map(|floor| floor.of_stage(stage, id)) else {
        return Err(NO_AA_BLOCK);
    };
    let shift = shift.ok_or(NO_REFERENCE)?;
    Ok(of_a.max(of_b) + a.load.max(b.load) + shift.abs())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn medians(of: &[(f64, f64)]) -> Vec<ProcessMedian> {
        of.iter().map(|&(log, variance)| ProcessMedian { log, variance }).collect()
    }

    /// statsmodels 0.15, `combine_effects(effects, variances, method_re="iterated").tau2`: Paule and Mandel's estimate.
    #[test]
    fn the_variance_between_processes_is_paule_and_mandels() {
        let found = |of: &[(f64, f64)]| variance_between(&[medians(of)]);
        let five = [(0.01, 0.0004), (-0.03, 0.0003), (0.05, 0.0004), (0.02, 0.0005), (-0.06, 0.0002)];
        assert!((found(&five) - 0.001_565_824_780_870_156_2).abs() < 1e-9, "{}", found(&five));
        let ten = [
            (4.605, 0.0011),
            (4.541, 0.0009),
            (4.702, 0.0010),
            (4.633, 0.0012),
            (4.588, 0.0010),
            (4.671, 0.0008),
            (4.499, 0.0011),
            (4.622, 0.0010),
            (4.757, 0.0013),
            (4.560, 0.0009),
        ];
        assert!((found(&ten) - 0.004_891_194_734_491_597).abs() < 1e-9, "{}", found(&ten));
        let alike = [(0.01, 0.0004), (0.011, 0.0003), (0.009, 0.0004)];
        assert_eq!(found(&alike), 0.0, "less apart than their rounds explain");
    }

    /// Ten configurations of five processes have 40 degrees of freedom. One process far out: its term would be 0.64 over the
    /// variance, and is 9; the 0.16 of the other four come to 31.
    #[test]
    fn a_single_process_adds_a_limited_amount() {
        let quiet = medians(&[(0.0, 0.0004); 5]);
        let far = medians(&[(0.0, 0.0004), (0.0, 0.0004), (0.0, 0.0004), (0.0, 0.0004), (1.0, 0.0004)]);
        let mut all = vec![quiet; 9];
        all.push(far);
        let found = variance_between(&all);
        assert!((found - (0.16 / 31.0 - 0.0004)).abs() < 1e-12, "{found}");
    }

    #[test]
    fn what_is_not_known_is_no_quiet() {
        let id: ConfigurationId = "ss_bi".parse().unwrap();
        let of = |aa: f64, load| NoiseFloor { aa: [("total", [(id.clone(), aa)].into())].into(), load };
        let floors = [of(0.1, 0.02), of(0.2, 0.01)];
        let found = between(&floors, Some(-0.05), Stage::Total, &id).unwrap();
        assert!((found - 0.27).abs() < 1e-15, "{found}");
        assert!(between(&floors, None, Stage::Total, &id).unwrap_err().starts_with("no reference work"));
        let without = NoiseFloor { aa: BTreeMap::new(), load: 0.0 };
        let floors = [floors[0].clone(), without];
        assert_eq!(between(&floors, Some(0.0), Stage::Total, &id), Err(NO_AA_BLOCK));
    }
}
