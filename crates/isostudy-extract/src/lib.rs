//! Isosurfaces from scalar fields, by one of the families of methods:
//!
//! | family | settings | what it does |
//! |---|---|---|
//! | marching tetrahedra | [`Tetrahedra`] | a triangle or two in each tetrahedron of a lattice; vertices merged or not ([`Clustering`]) |
//! | marching cubes | [`Cubes`] | a polygon for each loop of surface round a cube |
//! | snapped cubes | [`SnapCubes`] | the same, with crossings drawn to lattice points: no thin triangles |
//! | Macet | [`Macet`] | the same, with vertices moved to where edges stand square on the surface |
//! | cubical marching squares | [`CubicalMarchingSquares`] | the same, with vertices on creases: sharp edges, and no intersections |
//! | surface nets | [`SurfaceNets`] | the dual: a vertex in each cube, a quadrilateral round each crossed edge |
//! | blocks | [`Blocky`] | the same connections, with vertices half way between samples: squares, or rectangles |
//! | dual contouring | [`DualContouring`] | the same, with vertices where tangent planes meet: sharp edges |
//! | continuation | [`Continuation`] | cubes or tetrahedra, from cube to cube, beginning at seeds |
//! | labels | [`LabelVolume`] | surface nets between the regions of a volume of whole numbers |
//! | levels | [`LevelExtractor`] | chunks of several levels of detail, of cubes, nets or dual contouring |
//!
//! A [`Method`] is a family with its settings, as plain data; [`presets`] have names. It takes a field or samples on a [`BoxGrid`]:
//!
//! ```
//! use isostudy_extract::{Arrangement, BoxGrid, Execution, Extractor, Method, Source, Tetrahedra};
//! use isostudy_extract::{Bounds, Sphere, glam::Vec3};
//!
//! let method = Method::Tetrahedra(Tetrahedra::new(Arrangement::BodyCentred));
//! let grid = BoxGrid { bounds: Bounds { min: Vec3::splat(-1.1), max: Vec3::splat(1.1) }, spacing: 0.1 };
//! let (sphere, isovalue) = (Sphere { radius: 1.0 }, 0.0);
//! let (mut extractor, execution) = (Extractor::new(), Execution::default());
//! let extraction = method.extract(&mut extractor, Source::Study(&sphere), &grid, isovalue, &execution)?;
//! assert_eq!(extraction.counts.vertices * 2, extraction.counts.triangles + 4, "genus 0");
//! assert!((extraction.mesh.volume() - 4.18879).abs() < 0.03);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Tetrahedra can also be had of a [`Lattice`](by_lattice::Lattice) of one's own: see [`by_lattice`].
//!
//! # Guaranteed
//!
//! - Inside is a value above the isovalue. A value equal to it is outside, and so is `NaN`.
//! - Triangles are counter-clockwise seen from outside and have three different vertices; normals point outward.
//! - The same field, lattice and settings give the same mesh to the byte, on any number of threads. The fields of [`isostudy_field`]
//!   use no platform mathematics, so the mesh is also the same on every machine.
//! - Vertices lie in the lattice's box. With [`Topology::Guarded`] and [`Positions::Indexed`], the defaults, so do all
//!   sample points, and the tetrahedra fill the box and nothing else: outermost points lie on its faces, and where the
//!   spacing does not divide the box, the last cubes along an axis are thinner. So a surface ends at the box as it would
//!   end at any cut, and a sheet that crosses the box is one component there too.
//! - The triangles do not depend on where vertices are placed ([`Placement`], [`ExtractSettings::refine_crossings`](by_lattice::ExtractSettings::refine_crossings)),
//!   unless edges are collapsed; and beside the mean of interpolated crossings none is turned over.
//! - With [`Topology::Guarded`], the default, and any [`Clustering`]: whatever the samples, the mesh is an oriented
//!   2-manifold that uses all its vertices, closed where the surface stays clear of the box. No two triangles have
//!   the same vertices. Components, genus and boundary loops are those of the unclustered surface. Why: docs/manifold.md.
//! - With the same topology no unclustered triangle is without area, also at samples that equal the isovalue, and no edge
//!   is collapsed where one would lose its area. A sample that equals the isovalue lies below it by less than any number:
//!   a vertex that has its place to itself stays there; where there are several, each goes a few units in the last place
//!   of `f32` along its lattice edge, towards the inside. How far is known from the lattice and the edge alone.
//! - Unless edges are collapsed, vertices stand in storage order of the sample points they are nearest to (x fastest,
//!   then y, then z), triangles in that of their cells. Leaving samples out changes nothing, as long as a field keeps
//!   what it promises.
//! - Any boxes of cells that fill the lattice, extracted one by one, [weld](weld_chunks) to the mesh of the whole, to the byte
//!   ([`ChunkExtractor`]), on every arrangement and with every clustering and topology, projected and relaxed too; unless
//!   vertices keep each other from moving over 64 passes, which no samples did yet. A [`Grid`] without an end has the same
//!   chunks wherever one begins.
//! - A field that panics, or a [`Control::cancel`], leaves an extractor as good as new.
//! - No input panics; what cannot be done is an error. In debug builds a [`ScalarField`] that breaks a promise does.
//!
//! # Not guaranteed
//!
//! - Anything of that kind with [`Topology::Published`]: integrated clustering keeps well-resolved surfaces manifold
//!   and breaks others, the edge collapse leaves folded pairs of triangles nearly always.
//! - A surface that reaches the box is open there, unless the field ends at walls ([`Walled`](isostudy_field::Walled)). A vertex at the boundary is
//!   the mean of its crossings, and may lie a little inside.
//! - As published, points lie up to a cube beyond the box: what the surface does there is flattened onto the box, and
//!   may be scraps of their own. A sample equal to the isovalue puts all its crossings in one place, as vertices of
//!   their own: triangles without area. A crossing in the very middle of an edge has a vertex at each end, of which one
//!   is used; guarded, it belongs to the inside end.
//! - Means of crossings can lie in a line, so that a triangle between clusters has no area: of 40,000 volumes of noise with
//!   few levels one had one such triangle; scans of whole numbers had none.
//! - Triangles may intersect, but where [`Promises::no_intersections`] says that none do. A feature thinner than the spacing can be missed.
//!
//! # Where to start
//!
//! | to have | take |
//! |---|---|
//! | a mesh | a [`Method`]: written down, read from a file (feature `serde`), or one of the [`presets`] |
//! | meshes, one after the other | the same [`Extractor`], which keeps its buffers |
//! | the samples' own topology | [`Cubes`] with [`Faces::Trilinear`], preset `mc33` |
//! | counts to compare with other programs | [`VolumeCells`], preset `mc` |
//! | as few calls of a slow field as can be, of a surface whose parts are known | [`Continuation`] |
//! | the cells of one isovalue after another | [`active`] |
//! | no thin triangles, bounded angles | [`SnapCubes`], preset `snapmc` |
//! | terrain, for a game | a [`Grid`], a [`ChunkExtractor`] and [`Grid::touched`]: see [`engine`]; `examples/endless.rs` walks through one |
//! | the same with coarse chunks far away | a [`LevelExtractor`]; `examples/lod.rs` |
//! | regular triangles | [`Arrangement::BodyCentred`], [`Clustering::Integrated`], [`Placement::Relaxed`] |
//! | few samples | [`Arrangement::SimpleCubic`], [`Clustering::Integrated`] |
//! | a lattice of one's own, its samples and its memory | [`by_lattice`] |
//! | published numbers | [`Topology::Published`], [`Positions::Accumulated`] |
//! | how near the mesh is to the surface | [`accuracy`] |
//!
//! # Chunks
//!
//! A cell belongs to one [`Chunk`], and with it the triangles in its tetrahedra. Every vertex has a [`VertexKey`], the
//! same in all chunks that have it, so that seams weld without comparing coordinates; its position and its normal are
//! those of the whole, so that a seam does not show even where chunks are drawn side by side. A chunk looks at samples up
//! to three cells beyond its own, and farther where vertices are moved or smoothed ([`ChunkExtractor::window`]); what they decide is all that can change its triangles, and
//! [`Chunk::is_touched_by`] says of an edit whether it reaches them. With edge collapse the way is farther: see [`ChunkExtractor`].
//!
//! # Levels of detail
//!
//! A [`LevelExtractor`] makes chunks of several levels, each with cubes twice as large as the one before. Where chunks differ by one
//! level, coarse cells of marching cubes take what the finer ones have on their sides. Nets and dual contouring with one vertex per
//! cell have polygons round minimal edges. All of them weld to a closed mesh, whatever the samples. A chunk needs the levels of its [`Neighbours`] alone.
//!
//! # Three ways
//!
//! With [`Positions::Indexed`] the lattice is streamed: a few layers in memory, then the mesh; slabs of layers on
//! several threads; samples taken only where the field does not rule the surface out ([`StudyField::slope`]), or
//! given ([`Source::Samples`]), or read layer by layer ([`Source::Stored`]). An [`Extractor`] keeps its buffers from one volume to the next. With
//! [`Positions::Accumulated`], for comparison with the published evaluation, all samples and edges are stored. The
//! arrangements that are cut cube by cube are streamed by an extractor of their own.
//!
//! # Marching cubes
//!
//! [`Cubes`] is a [`Method`] whose cells are not cut any further. What is guaranteed above with [`Topology::Guarded`] holds for it,
//! with every choice of [`Faces`] and [`Diagonals`]. Its tables are made at first use by the rules of [`isostudy_cells`].
//!
//! - With [`Faces::Trilinear`] the mesh has the components, tunnels and boundary loops of the trilinear interpolant of the samples,
//!   at a level above the isovalue by less than any number: samples, saddles of faces and saddles of cells that equal it are
//!   outside. The crate `trilinear` counts the same without a mesh; 100,000 random grids agree (`tests/it/cubes_trilinear.rs`).
//!   Where distances from the isovalue differ by a factor of 1e8 and more, a tunnel may be missed (docs/cubes.md).
//! - A vertex is a crossing, but for a few in cells whose polygons have all diagonals in faces, or whose tube has a rung there.
//!   Vertices stand in storage order of the lower ends of their edges, then of the axes.
//! - [`SnapCubes`] draws crossings to nearby samples, so that angles are bounded; its mesh is closed off the box, and a manifold only
//!   where sheets of the surface keep a cell apart. [`Macet`] keeps the table's triangles and moves their vertices, and calls the
//!   field to do so. It makes no chunks.
//! - [`VolumeCells`] takes a volume's own cells, turned, mirrored, sheared and of unequal steps as they may be. At
//!   `isovalue.next_down()` vertices and triangles are as many as VTK's Flying Edges makes at `isovalue`, which has equal samples
//!   inside (`tests/it/cubes_vtk.rs`).
//!
//! # Odd input
//!
//! | input | what comes of it |
//! |---|---|
//! | isovalue infinite or `NaN` | [`ExtractError::Isovalue`] |
//! | isovalue that no sample passes, surface between the samples | a mesh without vertices |
//! | surface through the box | a mesh that is open there, and only there; closed with [`Walled`](isostudy_field::Walled) |
//! | spacing zero, negative, infinite, `NaN` | [`LatticeError::Spacing`] |
//! | spacing too small, too large for `f32` | [`LatticeError::TooManyCells`], [`LatticeError::TooManySamples`], [`LatticeError::OutOfRange`] |
//! | spacing beyond the box | one cell; as published it reaches past the box |
//! | box empty, inverted, infinite, `NaN` | [`LatticeError::Bounds`] |
//! | samples of another number than the lattice has | [`ExtractError::SampleCount`], [`ExtractError::StoredCounts`] |
//! | stored samples that cannot be read | [`ExtractError::Unread`] |
//! | chunks of two grids, methods or isovalues, welded | [`WeldError::Worlds`] |
//! | a clustering that the arrangement does not have | [`ExtractError::ArrangementClustering`] |
//! | accumulated positions on one that the original did not have | [`ExtractError::ArrangementAccumulated`] |
//! | a chunk beyond the lattice, or without a cell | [`ChunkError::Cells`] |
//! | chunks with refined crossings, weights by curvature, or moves after edge collapse | [`ChunkError::Placement`] |
//! | chunks of different fields, or one twice | [`WeldError::Mismatch`], [`WeldError::Overlap`] |
//! | chunks with relative positions, welded | [`WeldError::Relative`] |
//! | levels of neighbours that differ by more than one | [`LevelError::Step`] |
//! | memory that is not there | [`ExtractError::OutOfMemory`], [`ExtractError::NoMemoryForMesh`] |
//! | more than 2^32 - 1 vertices | [`ExtractError::TooManyVertices`] |
//!
//! What grows with the lattice or with the mesh is asked for. Not asked for, so that without it the process ends, are
//! tables of one size (under 1 MiB, and up to 8 MiB for an `Asteroid` of `isostudy_field`), what the threads need to start and to share
//! work, what a `MeshDistance` of it holds of its mesh, and, with accumulated positions, the pages of the lattice, which was
//! asked for as a whole before. Systems that promise more memory than they have can still end the process.
//!
//! A sample that is `NaN` is outside and leaves the crossings round it to the inside end, in the middle of their
//! edges; so are two infinities. One infinity puts the crossing on the other end.
//!
//! # Sources
//!
//! - G. M. Treece, R. W. Prager, A. H. Gee: Regularised marching tetrahedra: improved iso-surface extraction.
//!   Computers & Graphics 23 (1999). The clustering.
//! - W. E. Lorensen, H. E. Cline: Marching cubes. SIGGRAPH (1987). G. M. Nielson, B. Hamann: The asymptotic decider. IEEE
//!   Visualization (1991). E. V. Chernyaev: Marching cubes 33. CERN CN 95-17 (1995). The cases of cubes; how they are decided here
//!   is derived in `cubes/tunnel.rs`.
//! - E. Lengyel: Voxel-based terrain for real-time virtual simulations. PhD thesis, UC Davis (2010). Transition cells, and how
//!   vertices stand back from them; their patterns are derived here.
//! - T. Ju, F. Losasso, S. Schaefer, J. Warren: Dual contouring of Hermite data. ACM TOG 21 (2002). Minimal edges.
//! - S. L. Chan, E. O. Purisima: A new tetrahedral tesselation scheme for isosurface generation. Computers & Graphics
//!   22 (1998). The body-centred tetrahedra. The mirrored five and the face-centred 24 stand beside them in the
//!   literature; which 24 are meant here, and why, is with [`Arrangement::FaceCentred`].
//! - T. K. Dey, H. Edelsbrunner, S. Guha, D. V. Nekhayev: Topology preserving edge contraction. Publications de l'Institut
//!   Mathématique 66 (1999). The link condition of the guarded collapse.
//! - Costen: dissertation and program (2026). The evaluation this repeats: rules, fields, sizes and
//!   the numbers that the tests compare with.

