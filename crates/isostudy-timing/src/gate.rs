//! What a gate asks of a comparison, and how it ends.

use super::compare::{Comparison, Limits, Row};
use super::differences::{commit, sources};
use super::quiet::{busy_share, warnings};
use isostudy_design::record::BenchRun;
use isostudy_design::{ConfigurationId, Stage};
use serde::Serialize;

/// What a gate asks.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Gate {
    /// What is a regression.
    #[serde(flatten)]
    pub limits: Limits,
    /// The change of a total, as a share, that must not go unnoticed; `None` asks nothing.
    pub must_tell: Option<f64>,
}

/// What it found.
#[derive(Debug, Clone, PartialEq)]
pub struct GateResult<'a> {
    /// Totals and stages that are slower beyond the limits.
    pub regressions: Vec<&'a Row>,
    /// Configurations of A that B has not got: a build that drops one must not pass for one that is as fast. An imported table
    /// may have fewer rows than ours.
    pub missing: Vec<&'a ConfigurationId>,
    /// Totals of which a change as large as must be told would not have been.
    pub blind: Vec<&'a Row>,
    /// Whether something had to be told, and A and B are one run.
    pub itself: bool,
}

/// How a gate ends.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum GateStatus {
    /// Nothing was found, and what must be told would have been.
    Passed,
    /// Something is slower, or missing.
    Failed,
    /// Nothing was found where it would not have been told.
    Blind,
}

impl Gate {
    /// Judges the comparison of B with `a`.
    pub fn judge<'a>(&self, a: &BenchRun, comparison: &'a Comparison) -> GateResult<'a> {
        let of_a = |id: &&ConfigurationId| a.samples.iter().any(|sample| sample.id == **id);
        // Unknown is not small.
        let is_blind = |row: &&Row| {
            self.must_tell
                .is_some_and(|share| row.smallest_detectable.is_none_or(|ratio| ratio > 1.0 + share))
        };
        GateResult {
            regressions: comparison.regressions(&self.limits),
            missing: comparison.unmatched.iter().filter(of_a).collect(),
            blind: comparison.of_stage(Stage::Total).filter(is_blind).collect(),
            itself: self.must_tell.is_some() && comparison.itself,
        }
    }
}

impl GateResult<'_> {
    /// How it ends: what was found counts before what could not have been.
    pub fn status(&self) -> GateStatus {
        if !self.regressions.is_empty() || !self.missing.is_empty() {
            GateStatus::Failed
        } else if !self.blind.is_empty() || self.itself {
            GateStatus::Blind
        } else {
            GateStatus::Passed
        }
    }
}

/// A comparison with all that decided, for a program that reads it.
#[derive(Debug, Serialize)]
pub struct GateRecord<'a> {
    /// How the command ended.
    pub exit_status: u8,
    /// What was asked.
    pub limits: Gate,
    /// Totals and stages that are slower beyond the limits.
    pub regressions: Vec<Named<'a>>,
    /// In A and not in B.
    pub missing: &'a [&'a ConfigurationId],
    /// Configurations of which what must be told would not have been.
    pub blind: Vec<&'a ConfigurationId>,
    /// The first run.
    pub a: RunFacts<'a>,
    /// The second.
    pub b: RunFacts<'a>,
    /// Every row.
    #[serde(flatten)]
    pub comparison: &'a Comparison,
}

/// A stage of a configuration by name.
#[derive(Debug, Serialize)]
pub struct Named<'a> {
    /// Which configuration.
    pub id: &'a ConfigurationId,
    /// Which stage.
    pub stage: Stage,
    /// Median in A, seconds.
    pub a_s: f64,
    /// Median in B, seconds.
    pub b_s: f64,
}

/// What a run was measured of and on.
#[derive(Debug, Serialize)]
pub struct RunFacts<'a> {
    /// The study's id.
    pub study: &'a str,
    /// Of the program's sources, with a word on changes that were not committed; `None` if it is not known.
    pub commit: Option<String>,
    /// The first digits of the digest of what was timed.
    pub sources: Option<&'a str>,
    /// The CPU's model.
    pub model: Option<&'a str>,
    /// Measured rounds.
    pub rounds: u32,
    /// Rounds of the A/A block.
    pub aa_rounds: u32,
    /// What others had of the CPU time, as a share that three stretches of four stayed below.
    pub load: f64,
    /// What to know of the machine before reading on.
    pub warnings: Vec<String>,
}

impl<'a> GateRecord<'a> {
    /// Of two runs, their comparison and what a gate found in it. `exit_status` is the caller's.
    pub fn new(
        [a, b]: [&'a BenchRun; 2],
        comparison: &'a Comparison,
        limits: Gate,
        found: &'a GateResult<'a>,
        exit_status: u8,
    ) -> Self {
        let named = |row: &&'a Row| Named { id: &row.id, stage: row.stage, a_s: row.a_s, b_s: row.b_s };
        Self {
            exit_status,
            limits,
            regressions: found.regressions.iter().map(named).collect(),
            missing: &found.missing,
            blind: found.blind.iter().map(|row| &row.id).collect(),
            a: RunFacts::of(a),
            b: RunFacts::of(b),
            comparison,
        }
    }
}

impl<'a> RunFacts<'a> {
    fn of(run: &'a BenchRun) -> Self {
        Self {
            study: &run.study,
            commit: commit(&run.machine.build),
            sources: sources(&run.machine.build),
            model: run.machine.model.as_deref(),
            rounds: run.iterations,
            aa_rounds: run.aa_iterations,
            load: busy_share(&run.load),
            warnings: warnings(run),
        }
    }
}
