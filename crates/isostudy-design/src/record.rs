//! The records that stages hand to each other: what was extracted, measured, timed.

use crate::machine::{CpuProfile, Machine, ProfileDifference};
use crate::method::ConfigurationId;
use serde::{Deserialize, Serialize};
use std::ops::RangeInclusive;

mod pairs;
mod region;
mod stage;
mod validate;

pub use pairs::{AbPair, AbProgram, AbRun, InvalidPair};
pub use region::{Judged, RegionMeasures};
pub use stage::Stage;
pub use validate::{InvalidRun, InvalidSample};

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
    /// Version of this layout; [`MeshRecord::SCHEMA`].
    pub schema: u32,
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
    /// The same of the object's region alone, which is what decides; `None` where the object has none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub region: Option<RegionMeasures>,
    /// What the trilinear interpolant of the samples has instead, where the samples are the corners of the grid's cells.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub trilinear: Option<Trilinear>,
    /// The program that made it, as it calls itself; `None` of what is not made by a program.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub program: Option<MadeBy>,
}

/// What a program says of itself.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct MadeBy {
    /// Its name.
    pub name: String,
    /// Its version.
    pub version: String,
    /// What a reader of its times should know.
    #[serde(default)]
    pub note: Option<String>,
}

impl MeshRecord {
    /// The version of the layout that is written and read here. 2 has counts that every method has, and those of tetrahedra beside
    /// them.
    pub const SCHEMA: u32 = 2;

    /// Whether it was made on a grid of cells. A mesh that was there already was not.
    pub fn has_grid(&self) -> bool {
        self.counts.cells.is_some()
    }
}

/// The topology of the trilinear level set of a grid of samples; names as in `isostudy_trilinear::Summary`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Trilinear {
    /// Connected pieces.
    pub components: u64,
    /// Summed over them.
    pub euler_characteristic: i64,
    /// Tunnels of the surface.
    pub genus: i64,
    /// Cells whose surface has a tunnel.
    pub tunnel_cells: u64,
    /// Cells that the method decided otherwise than the interpolant, if it decides cell by cell.
    pub cells_otherwise: Option<u64>,
}

/// What was counted while a mesh was made. What its method does not have, or does not tell, is `None`.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Counts {
    /// Sample points that the grid has for the method.
    pub samples: Option<u64>,
    /// Cells of the grid.
    pub cells: Option<u64>,
    /// Cells that the method looked into.
    pub cells_visited: Option<u64>,
    /// Crossings of grid edges with the surface.
    pub crossings: Option<u64>,
    /// Vertices of the mesh.
    pub vertices: u64,
    /// Triangles of the mesh.
    pub triangles: u64,
    /// Triangles that merging took away.
    pub discarded_triangles: Option<u64>,
    /// Values of the field that were asked for: how often it was called.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub evaluations: Option<u64>,
    /// Gradients that the field gave.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gradients: Option<u64>,
    /// Bytes of the mesh's vertices, normals included.
    pub vertex_bytes: u64,
    /// Bytes of the mesh's indices.
    pub index_bytes: u64,
    /// What only tetrahedra have.
    pub tetrahedra: Option<TetrahedraCounts>,
}

/// What only marching tetrahedra count. Names as in `isostudy_extract::TetrahedraCounts`, whose docs define them.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[expect(missing_docs, reason = "defined where they are counted, in `isostudy_extract::TetrahedraCounts`")]
pub struct TetrahedraCounts {
    pub stored_samples: u64,
    pub stored_edges: u64,
    pub needed_edges: u64,
    pub tetrahedra: u64,
    pub tetrahedra_evaluated: u64,
    pub discarded_as_published: u64,
    pub sample_bytes: u64,
    pub edge_bytes: u64,
}

impl Counts {
    /// Calls of the field for each vertex of the mesh.
    pub fn evaluations_per_vertex(&self) -> Option<f64> {
        self.evaluations.filter(|_| self.vertices > 0).map(|calls| calls as f64 / self.vertices as f64)
    }

    /// What only tetrahedra have, by name of the function's field; `None` of another method.
    pub fn of_tetrahedra(&self, count: fn(&TetrahedraCounts) -> u64) -> Option<u64> {
        self.tetrahedra.as_ref().map(count)
    }
}

