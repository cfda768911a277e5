//! A volume's own cells: the surface between its samples, in the space its steps are in.

use glam::Vec3;
use isostudy_field::{Beyond, StoredSamples, VolumeField, VolumeFieldError};
use isostudy_mesh::Bounds;

use crate::active::{ActiveError, Bricks, GridSamples};
use crate::clock::Moment;
use crate::execution::control::Control;
use crate::extraction::ExtractError;
use crate::extraction::Extraction;
use crate::extractor::Extractor;
use crate::lattice::BoxGrid;
use crate::memory::copied;
use crate::method::{Method, MethodError};
use crate::source::{NormalsOf, Source};
use crate::surface::normals::vertex_normals;
use crate::surface::space::Space;
use crate::wording::in_words;

/// Samples on a regular grid that may be turned, mirrored, sheared and unequal in its steps. Sample `(i, j, k)` lies at
/// `origin + i * steps[0] + j * steps[1] + k * steps[2]`, the first axis fastest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VolumeCells<'a> {
    /// Samples along each axis, two at least.
    pub counts: [usize; 3],
    /// All of them.
    pub values: &'a [f32],
    /// Where the first sample lies.
    pub origin: [f64; 3],
    /// From one sample to the next along each axis.
    pub steps: [[f64; 3]; 3],
}

/// Why a volume has no mesh on its own cells.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum VolumeCellsError {
    /// An axis with fewer than two samples.
    Flat {
        /// As given.
        counts: [usize; 3],
    },
    /// The steps span no space, or are not finite.
    Steps {
        /// As given.
        steps: [[f64; 3]; 3],
        /// As given.
        origin: [f64; 3],
    },
    /// A method whose sample points are not the corners of cubes.
    Method,
    /// The samples make no field, for a method that calls one.
    Field(VolumeFieldError),
    /// The extraction fails.
    Extract(MethodError),
}

in_words! {
    VolumeCellsError {
        Self::Flat { counts } => "{counts:?} samples along the axes; there must be two or more along each";
        Self::Steps { steps, origin } =>
            "the steps {steps:?} from sample to sample, from {origin:?}, span no space";
        Self::Method =>
            "a volume's own cells are for methods of cubes: other methods have sample points between";
        Self::Field(error) => "{error}";
        Self::Extract(error) => "{error}";
    }
    from { MethodError => Self::Extract, VolumeFieldError => Self::Field }
}

impl<'a> VolumeCells<'a> {
    /// The grid in steps, a cube for each cell: what a method is asked about.
    pub fn grid(&self) -> BoxGrid {
        let max = Vec3::from_array(self.counts.map(|n| n.saturating_sub(1) as f32));
        BoxGrid { bounds: Bounds { min: Vec3::ZERO, max }, spacing: 1.0 }
    }

