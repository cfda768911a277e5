//! The six stages of an extraction, and what finishes a mesh, in seconds.

use isostudy_design::ConfigurationId;
use isostudy_design::record::{BenchSample, Counters};
use isostudy_extract::StageTimes;
use serde::{Deserialize, Serialize};
use std::time::Duration;

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
    #[serde(default)]
    pub finishing_s: f64,
}

/// One extraction: its stages, and what else was counted meanwhile.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Timed {
    /// How long each stage took.
    pub stages: StageSeconds,
    /// Over all threads of the process that extracted.
    pub counters: Counters,
}

/// The six, in their order.
pub(crate) fn six(times: &StageTimes) -> [Duration; 6] {
    let &StageTimes { allocation, sampling, vertex, geometry, clustering, normals } = times;
    [allocation, sampling, vertex, geometry, clustering, normals]
}

impl From<&StageTimes> for StageSeconds {
    fn from(times: &StageTimes) -> Self {
        let [allocation_s, sampling_s, vertex_s, geometry_s, clustering_s, normals_s] =
            six(times).map(|time| time.as_secs_f64());
        Self { allocation_s, sampling_s, vertex_s, geometry_s, clustering_s, normals_s, finishing_s: 0.0 }
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
        let Self { allocation_s, sampling_s, vertex_s, geometry_s, clustering_s, normals_s, finishing_s } =
            self;
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
            finishing_s,
            total_s,
            reference_s,
            counters: Counters::default(),
        }
    }

    /// The sum of all, added in their order.
    pub fn total(&self) -> f64 {
        self.allocation_s
            + self.sampling_s
            + self.vertex_s
            + self.geometry_s
            + self.clustering_s
            + self.normals_s
            + self.finishing_s
    }
}
