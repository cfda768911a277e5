//! The box that is filled with cubes, before anything is said about the method.

use isostudy_mesh::Bounds;

use crate::lattice::{Arrangement, Lattice, LatticeError};

/// A box and the edge of the cubes that fill it: what every method is given beside a field and an isovalue.
///
/// Cubes stand in line with the axes, the first at `bounds.min`. There are `ceil((max - min) / spacing)` along an axis,
/// evaluated in `f32`; what becomes of a spacing that does not divide the box is the method's affair
/// ([`Lattice`] says it for tetrahedra). A field that is turned, or has other steps along each axis, says so in its
/// samples, not here.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BoxGrid {
    /// The box, in the unit of the field's coordinates.
    pub bounds: Bounds,
    /// The edge of a cube, in the same unit.
    pub spacing: f32,
}

impl BoxGrid {
    /// The lattice of an arrangement over the box.
    ///
    /// # Errors
    /// As [`Lattice::try_new`].
    pub fn lattice(&self, arrangement: Arrangement) -> Result<Lattice, LatticeError> {
        Lattice::try_new(arrangement, self.bounds, self.spacing)
    }
}

impl From<&Lattice> for BoxGrid {
    /// The box and the spacing that the lattice was made with.
    fn from(lattice: &Lattice) -> Self {
        Self { bounds: lattice.bounds(), spacing: lattice.spacing() }
    }
}
