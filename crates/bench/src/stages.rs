//! The five stages of an extraction, in seconds.

use design::record::BenchSample;

/// A stage of an extraction, or all five together.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Stage {
    /// Allocating buffers.
    Allocation,
    /// Sampling the field.
    Sampling,
    /// Finding, clustering and placing vertices.
    Vertex,
    /// Making triangles, edge collapse included.
    Geometry,
    /// Computing vertex normals.
    Normals,
    /// The sum of the five. The paper's total leaves the normals out.
    Total,
}

impl Stage {
    /// The five stages in their order, then the total.
    pub const ALL: [Self; 6] =
        [Self::Allocation, Self::Sampling, Self::Vertex, Self::Geometry, Self::Normals, Self::Total];

    /// The name used in tables and errors.
    pub fn label(self) -> &'static str {
        match self {
            Self::Allocation => "allocation",
            Self::Sampling => "sampling",
            Self::Vertex => "vertex",
            Self::Geometry => "geometry",
            Self::Normals => "normals",
            Self::Total => "total",
        }
    }

    /// What a sample says about this stage, in seconds.
    pub fn of(self, sample: &BenchSample) -> f64 {
        match self {
            Self::Allocation => sample.allocation_s,
            Self::Sampling => sample.sampling_s,
            Self::Vertex => sample.vertex_s,
            Self::Geometry => sample.geometry_s,
            Self::Normals => sample.normals_s,
            Self::Total => sample.total_s,
        }
    }
}

/// How long each stage of one extraction took, in seconds.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[expect(missing_docs, reason = "defined in `Stage`")]
pub struct StageSeconds {
    pub allocation_s: f64,
    pub sampling_s: f64,
    pub vertex_s: f64,
    pub geometry_s: f64,
    pub normals_s: f64,
}

impl StageSeconds {
    /// The sum of the five, added in their order.
    pub fn total(&self) -> f64 {
        self.allocation_s + self.sampling_s + self.vertex_s + self.geometry_s + self.normals_s
    }

    /// The five with their names, in their order.
    pub(crate) fn by_stage(&self) -> [(Stage, f64); 5] {
        [
            (Stage::Allocation, self.allocation_s),
            (Stage::Sampling, self.sampling_s),
            (Stage::Vertex, self.vertex_s),
            (Stage::Geometry, self.geometry_s),
            (Stage::Normals, self.normals_s),
        ]
    }
}
