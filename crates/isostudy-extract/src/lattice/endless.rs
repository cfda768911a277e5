//! A grid of cubes without an end, for worlds that have none.

use isostudy_field::Aabb;

use crate::lattice::{CellBox, short};
use crate::wording::in_words;

/// Cubes of one size in line with the axes, numbered by `i32` in all directions from an origin.
///
/// Corner `i` along an axis lies at `origin + i * spacing`, in double precision with one rounding and then with one to
/// `f32`: the same bits for every chunk that looks at it, however far away.
///
/// ```
/// use isostudy_extract::Grid;
///
/// let grid = Grid::try_new([0.0, 0.0, -64.0], 0.5)?;
/// assert_eq!(grid.cell_at([-0.1, 0.0, -64.0]), [-1, 0, 0]);
/// let chunk = grid.chunk([-1, 0, 2], 32);
/// assert_eq!((chunk.start, chunk.end), ([-32, 0, 64], [0, 32, 96]));
/// # Ok::<(), isostudy_extract::GridError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Grid {
    origin: [f64; 3],
    spacing: f64,
}

/// What a grid cannot be or tell.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum GridError {
    /// The cubes' edge is not a positive finite number, in `f32` too.
    Spacing {
        /// What was given.
        value: f64,
    },
    /// The origin is not finite.
    Origin {
        /// `'x'`, `'y'` or `'z'`.
        axis: char,
        /// What was given.
        value: f64,
    },
    /// A box that is inverted or not finite.
    Bounds {
        /// `'x'`, `'y'` or `'z'`.
        axis: char,
        /// What was given.
        min: f32,
        /// What was given.
        max: f32,
    },
    /// A box that needs cells beyond `i32`.
    OutOfRange {
        /// `'x'`, `'y'` or `'z'`.
        axis: char,
    },
    /// A method whose chunks may depend on samples anywhere: with edge collapse, the whole piece of surface.
    NoWindow,
}

in_words! {
    GridError {
        Self::Spacing { value } => "spacing must be positive and finite in f32, not {value:?}";
        Self::Origin { axis, value } => "the origin must be finite along {axis}, not {value:?}";
        Self::Bounds { axis, min, max } =>
            "bounds along {axis} must be finite with min at most max, not {} to {}", short(*min), short(*max);
        Self::OutOfRange { axis } => "cells along {axis} beyond the numbers of i32";
        Self::NoWindow => "chunks by this method may look at samples anywhere";
    }
}

const AXES: [char; 3] = ['x', 'y', 'z'];

impl Grid {
    /// A grid with a corner at `origin` and cubes of edge `spacing`.
    ///
    /// # Errors
    /// [`GridError::Spacing`], [`GridError::Origin`].
    pub fn try_new(origin: [f64; 3], spacing: f64) -> Result<Self, GridError> {
        let single = spacing as f32;
        if !(single > 0.0 && single.is_finite()) {
            return Err(GridError::Spacing { value: spacing });
        }
        for (axis, value) in AXES.into_iter().zip(origin) {
            if !value.is_finite() {
                return Err(GridError::Origin { axis, value });
            }
        }
        Ok(Self { origin, spacing })
    }

    /// The grid of a level: cubes `2^level` times as large, with the same corner `[0, 0, 0]`. Its corner `i` is this grid's corner
    /// `2^level * i`, to the bit.
    ///
    /// # Errors
    /// [`GridError::Spacing`] if the cubes are too large for `f32`.
    pub fn coarser(&self, level: u32) -> Result<Self, GridError> {
        Self::try_new(self.origin, self.spacing * 2f64.powi(level.min(1 << 10) as i32))
    }

    /// The grid that this is the `level` of.
    pub(crate) fn finer(self, level: u32) -> Self {
        Self { spacing: self.spacing * 0.5f64.powi(level as i32), ..self }
    }

    /// The same cubes, with a corner at 0.
    pub(crate) fn at_origin(self) -> Self {
        Self { origin: [0.0; 3], ..self }
    }

    /// Corner `[0, 0, 0]`.
    pub fn origin(&self) -> [f64; 3] {
        self.origin
    }

    /// The edge of a cube.
    pub fn spacing(&self) -> f64 {
        self.spacing
    }

    /// The lowest corner of a cell.
    pub fn position(&self, cell: [i32; 3]) -> [f64; 3] {
        [0, 1, 2].map(|axis| self.coordinate(axis, 2 * i64::from(cell[axis])))
    }

    /// The place of so many half cells along an axis, with one rounding.
    pub(crate) fn coordinate(&self, axis: usize, halves: i64) -> f64 {
        (halves as f64).mul_add(0.5 * self.spacing, self.origin[axis])
    }

    /// The box of some cells, as samples at its corners see it.
    pub fn bounds(&self, cells: CellBox) -> Aabb {
        let at = |cell: [i32; 3]| self.position(cell).map(|c| c as f32);
        Aabb { min: at(cells.start), max: at(cells.end) }
    }

    /// The cell that a point is in; on a common side, the one with the greater number. Points beyond the numbers of `i32`
    /// are in the last cell.
    pub fn cell_at(&self, p: [f32; 3]) -> [i32; 3] {
        [0, 1, 2].map(|axis| self.last_corner(axis, |corner| corner <= p[axis]))
    }

    /// The chunk of so many cells a side that a point is in.
    ///
    /// # Panics
    /// If `cells` is 0.
    pub fn chunk_at(&self, p: [f32; 3], cells: u32) -> [i32; 3] {
        self.cell_at(p).map(|cell| i64::from(cell).div_euclid(i64::from(cells)) as i32)
    }

