//! What an extraction gives: the surface, counts, times, errors.

use std::collections::TryReserveError;
use std::time::Duration;

use isostudy_field::UnreadSamples;
use isostudy_mesh::TriangleMesh;

use crate::lattice::{Arrangement, CellBox, Lattice};
use crate::settings::{Clustering, ExtractSettings, Placement, Positions, Topology};
use crate::surface::normals::vertex_normals;
use crate::surface::triangulation::Triangulation;
use crate::wording::in_words;

/// A surface, what it took and what was seen on the way.
#[derive(Debug, Clone, Default)]
pub struct Extraction {
    /// The surface, with normals.
    pub mesh: TriangleMesh,
    /// How much of everything.
    pub counts: Counts,
    /// How long each stage took.
    pub times: StageTimes,
}

impl Extraction {
    /// Empties it; its vectors keep their room.
    pub(crate) fn clear(&mut self) {
        let TriangleMesh { positions, normals, triangles } = &mut self.mesh;
        positions.clear();
        normals.clear();
        triangles.clear();
        (self.counts, self.times) = Default::default();
    }

    /// Counts the mesh and gives it normals, where its triangles were made anew.
    ///
    /// # Errors
    /// [`ExtractError::NoMemoryForMesh`].
    pub(crate) fn renew(&mut self) -> Result<(), ExtractError> {
        let TriangleMesh { positions, normals, triangles } = &mut self.mesh;
        *normals = vertex_normals(positions, triangles).map_err(|_| ExtractError::NoMemoryForMesh)?;
        self.count();
        Ok(())
    }

    /// Counts the mesh, where its triangles were made anew.
    pub(crate) fn count(&mut self) {
        let counts = &mut self.counts;
        (counts.vertices, counts.triangles) =
            (self.mesh.positions.len() as u64, self.mesh.triangles.len() as u64);
        (counts.vertex_bytes, counts.index_bytes) = (24 * counts.vertices, 12 * counts.triangles);
    }
}

/// Wall-clock time of each stage. The stages follow each other without a gap.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct StageTimes {
    /// Reserving what is held of the lattice. Memory is handed out zeroed by the operating system, page by page on
    /// first touch, so part of its cost falls on the later stages.
    pub allocation: Duration,
    /// Finding the sides of all points and the values at crossings; with accumulated positions, evaluating the field at
    /// every stored point. With starting threads.
    pub sampling: Duration,
    /// Finding and placing vertices; integrated clustering is part of finding them.
    pub vertex: Duration,
    /// Making triangles, and moving vertices to where the settings want them.
    pub geometry: Duration,
    /// The edge collapse; zero where none is asked for. The published geometry stage is this and `geometry`.
    pub clustering: Duration,
    /// Making vertex normals.
    pub normals: Duration,
}

impl StageTimes {
    /// The sum of all stages. The published total leaves the normals out.
    pub fn total(&self) -> Duration {
        self.allocation + self.sampling + self.vertex + self.geometry + self.clustering + self.normals
    }
}

/// How much of everything an extraction had, whatever the method.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Counts {
    /// Sample points that belong to a cell, taken or not.
    pub samples: u64,
    /// Cells of the grid: the cubes, whatever they are cut into.
    pub cells: u64,
    /// Cells that the surface may meet, in which triangles are looked for.
    pub cells_visited: u64,
    /// Edges between sample points whose ends are on different sides.
    pub crossings: u64,
    /// Vertices of the mesh.
    pub vertices: u64,
    /// Triangles of the mesh.
    pub triangles: u64,
    /// Triangles that clustering took away: with `triangles`, those of the unclustered mesh.
    pub discarded_triangles: u64,
    /// Bytes of the vertices: 24 each, a position and a normal.
    pub vertex_bytes: u64,
    /// Bytes of the vertex indices: 12 a triangle.
    pub index_bytes: u64,
    /// What only marching tetrahedra have; `None` with any other method.
    pub tetrahedra: Option<TetrahedraCounts>,
}

