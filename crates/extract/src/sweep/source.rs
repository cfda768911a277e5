//! Where samples come from: a field that is called, or an array that is there.

use field::ScalarField;

/// What to extract from.
#[derive(Clone, Copy)]
pub enum Source<'a> {
    /// A field, called for each slice of the lattice when its turn comes.
    Field(&'a dyn ScalarField),
    /// All samples of the lattice in storage order, x fastest: [`Lattice::stored_samples`](crate::Lattice) of them.
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
