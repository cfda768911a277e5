//! The six stages of an extraction.

use super::{BenchSample, StageCounts};
use serde::{Deserialize, Serialize};

/// A stage of an extraction, or all six together.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Stage {
    /// Allocating buffers.
    Allocation,
    /// Sampling the field.
    Sampling,
    /// Finding and placing vertices, integrated clustering included.
    Vertex,
    /// Making triangles.
    Geometry,
    /// The edge collapse.
    Clustering,
    /// Computing vertex normals.
    Normals,
    /// What is done to the finished mesh. It is no stage of an extraction, and most methods have none.
    Finishing,
    /// The sum of the six and of finishing. The paper's total leaves the normals out.
    Total,
    /// Geometry and edge collapse together: the published geometry stage.
    GeometryAsPublished,
}

impl Stage {
    /// The six stages in their order, then the total.
    pub const ALL: [Self; 7] = [
        Self::Allocation,
        Self::Sampling,
        Self::Vertex,
        Self::Geometry,
        Self::Clustering,
        Self::Normals,
        Self::Total,
    ];

    /// The stages that samples have: [`ALL`](Self::ALL), with finishing before the total where some method is finished.
    pub fn parts_of<'s>(samples: impl IntoIterator<Item = &'s BenchSample>) -> Vec<Self> {
        let mut stages = Self::ALL.to_vec();
        if samples.into_iter().any(|sample| sample.finishing_s > 0.0) {
            stages.insert(stages.len() - 1, Self::Finishing);
        }
        stages
    }

    /// The name used in tables and errors.
    pub fn label(self) -> &'static str {
        match self {
            Self::Allocation => "allocation",
            Self::Sampling => "sampling",
            Self::Vertex => "vertex",
            Self::Geometry => "geometry",
            Self::Clustering => "clustering",
            Self::Normals => "normals",
            Self::Finishing => "finishing",
            Self::Total => "total",
            Self::GeometryAsPublished => "geometry and clustering",
        }
    }

    /// What a sample says about this stage, in seconds.
    pub fn of(self, sample: &BenchSample) -> f64 {
        match self {
            Self::Allocation => sample.allocation_s,
            Self::Sampling => sample.sampling_s,
            Self::Vertex => sample.vertex_s,
            Self::Geometry => sample.geometry_s,
            Self::Clustering => sample.clustering_s,
            Self::Normals => sample.normals_s,
            Self::Finishing => sample.finishing_s,
            Self::Total => sample.total_s,
            Self::GeometryAsPublished => sample.geometry_s + sample.clustering_s,
        }
    }

    /// What is counted for this stage. What finishing asks for stands in the total alone.
    pub fn count(self, counts: &StageCounts) -> u64 {
        match self {
            Self::Allocation => counts.allocation,
            Self::Sampling => counts.sampling,
            Self::Vertex => counts.vertex,
            Self::Geometry => counts.geometry,
            Self::Clustering => counts.clustering,
            Self::Normals => counts.normals,
            Self::Finishing => 0,
            Self::Total => counts.total,
            Self::GeometryAsPublished => counts.geometry + counts.clustering,
        }
    }
}
