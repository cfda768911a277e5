//! Two runs, configuration by configuration.

use super::counted::{InstructionRow, instruction_rows};
use super::differences::build_differences;
use super::floor::{NoiseFloor, between, speed_shift};
use super::series::{self, Judgement, Series, Verdict, by_configuration, middle, thirds, values};
use isostudy_design::record::{BenchRun, BenchSample};
use isostudy_design::{ConfigurationId, Stage};
use isostudy_statistics::interval::Interval;
use isostudy_statistics::median;
use serde::Serialize;

/// The version of [`Comparison`], with what a gate says of it, as JSON. 4 has limits, regressions, exit status and both runs.
pub const COMPARISON_SCHEMA: u32 = 4;

/// The chance that any one interval of a stage misses, over all its configurations together (Bonferroni).
const MISSES: f64 = 0.05;

/// What two runs say of each other.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Comparison {
    /// Version of this layout; [`COMPARISON_SCHEMA`].
    pub schema: u32,
    /// Whether A and B are one run, sample by sample.
    pub itself: bool,
    /// How the machines differ, each difference in a line; empty if they do not.
    pub across: Vec<String>,
    /// How the programs and their plans differ, each difference in a line; empty if they are of one build.
    pub builds: Vec<String>,
    /// The machines' speeds: the reference work's time in B over that in A. Part of every floor.
    pub reference_ratio: Option<f64>,
    /// Of each stage, total first, each configuration that both runs have.
    pub rows: Vec<Row>,
    /// Instructions of each configuration, where both runs counted them: a verdict of their own, which decides nothing.
    pub instructions: Vec<InstructionRow>,
    /// Configurations that only one of the runs has.
    pub unmatched: Vec<ConfigurationId>,
    /// Configurations of which other extractions were asked in B: another field, spacing, isovalue or recipe.
    pub changed: Vec<ConfigurationId>,
}

/// One stage of one configuration in both runs.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Row {
    /// Which configuration.
    pub id: ConfigurationId,
    /// Which stage.
    pub stage: Stage,
    /// Median in A, seconds.
    pub a_s: f64,
    /// Median in B, seconds.
    pub b_s: f64,
    /// B over A; `None` where a stage takes no time.
    pub ratio: Option<f64>,
    /// Of totals, the median CPU time in A and in B, seconds over all threads; `None` where it was not counted.
    pub cpu_s: Option<[f64; 2]>,
    /// Where the ratio may lie, at 95 % for all configurations of the stage together; `None` of single values, and of fewer
    /// rounds than that takes.
    pub interval: Option<Interval>,
    /// Ratios up to this, and down to its inverse, are no more than noise; `None` where that is not known.
    pub floor: Option<f64>,
    /// The smallest ratio above 1 that would have been told, with an interval as wide as this one; `None` without floor or
    /// interval.
    pub smallest_detectable: Option<f64>,
    /// What can be said of B.
    pub judgement: Judgement,
}

/// What is a regression: B slower, by more than both.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Limits {
    /// Share of A's time, 0.05 for 5 %.
    pub relative: f64,
    /// Seconds.
    pub absolute_s: f64,
}