    /// The cells of a chunk of so many a side. Chunk `[0, 0, 0]` begins at the origin. Beyond `i32` there are none.
    pub fn chunk(&self, id: [i32; 3], cells: u32) -> CellBox {
        let limit = |i: i64| i.clamp(i32::MIN.into(), i32::MAX.into()) as i32;
        let at = |n: i64| id.map(|i| limit((i64::from(i) + n) * i64::from(cells)));
        CellBox { start: at(0), end: at(1) }
    }

    /// The least box of cells that a box lies in. A bound at a corner of the grid, as `f32` has it, needs no cell beyond.
    ///
    /// # Errors
    /// [`GridError::Bounds`], [`GridError::OutOfRange`].
    pub fn cells_in(&self, bounds: Aabb) -> Result<CellBox, GridError> {
        check(&bounds)?;
        let mut cells = CellBox { start: [0; 3], end: [0; 3] };
        for (i, axis) in AXES.into_iter().enumerate() {
            let start = self.last_corner(i, |corner| corner <= bounds.min[i]);
            let before = self.last_corner(i, |corner| corner < bounds.max[i]);
            let end =
                before.checked_add(1).filter(|_| start > i32::MIN).ok_or(GridError::OutOfRange { axis })?;
            (cells.start[i], cells.end[i]) = (start, end.max(start.saturating_add(1)));
        }
        Ok(cells)
    }

    /// The last corner along an axis that `is_before` holds for, which holds up to some place and not beyond.
    fn last_corner(&self, axis: usize, is_before: impl Fn(f32) -> bool) -> i32 {
        let is_before = |i: i64| is_before(self.coordinate(axis, 2 * i) as f32);
        let (mut low, mut high) = (i64::from(i32::MIN), i64::from(i32::MAX));
        while low < high {
            let middle = (low + high + 1).div_euclid(2);
            if is_before(middle) { low = middle } else { high = middle - 1 }
        }
        low as i32
    }
}

pub(crate) fn check(bounds: &Aabb) -> Result<(), GridError> {
    for (i, axis) in AXES.into_iter().enumerate() {
        let (min, max) = (bounds.min[i], bounds.max[i]);
        if !(min.is_finite() && max.is_finite() && min <= max) {
            return Err(GridError::Bounds { axis, min, max });
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Clustering;
    use crate::lattice::Arrangement;
    use crate::method::{Method, Tetrahedra};

    #[test]
    fn cells_are_counted_without_a_quotient() {
        for (origin, spacing) in [(0.0, 0.3), (-28.8, 0.3), (7.1, 0.1), (1e5, 1.0 / 3.0)] {
            let grid = Grid::try_new([origin; 3], spacing).unwrap();
            for n in [1, 96, 1000] {
                let cells = CellBox { start: [-n; 3], end: [n; 3] };
                assert_eq!(grid.cells_in(grid.bounds(cells)).unwrap(), cells, "{origin} {spacing} {n}");
            }
        }
        let grid = Grid::try_new([0.0; 3], 1.0).unwrap();
        let point = Aabb { min: [1.5; 3], max: [1.5; 3] };
        assert_eq!(grid.cells_in(point).unwrap(), CellBox { start: [1; 3], end: [2; 3] });
    }

    #[test]
    fn a_point_is_between_the_corners_of_its_cell() {
        let grid = Grid::try_new([0.1, -3.0, 1e4], 0.3).unwrap();
        for p in [[0.1, -3.0, 1e4], [-17.3, 0.0, 0.0], [96.0, 1e5, -1e5], [0.4, -2.7, 9999.9]] {
            let cell = grid.cell_at(p);
            let bounds = grid.bounds(CellBox { start: cell, end: cell.map(|c| c + 1) });
            for axis in 0..3 {
                assert!(bounds.min[axis] <= p[axis] && p[axis] < bounds.max[axis], "{p:?} {bounds:?}");
            }
            let id = grid.chunk_at(p, 32);
            assert!(grid.chunk(id, 32).contains(cell), "{id:?}");
        }
        assert_eq!(grid.cell_at([f32::INFINITY; 3]), [i32::MAX; 3]);
    }

    #[test]
    fn what_is_no_grid_is_refused() {
        for value in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e300, 1e-300] {
            assert!(matches!(Grid::try_new([0.0; 3], value), Err(GridError::Spacing { .. })), "{value}");
        }
        let error = GridError::Origin { axis: 'y', value: f64::INFINITY };
        assert_eq!(Grid::try_new([0.0, f64::INFINITY, 0.0], 1.0), Err(error));
        let grid = Grid::try_new([0.0; 3], 1.0).unwrap();
        let inverted = Aabb { min: [0.0, 1.0, 0.0], max: [1.0, 0.0, 1.0] };
        let error = GridError::Bounds { axis: 'y', min: 1.0, max: 0.0 };
        assert_eq!(grid.cells_in(inverted), Err(error.clone()));
        let method = Method::Tetrahedra(Tetrahedra::new(Arrangement::BodyCentred));
        assert_eq!(grid.touched(inverted, 8, &method).err(), Some(error));
        let all = Aabb { min: [-1e30; 3], max: [1e30; 3] };
        assert_eq!(grid.cells_in(all), Err(GridError::OutOfRange { axis: 'x' }));
        let collapse =
            Tetrahedra { clustering: Clustering::EdgeCollapse, ..Tetrahedra::new(Arrangement::BodyCentred) };
        let point = Aabb::around([0.0; 3], 0.0);
        assert_eq!(grid.touched(point, 8, &Method::Tetrahedra(collapse)).err(), Some(GridError::NoWindow));
    }
}
