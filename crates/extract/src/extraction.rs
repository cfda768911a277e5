//! The stages in order, timed and counted.

use std::time::{Duration, Instant};

use mesh::TriangleMesh;

use crate::collapse;
use crate::edges::EdgeTable;
use crate::field::ScalarField;
use crate::lattice::{Coordinates, Lattice, Layout};
use crate::normals::vertex_normals;
use crate::sampling::sample;
use crate::settings::{Clustering, Execution, ExtractSettings, Positions, Topology};
use crate::triangles::triangulate;
use crate::vertices::{Sides, place_vertices};

/// A surface, what it took and what was seen on the way.
#[derive(Debug, Clone)]
pub struct Extraction {
    /// The surface, with normals.
    pub mesh: TriangleMesh,
    /// How much of everything.
    pub counts: Counts,
    /// How long each stage took.
    pub times: StageTimes,
}

/// Wall-clock time of each stage. The stages follow each other without a gap.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct StageTimes {
    /// Reserving samples and edge records. Memory is handed out zeroed by the operating system, page by page on
    /// first touch, so part of its cost falls on the later stages.
    pub allocation: Duration,
    /// Evaluating the field at every stored point, with starting threads.
    pub sampling: Duration,
    /// Finding, clustering and placing vertices.
    pub vertex: Duration,
    /// Making triangles, and the edge collapse if asked for.
    pub geometry: Duration,
    /// Making vertex normals.
    pub normals: Duration,
}

impl StageTimes {
    /// The sum of all stages. The published total leaves the normals out.
    pub fn total(&self) -> Duration {
        self.allocation + self.sampling + self.vertex + self.geometry + self.normals
    }
}

/// How much of everything an extraction had.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Counts {
    /// [`Lattice::stored_samples`].
    pub stored_samples: u64,
    /// [`Lattice::needed_samples`].
    pub needed_samples: u64,
    /// [`Lattice::stored_edges`].
    pub stored_edges: u64,
    /// [`Lattice::needed_edges`].
    pub needed_edges: u64,
    /// [`Lattice::tetrahedra`].
    pub tetrahedra: u64,
    /// Tetrahedra of all cells that the surface may meet: body-centred, where one of the centre's fourteen edges
    /// crosses; simple cubic, where the cube's corners are not all on one side.
    pub tetrahedra_evaluated: u64,
    /// Lattice edges whose ends are on different sides.
    pub crossings: u64,
    /// Vertices of the mesh.
    pub vertices: u64,
    /// Triangles of the mesh.
    pub triangles: u64,
    /// Triangles that clustering took away: with `triangles`, those of the unclustered mesh.
    pub discarded_triangles: u64,
    /// The same with the original's over-count, for comparison with the published column only: under integrated
    /// clustering a tetrahedron with one triangle can count two.
    pub discarded_as_published: u64,
    /// Bytes of the stored samples: 4 each.
    pub sample_bytes: u64,
    /// Bytes of the stored edge records: 58 a sample point, fourteen 4-byte vertex numbers and fourteen flags.
    pub edge_bytes: u64,
    /// Bytes of the vertices: 24 each, a position and a normal.
    pub vertex_bytes: u64,
    /// Bytes of the vertex indices: 12 a triangle.
    pub index_bytes: u64,
}

/// Why a surface cannot be extracted.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ExtractError {
    /// The isovalue is infinite or not a number.
    #[error("isovalue must be finite, not {value}")]
    Isovalue {
        /// What was given.
        value: f32,
    },
    /// [`Positions::Accumulated`] with no chunk at all.
    #[error("accumulated positions need at least one chunk of layers")]
    NoChunks,
    /// The lattice does not fit into memory.
    #[error("no memory for the {bytes} bytes of the lattice")]
    OutOfMemory {
        /// [`Lattice::memory_bytes`].
        bytes: u64,
    },
    /// The sampling threads could not be started.
    #[error("cannot start {threads} sampling threads: {reason}")]
    Threads {
        /// How many.
        threads: usize,
        /// What the thread pool says.
        reason: String,
    },
    /// More vertices than a 32-bit index can name.
    #[error("the surface has more than {limit} vertices")]
    TooManyVertices {
        /// The most there may be.
        limit: u32,
    },
}

