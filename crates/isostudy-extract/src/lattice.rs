//! Sampling lattices: which points are sampled and which edges and tetrahedra join them.

mod box_grid;
mod cell_box;
mod coordinates;
mod counts;
mod directions;
pub(crate) mod endless;
mod layout;
mod part;
pub(crate) mod tetrahedra;

pub use box_grid::BoxGrid;
pub use cell_box::CellBox;
pub(crate) use coordinates::{Border, Coordinates};
pub(crate) use directions::{ALL_DIRECTIONS, DIRECTIONS, DirectionSet, Directions, Offset, members};
pub use endless::{Grid, GridError};
pub(crate) use layout::{Layout, PADDING_LAYERS, PointKind};
pub(crate) use part::Part;

use std::fmt;

use glam::Vec3;
use isostudy_mesh::Bounds;

use crate::settings::Clustering;
use crate::wording::in_words;

/// How sample points fill space, and which tetrahedra they make.
///
/// The first two have fourteen lattice edges at every point and every [`Clustering`](crate::Clustering). At the points
/// of the others, 18 or 6, and 26, 14 or 6 meet; the rules of integrated clustering say nothing about them, so they
/// are unclustered or collapsed afterwards.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "kebab-case"))]
pub enum Arrangement {
    /// Cube corners and cube centres: congruent tetrahedra, twelve a cube, after Chan & Purisima (1998). One layer
    /// of centres belongs to each face of the box. As published it lies half a cube outside, so that pyramids stand on the
    /// box and a surface can enter one and leave it again, a scrap by itself; otherwise the layer lies on the face,
    /// where the halves of the tetrahedra end.
    BodyCentred,
    /// Cube corners only: six tetrahedra a cube round its main diagonal (Kuhn's split).
    SimpleCubic,
    /// Cube corners only: five tetrahedra a cube, a regular one on every second corner and one at each of the other
    /// four. Neighbouring cubes are mirror images, so that the diagonals of their common face agree: every diagonal
    /// joins corners with an even sum of indices.
    FiveTetrahedra,
    /// Cube corners, face centres and cube centres: congruent tetrahedra, twenty-four a cube, each on the cube's centre,
    /// a face's centre and a side of that face. All mirror planes of the cube are planes of it.
    ///
    /// The sources name a face-centred cube of 24 tetrahedra without drawing it; this is the reading under which all
    /// points of a cube are used and neighbours agree without a choice of diagonals. The face-centred cubic lattice
    /// proper has no cube centres: it fills a cube with 20 tetrahedra and an octahedron, whose cut into the last four
    /// prefers an axis.
    FaceCentred,
}

impl fmt::Display for Arrangement {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::BodyCentred => "body-centred",
            Self::SimpleCubic => "simple-cubic",
            Self::FiveTetrahedra => "five-tetrahedra",
            Self::FaceCentred => "face-centred",
        })
    }
}

impl Arrangement {
    /// Every arrangement.
    pub const ALL: [Self; 4] =
        [Self::BodyCentred, Self::SimpleCubic, Self::FiveTetrahedra, Self::FaceCentred];

    /// Whether the clustering's rules say something about the points of this arrangement: integrated clustering is for
    /// body-centred and simple cubic only, and the warp for body-centred.
    pub fn supports(self, clustering: Clustering) -> bool {
        match clustering {
            Clustering::None | Clustering::EdgeCollapse => true,
            Clustering::Integrated | Clustering::IntegratedCollapse => self.uniform().is_some(),
            Clustering::Warp => self == Self::BodyCentred,
        }
    }

    /// `None` where points differ in their lattice edges.
    pub(crate) fn uniform(self) -> Option<Uniform> {
        match self {
            Self::BodyCentred => Some(Uniform::BodyCentred),
            Self::SimpleCubic => Some(Uniform::SimpleCubic),
            Self::FiveTetrahedra | Self::FaceCentred => None,
        }
    }

