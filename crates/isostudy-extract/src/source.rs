//! Where samples come from: a field that is called, an array that is there, or layers that are read.

use isostudy_field::{ScalarField, StoredSamples, StudyField};

use crate::active::Bricks;
use crate::clock::Moment;
use crate::execution::control::Control;
use crate::extraction::ExtractError;
use crate::lattice::{CellBox, Lattice, Part};
use crate::sampling::level::Level;
use crate::settings::ExtractSettings;

/// What to extract from.
#[derive(Clone, Copy)]
pub enum Source<'a> {
    /// A field in plain numbers, called where the surface may be.
    Field(&'a dyn ScalarField),
    /// A field of a study, the same way.
    Study(&'a dyn StudyField),
    /// All samples of the lattice in storage order, x fastest: [`Lattice::stored_samples`] of them.
    ///
    /// Body-centred lattices stack half-layers in z, centres first, each with `x + 2` points a row and `y + 2`
    /// rows, where `x` and `y` are the cells along the axes. Layers of corners leave the last row and column unused.
    /// The outermost points lie on the box, as everywhere with guarded topology: samples for the published one lie where
    /// the spacing puts them, centres half a cube beyond. Face-centred lattices are a grid of half cells, `2x + 1` points a row, of which the middles of cube edges are
    /// unused; the others a grid of corners.
    Samples(&'a [f32]),
    /// The same with the ranges of their bricks, which need not be read where they lie on one side of the isovalue: for one
    /// isovalue after another. The mesh is the same.
    Bricks(&'a Bricks<'a>),
    /// The same samples, of which a layer is read when it is wanted, and forgotten a few layers later: for those of a file that is larger than
    /// memory. As many along each axis as the lattice stores. The mesh is the same.
    Stored(&'a dyn StoredSamples),
    /// The samples of a box of cells, in the order of [`SampleLayout`](crate::SampleLayout): for a
    /// [`ChunkExtractor`](crate::ChunkExtractor), of a box that contains its
    /// [`window`](crate::ChunkExtractor::window), and fastest of that box itself.
    Window {
        /// The box.
        cells: CellBox,
        /// As many as the layout says.
        samples: &'a [f32],
    },
}

impl<'a, F: ScalarField> From<&'a F> for Source<'a> {
    fn from(field: &'a F) -> Self {
        Self::Field(field)
    }
}

impl<'a> From<&'a dyn ScalarField> for Source<'a> {
    fn from(field: &'a dyn ScalarField) -> Self {
        Self::Field(field)
    }
}

impl<'a> From<&'a dyn StudyField> for Source<'a> {
    fn from(field: &'a dyn StudyField) -> Self {
        Self::Study(field)
    }
}

impl<'a> From<&'a [f32]> for Source<'a> {
    fn from(samples: &'a [f32]) -> Self {
        Self::Samples(samples)
    }
}

/// The same to the extractors.
#[derive(Clone, Copy)]
pub(crate) enum Sampler<'a> {
    Field(&'a dyn StudyField),
    /// All samples of the lattice, and what is known of them.
    Given {
        values: &'a [f32],
        bricks: Option<&'a Bricks<'a>>,
    },
    /// The same, to be read.
    Stored(&'a dyn StoredSamples),
}

/// What normals are made of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) enum NormalsOf {
    /// The triangles round a vertex.
    #[default]
    Triangles,
    /// The differences between samples, by extractors that can.
    Samples,
    /// There are none.
    Nothing,
}

/// One extraction: valid settings, a field made ready or as many samples as the lattice has.
#[derive(Clone, Copy)]
pub(crate) struct Request<'a> {
    pub(crate) source: Sampler<'a>,
    pub(crate) lattice: &'a Lattice,
    pub(crate) settings: &'a ExtractSettings,
    pub(crate) control: Control<'a>,
    pub(crate) most_vertices: u32,
    /// Which normals somebody looks at.
    pub(crate) normals: NormalsOf,
    /// The cells whose triangles somebody looks at, where not at all of them. An extractor may make more.
    pub(crate) part: Option<Part>,
    /// When it began.
    pub(crate) start: Moment,
}

impl<'a> Request<'a> {
    /// The isosurface, where there is a field to be called.
    pub(crate) fn level(&self) -> Option<Level<'a>> {
        match self.source {
            Sampler::Field(field) => {
                Some(Level { field, isovalue: self.settings.isovalue, spacing: self.lattice.spacing() })
            }
            Sampler::Given { .. } | Sampler::Stored(_) => None,
        }
    }
}

/// Reads a layer of stored samples.
///
/// # Errors
/// [`ExtractError::Unread`].
pub(crate) fn read_layer(
    samples: &dyn StoredSamples,
    layer: usize,
    values: &mut [f32],
) -> Result<(), ExtractError> {
    let [nx, ny, _] = samples.counts();
    samples.read_box([0, 0, layer], [nx, ny, 1], values).map_err(ExtractError::Unread)
}