// Passes that families share are in every build, whichever families it has: what none of them takes is left out by the linker.
#![cfg_attr(
    not(all(feature = "all-families", feature = "dual-contouring-clean")),
    allow(dead_code, unreachable_patterns, unused_imports, unused_variables)
)]

// The fields, the survey and the bunny of the integration tests, for the tests that need to see inside.
#[cfg(test)]
extern crate self as isostudy_extract;
#[cfg(test)]
#[path = "../tests/it/bunny.rs"]
mod bunny;
#[cfg(test)]
#[path = "../tests/it/fields.rs"]
mod fields;
#[cfg(test)]
#[path = "../tests/it/survey.rs"]
mod survey;

// The code of pages that the documentation does not show.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
mod readme {}
#[cfg(doctest)]
#[doc = include_str!("../docs/versions.md")]
mod versions {}

/// The extractor in a game: from a field to terrain that is dug, and what each call costs.
///
/// Its links lead to pages in the folder `docs` of the crate.
#[doc = include_str!("../docs/engine.md")]
pub mod engine {}

pub mod active;
mod builders;
pub mod by_lattice;
mod chunks;
mod clock;
mod clustering;
mod cubes;
mod duals;
mod execution;
mod extraction;
mod extractor;
mod lattice;
mod levels;
// It looks for the isosurface by tetrahedra.
#[cfg(feature = "tetrahedra")]
mod measure;
mod memory;
mod method;
mod placement;
mod sampling;
mod settings;
mod slabs;
mod source;
mod surface;
mod tetrahedra;
mod wording;

