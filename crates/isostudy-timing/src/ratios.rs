//! Configurations against each other within one run, paired round by round.

use super::floor::NoiseFloor;
use super::series::{Judgement, by_configuration, middle, thirds};
use isostudy_design::record::{BenchRun, BenchSample};
use isostudy_design::{ConfigurationId, Stage};
use isostudy_statistics::bootstrap::{Resampling, percentile};
use isostudy_statistics::interval::Interval;
use serde::Serialize;
use std::collections::BTreeMap;

/// The time of one configuration over that of another, of the same object and in the same round: what slows a round down
/// falls on both.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Ratio {
    /// The configuration below the line.
    pub first: ConfigurationId,
    /// The configuration above the line.
    pub second: ConfigurationId,
    /// Of which stage.
    pub stage: Stage,
    /// Median over rounds of second / first.
    pub ratio: f64,
    /// Its 95 % interval: percentile bootstrap of whole rounds; `None` of a single one.
    pub interval: Option<Interval>,
    /// Ratios up to this, and down to its inverse, are no more than noise; `None` without an A/A block.
    pub floor: Option<f64>,
    /// What can be said of the second beside the first.
    pub judgement: Judgement,
}

/// The stages that are put into ratios; the others are small or the same in all.
const STAGES: [Stage; 5] =
    [Stage::Total, Stage::Sampling, Stage::Vertex, Stage::GeometryAsPublished, Stage::Normals];

/// All pairs of one object, in the run's order of configurations.
pub(super) fn ratios(run: &BenchRun, floor: &NoiseFloor, resampling: Resampling) -> Vec<Ratio> {
    let series = by_configuration(run);
    let mut ratios = Vec::new();
    for (i, first) in series.iter().enumerate() {
        for second in &series[i + 1..] {
            if first.0.object == second.0.object {
                ratios.extend(
                    STAGES.iter().filter_map(|stage| ratio(floor, first, second, *stage, resampling)),
                );
            }
        }
    }
    ratios
}

fn ratio(
    floor: &NoiseFloor,
    first: &(&ConfigurationId, Vec<&BenchSample>),
    second: &(&ConfigurationId, Vec<&BenchSample>),
    stage: Stage,
    resampling: Resampling,
) -> Option<Ratio> {
    let by_round = |samples: &[&BenchSample]| -> BTreeMap<u32, f64> {
        samples.iter().map(|sample| (sample.iteration, stage.of(sample))).collect()
    };
    let (below, above) = (by_round(&first.1), by_round(&second.1));
    let log_ratio = |(round, a): (&u32, &f64)| Some((above.get(round)? / a).ln());
    let logs: Vec<f64> = below.iter().filter_map(log_ratio).collect();
    if logs.is_empty() || !logs.iter().all(|log| log.is_finite()) {
        return None;
    }
    let statistic = |draws: &[u64]| {
        let drawn =
            logs.iter().zip(draws).flat_map(|(&log, &times)| std::iter::repeat_n(log, times as usize));
        Some(middle(&drawn.collect::<Vec<_>>()))
    };
    let interval =
        (logs.len() > 1).then(|| percentile(&vec![1; logs.len()], resampling, statistic)).flatten();
    let interval = interval.map(|found| found.interval);
    let parts = thirds(&logs).map(|parts| parts.map(middle));
    let noise = floor.within(stage, first.0, second.0);
    let judgement = match interval {
        None => Judgement::cannot_say("a single value has no interval"),
        Some(Interval { low, high }) => {
            Judgement::of(low, high, noise, parts.as_ref().map(|parts| &parts[..]))
        }
    };
    Some(Ratio {
        first: first.0.clone(),
        second: second.0.clone(),
        stage,
        ratio: middle(&logs).exp(),
        interval: interval.map(|i| Interval { low: i.low.exp(), high: i.high.exp() }),
        floor: noise.map(f64::exp),
        judgement,
    })
}
