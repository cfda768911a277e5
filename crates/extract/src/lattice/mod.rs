//! Sampling lattices: which points are sampled and which edges and tetrahedra join them.

mod coordinates;
mod counts;
mod directions;
mod layout;

pub(crate) use coordinates::Coordinates;
pub(crate) use directions::{ALL_DIRECTIONS, DIRECTIONS, DirectionSet, Directions, Offset, members};
pub(crate) use layout::{Layout, PADDING_LAYERS, PointKind};

use mesh::Bounds;

/// How sample points fill space.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Arrangement {
    /// Cube corners and cube centres: congruent tetrahedra, twelve a cube, after Chan & Purisima (1998). One layer
    /// of centres lies outside each face of the box, half a cube away.
    BodyCentred,
    /// Cube corners only: six tetrahedra a cube round its main diagonal (Kuhn's split).
    SimpleCubic,
}

/// A box filled with cubes of one size, and an arrangement of sample points in it.
///
/// `cells = ceil((max - min) / spacing)` on each axis, evaluated in `f32`; when it does not divide evenly the
/// lattice reaches past `max`. Nothing is allocated until [`extract`](crate::extract) runs, so a caller can look
/// at [`memory_bytes`](Self::memory_bytes) and refuse.
#[derive(Debug, Clone, PartialEq)]
pub struct Lattice {
    arrangement: Arrangement,
    bounds: Bounds,
    spacing: f32,
    cells: [u32; 3],
}

/// Why a lattice cannot be built.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LatticeError {
    /// The cube edge is not a positive finite number.
    #[error("spacing must be positive and finite, not {}", short(*value))]
    Spacing {
        /// What was given.
        value: f32,
    },
    /// The box has no extent along an axis, or a bound is not a finite number.
    #[error("bounds along {axis} must be finite with min below max, not {} to {}", short(*min), short(*max))]
    Bounds {
        /// `'x'`, `'y'` or `'z'`.
        axis: char,
        /// What was given.
        min: f32,
        /// What was given.
        max: f32,
    },
    /// More cells along an axis than `f32` can count one by one.
    #[error("{} cells along {axis} exceed the limit of {limit}", short(*cells))]
    TooManyCells {
        /// `'x'`, `'y'` or `'z'`.
        axis: char,
        /// What the bounds and the spacing ask for; may be infinite.
        cells: f32,
        /// [`Lattice::MAX_CELLS_PER_AXIS`].
        limit: u32,
    },
    /// More sample points than a 32-bit index can name.
    #[error("{samples} sample points exceed the limit of {limit}")]
    TooManySamples {
        /// What the lattice would store.
        samples: u128,
        /// [`Lattice::MAX_SAMPLES`].
        limit: u64,
    },
    /// The outermost lattice points lie beyond the range of `f32`.
    #[error("spacing {} puts lattice points along {axis} beyond the range of f32", short(*spacing))]
    OutOfRange {
        /// `'x'`, `'y'` or `'z'`.
        axis: char,
        /// What was given.
        spacing: f32,
    },
}

/// A number in few letters: `0.04`, `-2`, `1e-40`.
fn short(value: f32) -> String {
    let text = format!("{value:?}");
    text.strip_suffix(".0").map_or_else(|| text.clone(), str::to_owned)
}

impl Lattice {
    /// The most cells along one axis: whole numbers in `f32` are exact up to here.
    pub const MAX_CELLS_PER_AXIS: u32 = 1 << 24;
    /// The most stored sample points.
    pub const MAX_SAMPLES: u64 = u32::MAX as u64;

    /// A lattice with cubes of edge `spacing` over `bounds`, in the unit of the field's coordinates.
    ///
    /// # Errors
    /// [`LatticeError`] if the spacing is not positive and finite, the box is empty, inverted or not finite, or the
    /// lattice would have too many cells or points, or points beyond `f32`.
    pub fn try_new(arrangement: Arrangement, bounds: Bounds, spacing: f32) -> Result<Self, LatticeError> {
        if !(spacing > 0.0 && spacing.is_finite()) {
            return Err(LatticeError::Spacing { value: spacing });
        }
        let (min, max, size) = (bounds.min.to_array(), bounds.max.to_array(), bounds.size().to_array());
        let mut cells = [0; 3];
        for (i, axis) in ['x', 'y', 'z'].into_iter().enumerate() {
            if !(min[i].is_finite() && max[i].is_finite() && min[i] < max[i]) {
                return Err(LatticeError::Bounds { axis, min: min[i], max: max[i] });
            }
            // At least one: the quotient can underflow to zero.
            let wanted = (size[i] / spacing).ceil().max(1.0);
            if wanted > Self::MAX_CELLS_PER_AXIS as f32 {
                return Err(LatticeError::TooManyCells {
                    axis,
                    cells: wanted,
                    limit: Self::MAX_CELLS_PER_AXIS,
                });
            }
            if !((wanted + 1.0) * spacing + min[i]).is_finite() || !(min[i] - spacing).is_finite() {
                return Err(LatticeError::OutOfRange { axis, spacing });
            }
            cells[i] = wanted as u32;
        }
        let lattice = Self { arrangement, bounds, spacing, cells };
        let samples = lattice.stored_grid().iter().map(|&n| u128::from(n)).product();
        if samples > u128::from(Self::MAX_SAMPLES) {
            return Err(LatticeError::TooManySamples { samples, limit: Self::MAX_SAMPLES });
        }
        Ok(lattice)
    }

    /// How sample points fill the box.
    pub fn arrangement(&self) -> Arrangement {
        self.arrangement
    }

    /// The box. Vertices are clamped to it.
    pub fn bounds(&self) -> Bounds {
        self.bounds
    }

    /// The edge of a cube.
    pub fn spacing(&self) -> f32 {
        self.spacing
    }

    /// Cubes along x, y and z.
    pub fn cells(&self) -> [u32; 3] {
        self.cells
    }
}
