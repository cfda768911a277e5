//! Two programs timed in turn.

use super::{BenchSample, Failure, InvalidSample, LoadWindow, Workload};
use crate::machine::Machine;
use crate::method::ConfigurationId;
use serde::{Deserialize, Serialize};

/// A run of two builds in the same rounds: each configuration by one and at once by the other, so that what slows the machine down
/// falls on both.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct AbRun {
    /// Version of this layout; [`AbRun::SCHEMA`].
    pub schema: u32,
    /// The study's id.
    pub study: String,
    /// What was asked of both.
    pub workloads: Vec<Workload>,
    /// The program that the other is compared with.
    pub old: AbProgram,
    /// The program that is judged.
    pub new: AbProgram,
    /// Rounds run and thrown away at the start of every pair of processes.
    pub warmup: u32,
    /// Pairs of processes, which are the `invocation`s of the samples.
    pub processes: u32,
    /// Seed of the order within each round.
    pub seed: u64,
    /// Threads in the sampling stage.
    pub threads: u32,
    /// The CPUs that the processes were pinned to; `None` if they were not.
    pub pinned: Option<Vec<u32>>,
    /// The machine.
    pub machine: Machine,
    /// Pairs, in the order measured.
    pub pairs: Vec<AbPair>,
    /// What else the machine did meanwhile, a window for each pair of processes.
    pub load: Vec<LoadWindow>,
    /// Configurations that were left out because one of both could not make them every time; the lists above have nothing of them.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub failed: Vec<Failure>,
}

/// A program that was timed.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct AbProgram {
    /// Its file, or the folder of its links.
    pub path: String,
    /// SHA-256 of it; of several links, that of their digests in their order.
    pub sha256: String,
    /// How many links of one build there are, which differ in the order of their code. A pair of processes takes the link of its own
    /// number, from the first again after the last.
    #[serde(default = "one")]
    pub links: u32,
}

fn one() -> u32 {
    1
}

/// One configuration by both programs, one at once after the other.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct AbPair {
    /// Whether the new one was first.
    pub new_first: bool,
    /// By the old program.
    pub old: BenchSample,
    /// By the new one.
    pub new: BenchSample,
}

impl AbRun {
    /// The version of the layout that is written and read here.
    pub const SCHEMA: u32 = 1;
}

impl AbPair {
    /// Checks that both were measured, and are of one configuration, round and pair of processes.
    ///
    /// # Errors
    /// The first thing that cannot be.
    pub fn check(&self) -> Result<(), InvalidPair> {
        let at =
            |sample: &BenchSample| (sample.id.clone(), sample.invocation, sample.iteration, sample.place);
        if at(&self.old) != at(&self.new) {
            return Err(InvalidPair::Apart { old: self.old.id.clone(), new: self.new.id.clone() });
        }
        for sample in [&self.old, &self.new] {
            let invalid = |reason| InvalidPair::Sample { id: sample.id.clone(), reason };
            sample.check(u32::MAX).map_err(invalid)?;
        }
        Ok(())
    }
}

/// Why a pair cannot have been measured.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum InvalidPair {
    /// Two that are not of one configuration, round and pair of processes.
    #[error("{old} and {new} are no pair: another configuration, round or process")]
    Apart {
        /// Of which configuration the old program's sample is.
        old: ConfigurationId,
        /// Of which the new one's is.
        new: ConfigurationId,
    },
    /// A sample that no clock can have given.
    #[error("{id}: {reason}")]
    Sample {
        /// Of which configuration.
        id: ConfigurationId,
        /// What is wrong with it.
        reason: InvalidSample,
    },
}
