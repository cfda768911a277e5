//! Where samples come from: a field that is called, or an array that is there.

use std::time::Instant;

use field::ScalarField;

use crate::lattice::Lattice;
use crate::level::Level;
use crate::settings::{Execution, ExtractSettings};

/// What to extract from.
#[derive(Clone, Copy)]
pub enum Source<'a> {
    /// A field, called for each slice of the lattice when its turn comes.
    Field(&'a dyn ScalarField),
    /// All samples of the lattice in storage order, x fastest: [`Lattice::stored_samples`] of them.
    ///
    /// Body-centred lattices stack half-layers in z, centres first, each with `x + 2` points a row and `y + 2`
    /// rows, where `x` and `y` are the cells along the axes. Layers of corners leave the last row and column unused.
    /// The outermost points lie on the box, as everywhere with guarded topology: samples for the published one lie where
    /// the spacing puts them, centres half a cube beyond. Face-centred lattices are a grid of half cells, `2x + 1` points a row, of which the middles of cube edges are
    /// unused; the others a grid of corners.
    Samples(&'a [f32]),
}

impl<'a> From<&'a dyn ScalarField> for Source<'a> {
    fn from(field: &'a dyn ScalarField) -> Self {
        Self::Field(field)
    }
}

impl<'a> From<&'a [f32]> for Source<'a> {
    fn from(samples: &'a [f32]) -> Self {
        Self::Samples(samples)
    }
}

/// One extraction: valid settings, a field made ready or as many samples as the lattice has.
#[derive(Clone, Copy)]
pub(crate) struct Request<'a> {
    pub(crate) source: Source<'a>,
    pub(crate) lattice: &'a Lattice,
    pub(crate) settings: &'a ExtractSettings,
    pub(crate) execution: &'a Execution,
    pub(crate) most_vertices: u32,
    /// When it began.
    pub(crate) start: Instant,
}

impl<'a> Request<'a> {
    /// The isosurface, where there is a field to be called.
    pub(crate) fn level(&self) -> Option<Level<'a>> {
        match self.source {
            Source::Field(field) => {
                Some(Level { field, isovalue: self.settings.isovalue, spacing: self.lattice.spacing() })
            }
            Source::Samples(_) => None,
        }
    }
}