    /// The same where it is known that there is one: what depends on it is never asked about other arrangements.
    pub(crate) fn expect_uniform(self) -> Uniform {
        self.uniform().expect("an arrangement with fourteen lattice edges at every point")
    }
}

/// The arrangements with fourteen lattice edges at every point, in which tetrahedra stand round edges.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Uniform {
    BodyCentred,
    SimpleCubic,
}

/// A box filled with cubes of one size, and an arrangement of sample points in it.
///
/// `cells = ceil((max - min) / spacing)` on each axis, evaluated in `f32`; when it does not divide evenly the
/// lattice reaches past `max` as published; otherwise the last cubes are thinner, though not below a quarter, which
/// those before them give up. Nothing is allocated until [`extract`](crate::by_lattice::extract) runs, so a caller can look
/// at [`memory_bytes`](Self::memory_bytes) and refuse.
#[derive(Debug, Clone, PartialEq)]
pub struct Lattice {
    arrangement: Arrangement,
    bounds: Bounds,
    spacing: f32,
    cells: [u32; 3],
    /// Of a window, its first cell in the whole lattice.
    origin: [i32; 3],
    whole: Whole,
}

/// What a window is a part of.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Whole {
    /// The cells of the box.
    Box([u32; 3]),
    /// There is no box: the bounds are those of `f32`.
    Endless(Grid),
}

/// Why a lattice cannot be built.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum LatticeError {
    /// The cube edge is not a positive finite number.
    Spacing {
        /// What was given.
        value: f32,
    },
    /// The box has no extent along an axis, or a bound is not a finite number.
    Bounds {
        /// `'x'`, `'y'` or `'z'`.
        axis: char,
        /// What was given.
        min: f32,
        /// What was given.
        max: f32,
    },
    /// More cells along an axis than `f32` can count one by one.
    TooManyCells {
        /// `'x'`, `'y'` or `'z'`.
        axis: char,
        /// What the bounds and the spacing ask for; may be infinite.
        cells: f32,
        /// [`Lattice::MAX_CELLS_PER_AXIS`].
        limit: u32,
    },
    /// More sample points than can be counted, or more in the window of a chunk than a 32-bit number can name.
    TooManySamples {
        /// What the lattice would store.
        samples: u128,
        /// [`Lattice::MAX_SAMPLES`], or [`Lattice::MAX_SAMPLES_OF_CHUNK`].
        limit: u64,
    },
    /// More sample points in a layer than a 32-bit number can name.
    TooManyInLayer {
        /// What a layer would store.
        samples: u128,
        /// [`Lattice::MAX_SAMPLES_PER_LAYER`].
        limit: u64,
    },
    /// The outermost lattice points lie beyond the range of `f32`.
    OutOfRange {
        /// `'x'`, `'y'` or `'z'`.
        axis: char,
        /// What was given.
        spacing: f32,
    },
}

in_words! {
    LatticeError {
        Self::Spacing { value } => "spacing must be positive and finite, not {}", short(*value);
        Self::Bounds { axis, min, max } =>
            "bounds along {axis} must be finite with min below max, not {} to {}", short(*min), short(*max);
        Self::TooManyCells { axis, cells, limit } =>
            "{} cells along {axis} exceed the limit of {limit}", short(*cells);
        Self::TooManySamples { samples, limit } => "{samples} sample points exceed the limit of {limit}";
        Self::TooManyInLayer { samples, limit } =>
            "{samples} sample points in each layer exceed the limit of {limit}";
        Self::OutOfRange { axis, spacing } =>
            "spacing {} puts lattice points along {axis} beyond the range of f32", short(*spacing);
    }
}

/// A number in few letters: `0.04`, `-2`, `1e-40`.
pub(crate) fn short(value: f32) -> String {
    let text = format!("{value:?}");
    text.strip_suffix(".0").map_or_else(|| text.clone(), str::to_owned)
}

