//! What tables and figures are made from.

use crate::answered::Answered;
use isostudy_design::record::{BenchRun, ChunkTimes, MeshRecord, StoredTimes};
use isostudy_design::{ConfigurationId, Study};

/// What tables and figures are made from. Absent or empty parts leave out what depends on them.
#[derive(Debug, Clone, Copy)]
pub struct Inputs<'a> {
    /// The study.
    pub study: &'a Study,
    /// Meshes of any purpose, in any order; configurations may be missing.
    pub meshes: &'a [MeshRecord],
    /// The benchmark run.
    pub bench: Option<&'a BenchRun>,
    /// Times chunk by chunk, of what was timed so.
    pub chunks: &'a [ChunkTimes],
    /// Times from stored samples, of what was timed so.
    pub stored: &'a [StoredTimes],
    /// The answers to this study's comparisons.
    pub answers: Option<&'a Answered>,
    /// What has no mesh or no times because its program failed, and why.
    pub left_out: &'a [(ConfigurationId, String)],
}