/// How much of everything else marching tetrahedra had. Their [`Counts::samples`] are [`Lattice::needed_samples`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct TetrahedraCounts {
    /// [`Lattice::stored_samples`].
    pub stored_samples: u64,
    /// [`Lattice::stored_edges`].
    pub stored_edges: u64,
    /// [`Lattice::needed_edges`].
    pub needed_edges: u64,
    /// [`Lattice::tetrahedra`].
    pub tetrahedra: u64,
    /// Tetrahedra of all cells that the surface may meet: body-centred, where one of the centre's fourteen edges
    /// crosses; simple cubic, where the cube's corners are not all on one side.
    pub tetrahedra_evaluated: u64,
    /// [`Counts::discarded_triangles`] with the original's over-count, for comparison with the published column only: under
    /// integrated clustering a tetrahedron with one triangle can count two.
    pub discarded_as_published: u64,
    /// Bytes of the samples where all are stored: 4 each.
    pub sample_bytes: u64,
    /// Bytes of the edge records where all are stored: 58 a sample point, fourteen 4-byte vertex numbers and fourteen flags.
    pub edge_bytes: u64,
}

/// Why a surface cannot be extracted.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum ExtractError {
    /// The isovalue is infinite or not a number.
    Isovalue {
        /// What was given.
        value: f32,
    },
    /// No lattice over the grid.
    Grid(crate::lattice::LatticeError),
    /// [`Positions::Accumulated`] with no chunk at all.
    NoChunks,
    /// The lattice does not fit into memory.
    OutOfMemory {
        /// [`Lattice::memory_bytes_for`] the settings.
        bytes: u64,
    },
    /// The mesh outgrew the memory that is left.
    NoMemoryForMesh,
    /// Samples that are not as many as the lattice stores.
    SampleCount {
        /// What was given.
        given: u64,
        /// [`Lattice::stored_samples`].
        wanted: u64,
    },
    /// Bricks of samples that are not those of the lattice's points.
    BrickCounts {
        /// Samples along each axis.
        given: [usize; 3],
        /// Stored points along each axis.
        wanted: [usize; 3],
    },
    /// Stored samples that are not those of the lattice's points.
    StoredCounts {
        /// Samples along each axis.
        given: [usize; 3],
        /// Stored points along each axis.
        wanted: [usize; 3],
    },
    /// Stored samples that cannot be read.
    Unread(UnreadSamples),
    /// The samples of a box that is not the lattice.
    Window {
        /// What was given.
        given: CellBox,
        /// All cells of the lattice.
        wanted: CellBox,
    },
    /// Integrated clustering where points differ in their lattice edges, or a warp elsewhere than on the body-centred lattice
    /// ([`Arrangement::supports`]).
    ArrangementClustering {
        /// What was given.
        arrangement: Arrangement,
        /// What was given.
        clustering: Clustering,
    },
    /// [`Positions::Accumulated`] where no original program is repeated.
    ArrangementAccumulated {
        /// What was given.
        arrangement: Arrangement,
    },
    /// [`ExtractSettings::edge_clamp`] out of its range.
    EdgeClamp {
        /// What was given.
        edge_clamp: f32,
    },
    /// [`Clustering::Warp`] with a setting that says what it does not know.
    Warp {
        /// What it does not go with.
        with: &'static str,
    },
    /// Given samples and [`Positions::Accumulated`], which says where a field is sampled.
    SamplesAccumulated,
    /// Given samples, and settings that call the field.
    PlacementNeedsField {
        /// What was asked for.
        placement: Placement,
        /// What was asked for.
        refine_crossings: bool,
    },
    /// [`Control::cancel`](crate::Control) was set. What extracts can be used again.
    Cancelled,
    /// The sampling threads could not be started.
    Threads {
        /// How many.
        threads: usize,
        /// What the thread pool says.
        reason: String,
    },
    /// More vertices than a 32-bit index can name.
    TooManyVertices {
        /// The most there may be.
        limit: u32,
    },
}

