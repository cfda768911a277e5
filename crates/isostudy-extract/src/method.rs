//! A method as plain data: everything that decides a mesh, but for the field, the grid and the isovalue.

mod family;
mod presets;
mod volume_cells;

use family::Family;
pub use presets::{Preset, presets};
pub use volume_cells::{VolumeCells, VolumeCellsError};

use std::fmt;

use crate::cubes::cells_otherwise;
use crate::execution::control::Control;
use crate::extraction::{ExtractError, Extraction, check};
use crate::extractor::Extractor;
use crate::lattice::{Arrangement, Border, BoxGrid, CellBox, Lattice, LatticeError};
use crate::settings::{Execution, Positions};
use crate::source::Source;
use crate::wording::in_words;
use isostudy_field::StudyField;

/// Names every family once: its settings, what files and features call its kind, and the file that has both, with its presets.
macro_rules! families {
    ($(#[$about:meta])* Method: $($(#[$of:meta])* $family:ident = $kind:literal in $file:ident,)*) => {
        $(#[cfg(feature = $kind)] mod $file;)*

        /// The settings of each family.
        pub(crate) mod families {
            $(#[cfg(feature = $kind)] pub use super::$file::$family;)*
        }
        pub(crate) use families::*;

        $(#[$about])*
        #[non_exhaustive]
        #[derive(Debug, Clone, Copy, PartialEq)]
        #[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
        #[cfg_attr(feature = "serde", serde(tag = "kind"))]
        pub enum Method {
            $(#[cfg(feature = $kind)] $(#[$of])* #[cfg_attr(feature = "serde", serde(rename = $kind))] $family($family),)*
        }

        /// The kinds there are, in the order of their presets.
        static KINDS: &[Kind] = &[$(#[cfg(feature = $kind)] Kind { name: $kind, presets: $file::PRESETS },)*];

        impl Method {
            /// What its family says of it.
            pub(crate) fn family(&self) -> &dyn Family {
                match self {
                    $(#[cfg(feature = $kind)] Self::$family(of) => of,)*
                }
            }

            /// What a file calls the method's [kind](kinds).
            pub fn kind(&self) -> &'static str {
                match self {
                    $(#[cfg(feature = $kind)] Self::$family(_) => $kind,)*
                }
            }
        }
    };
}

families! {
    /// A way to make a mesh. The same method, field, grid and isovalue give the same mesh to the byte, on any number of
    /// threads.
    ///
    /// With the feature `serde` it is read and written as a table that says its `kind`, with keys left out for defaults:
    /// `{ kind = "tetrahedra", arrangement = "body-centred", placement = "relaxed" }`, `{ kind = "cubes", faces = "trilinear" }`.
    /// Unknown keys are refused.
    ///
    /// ```
    /// use isostudy_extract::{Arrangement, BoxGrid, Execution, Extractor, Method, Placement, StudyField, Sphere, Tetrahedra};
    /// # use isostudy_extract::{Bounds, glam::Vec3};
    ///
    /// let relaxed = Tetrahedra::new(Arrangement::BodyCentred).with_placement(Placement::Relaxed);
    /// let method = Method::Tetrahedra(relaxed);
    /// let grid = BoxGrid { bounds: Bounds { min: Vec3::splat(-1.1), max: Vec3::splat(1.1) }, spacing: 0.1 };
    /// let sphere: &dyn StudyField = &Sphere { radius: 1.0 };
    /// let (mut extractor, execution) = (Extractor::new(), Execution::default());
    /// let extraction = method.extract(&mut extractor, sphere.into(), &grid, 0.0, &execution)?;
    /// assert!(method.promises().manifold);
    /// assert_eq!(extraction.counts.vertices * 2, extraction.counts.triangles + 4, "genus 0");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    Method:
    /// Regularised marching tetrahedra.
    Tetrahedra = "tetrahedra" in tetrahedra,
    /// Marching cubes.
    Cubes = "cubes" in cubes,
    /// Marching cubes with crossings drawn to lattice points.
    SnapCubes = "snap-cubes" in snap_cubes,
    /// Marching cubes with edges turned square to the surface.
    Macet = "macet" in macet,
    /// Cubical marching squares: marching cubes with vertices on creases.
    CubicalMarchingSquares = "cubical-marching-squares" in cubical_marching_squares,
    /// Surface nets, the dual of marching cubes.
    SurfaceNets = "surface-nets" in surface_nets,
    /// Blocks round samples.
    Blocky = "blocky" in blocky,
    /// Dual contouring: surface nets with vertices where tangent planes meet.
    DualContouring = "dual-contouring" in dual_contouring,
    /// Marching cubes, or tetrahedra, from cube to cube beginning at seeds.
    Continuation = "continuation" in continuation,
}

/// A family of methods, as files name it.
#[derive(Debug, Clone, Copy)]
#[non_exhaustive]
pub struct Kind {
    /// What a table's `kind` says.
    pub name: &'static str,
    /// Its methods that have a name.
    pub presets: &'static [Preset],
}

/// All kinds of methods, each with its presets.
pub fn kinds() -> &'static [Kind] {
    KINDS
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
    /// No triangle has more in common with another one than vertices and sides that both have.
    pub no_intersections: bool,
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
    /// A setting of the family's own that is out of its range.
    Setting {
        /// What files call it.
        key: &'static str,
        /// As given.
        value: String,
        /// What it must be.
        allowed: &'static str,
    },
    /// There are samples, and the method calls the field between them.
    NeedsField,
    /// The method's settings do not go together, or the extraction fails.
    Extract(ExtractError),
}

in_words! {
    MethodError {
        Self::Grid(error) => "{error}";
        Self::Setting { key, value, allowed } => "{key} = {value}: {allowed}";
        Self::NeedsField => "the method calls the field; samples alone do not suffice";
        Self::Extract(error) => "{error}";
    }
    from { LatticeError => Self::Grid, ExtractError => Self::Extract }
}

impl MethodError {
    /// Refuses a setting that is not what it must be.
    fn unless(
        is_allowed: bool,
        key: &'static str,
        value: impl fmt::Debug,
        allowed: &'static str,
    ) -> Result<(), Self> {
        let refused = || Self::Setting { key, value: format!("{value:?}"), allowed };
        if is_allowed { Ok(()) } else { Err(refused()) }
    }
}

impl Method {
    /// Whether the samples at the corners of cubes are all that the method asks for, so that a volume's own cells will do
    /// ([`VolumeCells`](crate::VolumeCells)).
    pub fn is_of_cubes(&self) -> bool {
        let family = self.family();
        family.way().is_some() && !family.calls_the_field_always()
    }

    /// Whether the samples at the corners of a grid's cells are all that the method asks for: then
    /// [`Source::Samples`](crate::Source::Samples) of them makes its mesh. Otherwise it asks for values elsewhere, or for gradients.
    pub fn is_of_corners(&self) -> bool {
        let family = self.family();
        let has_only_corners = match family.arrangement() {
            Arrangement::SimpleCubic | Arrangement::FiveTetrahedra => true,
            Arrangement::BodyCentred | Arrangement::FaceCentred => false,
        };
        let settings = family.settings(0.0);
        has_only_corners
            && settings.positions == Positions::Indexed
            && !family.calls_the_field_always()
            && crate::placement::check(&settings, false).is_ok()
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
        let counts = lattice.stored_grid().map(|n| n as usize);
        let mut at = [const { Vec::new() }; 3];
        lattice.refit_in_line(Border::OnBox, &mut at).expect("samples take more room");
        let [x, y, z] = at;
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
        self.family().rule().map(|rule| cells_otherwise(rule, counts, values, isovalue))
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
        self.family().check_own()?;
        check(&self.family().settings(0.0), self.family().arrangement())?;
        self.lattice(grid)?;
        Ok(())
    }

    /// Cells of the grid along x, y and z.
    ///
    /// # Errors
    /// [`LatticeError`] if the grid is not one for this method.
    pub fn cells(&self, grid: &BoxGrid) -> Result<[u32; 3], LatticeError> {
        Ok(self.lattice(grid)?.cells())
    }

    /// What an extraction holds of the grid at a time, in bytes. The mesh, and what the field holds, come on top.
    ///
    /// # Errors
    /// [`LatticeError`] if the grid is not one for this method.
    pub fn memory_bytes(&self, grid: &BoxGrid, execution: &Execution) -> Result<u64, LatticeError> {
        let settings = self.family().settings(0.0);
        Ok(self.family().layers() * self.lattice(grid)?.memory_bytes_for(&settings, execution))
    }

    /// What is certain of every mesh.
    pub fn promises(&self) -> Promises {
        self.family().promises()
    }

    /// Whether it is there to be compared with, not to be chosen: the published rules as they were, clustering by edge
    /// collapse alone, which the paper compares with, and five tetrahedra, which compare cuts of the cube.
    pub fn is_for_comparison(&self) -> bool {
        self.family().is_for_comparison()
    }

    /// Extracts the surface where `source` has the isovalue into `extraction`, whose vectors are used again. `control` is an [`Execution`],
    /// or a [`Control`] with jobs, a flag that cancels, and somebody to be told of progress. After an error
    /// it is empty. `control` changes nothing about the mesh.
    ///
    /// # Errors
    /// As [`check`](Self::check), and [`MethodError::Extract`] as [`Extractor::extract_into`].
    pub fn extract_into<'c>(
        &self,
        extractor: &mut Extractor,
        source: Source,
        grid: &BoxGrid,
        isovalue: f32,
        control: impl Into<Control<'c>>,
        extraction: &mut Extraction,
    ) -> Result<(), MethodError> {
        let result = self.try_extract_into(extractor, source, grid, isovalue, control.into(), extraction);
        if result.is_err() {
            extraction.clear();
        }
        result
    }

    fn try_extract_into(
        &self,
        extractor: &mut Extractor,
        source: Source,
        grid: &BoxGrid,
        isovalue: f32,
        control: Control,
        extraction: &mut Extraction,
    ) -> Result<(), MethodError> {
        let family = self.family();
        family.check_own()?;
        let is_field = matches!(source, Source::Field(_) | Source::Study(_));
        if family.calls_the_field_always() && !is_field {
            return Err(MethodError::NeedsField);
        }
        let settings = family.settings(isovalue);
        // Before the lattice, as in `check`.
        check(&settings, family.arrangement())?;
        let lattice = self.lattice(grid)?;
        Ok(extractor.extract_by(family.way(), source, &lattice, &settings, control, extraction)?)
    }

    /// The grid's sample points.
    fn lattice(&self, grid: &BoxGrid) -> Result<Lattice, LatticeError> {
        grid.lattice(self.family().arrangement())
    }

    /// Extracts the surface where `source` has the isovalue, as [`extract_into`](Self::extract_into).
    ///
    /// # Errors
    /// The same.
    pub fn extract<'c>(
        &self,
        extractor: &mut Extractor,
        source: Source,
        grid: &BoxGrid,
        isovalue: f32,
        control: impl Into<Control<'c>>,
    ) -> Result<Extraction, MethodError> {
        let mut extraction = Extraction::default();
        self.extract_into(extractor, source, grid, isovalue, control, &mut extraction)?;
        Ok(extraction)
    }

    /// The cells whose samples can matter to the chunk of a box, in a grid without an end. `None` where that is not known
    /// beforehand: with edge collapse it is the whole piece of surface.
    pub fn window(&self, cells: CellBox) -> Option<CellBox> {
        let everywhere = CellBox { start: [i32::MIN; 3], end: [i32::MAX; 3] };
        Some(cells.grown(self.family().halo()?, &everywhere))
    }
}
