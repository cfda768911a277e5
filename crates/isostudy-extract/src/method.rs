//! A method as plain data: everything that decides a mesh, but for the field, the grid and the isovalue.

mod continuation;
mod cubes;
mod dual_contouring;
mod macet;
mod of_cubes;
mod presets;
mod snap_cubes;
mod surface_nets;
mod tetrahedra;
mod volume_cells;

pub use continuation::Continuation;
pub use cubes::Cubes;
pub use dual_contouring::DualContouring;
pub use macet::Macet;
pub use presets::{Preset, presets};
pub use snap_cubes::SnapCubes;
pub use surface_nets::SurfaceNets;
pub use tetrahedra::Tetrahedra;
pub use volume_cells::{VolumeCells, VolumeCellsError};

use std::error::Error;
use std::fmt;

use crate::extraction::{ExtractError, Extraction};
use crate::extractor::Extractor;
use crate::extractor::Way;
use crate::lattice::BoxGrid;
use crate::lattice::{Arrangement, Border, CellBox, LatticeError};
use crate::settings::{Execution, ExtractSettings};
use crate::source::Source;
use isostudy_field::StudyField;

/// A way to make a mesh. The same method, field, grid and isovalue give the same mesh to the byte, on any number of
/// threads.
///
/// With the feature `serde` it is read and written as a table that says its `kind`, with keys left out for defaults:
/// `{ kind = "tetrahedra", arrangement = "body-centred", placement = "relaxed" }`, `{ kind = "cubes", faces = "trilinear" }`.
/// Unknown keys are refused.
///
/// ```
/// use isostudy_extract::{Arrangement, BoxGrid, Execution, Extractor, Method, Placement, Tetrahedra};
/// use isostudy_field::{StudyField, Sphere};
/// # use glam::Vec3;
/// # use isostudy_mesh::Bounds;
///
/// let relaxed = Tetrahedra { placement: Placement::Relaxed, ..Tetrahedra::new(Arrangement::BodyCentred) };
/// let method = Method::Tetrahedra(relaxed);
/// let grid = BoxGrid { bounds: Bounds { min: Vec3::splat(-1.1), max: Vec3::splat(1.1) }, spacing: 0.1 };
/// let sphere: &dyn StudyField = &Sphere { radius: 1.0 };
/// let (mut extractor, execution) = (Extractor::new(), Execution::default());
/// let extraction = method.extract(&mut extractor, sphere.into(), &grid, 0.0, &execution)?;
/// assert!(method.promises().manifold);
/// assert_eq!(extraction.counts.vertices * 2, extraction.counts.triangles + 4, "genus 0");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[non_exhaustive]
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(tag = "kind", rename_all = "kebab-case"))]
pub enum Method {
    /// Regularised marching tetrahedra.
    Tetrahedra(Tetrahedra),
    /// Marching cubes.
    Cubes(Cubes),
    /// Marching cubes with crossings drawn to lattice points.
    SnapCubes(SnapCubes),
    /// Marching cubes with edges turned square to the surface.
    Macet(Macet),
    /// Surface nets, the dual of marching cubes.
    SurfaceNets(SurfaceNets),
    /// Dual contouring: surface nets with vertices where tangent planes meet.
    DualContouring(DualContouring),
    /// Marching cubes, or tetrahedra, from cube to cube beginning at seeds.
    Continuation(Continuation),
}

/// What a method promises of every mesh, whatever the field. A promise that is not made may still hold for a field.
#[non_exhaustive]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Promises {
    /// The mesh is an oriented 2-manifold, with or without boundary, that uses all its vertices. No two triangles have
    /// the same vertices.
    pub manifold: bool,
    /// The mesh has no boundary where the surface stays clear of the box.
    pub closed_off_the_box: bool,
    /// Triangles are the same, number by number, wherever vertices are placed; only positions and normals change.
    pub same_triangles_for_all_placements: bool,
    /// Boxes of cells that fill the grid, extracted one by one, weld to the mesh of the whole, to the byte.
    pub chunks: bool,
    /// Samples are enough ([`Source::Samples`]); otherwise there must be a field to be called.
    pub samples_suffice: bool,
}

/// Samples at the corners of a grid's cells.
#[derive(Debug, Clone, PartialEq)]
pub struct CornerSamples {
    /// Samples along each axis.
    pub counts: [usize; 3],
    /// All of them, x fastest.
    pub values: Vec<f32>,
}

/// Why a method makes no mesh.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum MethodError {
    /// The grid is not one for this method.
    Grid(LatticeError),
    /// A distance to snap from that is none.
    Gamma {
        /// As given.
        gamma: f32,
    },
    /// A share of the largest eigenvalue that is none.
    Truncation {
        /// As given.
        truncation: f32,
    },
    /// A tolerance that is none.
    Tolerance {
        /// As given.
        tolerance: f32,
    },
    /// More steps than there may be.
    Smoothing {
        /// As given.
        smoothing: u32,
    },
    /// Lines to search for seeds on that are no cells apart.
    Search {
        /// As given.
        search: u32,
    },
    /// Moves that are none.
    Macet {
        /// As given.
        pull: f32,
        /// As given.
        steps: u32,
        /// As given.
        share: f32,
    },
    /// There are samples, and the method calls the field between them.
    NeedsField,
    /// The method's settings do not go together, or the extraction fails.
    Extract(ExtractError),
}

