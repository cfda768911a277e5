//! The six stages of an extraction, in seconds.

use isostudy_design::ConfigurationId;
use isostudy_design::record::{BenchSample, Counters};
use isostudy_extract::StageTimes;
use serde::{Deserialize, Serialize};

/// How long each stage of one extraction took, in seconds.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[expect(missing_docs, reason = "defined in `Stage`")]
pub struct StageSeconds {
    pub allocation_s: f64,
    pub sampling_s: f64,
    pub vertex_s: f64,
    pub geometry_s: f64,
    pub clustering_s: f64,
    pub normals_s: f64,
}

/// One extraction: its stages, and what else was counted meanwhile.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Timed {
    /// How long each stage took.
    pub stages: StageSeconds,
    /// Over all threads of the process that extracted.
    pub counters: Counters,
}

impl From<&StageTimes> for StageSeconds {
    fn from(times: &StageTimes) -> Self {
        Self {
            allocation_s: times.allocation.as_secs_f64(),
            sampling_s: times.sampling.as_secs_f64(),
            vertex_s: times.vertex.as_secs_f64(),
            geometry_s: times.geometry.as_secs_f64(),
            clustering_s: times.clustering.as_secs_f64(),
            normals_s: times.normals.as_secs_f64(),
        }
    }
}

impl StageSeconds {
    /// These times as a sample of a run: which invocation, which round, which place in it, and the reference work's time.
    pub fn sample(
        self,
        id: ConfigurationId,
        [invocation, iteration, place]: [u32; 3],
        reference_s: Option<f64>,
    ) -> BenchSample {
        let total_s = self.total();
        let Self { allocation_s, sampling_s, vertex_s, geometry_s, clustering_s, normals_s } = self;
        BenchSample {
            id,
            invocation,
            iteration,
            place,
            allocation_s,
            sampling_s,
            vertex_s,
            geometry_s,
            clustering_s,
            normals_s,
            total_s,
            reference_s,
            counters: Counters::default(),
        }
    }

    /// The sum of the six, added in their order.
    pub fn total(&self) -> f64 {
        self.allocation_s
            + self.sampling_s
            + self.vertex_s
            + self.geometry_s
            + self.clustering_s
            + self.normals_s
    }
}