/// Extracts the surface where `field` has the isovalue.
///
/// The mesh depends on the field, the lattice and the settings, never on `execution`, to the byte. See the crate's
/// front page for what it is and what it is not.
///
/// # Errors
/// [`ExtractError`] if the settings are not valid, memory or threads are not to be had, or there are too many
/// vertices.
pub fn extract(
    field: &dyn ScalarField,
    lattice: &Lattice,
    settings: &ExtractSettings,
    execution: &Execution,
) -> Result<Extraction, ExtractError> {
    check(settings)?;
    let mut clock = Clock::start();

    let layout = Layout::new(lattice);
    reserve(lattice)?;
    let mut samples = vec![0.0; layout.len()];
    let mut sides = Sides::new(&layout);
    let mut edges = EdgeTable::new(layout.len());
    let allocation = clock.lap();

    let coordinates = Coordinates::sampled(lattice, &layout, settings.positions);
    sample(field, &layout, &coordinates, execution, &mut samples)?;
    let sampling = clock.lap();

    let (mut positions, crossings) =
        place_vertices(lattice, &layout, &samples, settings, &mut sides, &mut edges)?;
    let vertex = clock.lap();

    let mut surface = triangulate(lattice, &layout, &sides, &edges);
    if matches!(settings.clustering, Clustering::EdgeCollapse | Clustering::IntegratedCollapse) {
        let before = surface.triangles.len();
        let collapse = match settings.topology {
            Topology::Guarded => collapse::guarded,
            Topology::Published => collapse::published,
        };
        (positions, surface.triangles) = collapse(positions, &surface.triangles, lattice.spacing());
        let dropped = (before - surface.triangles.len()) as u64;
        surface.discarded += dropped;
        surface.discarded_as_published += dropped;
    }
    let geometry = clock.lap();

    let normals = vertex_normals(&positions, &surface.triangles);
    let times = StageTimes { allocation, sampling, vertex, geometry, normals: clock.lap() };

    let (vertices, triangles) = (positions.len() as u64, surface.triangles.len() as u64);
    let counts = Counts {
        stored_samples: lattice.stored_samples(),
        needed_samples: lattice.needed_samples(),
        stored_edges: lattice.stored_edges(),
        needed_edges: lattice.needed_edges(),
        tetrahedra: lattice.tetrahedra(),
        tetrahedra_evaluated: surface.tetrahedra_evaluated,
        crossings,
        vertices,
        triangles,
        discarded_triangles: surface.discarded,
        discarded_as_published: surface.discarded_as_published,
        sample_bytes: lattice.sample_bytes(),
        edge_bytes: lattice.edge_bytes(),
        vertex_bytes: 24 * vertices,
        index_bytes: 12 * triangles,
    };
    Ok(Extraction { mesh: TriangleMesh { positions, normals, triangles: surface.triangles }, counts, times })
}

fn check(settings: &ExtractSettings) -> Result<(), ExtractError> {
    if !settings.isovalue.is_finite() {
        return Err(ExtractError::Isovalue { value: settings.isovalue });
    }
    match settings.positions {
        Positions::Accumulated { chunks: 0 } => Err(ExtractError::NoChunks),
        _ => Ok(()),
    }
}

/// Asks for the memory once and gives it back, so that a lattice beyond the machine is an error and not an abort.
/// Filling a vector that reserved fallibly would write all of it; zeroed memory is not written before it is used.
fn reserve(lattice: &Lattice) -> Result<(), ExtractError> {
    let bytes = lattice.memory_bytes();
    let error = ExtractError::OutOfMemory { bytes };
    let length = usize::try_from(bytes).map_err(|_| error.clone())?;
    Vec::<u8>::new().try_reserve_exact(length).map_err(|_| error)
}

/// Laps without a gap.
struct Clock {
    last: Instant,
}

impl Clock {
    fn start() -> Self {
        Self { last: Instant::now() }
    }

    fn lap(&mut self) -> Duration {
        let now = Instant::now();
        now - std::mem::replace(&mut self.last, now)
    }
}