/// Quality of a mesh's triangles. Names as in `isostudy_mesh::quality::QualityReport`.
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
    /// Length of the shortest edge, in scene units. Records of before this was measured have none.
    #[serde(default)]
    pub shortest_edge: Option<f64>,
}

/// A mesh against its isosurface. Names as in `isostudy_extract::Accuracy`, whose docs define them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Accuracy {
    /// Distance from points of the mesh to the isosurface, in scene units; over the area.
    pub distance: Distribution,
    /// Distance from points of the isosurface to the mesh. Records of before this was measured have none.
    #[serde(default)]
    pub distance_to_mesh: Option<Distribution>,
    /// Distance from points of the isosurface's sharp edges to the mesh; empty if it has none. Records of before this was measured
    /// have none.
    #[serde(default)]
    pub sharp_edges: Option<Distribution>,
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

impl Accuracy {
    /// The Hausdorff distance, as far as the points tell: the larger of both maxima. `None` if one is not known.
    pub fn hausdorff(&self) -> Option<f64> {
        let there = (self.distance.count > 0).then_some(self.distance.max)?;
        let back = self.distance_to_mesh.as_ref().filter(|back| back.count > 0)?;
        Some(there.max(back.max))
    }
}

impl Distribution {
    /// Root of the mean square.
    pub fn rms(&self) -> f64 {
        self.mean.hypot(self.sd)
    }
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

/// Where counting of intersecting pairs ends.
pub const MOST_INTERSECTIONS: u64 = 1_000_000;

/// Topology of a mesh. Names as in `isostudy_mesh::topology::TopologyReport`, whose docs define them, but for the last.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[expect(missing_docs, reason = "defined where they are counted, in `isostudy_mesh::topology`")]
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
    /// Pairs of triangles that pass through each other, as `isostudy_mesh::self_intersections` counts them: up to
    /// [`MOST_INTERSECTIONS`], which means at least as many. `None` where the search was given up, and in records of before this was
    /// counted.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub self_intersections: Option<u64>,
}

/// What one configuration of a sweep is at one resolution, with positions computed from indices.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SweepMesh {
    /// Which configuration.
    pub id: ConfigurationId,
    /// Cells along the longest axis of the volume.
    pub cells: u32,
    /// Sample points that the lattice needs.
    pub needed_samples: u64,
    /// Vertices of the mesh.
    pub vertices: u64,
    /// Triangles of the mesh.
    pub triangles: u64,
    /// Mean of the normalised radius ratio; 0 of no triangle, as the others.
    pub radius_ratio_mean: f64,
    /// Mean of longest over shortest edge.
    pub edge_ratio_mean: f64,
    /// Mean of the published ratio of two edges.
    pub published_aspect_ratio_mean: f64,
}

/// What a configuration costs where the object's samples are stored: those at the corners of its cubes, the same for all methods. On
/// one thread, from the samples to the mesh; what a program takes to read them is not in it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct StoredTimes {
    /// Which configuration, at the benchmark spacing.
    pub id: ConfigurationId,
    /// Whether the method asks for values or gradients between the samples, which are interpolated in the time measured.
    pub is_between: bool,
    /// Seconds for the whole mesh without its normals, round by round.
    pub whole_s: Vec<f64>,
    /// Chunks that are timed, as in [`ChunkTimes`]; 0 where none are.
    pub timed: u64,
    /// Seconds per extraction of such a chunk, round by round.
    pub chunk_s: Vec<f64>,
    /// Seconds to extract again what each edit touches, as in [`ChunkTimes`].
    pub edit_s: Vec<f64>,
}

/// What a configuration costs chunk by chunk, on one thread, from the field: terrain as a game keeps it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ChunkTimes {
    /// Which configuration, at the benchmark spacing.
    pub id: ConfigurationId,
    /// Cells along a side of a chunk; those at the upper ends of the box may be smaller.
    pub cells: u32,
    /// Chunks that fill the box.
    pub chunks: u64,
    /// Those of all cells that have triangles: theirs are the times.
    pub timed: u64,
    /// Seconds per extraction of such a chunk, round by round.
    pub chunk_s: Vec<f64>,
    /// Chunks that each edit touches.
    pub edit_chunks: Vec<u64>,
    /// Seconds to extract all of them again, edit by edit: the median of a few rounds. Edits are at the same places for all methods.
    pub edit_s: Vec<f64>,
    /// Boundary edges of the chunks welded together, less those of the mesh that is made at once.
    pub open_seam_edges: i64,
    /// Whether the welded chunks are that mesh, to the bit.
    pub is_whole: bool,
}