impl Lattice {
    /// The most cells along one axis: whole numbers in `f32` are exact up to here.
    pub const MAX_CELLS_PER_AXIS: u32 = 1 << 24;
    /// The most stored sample points: so many that edges and tetrahedra can be counted in 64 bits. Where memory has 32-bit addresses, as
    /// many as these can tell apart.
    ///
    /// Streaming holds a few layers, and numbers nothing by its place in the whole lattice; so this is no matter of memory.
    pub const MAX_SAMPLES: u64 = if usize::BITS < 64 { usize::MAX as u64 } else { 1 << 48 };
    /// The most stored sample points of a layer: what is remembered of the points of one is numbered in 32 bits.
    pub const MAX_SAMPLES_PER_LAYER: u64 = u32::MAX as u64;
    /// The most stored sample points of the window of a [chunk](crate::ChunkExtractor): a triangle's cell there has a 32-bit number.
    pub const MAX_SAMPLES_OF_CHUNK: u64 = u32::MAX as u64;

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
        let lattice = Self { arrangement, bounds, spacing, cells, origin: [0; 3], whole: Whole::Box(cells) };
        lattice.check_samples(Self::MAX_SAMPLES)?;
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

    /// Some cells of a grid without an end.
    ///
    /// # Errors
    /// [`LatticeError::TooManySamples`], and [`LatticeError::OutOfRange`] where points lie beyond `f32`.
    pub(crate) fn endless(
        arrangement: Arrangement,
        grid: &Grid,
        cells: CellBox,
    ) -> Result<Self, LatticeError> {
        let bounds = Bounds { min: Vec3::MIN, max: Vec3::MAX };
        let spacing = grid.spacing() as f32;
        let (origin, size) = (cells.start, cells.size());
        let lattice =
            Self { arrangement, bounds, spacing, cells: size, origin, whole: Whole::Endless(*grid) };
        lattice.check_samples(Self::MAX_SAMPLES_OF_CHUNK)?;
        let Bounds { min, max } = lattice.sampled_bounds();
        for (i, axis) in ['x', 'y', 'z'].into_iter().enumerate() {
            if !(min[i].is_finite() && max[i].is_finite()) {
                return Err(LatticeError::OutOfRange { axis, spacing });
            }
        }
        Ok(lattice)
    }

    fn check_samples(&self, limit: u64) -> Result<(), LatticeError> {
        let beyond = match self.arrangement {
            Arrangement::BodyCentred => [(1, 2), (1, 2), (2, 3)],
            Arrangement::SimpleCubic | Arrangement::FiveTetrahedra => [(1, 1); 3],
            Arrangement::FaceCentred => [(2, 1); 3],
        };
        let points = [0, 1, 2].map(|axis| beyond[axis].0 * u128::from(self.cells[axis]) + beyond[axis].1);
        let samples = points.iter().product();
        if samples > u128::from(limit) {
            return Err(LatticeError::TooManySamples { samples, limit });
        }
        let (samples, limit) = (points[0] * points[1], Self::MAX_SAMPLES_PER_LAYER);
        if samples > u128::from(limit) {
            return Err(LatticeError::TooManyInLayer { samples, limit });
        }
        Ok(())
    }

    /// The same lattice, of which only the cells of a box are there. Points are where they are in the whole, and
    /// vertices are clamped to the whole's box.
    ///
    /// # Errors
    /// [`LatticeError::TooManySamples`] if there are more than of a chunk.
    pub(crate) fn window(&self, cells: CellBox) -> Result<Self, LatticeError> {
        let window = Self { cells: cells.size(), origin: cells.start, ..self.clone() };
        window.check_samples(Self::MAX_SAMPLES_OF_CHUNK)?;
        Ok(window)
    }

    /// The cells that are there, in the whole lattice.
    pub(crate) fn cell_box(&self) -> CellBox {
        let end = [0, 1, 2].map(|axis| self.origin[axis].wrapping_add_unsigned(self.cells[axis]));
        CellBox { start: self.origin, end }
    }

