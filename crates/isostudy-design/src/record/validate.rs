//! Whether a run that was read from a file can have been measured.

use super::stage::Stage;
use super::{BenchRun, BenchSample, Counters, LoadWindow};
use crate::method::ConfigurationId;
use std::collections::{BTreeMap, BTreeSet};

/// Share by which a total may be off the sum of its stages: a tool that rewrote the file may have rounded.
const ROUNDING: f64 = 1e-9;

/// Why a run cannot have been measured. Every variant names the place.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum InvalidRun {
    /// A sample that no clock can have given.
    #[error("{list}[{place}], {id}: {reason}")]
    Sample {
        /// `samples` or `aa_samples`.
        list: &'static str,
        /// Where in it, from 0.
        place: usize,
        /// Of which configuration.
        id: ConfigurationId,
        /// What is wrong with it.
        reason: InvalidSample,
    },
    /// Two samples of one round.
    #[error("{list}: {id} is there twice in round {round}")]
    Twice {
        /// `samples` or `aa_samples`.
        list: &'static str,
        /// Which configuration.
        id: ConfigurationId,
        /// Which round.
        round: u32,
    },
    /// Rounds that a configuration lacks.
    #[error("{list}: {id} has {found} of {asked} rounds")]
    Rounds {
        /// `samples` or `aa_samples`.
        list: &'static str,
        /// Which configuration.
        id: ConfigurationId,
        /// How many are there.
        found: usize,
        /// How many the run says it has.
        asked: usize,
    },
    /// A configuration that only one of the lists has.
    #[error("{id} is in one of samples and aa_samples only")]
    OneList {
        /// Which configuration.
        id: ConfigurationId,
    },
    /// A process that measured for both lists.
    #[error("invocation {0} has both samples and aa_samples: the A/A block has processes of its own")]
    SharedInvocation(u32),
    /// A run whose every total is 0.
    #[error("samples: every total is 0 s: nothing was measured")]
    NothingTimed,
    /// A share of the CPU time that is none.
    #[error("load[{place}]: others = {others}, steal = {steal}: must be from 0 to 1, together too")]
    Load {
        /// Where, from 0.
        place: usize,
        /// The share of other processes.
        others: f64,
        /// The share of other machines.
        steal: f64,
    },
    /// Peaks that fall.
    #[error(
        "memory[{place}], {id}: before_bytes = {}, peak_before_bytes = {}, peak_bytes = {}: must not fall",
        bytes[0], bytes[1], bytes[2]
    )]
    Memory {
        /// Where, from 0.
        place: usize,
        /// Of which configuration.
        id: ConfigurationId,
        /// The three, in their order.
        bytes: [u64; 3],
    },
    /// Memory of one configuration listed twice.
    #[error("memory: {0} is there twice")]
    MemoryTwice(ConfigurationId),
}

/// Why a sample cannot have been measured.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum InvalidSample {
    /// Not a duration.
    #[error("{what} = {seconds:?} s: must be finite and not negative")]
    NotADuration {
        /// Which stage.
        what: &'static str,
        /// What it says.
        seconds: f64,
    },
    /// Something counted that nothing counts.
    #[error("{what} = {value:?}: must be finite and not negative")]
    Counter {
        /// What was counted.
        what: &'static str,
        /// What it says.
        value: f64,
    },
    /// A reference work that took no time.
    #[error("reference work = {0:?} s: must be finite and above 0")]
    Reference(f64),
    /// A total that is not the sum of the six stages.
    #[error("total = {total:?} s, and its stages add up to {sum:?} s")]
    Sum {
        /// What is said.
        total: f64,
        /// What it should be.
        sum: f64,
    },
    /// A round that the run does not have.
    #[error("iteration = {iteration}: the run has {rounds}, counted from 0")]
    Round {
        /// What is said.
        iteration: u32,
        /// How many there are.
        rounds: u32,
    },
}