impl fmt::Display for MethodError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Grid(error) => error.fmt(f),
            Self::Gamma { gamma } => {
                write!(f, "gamma = {gamma:?}: must be from 0 to 0.5, in lengths of a lattice edge")
            }
            Self::Truncation { truncation } => write!(
                f,
                "truncation = {truncation:?}: must be from 0 to 1, a share of the largest eigenvalue"
            ),
            Self::Tolerance { tolerance } => {
                write!(f, "tolerance = {tolerance:?}: must be 0 or more, in lengths of a lattice edge")
            }
            Self::Smoothing { smoothing } => {
                write!(f, "smoothing = {smoothing}: must be from 0 to 64, steps")
            }
            Self::Search { search } => write!(f, "search = {search}: must be 1 or more, cells"),
            Self::Macet { pull, steps, share } => write!(
                f,
                "pull = {pull:?}, steps = {steps}, share = {share:?}: pull and share must be from 0 to 1, steps at most 64"
            ),
            Self::NeedsField => f.write_str("the method calls the field; samples alone do not suffice"),
            Self::Extract(error) => error.fmt(f),
        }
    }
}

impl Error for MethodError {}

impl From<LatticeError> for MethodError {
    fn from(error: LatticeError) -> Self {
        Self::Grid(error)
    }
}

impl From<ExtractError> for MethodError {
    fn from(error: ExtractError) -> Self {
        Self::Extract(error)
    }
}

impl Method {
    /// Whether the samples at the corners of cubes are all that the method asks for, so that a volume's own cells will do
    /// ([`VolumeCells`](crate::VolumeCells)).
    pub fn is_of_cubes(&self) -> bool {
        self.family().is_of_cubes()
    }

    /// The samples at the corners of a grid's cells, where the method takes them; `None` if its sample points are others.
    ///
    /// # Errors
    /// [`LatticeError`] if the grid is not one for this method.
    pub fn corner_samples(
        &self,
        field: &dyn StudyField,
        grid: &BoxGrid,
    ) -> Result<Option<CornerSamples>, LatticeError> {
        if !self.family().has_corners() {
            return Ok(None);
        }
        let lattice = grid.lattice(Arrangement::SimpleCubic)?;
        let counts = lattice.cells().map(|n| n as usize + 1);
        let first = lattice.origin();
        let axis = |axis: usize| -> Vec<f32> {
            let at =
                |i: usize| lattice.coordinate(axis, 2 * (i64::from(first[axis]) + i as i64), Border::OnBox);
            (0..counts[axis]).map(at).collect()
        };
        let [x, y, z] = [axis(0), axis(1), axis(2)];
        let mut samples = vec![0.0; counts.iter().product()];
        for (row, values) in samples.chunks_exact_mut(counts[0]).enumerate() {
            field.sample_row(&x, y[row % counts[1]], z[row / counts[1]], values);
        }
        Ok(Some(CornerSamples { counts, values: samples }))
    }

    /// How many cells of a grid of samples, x fastest, two or more along each axis, the method decides otherwise than the trilinear
    /// interpolant of the samples: what ambiguous faces join, and whether there is a tunnel. `None` where it does not decide cell by
    /// cell what is joined.
    ///
    /// # Panics
    /// If there are not as many samples as the counts say.
    pub fn cells_otherwise(&self, counts: [usize; 3], values: &[f32], isovalue: f32) -> Option<u64> {
        assert_eq!(values.len(), counts.iter().product::<usize>(), "samples for the counts");
        self.family().cells_otherwise(counts, values, isovalue)
    }

    /// The tables by which signs decide triangles, before anything is merged or moved: of the cube; or of the tetrahedra of a cube's
    /// worth of a uniform lattice, corners in half cells from its base point. None where samples decide as well, and for snapped cubes
    /// and the arrangements that are cut cube by cube.
    pub fn tables(&self) -> Vec<isostudy_cells::Table> {
        self.family().tables()
    }

    /// Whether the method's settings go with each other and with the grid. What this passes is refused by
    /// [`extract_into`](Self::extract_into) only for its source, its isovalue, or want of memory, threads or numbers.
    ///
    /// # Errors
    /// [`MethodError`], which says what is allowed.
    pub fn check(&self, grid: &BoxGrid) -> Result<(), MethodError> {
        self.family().check(grid)
    }

    /// Cells of the grid along x, y and z.
    ///
    /// # Errors
    /// [`LatticeError`] if the grid is not one for this method.
    pub fn cells(&self, grid: &BoxGrid) -> Result<[u32; 3], LatticeError> {
        self.family().cells(grid)
    }