/// What was asked of the extractor for one configuration: times of different work say nothing of each other.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Workload {
    /// Which configuration.
    pub id: ConfigurationId,
    /// Digest of the field, the box, the spacing, the isovalue and the recipe.
    pub digest: String,
}

/// A benchmark run: every sample, the plan it followed, the machine it ran on.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BenchRun {
    /// Version of this layout; [`BenchRun::SCHEMA`].
    pub schema: u32,
    /// The study's id.
    pub study: String,
    /// What was asked of the extractor, configuration by configuration; empty if it is not known.
    pub workloads: Vec<Workload>,
    /// Where the numbers are from if they were not measured here: each sample is then a mean that somebody published.
    pub imported_from: Option<String>,
    /// Rounds run and thrown away at the start of every invocation.
    pub warmup: u32,
    /// Rounds measured.
    pub iterations: u32,
    /// Rounds measured once more, in invocations of their own between the others: the A/A block.
    pub aa_iterations: u32,
    /// Seed of the order within each round.
    pub seed: u64,
    /// Threads in the sampling stage.
    pub threads: u32,
    /// Threads of the reference work: as many as sampled. Runs of schema 3 had one.
    #[serde(default = "one")]
    pub reference_threads: u32,
    /// The CPUs that the run was pinned to; `None` if it was not.
    pub pinned: Option<Vec<u32>>,
    /// The CPU the numbers are meant for.
    pub target: CpuProfile,
    /// The machine they were measured on.
    pub machine: Machine,
    /// How the two differ; empty when they match.
    pub differences: Vec<ProfileDifference>,
    /// Every measured sample, in the order measured.
    pub samples: Vec<BenchSample>,
    /// Every sample of the A/A block, in the order measured.
    pub aa_samples: Vec<BenchSample>,
    /// What else the machine did meanwhile, in the order observed.
    pub load: Vec<LoadWindow>,
    /// What one extraction of each configuration needs.
    pub memory: Vec<PeakMemory>,
    /// What one extraction of each asks of the allocator.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub allocations: Vec<Allocations>,
    /// Where the run was broken off and taken up again.
    pub resumed: Vec<Resumption>,
    /// Configurations that were left out because they could not be made every time; the lists above have nothing of them.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub failed: Vec<Failure>,
}

impl BenchRun {
    /// The version of the layout that is written here. 2 has the edge collapse as a stage of its own, the A/A block, load,
    /// memory and resumptions; 4 has [`Counters`], and the reference work on as many threads as sampled.
    pub const SCHEMA: u32 = 4;
    /// The versions that are read here. What an older one has not got is `None`.
    pub const READ: RangeInclusive<u32> = 3..=Self::SCHEMA;
}

fn is_zero(seconds: &f64) -> bool {
    *seconds == 0.0
}

/// Of runs from before it was recorded.
fn one() -> u32 {
    1
}

/// One timed extraction. The six stages and finishing add up to the total.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BenchSample {
    /// What was extracted.
    pub id: ConfigurationId,
    /// The process it was measured in: invocations are counted from 0 over measured rounds and A/A block alike.
    #[serde(alias = "sitting")]
    pub invocation: u32,
    /// Round, from 0; of the A/A block counted on its own.
    pub iteration: u32,
    /// Place within the round, from 0.
    pub place: u32,
    /// Seconds to allocate buffers.
    pub allocation_s: f64,
    /// Seconds to sample the field.
    pub sampling_s: f64,
    /// Seconds in the vertex stage, integrated clustering included.
    pub vertex_s: f64,
    /// Seconds in the geometry stage; the published one has `clustering_s` in it.
    pub geometry_s: f64,
    /// Seconds in the edge collapse; 0 without one.
    pub clustering_s: f64,
    /// Seconds to compute vertex normals.
    pub normals_s: f64,
    /// Seconds of the method's finishing steps; 0 where it has none.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub finishing_s: f64,
    /// Their sum.
    pub total_s: f64,
    /// Seconds that a fixed piece of work, the same in every run, took just before: the machine's speed at the time.
    pub reference_s: Option<f64>,
    /// What else was counted meanwhile.
    #[serde(default)]
    pub counters: Counters,
}

