//! Totals of a run in the formats of hyperfine (`--export-json`) and criterion (`target/criterion`).
//!
//! # Not guaranteed
//! - An order that the others have not got is lost: samples of a configuration stand in the order measured, and which round
//!   they shared with those of others is not told.

use super::series::{by_configuration, values};
use isostudy_design::Stage;
use isostudy_design::record::{BenchRun, BenchSample};
use isostudy_statistics::bootstrap::{Resampling, percentile};
use serde::Serialize;

/// The standard normal quantile of 97.5 %.
const Z: f64 = 1.959_963_984_540_054;

/// As hyperfine writes it; times in seconds.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Hyperfine {
    /// A configuration each.
    pub results: Vec<HyperfineResult>,
}

/// One configuration. CPU time is not split into that of the program and that of the kernel, and `user` is both.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct HyperfineResult {
    /// Its id, in the command's place.
    pub command: String,
    /// Mean of the totals.
    pub mean: f64,
    /// Their standard deviation; `None` of one.
    pub stddev: Option<f64>,
    /// Their median.
    pub median: f64,
    /// Mean CPU time; `None` where it was not counted.
    pub user: Option<f64>,
    /// Always 0: it is in `user`.
    pub system: f64,
    /// The shortest.
    pub min: f64,
    /// The longest.
    pub max: f64,
    /// All of them, in the order measured.
    pub times: Vec<f64>,
    /// 0 for each: a run in which one fails is none.
    pub exit_codes: Vec<i32>,
}

/// The totals of every configuration, for what reads hyperfine's files.
pub fn hyperfine(run: &BenchRun) -> Hyperfine {
    let result = |(id, samples): (_, Vec<&BenchSample>)| {
        let times = values(&samples, Stage::Total);
        let cpu: Option<Vec<f64>> = samples.iter().map(|sample| sample.counters.cpu_s).collect();
        HyperfineResult {
            command: ToString::to_string(id),
            mean: mean(&times),
            stddev: deviation(&times),
            median: median(&times),
            user: cpu.map(|cpu| mean(&cpu)),
            system: 0.0,
            min: times.iter().copied().fold(f64::INFINITY, f64::min),
            max: times.iter().copied().fold(0.0, f64::max),
            exit_codes: vec![0; times.len()],
            times,
        }
    };
    Hyperfine {
        results: by_configuration(run).into_iter().map(|(id, samples)| result((id, samples))).collect(),
    }
}

/// The three files that criterion writes for a benchmark; times in nanoseconds.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Criterion {
    /// `benchmark.json`.
    pub benchmark: CriterionName,
    /// `sample.json`.
    pub sample: CriterionSample,
    /// `estimates.json`.
    pub estimates: CriterionEstimates,
}

/// What it is called.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CriterionName {
    /// The study's id.
    pub group_id: String,
    /// The configuration's.
    pub function_id: Option<String>,
    /// None.
    pub value_str: Option<String>,
    /// None.
    pub throughput: Option<u64>,
    /// Both, by a slash.
    pub full_id: String,
    /// The same, as a folder.
    pub directory_name: String,
    /// The same, for headings.
    pub title: String,
}

/// Every sample: one extraction each.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CriterionSample {
    /// `Flat`: each sample has as many extractions as the others.
    pub sampling_mode: &'static str,
    /// One for each.
    pub iters: Vec<f64>,
    /// What it took.
    pub times: Vec<f64>,
}

/// What follows from them; there is no slope where all samples have one extraction.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CriterionEstimates {
    /// Mean.
    pub mean: Estimate,
    /// Median.
    pub median: Estimate,
    /// Median absolute deviation, unscaled.
    pub median_abs_dev: Estimate,
    /// None.
    pub slope: Option<Estimate>,
    /// Standard deviation.
    pub std_dev: Estimate,
}

/// A number with a percentile interval of 2,000 bootstrap resamples, and the standard error of a normal interval as wide.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Estimate {
    /// Where it may lie.
    pub confidence_interval: CriterionInterval,
    /// The number.
    pub point_estimate: f64,
    /// How far it may be off.
    pub standard_error: f64,
}

/// An interval with its level.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CriterionInterval {
    /// 0.95.
    pub confidence_level: f64,
    /// Lower end.
    pub lower_bound: f64,
    /// Upper end.
    pub upper_bound: f64,
}