impl BenchRun {
    /// Checks that the run can have been measured: durations, totals that are the sum of their stages, every round of every
    /// configuration once, shares of time and peaks of memory that can be. An imported run has one sample a configuration.
    ///
    /// # Errors
    /// The first thing that cannot be.
    pub fn check(&self) -> Result<(), InvalidRun> {
        let measured = if self.imported_from.is_some() { 1 } else { self.iterations };
        let of_samples = check_samples("samples", &self.samples, measured)?;
        if !self.samples.is_empty() && self.samples.iter().all(|sample| sample.total_s == 0.0) {
            return Err(InvalidRun::NothingTimed);
        }
        let of_aa = check_samples("aa_samples", &self.aa_samples, self.aa_iterations)?;
        if self.aa_iterations > 0 {
            if let Some(id) = of_samples.symmetric_difference(&of_aa).next() {
                return Err(InvalidRun::OneList { id: (*id).clone() });
            }
            let measured: BTreeSet<u32> = self.samples.iter().map(|sample| sample.invocation).collect();
            let mut again = self.aa_samples.iter().map(|sample| sample.invocation);
            if let Some(invocation) = again.find(|invocation| measured.contains(invocation)) {
                return Err(InvalidRun::SharedInvocation(invocation));
            }
        }
        for (place, &LoadWindow { others, steal, .. }) in self.load.iter().enumerate() {
            let valid = |share: f64| (0.0..=1.0).contains(&share);
            if !(valid(others) && valid(steal) && others + steal <= 1.0 + ROUNDING) {
                return Err(InvalidRun::Load { place, others, steal });
            }
        }
        let mut seen = BTreeSet::new();
        for (place, memory) in self.memory.iter().enumerate() {
            let (id, bytes) =
                (memory.id.clone(), [memory.before_bytes, memory.peak_before_bytes, memory.peak_bytes]);
            if !seen.insert(&memory.id) {
                return Err(InvalidRun::MemoryTwice(id));
            }
            if !bytes.is_sorted() {
                return Err(InvalidRun::Memory { place, id, bytes });
            }
        }
        Ok(())
    }
}

/// Returns the configurations that are there.
fn check_samples<'a>(
    list: &'static str,
    samples: &'a [BenchSample],
    rounds: u32,
) -> Result<BTreeSet<&'a ConfigurationId>, InvalidRun> {
    let mut seen = BTreeMap::<&ConfigurationId, BTreeSet<u32>>::new();
    for (place, sample) in samples.iter().enumerate() {
        let (id, round) = (&sample.id, sample.iteration);
        sample.check(rounds).map_err(|reason| InvalidRun::Sample { list, place, id: id.clone(), reason })?;
        if !seen.entry(id).or_default().insert(round) {
            return Err(InvalidRun::Twice { list, id: id.clone(), round });
        }
    }
    let asked = rounds as usize;
    match seen.iter().find(|(_, of)| of.len() != asked) {
        Some((id, of)) => Err(InvalidRun::Rounds { list, id: (*id).clone(), found: of.len(), asked }),
        None => Ok(seen.into_keys().collect()),
    }
}