    /// Extracts the surface where the samples have the isovalue, cell by cell of the volume, so that counts can be compared with other
    /// programs'. The same volume with other steps has the same triangles, but for their orientation where they are mirrored:
    /// triangles always face outward.
    ///
    /// Vertices are placed in steps of the grid, then taken to space in double precision.
    ///
    /// # Errors
    /// [`VolumeCellsError`].
    pub fn extract<'c>(
        &self,
        method: &Method,
        extractor: &mut Extractor,
        isovalue: f32,
        control: impl Into<Control<'c>>,
    ) -> Result<Extraction, VolumeCellsError> {
        self.extract_from(Source::Samples(self.values), method, extractor, isovalue, control.into())
    }

    /// Extracts by any method. Where the samples are all that it asks for, as [`extract`](Self::extract), to the byte. Any other method is
    /// given the samples' trilinear interpolant in steps of the grid, of which it takes what it asks for. Beyond the outermost
    /// samples that field goes on.
    ///
    /// # Errors
    /// [`VolumeCellsError`].
    pub fn extract_interpolated<'c>(
        &self,
        method: &Method,
        extractor: &mut Extractor,
        isovalue: f32,
        control: impl Into<Control<'c>>,
    ) -> Result<Extraction, VolumeCellsError> {
        if method.is_of_cubes() && method.promises().samples_suffice {
            return self.extract(method, extractor, isovalue, control.into());
        }
        let unit = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let values = copied(self.values).map_err(|_| MethodError::from(ExtractError::NoMemoryForMesh))?;
        let field = VolumeField::try_new(self.counts, values, [0.0; 3], unit, Beyond::Continued)?;
        self.extract_in_steps(Source::Study(&field), method, extractor, isovalue, control.into())
    }

    /// The ranges of bricks of the samples, for [`extract_by_bricks`](Self::extract_by_bricks).
    ///
    /// # Errors
    /// [`ActiveError`].
    pub fn bricks(&self) -> Result<Bricks<'a>, ActiveError> {
        Bricks::try_new(GridSamples::try_new(self.counts, self.values)?)
    }

    /// Extracts the same mesh, to the byte, without reading rows of [`bricks`](Self::bricks) that lie on one side of the isovalue: for one
    /// isovalue after another.
    ///
    /// # Errors
    /// [`VolumeCellsError`], [`ExtractError::BrickCounts`] among them if the bricks are those of a volume of another size.
    pub fn extract_by_bricks<'c>(
        &self,
        bricks: &Bricks,
        method: &Method,
        extractor: &mut Extractor,
        isovalue: f32,
        control: impl Into<Control<'c>>,
    ) -> Result<Extraction, VolumeCellsError> {
        self.extract_from(Source::Bricks(bricks), method, extractor, isovalue, control.into())
    }

    /// Extracts the same mesh, to the byte, of samples that are not in memory: a few layers of them are, while the surface is made. `values`
    /// are not looked at, and need not be there.
    ///
    /// # Errors
    /// [`VolumeCellsError`], [`ExtractError::StoredCounts`] and [`ExtractError::Unread`] among them.
    pub fn extract_stored<'c>(
        &self,
        samples: &dyn StoredSamples,
        method: &Method,
        extractor: &mut Extractor,
        isovalue: f32,
        control: impl Into<Control<'c>>,
    ) -> Result<Extraction, VolumeCellsError> {
        self.extract_from(Source::Stored(samples), method, extractor, isovalue, control.into())
    }

    fn extract_from(
        &self,
        source: Source,
        method: &Method,
        extractor: &mut Extractor,
        isovalue: f32,
        control: Control,
    ) -> Result<Extraction, VolumeCellsError> {
        if !method.is_of_cubes() {
            return Err(VolumeCellsError::Method);
        }
        self.extract_in_steps(source, method, extractor, isovalue, control)
    }

    fn extract_in_steps(
        &self,
        source: Source,
        method: &Method,
        extractor: &mut Extractor,
        isovalue: f32,
        control: Control,
    ) -> Result<Extraction, VolumeCellsError> {
        let Self { counts, origin, steps, .. } = *self;
        if counts.iter().any(|&n| n < 2) {
            return Err(VolumeCellsError::Flat { counts });
        }
        let space = Space::try_new(origin, steps).ok_or(VolumeCellsError::Steps { steps, origin })?;
        let grid = self.grid();
        // Those of the grid's own steps would be made for nothing.
        let normals = std::mem::replace(&mut extractor.normals, NormalsOf::Nothing);
        let extraction = method.extract(extractor, source, &grid, isovalue, control);
        extractor.normals = normals;
        let mut extraction = extraction?;
        let mesh = &mut extraction.mesh;
        space.place(mesh);
        let making_normals = Moment::now();
        let normals = vertex_normals(&mesh.positions, &mesh.triangles);
        mesh.normals = normals.map_err(|_| MethodError::from(ExtractError::NoMemoryForMesh))?;
        extraction.times.normals = making_normals.elapsed();
        Ok(extraction)
    }
}
