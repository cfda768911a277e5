//! Everything that one run says.

use super::floor::NoiseFloor;
use super::outliers::{Outlier, outliers};
use super::quiet::warnings;
use super::ratios::{Ratio, ratios};
use super::series::{by_configuration, values};
use isostudy_design::record::{BenchRun, PeakMemory};
use isostudy_design::{ConfigurationId, Stage};
use isostudy_statistics::bootstrap::Resampling;
use isostudy_statistics::interval::LEVEL;
use isostudy_statistics::{Median, median};
use serde::Serialize;

/// The version of [`Statements`] as JSON.
pub const STATEMENTS_SCHEMA: u32 = 3;

/// What a run says of itself.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Statements {
    /// Version of this layout; [`STATEMENTS_SCHEMA`].
    pub schema: u32,
    /// The study's id.
    pub study: String,
    /// What to know of the machine before reading on.
    pub warnings: Vec<String>,
    /// What is no more than noise, as log-ratios.
    pub floor: NoiseFloor,
    /// A median for each stage of each configuration.
    pub medians: Vec<StageMedian>,
    /// Configurations against each other.
    pub ratios: Vec<Ratio>,
    /// Samples far from the rest, all of them kept.
    pub outliers: Vec<Outlier>,
    /// Median of the totals with and without the outliers, of configurations that have any.
    pub outlier_effects: Vec<OutlierEffect>,
    /// Peak memory, as recorded.
    pub memory: Vec<PeakMemory>,
}

/// The median time of a stage.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StageMedian {
    /// Of which configuration.
    pub id: ConfigurationId,
    /// Of which stage.
    pub stage: Stage,
    /// How many samples.
    pub samples: usize,
    /// The median in seconds, with its order-statistic interval.
    #[serde(flatten)]
    pub seconds: Median,
}

/// What outliers do to a median.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct OutlierEffect {
    /// Of which configuration.
    pub id: ConfigurationId,
    /// How many outliers.
    pub outliers: usize,
    /// Median of all totals in seconds.
    pub median_s: f64,
    /// Median without the outliers.
    pub median_without_s: f64,
}

/// Works out what a run says.
pub fn statements(run: &BenchRun) -> Statements {
    let floor = NoiseFloor::of(run);
    let mut medians = Vec::new();
    let (mut found, mut effects) = (Vec::new(), Vec::new());
    for (id, samples) in by_configuration(run) {
        for stage in Stage::parts_of(samples.iter().copied()) {
            let seconds = median(values(&samples, stage), LEVEL).expect("the configuration has samples");
            medians.push(StageMedian { id: id.clone(), stage, samples: samples.len(), seconds });
        }
        let (outliers, median_without_s) = outliers(&samples);
        if !outliers.is_empty() {
            let median_s = medians.last().expect("pushed above, the total last").seconds.median;
            effects.push(OutlierEffect {
                id: id.clone(),
                outliers: outliers.len(),
                median_s,
                median_without_s,
            });
            found.extend(outliers);
        }
    }
    Statements {
        schema: STATEMENTS_SCHEMA,
        study: run.study.clone(),
        warnings: warnings(run),
        ratios: ratios(run, &floor, Resampling { seed: run.seed, ..Resampling::default() }),
        floor,
        medians,
        outliers: found,
        outlier_effects: effects,
        memory: run.memory.clone(),
    }
}