pub use chunks::{
    Chunk, ChunkError, ChunkExtractor, ChunkSettings, LabelChunk, Mismatch, Normals, SampleLayout,
    TooManyVertices, WeldError, World, weld_chunks, weld_label_chunks,
};
#[cfg(feature = "stage-clock")]
pub use clock::set_stage_clock;
pub use cubes::{ContinuedCells, Diagonals, Faces, Flat, Seeds, SeedsError};
pub use duals::{LabelCount, LabelError, LabelSettings, LabelSurface, LabelVolume};
pub use execution::{Control, Jobs, Threads};
pub use extraction::{Counts, ExtractError, Extraction, StageTimes, TetrahedraCounts};
pub use extractor::Extractor;
pub use glam;
pub use isostudy_cells as cells;
pub use isostudy_field::{
    self as field, Aabb, Bound, FieldFault, FromFn, ScalarField, Sphere, StoredSamples, StudyField,
    UnreadSamples, check_field, from_fn,
};
pub use isostudy_mesh::{self as mesh, Bounds, TriangleMesh};
pub use lattice::{Arrangement, BoxGrid, CellBox, Grid, GridError, LatticeError};
pub use levels::{LevelError, LevelExtractor, LevelWindow, Neighbours};
#[cfg(feature = "tetrahedra")]
pub use measure::{
    Accuracy, DistanceError, IsosurfacePoints, accuracy, accuracy_beside, distances, normal_errors_deg,
    triangle_distances,
};
pub use memory::watch_memory;
pub use method::families::*;
pub use method::{
    CornerSamples, Kind, Method, MethodError, Preset, Promises, VolumeCells, VolumeCellsError, kinds, presets,
};
pub use settings::{Clustering, Execution, Placement, Positions, Topology};
pub use source::Source;
pub use surface::trace::VertexKey;
