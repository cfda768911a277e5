//! The records that stages hand to each other: what was extracted, measured, timed.

use crate::machine::{CpuProfile, Machine, ProfileDifference};
use crate::method::ConfigurationId;
use serde::{Deserialize, Serialize};

/// What a mesh was extracted for; each purpose has its own spacing.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Purpose {
    /// At the benchmark spacing, with the study's positions.
    Benchmark,
    /// At the stimulus spacing, with the study's positions.
    Stimulus,
    /// At the benchmark spacing, with positions computed from indices: shows what accumulated positions change.
    Indexed,
}

/// One extracted mesh: how it was made, what was counted, what its triangles and its topology are.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MeshRecord {
    /// Which configuration.
    pub id: ConfigurationId,
    /// What for.
    pub purpose: Purpose,
    /// Cube edge.
    pub spacing: f64,
    /// Cubes along x, y and z.
    pub cells: [u32; 3],
    /// What was counted on the way.
    pub counts: Counts,
    /// Quality of the triangles.
    pub quality: Quality,
    /// Topology of the mesh.
    pub topology: Topology,
    /// How well the mesh stands for its isosurface.
    pub accuracy: Accuracy,
}

/// What an extraction counted. Names as in `extract::Counts`, whose docs define them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[expect(missing_docs, reason = "defined where they are counted, in `extract::Counts`")]
pub struct Counts {
    pub stored_samples: u64,
    pub needed_samples: u64,
    pub stored_edges: u64,
    pub needed_edges: u64,
    pub tetrahedra: u64,
    pub tetrahedra_evaluated: u64,
    pub crossings: u64,
    pub vertices: u64,
    pub triangles: u64,
    pub discarded_triangles: u64,
    pub discarded_as_published: u64,
    pub sample_bytes: u64,
    pub edge_bytes: u64,
    pub vertex_bytes: u64,
    pub index_bytes: u64,
}

/// Quality of a mesh's triangles. Names as in `mesh::quality::QualityReport`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Quality {
    /// Triangles in the mesh.
    pub triangles: u64,
    /// Triangles with zero area or a zero-length edge; left out of every distribution but the area. The published
    /// moments of the aspect ratio count them as 0 instead.
    pub degenerate: u64,
    /// The published ratio: longer over shorter of the two edges at the first corner.
    pub published_aspect_ratio: Distribution,
    /// Longest over shortest edge.
    pub edge_ratio: Distribution,
    /// Normalised radius ratio, 1 for an equilateral triangle.
    pub radius_ratio: Distribution,
    /// Smallest angle in degrees.
    pub min_angle_deg: Distribution,
    /// Largest angle in degrees.
    pub max_angle_deg: Distribution,
    /// Area.
    pub area: Distribution,
}

/// A mesh against its isosurface. Names as in `extract::Accuracy`, whose docs define them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Accuracy {
    /// Distance from points of the mesh to the isosurface, in scene units; over the area.
    pub distance: Distribution,
    /// Angle between a vertex's normal and the field's, degrees; over vertices.
    pub normal_error_deg: Distribution,
    /// Points without a distance.
    pub lost_points: u64,
    /// Vertices without an angle.
    pub lost_vertices: u64,
}

/// A distribution, over triangles where nothing else is said. All zero when `count` is.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[expect(missing_docs, reason = "standard terms; `sd` is the population standard deviation, qNN a quantile")]
pub struct Distribution {
    pub count: u64,
    pub mean: f64,
    pub sd: f64,
    pub min: f64,
    pub q05: f64,
    pub q25: f64,
    pub median: f64,
    pub q75: f64,
    pub q95: f64,
    pub max: f64,
    pub histogram: Histogram,
}

/// Equal-width bins from `low` to `high`, and what lies outside.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[expect(missing_docs, reason = "said above")]
pub struct Histogram {
    pub low: f64,
    pub high: f64,
    pub counts: Vec<u64>,
    pub below: u64,
    pub above: u64,
}

/// Topology of a mesh. Names as in `mesh::topology::TopologyReport`, whose docs define them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[expect(missing_docs, reason = "defined where they are counted, in `mesh::topology`")]
pub struct Topology {
    pub vertices: u64,
    pub edges: u64,
    pub triangles: u64,
    pub boundary_edges: u64,
    pub non_manifold_edges: u64,
    pub misoriented_edges: u64,
    pub non_manifold_vertices: u64,
    pub duplicate_faces: u64,
    pub folded_faces: u64,
    pub components: u64,
    pub euler_characteristic: i64,
}

/// A benchmark run: every sample, the plan it followed, the machine it ran on.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BenchRun {
    /// Version of this layout; 1.
    pub schema: u32,
    /// The study's id.
    pub study: String,
    /// Rounds run and thrown away.
    pub warmup: u32,
    /// Rounds measured.
    pub iterations: u32,
    /// Seed of the order within each round.
    pub seed: u64,
    /// Threads in the sampling stage.
    pub threads: u32,
    /// The CPU the numbers are meant for.
    pub target: CpuProfile,
    /// The machine they were measured on.
    pub machine: Machine,
    /// How the two differ; empty when they match.
    pub differences: Vec<ProfileDifference>,
    /// Every sample, in the order measured.
    pub samples: Vec<BenchSample>,
}

/// One timed extraction. The five stages add up to the total.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BenchSample {
    /// What was extracted.
    pub id: ConfigurationId,
    /// Round, from 0.
    pub iteration: u32,
    /// Place within the round, from 0.
    pub place: u32,
    /// Seconds to allocate buffers.
    pub allocation_s: f64,
    /// Seconds to sample the field.
    pub sampling_s: f64,
    /// Seconds in the vertex stage.
    pub vertex_s: f64,
    /// Seconds in the geometry stage, edge collapse included.
    pub geometry_s: f64,
    /// Seconds to compute vertex normals.
    pub normals_s: f64,
    /// Their sum.
    pub total_s: f64,
}