in_words! {
    ExtractError {
        Self::Isovalue { value } => "isovalue must be finite, not {value}";
        Self::Grid(error) => "{error}";
        Self::NoChunks => "accumulated positions need at least one chunk of layers";
        Self::OutOfMemory { bytes } => "no memory for the {bytes} bytes of the lattice";
        Self::NoMemoryForMesh => "no memory for a mesh this large";
        Self::SampleCount { given, wanted } => "{given} samples for a lattice of {wanted}";
        Self::BrickCounts { given, wanted } => "bricks of {given:?} samples for a lattice of {wanted:?}";
        Self::StoredCounts { given, wanted } => "{given:?} samples for a lattice of {wanted:?}";
        Self::Unread(why) => "{why}";
        Self::Window { given, wanted } => "samples of the cells {given:?} for a lattice of {wanted:?}";
        Self::ArrangementClustering { arrangement, clustering } =>
            "{clustering} clustering does not go with {arrangement}: none and edge-collapse do, integrated \
             and integrated-collapse go with body-centred and simple-cubic, and warp with body-centred";
        Self::ArrangementAccumulated { arrangement } =>
            "{arrangement} has indexed positions only: accumulated ones go with body-centred and simple-cubic";
        Self::EdgeClamp { edge_clamp } =>
            "edge_clamp = {edge_clamp:?}: must be 0 or more and below 0.5, in lengths of a lattice edge";
        Self::Warp { with } =>
            "warp clustering does not go with {with}: it has guarded topology, indexed positions, crossings \
             where they are interpolated, and any placement but curvature-weighted";
        Self::SamplesAccumulated => "given samples have no accumulated positions";
        Self::PlacementNeedsField { placement, refine_crossings } =>
            "given samples say nothing between them: {placement:?}{} needs the field",
            if *refine_crossings { " with refined crossings" } else { "" };
        Self::Cancelled => "the extraction was cancelled";
        Self::Threads { threads, reason } => "cannot start {threads} sampling threads: {reason}";
        Self::TooManyVertices { limit } => "the surface has more than {limit} vertices";
    }
    from { crate::lattice::LatticeError => Self::Grid }
}

/// What memory is asked for beyond that of the lattice is the mesh's.
impl From<TryReserveError> for ExtractError {
    fn from(_: TryReserveError) -> Self {
        Self::NoMemoryForMesh
    }
}

pub(crate) fn check(settings: &ExtractSettings, arrangement: Arrangement) -> Result<(), ExtractError> {
    if !settings.isovalue.is_finite() {
        return Err(ExtractError::Isovalue { value: settings.isovalue });
    }
    let edge_clamp = settings.edge_clamp;
    if !(0.0..0.5).contains(&edge_clamp) {
        return Err(ExtractError::EdgeClamp { edge_clamp });
    }
    match settings.positions {
        Positions::Accumulated { chunks: 0 } => return Err(ExtractError::NoChunks),
        Positions::Accumulated { .. } if arrangement.uniform().is_none() => {
            return Err(ExtractError::ArrangementAccumulated { arrangement });
        }
        _ => {}
    }
    if !arrangement.supports(settings.clustering) {
        return Err(ExtractError::ArrangementClustering { arrangement, clustering: settings.clustering });
    }
    if settings.clustering == Clustering::Warp {
        let refused = [
            (settings.topology != Topology::Guarded, "published topology"),
            (settings.positions != Positions::Indexed, "accumulated positions"),
            (settings.placement == Placement::CurvatureWeighted, "curvature-weighted placement"),
            (settings.refine_crossings, "refined crossings"),
            (settings.edge_clamp > 0.0, "an edge_clamp"),
        ];
        if let Some(&(_, with)) = refused.iter().find(|(is_given, _)| *is_given) {
            return Err(ExtractError::Warp { with });
        }
    }
    Ok(())
}

impl Counts {
    /// What is known of a lattice and the surface in it.
    pub(crate) fn of(
        lattice: &Lattice,
        mesh: &TriangleMesh,
        surface: &Triangulation,
        crossings: u64,
    ) -> Self {
        let (vertices, triangles) = (mesh.positions.len() as u64, mesh.triangles.len() as u64);
        let tetrahedra = TetrahedraCounts {
            stored_samples: lattice.stored_samples(),
            stored_edges: lattice.stored_edges(),
            needed_edges: lattice.needed_edges(),
            tetrahedra: lattice.tetrahedra(),
            tetrahedra_evaluated: surface.tetrahedra_evaluated,
            discarded_as_published: surface.discarded_as_published,
            sample_bytes: lattice.sample_bytes(),
            edge_bytes: lattice.edge_bytes(),
        };
        Self {
            samples: lattice.needed_samples(),
            cells: lattice.cells().iter().map(|&n| u64::from(n)).product(),
            cells_visited: surface.cells_visited,
            crossings,
            vertices,
            triangles,
            discarded_triangles: surface.discarded,
            vertex_bytes: 24 * vertices,
            index_bytes: 12 * triangles,
            tetrahedra: Some(tetrahedra),
        }
    }
}