    /// What an extraction holds of the grid at a time, in bytes. The mesh, and what the field holds, come on top.
    ///
    /// # Errors
    /// [`LatticeError`] if the grid is not one for this method.
    pub fn memory_bytes(&self, grid: &BoxGrid, execution: &Execution) -> Result<u64, LatticeError> {
        self.family().memory_bytes(grid, execution)
    }

    /// What is certain of every mesh.
    pub fn promises(&self) -> Promises {
        self.family().promises()
    }

    /// Extracts the surface where `source` has the isovalue into `extraction`, whose vectors are used again. After an error
    /// it is empty. `execution` changes nothing about the mesh.
    ///
    /// # Errors
    /// As [`check`](Self::check), and [`MethodError::Extract`] as [`Extractor::extract_into`].
    pub fn extract_into(
        &self,
        extractor: &mut Extractor,
        source: Source,
        grid: &BoxGrid,
        isovalue: f32,
        execution: &Execution,
        extraction: &mut Extraction,
    ) -> Result<(), MethodError> {
        let result = self.family().extract_into(extractor, source, grid, isovalue, execution, extraction);
        if result.is_err() {
            extraction.clear();
        }
        result
    }

    /// Extracts the surface where `source` has the isovalue, as [`extract_into`](Self::extract_into).
    ///
    /// # Errors
    /// The same.
    pub fn extract(
        &self,
        extractor: &mut Extractor,
        source: Source,
        grid: &BoxGrid,
        isovalue: f32,
        execution: &Execution,
    ) -> Result<Extraction, MethodError> {
        let mut extraction = Extraction::default();
        self.extract_into(extractor, source, grid, isovalue, execution, &mut extraction)?;
        Ok(extraction)
    }

    fn family(&self) -> &dyn Family {
        match self {
            Self::Tetrahedra(tetrahedra) => tetrahedra,
            Self::Cubes(cubes) => cubes,
            Self::SnapCubes(cubes) => cubes,
            Self::Macet(macet) => macet,
            Self::SurfaceNets(nets) => nets,
            Self::DualContouring(nets) => nets,
            Self::Continuation(continuation) => continuation,
        }
    }
}

/// What only the extractor of chunks asks.
impl Method {
    /// How many cells beyond a box's own samples can matter to its chunk; `None` where there is no such number, or there
    /// are no chunks.
    pub(crate) fn halo(&self) -> Option<u32> {
        self.family().halo()
    }

    /// How a window is extracted, where the method is one that chunks are made by.
    pub(crate) fn by_window(&self, isovalue: f32) -> Option<ByWindow> {
        self.family().by_window(isovalue)
    }

    /// Whether the settings that only its family has are in their ranges.
    pub(crate) fn check_own(&self) -> Result<(), MethodError> {
        self.family().check_own()
    }

    /// Whether samples can never suffice.
    pub(crate) fn calls_the_field_always(&self) -> bool {
        self.family().calls_the_field_always()
    }

    /// The cells whose samples can matter to the chunk of a box, in a grid without an end. `None` where that is not known
    /// beforehand: with edge collapse it is the whole piece of surface.
    pub fn window(&self, cells: CellBox) -> Option<CellBox> {
        let everywhere = CellBox { start: [i32::MIN; 3], end: [i32::MAX; 3] };
        Some(cells.grown(self.halo()?, &everywhere))
    }
}

/// How the cells of a window are extracted.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ByWindow {
    pub(crate) arrangement: Arrangement,
    pub(crate) settings: ExtractSettings,
    /// By cubes that are not cut any further, which then are the arrangement's.
    pub(crate) cubes: Option<Way>,
    /// How many cells from the rim of a window on its mesh is that of the whole, before vertices are moved or edges
    /// collapsed.
    pub(crate) halo: u32,
}

/// What a family of methods implements; see the functions of [`Method`] with the same names.
trait Family {
    /// Whether the settings that only the family has are in their ranges.
    fn check_own(&self) -> Result<(), MethodError>;
    /// Whether the field is called between the samples whatever the settings are.
    fn calls_the_field_always(&self) -> bool;
    fn check(&self, grid: &BoxGrid) -> Result<(), MethodError>;
    fn cells(&self, grid: &BoxGrid) -> Result<[u32; 3], LatticeError>;
    fn memory_bytes(&self, grid: &BoxGrid, execution: &Execution) -> Result<u64, LatticeError>;
    fn promises(&self) -> Promises;
    fn is_of_cubes(&self) -> bool;
    /// Whether the sample points are the corners of cubes, wherever else the field is called.
    fn has_corners(&self) -> bool;
    fn cells_otherwise(&self, counts: [usize; 3], values: &[f32], isovalue: f32) -> Option<u64>;
    fn tables(&self) -> Vec<isostudy_cells::Table>;
    fn halo(&self) -> Option<u32>;
    fn by_window(&self, isovalue: f32) -> Option<ByWindow>;
    fn extract_into(
        &self,
        extractor: &mut Extractor,
        source: Source,
        grid: &BoxGrid,
        isovalue: f32,
        execution: &Execution,
        extraction: &mut Extraction,
    ) -> Result<(), MethodError>;
}
