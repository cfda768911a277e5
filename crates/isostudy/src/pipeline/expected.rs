//! How long a benchmark is expected to take, which is said before it starts.

use super::Pipeline;
use crate::work_time::Trials;
use anyhow::Result;
use isostudy_bench::Plan;
use isostudy_design::Configuration;
use isostudy_design::record::Purpose;

/// Seconds of the reference work before each sample.
const REFERENCE_S: f64 = 0.001;
/// Rounds beside those that are timed: one for peak memory, and about two for allocations.
const COUNTED_ROUNDS: u32 = 3;

/// What a round takes.
#[derive(Debug, Clone, Copy)]
pub(super) struct RoundCost {
    /// Of all configurations that were tried.
    pub(super) seconds: f64,
    /// Configurations that cannot be tried: programs, and what is no extractor of ours.
    pub(super) untried: usize,
}

impl Pipeline<'_> {
    /// What a round of some configurations takes, by a trial of each on few cells.
    ///
    /// # Errors
    /// If a recipe or a field cannot be made.
    pub(super) fn round_cost(&self, configurations: &[&Configuration]) -> Result<RoundCost> {
        let mut trials = Trials::of_extractions(self.study);
        let mut cost = RoundCost { seconds: 0.0, untried: 0 };
        for &configuration in configurations {
            let (purpose, object) = (Purpose::Benchmark, self.study.object(configuration));
            let found = self.spacings().of(&configuration.id, purpose);
            let tried = trials.cost(configuration, purpose, found.unwrap_or(object.benchmark_spacing))?;
            match tried {
                Some(tried) => cost.seconds += tried.extracting_s + REFERENCE_S,
                None => cost.untried += 1,
            }
        }
        Ok(cost)
    }

    /// Says how long a run of a plan is expected to take.
    ///
    /// # Errors
    /// As [`round_cost`](Self::round_cost).
    pub(super) fn say_expected(&self, plan: &Plan, configurations: &[&Configuration]) -> Result<()> {
        let cost = self.round_cost(configurations)?;
        let timed = plan.invocations().iter().map(|of| plan.warmup + of.rounds.len() as u32).sum::<u32>();
        let rounds = timed + if plan.memory || plan.allocations { COUNTED_ROUNDS } else { 0 };
        tell!(
            "timings: {}, {} in {timed} rounds, warm-up included{}",
            about(f64::from(rounds) * cost.seconds),
            configurations_in_words(configurations.len()),
            beside(cost.untried)
        );
        Ok(())
    }
}

/// `about 3 min`.
pub(super) fn about(seconds: f64) -> String {
    match seconds {
        ..1.5 => "about a second".to_owned(),
        ..90.0 => format!("about {seconds:.0} s"),
        ..5400.0 => format!("about {:.0} min", seconds / 60.0),
        _ => format!("about {:.1} h", seconds / 3600.0),
    }
}

pub(super) fn configurations_in_words(count: usize) -> String {
    match count {
        1 => "1 configuration".to_owned(),
        _ => format!("{count} configurations"),
    }
}

/// Of those that were not tried.
pub(super) fn beside(untried: usize) -> String {
    match untried {
        0 => String::new(),
        _ => format!("; {untried} of them come on top, whose time nobody knows"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_time_is_said_in_its_unit() {
        let said = [0.2, 12.4, 170.0, 9000.0].map(about);
        assert_eq!(said, ["about a second", "about 12 s", "about 3 min", "about 2.5 h"]);
    }
}
