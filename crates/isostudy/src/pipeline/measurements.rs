//! What choices, tables and figures are made from: records of finished stages, read again.

use super::{Meshes, Pipeline};
use crate::store::Stamp;
use anyhow::Result;
use isostudy_design::record::{BenchRun, ChunkTimes, MeshRecord, StoredTimes};
use isostudy_design::{ConfigurationId, Study};
use isostudy_inference::{Answered, Inputs};

/// The finished stages of times.
pub(super) struct Times<'a> {
    pub(super) whole: &'a Stamp,
    pub(super) chunks: &'a [Stamp],
    pub(super) stored: &'a [Stamp],
}

impl Times<'_> {
    pub(super) fn stamps(&self) -> impl Iterator<Item = &Stamp> {
        std::iter::once(self.whole).chain(self.chunks).chain(self.stored)
    }
}

/// What was measured of meshes.
pub(super) struct Measurements {
    meshes: Vec<MeshRecord>,
    run: BenchRun,
    chunks: Vec<ChunkTimes>,
    stored: Vec<StoredTimes>,
    left_out: Vec<(ConfigurationId, String)>,
}

impl Measurements {
    /// With what was answered, if anything is to be said of that.
    pub(super) fn inputs<'a>(&'a self, study: &'a Study, answers: Option<&'a Answered>) -> Inputs<'a> {
        Inputs {
            study,
            meshes: &self.meshes,
            bench: Some(&self.run),
            chunks: &self.chunks,
            stored: &self.stored,
            answers,
            left_out: &self.left_out,
        }
    }
}

impl Pipeline<'_> {
    pub(super) fn measurements(&self, meshes: &Meshes, times: &Times<'_>) -> Result<Measurements> {
        Ok(Measurements {
            meshes: self.mesh_records(meshes)?,
            run: self.bench_run(times.whole)?,
            chunks: self.times_apart(times.chunks)?,
            stored: self.times_apart(times.stored)?,
            left_out: self.left_out(),
        })
    }
}
