//! Which cells of a volume a surface goes through, asked for one isovalue after another.
//!
//! A cell is *active* at an isovalue where some of its eight samples are above it and some are not. A sample that equals the isovalue
//! is not above it, and neither is `NaN`: the extractor's own rule, so these are the cells that marching cubes, surface nets and dual
//! contouring have something in. With `NaN` as minus infinity, the cell whose samples run from `least` to `greatest` is active where
//! `least <= isovalue < greatest`.
//!
//! [`Bricks`] keep the range of each 8 x 8 x 8 cells, and look into those that are crossed. They give the active cells exactly, for any
//! samples and any isovalue, infinite ones and `NaN` included. The extractor works with them
//! ([`Source::Bricks`](crate::Source::Bricks)), since it walks cells in their order. What else was published is compared with them by the
//! benchmark `isovalues` of the crate `volume`: see `docs/isovalues.md`.
//!
//! ```
//! use isostudy_extract::active::{ActiveCells, Bricks, GridSamples};
//!
//! let values: Vec<f32> = (0..27).map(|i| (i % 3) as f32).collect();
//! let bricks = Bricks::try_new(GridSamples::try_new([3, 3, 3], &values)?)?;
//! let mut cells = Vec::new();
//! bricks.find(1.0, &mut cells);
//! assert_eq!(cells, [1, 3, 5, 7], "from 1 to 2; those from 0 to 1 end below 1");
//! # Ok::<(), isostudy_extract::active::ActiveError>(())
//! ```

mod bricks;
mod spans;

use std::collections::TryReserveError;

use crate::wording::in_words;

pub use bricks::Bricks;

/// What tells the active cells of a volume.
pub trait ActiveCells {
    /// Makes `cells` the numbers of the active cells, each once, in an order that depends on the samples and the isovalue alone. Cell
    /// `(x, y, z)` of `nx * ny * nz` has the number `x + nx * (y + ny * z)`.
    fn find(&self, isovalue: f32, cells: &mut Vec<u32>);

    /// Bytes that are held beside the samples.
    fn bytes(&self) -> usize;
}

/// Samples at the corners of a grid of cells.
#[derive(Debug, Clone, Copy)]
pub struct GridSamples<'a> {
    counts: [usize; 3],
    values: &'a [f32],
}

/// Why there is no structure for some samples.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum ActiveError {
    /// An axis with fewer than two samples, or counts that do not make the number of samples.
    Counts {
        /// As given.
        counts: [usize; 3],
        /// How many samples there are.
        samples: usize,
    },
    /// More cells than a 32-bit number can name.
    TooManyCells {
        /// How many there are.
        cells: usize,
    },
    /// Memory that is not to be had.
    OutOfMemory,
}

in_words! {
    ActiveError {
        Self::Counts { counts, samples } =>
            "{samples} samples, and {counts:?} along the axes; there must be two or more along each, and as \
             many as they make";
        Self::TooManyCells { cells } => "{cells} cells; at most {} can be numbered", u32::MAX;
        Self::OutOfMemory => "no memory for the ranges of the cells";
    }
}

impl From<TryReserveError> for ActiveError {
    fn from(_: TryReserveError) -> Self {
        Self::OutOfMemory
    }
}

impl<'a> GridSamples<'a> {
    /// `counts[0] * counts[1] * counts[2]` samples, the first axis fastest.
    ///
    /// # Errors
    /// [`ActiveError::Counts`], [`ActiveError::TooManyCells`].
    pub fn try_new(counts: [usize; 3], values: &'a [f32]) -> Result<Self, ActiveError> {
        let product = counts.iter().try_fold(1usize, |product, &n| product.checked_mul(n));
        if product != Some(values.len()) || counts.iter().any(|&n| n < 2) {
            return Err(ActiveError::Counts { counts, samples: values.len() });
        }
        let cells = counts.iter().map(|n| n - 1).product();
        if u32::try_from(cells).is_err() {
            return Err(ActiveError::TooManyCells { cells });
        }
        Ok(Self { counts, values })
    }

    /// Samples along each axis.
    pub fn counts(&self) -> [usize; 3] {
        self.counts
    }

    /// All of them.
    pub fn values(&self) -> &'a [f32] {
        self.values
    }

    /// Cells along each axis.
    pub fn cells(&self) -> [usize; 3] {
        self.counts.map(|n| n - 1)
    }

    /// The samples of a row.
    fn row(&self, y: usize, z: usize) -> &'a [f32] {
        let [nx, ny, _] = self.counts;
        &self.values[(z * ny + y) * nx..][..nx]
    }

    /// The four rows of samples that the cells of a row are between.
    fn rows_of_cells(&self, y: usize, z: usize) -> [&'a [f32]; 4] {
        [[y, z], [y + 1, z], [y, z + 1], [y + 1, z + 1]].map(|[y, z]| self.row(y, z))
    }

    /// The number of a cell.
    fn cell(&self, [x, y, z]: [usize; 3]) -> u32 {
        let [nx, ny, _] = self.cells();
        (x + nx * (y + ny * z)) as u32
    }
}