    /// The cells of a part of this window, in the whole lattice.
    pub(crate) fn cells_of(&self, part: Part) -> CellBox {
        let [start, end] = [part.start, part.end]
            .map(|corner| [0, 1, 2].map(|axis| self.origin[axis].wrapping_add(corner[axis] as i32)));
        CellBox { start, end }
    }

    /// Whether there is no box.
    pub(crate) fn is_endless(&self) -> bool {
        matches!(self.whole, Whole::Endless(_))
    }

    /// Of a window, its first cell in the whole lattice.
    pub(crate) fn origin(&self) -> [i32; 3] {
        self.origin
    }

    /// The number of a cell of this window, x fastest; of no use in lattices that are too large for a chunk, which ask for none.
    pub(crate) fn cell_number(&self, [x, y, z]: [usize; 3]) -> u32 {
        let [nx, ny, _] = self.cells;
        (z as u32).wrapping_mul(ny).wrapping_add(y as u32).wrapping_mul(nx).wrapping_add(x as u32)
    }

    /// Where a stored point of this window is stored in the whole lattice, along each axis.
    pub(crate) fn stored(&self, point: [usize; 3]) -> [i64; 3] {
        let first = self.first_stored();
        [0, 1, 2].map(|axis| first[axis] + point[axis] as i64)
    }

    /// The cell of the whole lattice that a stored point counts as its own: the one it is the centre, the lowest corner
    /// or a lower face's centre of, or the nearest.
    pub(crate) fn cell_of_point(&self, stored: [i64; 3]) -> [i32; 3] {
        let cell = cell_of_stored(self.arrangement, stored);
        [0, 1, 2].map(|axis| match self.whole {
            Whole::Box(cells) => cell[axis].clamp(0, i64::from(cells[axis]) - 1) as i32,
            Whole::Endless(_) => cell[axis] as i32,
        })
    }

    /// The box of all stored points.
    pub(crate) fn sampled_bounds(&self) -> Bounds {
        let beyond = if self.arrangement == Arrangement::BodyCentred { 1 } else { 0 };
        let CellBox { start, end } = self.cell_box();
        let at = |cell: [i32; 3], beyond: i64| {
            Vec3::from_array([0, 1, 2].map(|axis| match self.whole {
                Whole::Box(_) => {
                    self.bounds.min[axis] + (cell[axis] as f32 + 0.5 * beyond as f32) * self.spacing
                }
                Whole::Endless(grid) => grid.coordinate(axis, 2 * i64::from(cell[axis]) + beyond) as f32,
            }))
        };
        Bounds { min: at(start, -beyond), max: at(end, beyond) }
    }

    /// The first stored point of this window along each axis of the whole lattice.
    pub(crate) fn first_stored(&self) -> [i64; 3] {
        let [x, y, z] = self.origin.map(i64::from);
        match self.arrangement {
            Arrangement::BodyCentred => [x, y, 2 * z],
            Arrangement::SimpleCubic | Arrangement::FiveTetrahedra => [x, y, z],
            Arrangement::FaceCentred => [2 * x, 2 * y, 2 * z],
        }
    }
}

/// The cell that a stored point is the centre, the lowest corner or a lower face's centre of.
pub(crate) fn cell_of_stored(arrangement: Arrangement, [x, y, z]: [i64; 3]) -> [i64; 3] {
    match arrangement {
        Arrangement::BodyCentred if z % 2 == 0 => [x - 1, y - 1, z.div_euclid(2) - 1],
        Arrangement::BodyCentred => [x, y, z.div_euclid(2)],
        Arrangement::SimpleCubic | Arrangement::FiveTetrahedra => [x, y, z],
        Arrangement::FaceCentred => [x, y, z].map(|i| i.div_euclid(2)),
    }
}