impl BenchSample {
    /// Whether its stages were told apart. A program's are not: all it does stands as geometry, and sampling may be ours.
    pub fn has_stages(&self) -> bool {
        self.allocation_s + self.vertex_s + self.clustering_s + self.normals_s > 0.0
    }
}

/// What the measuring process used for one extraction, over all its threads, beside time. `None` is not told: by the system, or
/// of a program that is not ours, which has CPU time alone.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Counters {
    /// Seconds of CPU time. Less than the time times the threads is time in which threads waited. Of a program that is not ours, its own
    /// and that of all that it started, as long as `outside_s`: its reading of samples is in it.
    pub cpu_s: Option<f64>,
    /// Pages that had to be mapped or read.
    pub page_faults: Option<u64>,
    /// How often the thread that extracts gave its CPU away or lost it; not those it starts.
    pub context_switches: Option<u64>,
    /// Instructions retired, outside the kernel.
    pub instructions: Option<u64>,
    /// References that the last cache did not have.
    pub cache_misses: Option<u64>,
    /// Branches that were predicted wrongly.
    pub branch_misses: Option<u64>,
    /// Energy of the whole package, in joules.
    pub energy_j: Option<f64>,
    /// Of a program that is not ours, seconds from the request to its answer by our clock, beside what it says itself: the command's
    /// reading and writing, and the program's reading of samples, are in it.
    #[serde(default)]
    pub outside_s: Option<f64>,
}

/// What others had of the machine during some rounds of an invocation, or before the run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LoadWindow {
    /// Which invocation; `None` before the first.
    #[serde(alias = "sitting")]
    pub invocation: Option<u32>,
    /// First and last round of the window, as in [`BenchSample::iteration`]; `None` before the first invocation.
    pub rounds: Option<(u32, u32)>,
    /// Share of the CPU time that other processes had, 0 to 1, of the CPUs that the run may use.
    pub others: f64,
    /// Share that the hypervisor gave to other machines, 0 to 1.
    pub steal: f64,
    /// One-minute load average at the end.
    pub load_average: Option<f64>,
}

/// The resident memory of a process that extracts one configuration once, in bytes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PeakMemory {
    /// What was extracted.
    pub id: ConfigurationId,
    /// Resident when the field was ready and extraction had not begun.
    pub before_bytes: u64,
    /// The most that had been resident until then; making the field may have taken more than it holds.
    pub peak_before_bytes: u64,
    /// The most that was resident at any time. No more than `peak_before_bytes` says that extraction needed no more.
    pub peak_bytes: u64,
}

impl PeakMemory {
    /// What extraction took beside the field. `None` if making the field had taken more, so that nobody saw it.
    pub fn of_extraction(&self) -> Option<u64> {
        (self.peak_bytes > self.peak_before_bytes).then(|| self.peak_bytes - self.before_bytes)
    }
}

/// What one extraction of a configuration asks of the allocator: counted in extractions of their own, on one thread and not timed.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Allocations {
    /// What was extracted.
    pub id: ConfigurationId,
    /// How often memory was asked for, or a piece of it to become larger or smaller.
    pub calls: StageCounts,
    /// Bytes asked for, those that were given back meanwhile too; of a piece that became larger, by how much.
    pub bytes: StageCounts,
}

/// A count for each stage ([`Stage::count`](crate::Stage::count)), and for the extraction as a whole, which may have some outside of the
/// stages.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[expect(missing_docs, reason = "defined in `Stage`")]
pub struct StageCounts {
    pub allocation: u64,
    pub sampling: u64,
    pub vertex: u64,
    pub geometry: u64,
    pub clustering: u64,
    pub normals: u64,
    pub total: u64,
}

/// A configuration that a run left out.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Failure {
    /// Which one.
    pub id: ConfigurationId,
    /// What its program, or the check of its mesh, said.
    pub reason: String,
}

/// Where a run was taken up again, in a new process and after warm-up.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Resumption {
    /// The invocation that was broken off.
    #[serde(alias = "sitting")]
    pub invocation: u32,
    /// The first round with something left to measure.
    pub iteration: u32,
    /// The first place in it that was left.
    pub place: u32,
}