impl BenchSample {
    /// Checks that the sample can have been measured in a run of so many rounds.
    ///
    /// # Errors
    /// The first thing that cannot be.
    pub fn check(&self, rounds: u32) -> Result<(), InvalidSample> {
        let [of_extraction @ .., total] = Stage::ALL;
        let parts = of_extraction.into_iter().chain([Stage::Finishing]);
        let stages: Vec<_> = parts.chain([total]).map(|stage| (stage.label(), stage.of(self))).collect();
        let valid = |seconds: f64| seconds.is_finite() && seconds >= 0.0;
        if let Some((what, seconds)) = stages.iter().copied().find(|(_, s)| !valid(*s)) {
            return Err(InvalidSample::NotADuration { what, seconds });
        }
        if let Some(seconds) = self.reference_s.filter(|seconds| !(valid(*seconds) && *seconds > 0.0)) {
            return Err(InvalidSample::Reference(seconds));
        }
        let Counters { cpu_s, energy_j, outside_s, .. } = self.counters;
        let counted = [("cpu_s", cpu_s), ("energy_j", energy_j), ("outside_s", outside_s)];
        let mut counted = counted.into_iter().filter_map(|(what, value)| Some((what, value?)));
        if let Some((what, value)) = counted.find(|(_, value)| !valid(*value)) {
            return Err(InvalidSample::Counter { what, value });
        }
        let (total, sum) =
            (self.total_s, stages[..stages.len() - 1].iter().map(|(_, seconds)| seconds).sum::<f64>());
        // A sum beyond every number is none.
        if !sum.is_finite() || (total - sum).abs() > ROUNDING * sum {
            return Err(InvalidSample::Sum { total, sum });
        }
        if self.iteration >= rounds {
            return Err(InvalidSample::Round { iteration: self.iteration, rounds });
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::machine::{CpuProfile, Machine};
    use crate::record::PeakMemory;

    fn sample(id: &str, iteration: u32) -> BenchSample {
        BenchSample {
            id: id.parse().unwrap(),
            invocation: 0,
            iteration,
            place: 0,
            allocation_s: 0.001,
            sampling_s: 0.01,
            vertex_s: 0.1,
            geometry_s: 0.3,
            clustering_s: 0.7,
            normals_s: 1e-7,
            finishing_s: 0.0,
            total_s: 0.001 + 0.01 + 0.1 + 0.3 + 0.7 + 1e-7,
            reference_s: Some(0.001),
            counters: Counters { cpu_s: Some(2.0), ..Counters::default() },
        }
    }

    fn run() -> BenchRun {
        let rounds = |of: u32| (0..of).flat_map(|round| ["ss_bi", "ss_su"].map(|id| sample(id, round)));
        let memory =
            PeakMemory { id: "ss_bi".parse().unwrap(), before_bytes: 2, peak_before_bytes: 3, peak_bytes: 4 };
        let window =
            LoadWindow { invocation: None, rounds: None, others: 0.25, steal: 0.75, load_average: None };
        let target: CpuProfile = toml::from_str("name = \"any\"\nmodel = \"\"").unwrap();
        BenchRun {
            schema: BenchRun::SCHEMA,
            study: "s".into(),
            workloads: Vec::new(),
            imported_from: None,
            warmup: 1,
            iterations: 3,
            aa_iterations: 2,
            seed: 1,
            threads: 1,
            reference_threads: 1,
            pinned: None,
            target,
            machine: Machine::default(),
            differences: Vec::new(),
            samples: rounds(3).collect(),
            aa_samples: rounds(2).map(|sample| BenchSample { invocation: 1, ..sample }).collect(),
            load: vec![window],
            memory: vec![memory],
            resumed: Vec::new(),
            failed: Vec::new(),
            allocations: Vec::new(),
        }
    }

    fn id(text: &str) -> ConfigurationId {
        text.parse().unwrap()
    }

    /// Why a run is invalid after this was done to it.
    fn after(spoil: impl FnOnce(&mut BenchRun)) -> InvalidRun {
        let mut run = run();
        spoil(&mut run);
        run.check().unwrap_err()
    }

    #[test]
    fn a_run_as_measured_is_valid() {
        assert_eq!(run().check(), Ok(()));
        let mut rounded = run();
        rounded.samples[0].total_s *= 1.0 + 1e-12;
        assert_eq!(rounded.check(), Ok(()), "another tool may round");
        let mut imported = run();
        imported.imported_from = Some("a table".into());
        imported.samples.truncate(2);
        assert_eq!(imported.check(), Ok(()));
    }

    #[test]
    fn what_no_clock_gives_is_refused_with_its_place() {
        let of = |place, reason| InvalidRun::Sample { list: "samples", place, id: id("ss_su"), reason };
        assert_eq!(
            after(|run| run.samples[3].vertex_s = -0.5),
            of(3, InvalidSample::NotADuration { what: "vertex", seconds: -0.5 })
        );
        let reason = InvalidSample::Reference(f64::INFINITY);
        assert_eq!(
            after(|run| run.aa_samples[0].reference_s = Some(f64::INFINITY)),
            InvalidRun::Sample { list: "aa_samples", place: 0, id: id("ss_bi"), reason }
        );
        let sum = 0.001 + 0.01 + 0.1 + 0.3 + 0.7 + 1e-7;
        assert_eq!(after(|run| run.samples[1].total_s = 2.0), of(1, InvalidSample::Sum { total: 2.0, sum }));
        assert_eq!(after(|run| run.samples[1].reference_s = Some(0.0)), of(1, InvalidSample::Reference(0.0)));
        let beyond = after(|run| {
            let sample = &mut run.samples[1];
            (sample.vertex_s, sample.geometry_s, sample.total_s) = (1e308, 1e308, 1.7e308);
        });
        assert_eq!(beyond, of(1, InvalidSample::Sum { total: 1.7e308, sum: f64::INFINITY }));
        assert_eq!(
            after(|run| run.samples[1].iteration = 3),
            of(1, InvalidSample::Round { iteration: 3, rounds: 3 })
        );
    }

    #[test]
    fn a_run_that_measured_nothing_is_refused() {
        let nothing = |sample: &mut BenchSample| {
            (sample.allocation_s, sample.sampling_s, sample.vertex_s) = (0.0, 0.0, 0.0);
            (sample.geometry_s, sample.clustering_s, sample.normals_s) = (0.0, 0.0, 0.0);
            sample.total_s = 0.0;
        };
        assert_eq!(after(|run| run.samples.iter_mut().for_each(nothing)), InvalidRun::NothingTimed);
        let mut one = run();
        one.samples[1..].iter_mut().for_each(nothing);
        assert_eq!(one.check(), Ok(()), "one of them was");
        let reason = InvalidSample::Counter { what: "cpu_s", value: -1.0 };
        assert_eq!(
            after(|run| run.samples[0].counters.cpu_s = Some(-1.0)),
            InvalidRun::Sample { list: "samples", place: 0, id: id("ss_bi"), reason }
        );
    }

    #[test]
    fn every_round_is_there_once() {
        assert_eq!(
            after(|run| run.samples[2].iteration = 0),
            InvalidRun::Twice { list: "samples", id: id("ss_bi"), round: 0 }
        );
        assert_eq!(
            after(|run| drop(run.samples.pop())),
            InvalidRun::Rounds { list: "samples", id: id("ss_su"), found: 2, asked: 3 }
        );
        assert_eq!(
            after(|run| drop(run.aa_samples.remove(0))),
            InvalidRun::Rounds { list: "aa_samples", id: id("ss_bi"), found: 1, asked: 2 }
        );
        assert_eq!(after(|run| run.aa_samples.clear()), InvalidRun::OneList { id: id("ss_bi") });
        assert_eq!(after(|run| run.aa_samples[1].invocation = 0), InvalidRun::SharedInvocation(0));
    }

    #[test]
    fn shares_and_peaks_are_ones_that_can_be() {
        assert_eq!(
            after(|run| run.load[0].steal = 0.8),
            InvalidRun::Load { place: 0, others: 0.25, steal: 0.8 }
        );
        assert_eq!(
            after(|run| run.memory[0].peak_bytes = 1),
            InvalidRun::Memory { place: 0, id: id("ss_bi"), bytes: [2, 3, 1] }
        );
        assert_eq!(after(|run| run.memory.push(run.memory[0].clone())), InvalidRun::MemoryTwice(id("ss_bi")));
    }
}
