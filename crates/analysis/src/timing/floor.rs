//! How far two measurements of one and the same program may lie apart.

use super::quiet::busy_share;
use super::series::{by_configuration, middle, values};
use design::Stage;
use design::record::BenchRun;
use serde::Serialize;
use std::collections::BTreeMap;

/// What the largest difference within the A/A block is multiplied by. The block sees two processes; two runs are others, and
/// may lie further apart. Chosen by simulation (`timing/simulation.rs`): where processes differ by fifteen times as much as
/// samples, 1 gives a false verdict in one comparison of eight, 1.25 in one of a hundred; 1.5 would lose a third of the
/// 10 % changes at 4 % noise that 1.25 still tells.
pub const AA_MARGIN: f64 = 1.25;

/// Log-ratios that are no more than noise.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct NoiseFloor {
    /// Of each stage: [`AA_MARGIN`] times the largest log-ratio, over configurations, between the median of the A/A block
    /// and that of the measured rounds. Empty without an A/A block.
    pub aa: BTreeMap<&'static str, f64>,
    /// What others may have added: -ln(1 - s), where s is the share of the CPU time that three rounds of four stayed below.
    pub load: f64,
}

impl NoiseFloor {
    /// The floor of a run.
    pub fn of(run: &BenchRun) -> Self {
        let (measured, again) = (by_configuration(&run.samples), by_configuration(&run.aa_samples));
        let both: Vec<_> = again.iter().filter_map(|(id, again)| Some((measured.get(id)?, again))).collect();
        let floor = |stage: Stage| {
            let apart = both.iter().map(|(measured, again)| {
                let medians = [measured, again].map(|samples| middle(&values(samples, stage)));
                // A stage that takes no time at all is the same in both.
                if medians == [0.0; 2] { 0.0 } else { (medians[1] / medians[0]).ln().abs() }
            });
            AA_MARGIN * apart.fold(0.0, f64::max)
        };
        let stages = Stage::ALL.into_iter().chain([Stage::GeometryAsPublished]);
        let aa = match both.is_empty() {
            true => BTreeMap::new(),
            false => stages.map(|stage| (stage.label(), floor(stage))).collect(),
        };
        Self { aa, load: -(1.0 - busy_share(&run.load).min(0.999)).ln() }
    }

    /// Of one stage, within the run: rounds are compared with themselves there, and load falls on both sides alike.
    pub fn within(&self, stage: Stage) -> Option<f64> {
        self.aa.get(stage.label()).copied()
    }
}

/// The log-ratio of the machines' speeds: the reference work's median time in `b` over that in `a`. `None` if one has none.
pub(super) fn speed_shift(a: &BenchRun, b: &BenchRun) -> Option<f64> {
    let median = |run: &BenchRun| {
        let times: Vec<f64> = run.samples.iter().filter_map(|sample| sample.reference_s).collect();
        Some(middle(&times)).filter(|median| *median > 0.0)
    };
    Some((median(b)? / median(a)?).ln())
}

/// Between two runs: the larger of their A/A floors, the larger of their loads, and by how much the machine's speed
/// changed. `None` without an A/A block in either.
pub(super) fn between(a: &NoiseFloor, b: &NoiseFloor, shift: Option<f64>, stage: Stage) -> Option<f64> {
    let aa = a.within(stage)?.max(b.within(stage)?);
    Some(aa + a.load.max(b.load) + shift.unwrap_or(0.0).abs())
}