/// The totals of every configuration, for what reads criterion's folders.
pub fn criterion(run: &BenchRun) -> Vec<Criterion> {
    let of = |id: String, times: Vec<f64>| {
        let full_id = format!("{}/{id}", run.study);
        let estimate = |statistic: fn(&[f64]) -> f64| estimate(&times, run.seed, statistic);
        Criterion {
            estimates: CriterionEstimates {
                mean: estimate(mean),
                median: estimate(median),
                median_abs_dev: estimate(absolute_deviation),
                slope: None,
                std_dev: estimate(|values| deviation(values).unwrap_or(0.0)),
            },
            benchmark: CriterionName {
                group_id: run.study.clone(),
                function_id: Some(id),
                value_str: None,
                throughput: None,
                directory_name: full_id.clone(),
                title: full_id.clone(),
                full_id,
            },
            sample: CriterionSample { sampling_mode: "Flat", iters: vec![1.0; times.len()], times },
        }
    };
    let nanoseconds =
        |samples: &[&BenchSample]| values(samples, Stage::Total).iter().map(|s| 1e9 * s).collect();
    by_configuration(run).into_iter().map(|(id, samples)| of(id.to_string(), nanoseconds(&samples))).collect()
}

fn estimate(values: &[f64], seed: u64, statistic: fn(&[f64]) -> f64) -> Estimate {
    let resampled = |draws: &[u64]| {
        let drawn =
            values.iter().zip(draws).flat_map(|(&value, &times)| std::iter::repeat_n(value, times as usize));
        Some(statistic(&drawn.collect::<Vec<_>>()))
    };
    let point_estimate = statistic(values);
    let resampling = Resampling { seed, ..Resampling::default() };
    // A single value has no interval but itself.
    let found =
        (values.len() > 1).then(|| percentile(&vec![1; values.len()], resampling, resampled)).flatten();
    let (lower_bound, upper_bound) =
        found.map_or((point_estimate, point_estimate), |found| (found.interval.low, found.interval.high));
    Estimate {
        confidence_interval: CriterionInterval { confidence_level: 0.95, lower_bound, upper_bound },
        point_estimate,
        standard_error: (upper_bound - lower_bound) / (2.0 * Z),
    }
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

fn median(values: &[f64]) -> f64 {
    super::series::middle(values)
}

fn absolute_deviation(values: &[f64]) -> f64 {
    let centre = median(values);
    median(&values.iter().map(|value| (value - centre).abs()).collect::<Vec<_>>())
}

/// Of a sample; `None` of one value.
fn deviation(values: &[f64]) -> Option<f64> {
    let centre = mean(values);
    let squares: f64 = values.iter().map(|value| (value - centre).powi(2)).sum();
    (values.len() > 1).then(|| (squares / (values.len() - 1) as f64).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture;

    /// By hand: 1, 2, 3, 4 and 10 have the mean 4, the median 3, deviations from it 2, 1, 0, 1, 7 with the median 1, and
    /// squares 9 + 4 + 1 + 0 + 36 over 4.
    #[test]
    fn numbers_are_those_of_the_samples() {
        let mut run = fixture::bench(&fixture::study());
        let id = run.samples[0].id.clone();
        run.samples.retain(|sample| sample.id == id);
        for (sample, total) in run.samples.iter_mut().zip([1.0, 2.0, 3.0, 4.0, 10.0]) {
            (sample.total_s, sample.counters.cpu_s) = (total, Some(2.0 * total));
        }
        let found = &hyperfine(&run).results[0];
        assert_eq!((found.mean, found.median, found.min, found.max), (4.0, 3.0, 1.0, 10.0));
        assert_eq!((found.stddev, found.user), (Some(12.5_f64.sqrt()), Some(8.0)));
        assert_eq!(found.times, [1.0, 2.0, 3.0, 4.0, 10.0]);
        let found = &criterion(&run)[0];
        let estimates = &found.estimates;
        assert_eq!(estimates.mean.point_estimate, 4e9);
        assert_eq!((estimates.median.point_estimate, estimates.median_abs_dev.point_estimate), (3e9, 1e9));
        let interval = &estimates.median.confidence_interval;
        assert!(interval.lower_bound >= 1e9 && interval.lower_bound < 3e9 && interval.upper_bound > 3e9);
        assert_eq!((found.sample.iters.len(), found.benchmark.full_id.as_str()), (5, "paper/ss_bu"));
        run.samples[1].counters.cpu_s = None;
        assert_eq!(hyperfine(&run).results[0].user, None, "not known of all");
    }
}