/// Compares run B with run A, where both did the same work. `across` are the differences of their machines, if they are to be compared nevertheless.
///
/// The interval of a ratio is made from the order-statistic intervals of both medians, each end at its own distance, by the
/// rule for differences of independent estimates (Zou & Donner 2008), on logarithms. It speaks of the rounds that were
/// measured; that processes, hours and loads differ is the floor's part.
pub fn compare(a: &BenchRun, b: &BenchRun, across: Vec<String>) -> Comparison {
    let floors = [a, b].map(NoiseFloor::of);
    let shift = speed_shift(a, b);
    let (in_a, in_b) = (by_configuration(a), by_configuration(b));
    let mut both: Vec<_> =
        in_a.iter().filter_map(|(id, a)| Some((*id, [a, series::of(&in_b, id)?]))).collect();
    let changed: Vec<_> =
        both.iter().map(|(id, _)| *id).filter(|id| asks_otherwise(a, b, id)).cloned().collect();
    both.retain(|(id, _)| !changed.contains(id));
    let without = |one: &[(&'_ ConfigurationId, Vec<&BenchSample>)], other: &Series<'_>| {
        let alone = one.iter().filter(|(id, _)| series::of(other, id).is_none());
        alone.map(|(id, _)| (*id).clone()).collect::<Vec<_>>()
    };
    let alone = [without(&in_a, &in_b), without(&in_b, &in_a)].concat();
    let level = 1.0 - MISSES / both.len().max(1) as f64;
    let of_stage = |stage: Stage| {
        let floors = &floors;
        both.iter()
            .map(move |(id, samples)| row(*samples, id, stage, between(floors, shift, stage, id), level))
    };
    let stages = stages(a.imported_from.is_some() || b.imported_from.is_some());
    Comparison {
        schema: COMPARISON_SCHEMA,
        itself: a.samples == b.samples && a.aa_samples == b.aa_samples,
        across,
        builds: build_differences(a, b),
        reference_ratio: shift.map(f64::exp),
        instructions: instruction_rows(a, b, &both.iter().map(|(id, _)| *id).collect::<Vec<_>>()),
        rows: stages.into_iter().flat_map(of_stage).collect(),
        unmatched: alone,
        changed,
    }
}

/// The growth of each total, as a ratio, that a second run like this one would tell: the smallest and the largest of the
/// configurations. `None` if of one of them nothing would be told.
pub fn would_tell(run: &BenchRun) -> Option<(f64, f64)> {
    let comparison = compare(run, run, Vec::new());
    let every = comparison.of_stage(Stage::Total).all(|row| row.smallest_detectable.is_some());
    comparison.smallest_detectable(Stage::Total).filter(|_| every)
}

/// Whether both runs tell what a configuration asked of the extractor, and it is not the same.
fn asks_otherwise(a: &BenchRun, b: &BenchRun, id: &ConfigurationId) -> bool {
    let [a, b] = [a, b].map(|run| run.workloads.iter().find(|workload| workload.id == *id));
    a.zip(b).is_some_and(|(a, b)| a.digest != b.digest)
}

impl Comparison {
    /// The totals and stages that are slower in B by more than the limits: what a total's noise hides, a stage may show.
    pub fn regressions(&self, limits: &Limits) -> Vec<&Row> {
        let beyond = |row: &&Row| {
            row.judgement.verdict == Verdict::Slower
                && row.b_s > row.a_s * (1.0 + limits.relative)
                && row.b_s > row.a_s + limits.absolute_s
        };
        self.rows.iter().filter(beyond).collect()
    }

    /// The smallest and the largest of what would have been told of a stage, as ratios above 1; `None` if nothing would.
    pub fn smallest_detectable(&self, stage: Stage) -> Option<(f64, f64)> {
        let mut ratios = self.of_stage(stage).filter_map(|row| row.smallest_detectable);
        let first = ratios.next()?;
        Some(ratios.fold((first, first), |(low, high), ratio| (low.min(ratio), high.max(ratio))))
    }

    /// Of one stage.
    pub fn of_stage(&self, stage: Stage) -> impl Iterator<Item = &Row> {
        self.rows.iter().filter(move |row| row.stage == stage)
    }
}

/// Total first. Published geometry has the edge collapse in it.
fn stages(published: bool) -> Vec<Stage> {
    use Stage::{Allocation, Clustering, Geometry, GeometryAsPublished, Normals, Sampling, Total, Vertex};
    match published {
        true => vec![Total, Allocation, Sampling, Vertex, GeometryAsPublished, Normals],
        false => vec![Total, Allocation, Sampling, Vertex, Geometry, Clustering, Normals],
    }
}

fn row(
    samples: [&Vec<&BenchSample>; 2],
    id: &ConfigurationId,
    stage: Stage,
    noise: Result<f64, &'static str>,
    level: f64,
) -> Row {
    let values = samples.map(|samples| values(samples, stage));
    let [a, b] = values.each_ref().map(|values| median(values.clone(), level).expect("both have samples"));
    let [a_s, b_s] = [a.median, b.median];
    let (judgement, interval) = match a.interval_at(level).zip(b.interval_at(level)) {
        _ if a_s == 0.0 || b_s == 0.0 => (Judgement::cannot_say("takes no time"), None),
        None if values.iter().any(|values| values.len() == 1) => {
            (Judgement::cannot_say("a single value has no interval"), None)
        }
        None => (Judgement::cannot_say("too few rounds for an interval"), None),
        Some((around_a, around_b)) => {
            let difference = (b_s / a_s).ln();
            let below = (b_s / around_b.low).ln().hypot((around_a.high / a_s).ln());
            let above = (around_b.high / b_s).ln().hypot((a_s / around_a.low).ln());
            let (low, high) = (difference - below, difference + above);
            let [thirds_a, thirds_b] = values.each_ref().map(|values| thirds(values));
            let parts =
                thirds_a.zip(thirds_b).map(|(a, b)| [0, 1, 2].map(|i| (middle(b[i]) / middle(a[i])).ln()));
            let parts = parts.as_ref().map(|parts| &parts[..]);
            let interval = Interval { low: low.exp(), high: high.exp() };
            let judgement = match noise {
                Ok(floor) => Judgement::of(low, high, Some(floor), parts),
                Err(reason) => Judgement::cannot_say(reason),
            };
            (judgement, interval.high.is_finite().then_some(interval))
        }
    };
    let ratio = (a_s > 0.0 && b_s > 0.0).then(|| b_s / a_s);
    let floor = noise.ok().map(f64::exp);
    let smallest_detectable = || Some(floor? * ratio? / interval?.low).filter(|ratio| ratio.is_finite());
    Row {
        id: id.clone(),
        stage,
        a_s,
        b_s,
        ratio,
        cpu_s: (stage == Stage::Total).then(|| cpu_times(samples)).flatten(),
        interval,
        floor,
        smallest_detectable: smallest_detectable(),
        judgement,
    }
}

/// Medians of the CPU time, if every sample has one: a time that grows without it is time in which threads waited.
fn cpu_times(samples: [&Vec<&BenchSample>; 2]) -> Option<[f64; 2]> {
    let median = |samples: &Vec<&BenchSample>| -> Option<f64> {
        let times: Option<Vec<f64>> = samples.iter().map(|sample| sample.counters.cpu_s).collect();
        times.map(|times| middle(&times))
    };
    Some([median(samples[0])?, median(samples[1])?])
}

#[cfg(test)]
mod tests {
    use super::super::simulation::sample;
    use super::*;
    use std::ops::RangeInclusive;

    fn samples(totals: RangeInclusive<u32>) -> Vec<BenchSample> {
        let id = "ss_bi".parse().unwrap();
        totals.map(|total| sample(&id, 0, 0, 0, f64::from(total), 0.001)).collect()
    }

    /// By hand: of nine values the second and the eighth hold the median at 96 %, the third and the seventh at 82 %. The rule for
    /// differences then has hypot(ln 14/11, ln 8/5) below ln 2.8 and hypot(ln 17/14, ln 5/2) above it.
    #[test]
    fn the_interval_of_a_ratio_follows_from_those_of_both_medians() {
        let (a, b) = (samples(1..=9), samples(10..=18));
        let (a, b): (Vec<&BenchSample>, Vec<&BenchSample>) = (a.iter().collect(), b.iter().collect());
        let of = |noise| row([&a, &b], &a[0].id, Stage::Total, noise, 0.9);
        let quiet = of(Ok(0.0));
        assert_eq!(quiet.cpu_s, None, "not counted");
        let interval = quiet.interval.unwrap();
        assert_eq!((quiet.a_s, quiet.b_s, quiet.ratio), (5.0, 14.0, Some(2.8)));
        assert!((interval.low - 1.650_957_966_889).abs() < 1e-11, "{interval:?}");
        assert!((interval.high - 7.143_868_897_104).abs() < 1e-11, "{interval:?}");
        assert_eq!(quiet.judgement.verdict, Verdict::Slower);
        // With 10 % of noise, what would have been told: 1.1 times as far as the interval reaches below.
        let smallest_detectable = of(Ok(1.1_f64.ln())).smallest_detectable.unwrap();
        assert!((smallest_detectable - 1.865_583_534_997).abs() < 1e-11, "{smallest_detectable}");
        let unknown = of(Err("nobody knows"));
        assert_eq!((unknown.floor, unknown.smallest_detectable), (None, None));
        assert_eq!(unknown.judgement, Judgement::cannot_say("nobody knows"));
    }
}
