//! What the passes need to know about the lattice, worked out once.

use std::collections::TryReserveError;

use glam::Vec3;
use isostudy_mesh::Bounds;

use crate::lattice::{Border, Lattice};
use crate::sampling::bits::between;
use crate::sampling::line::All;
use crate::sampling::tiles::Points;
use crate::slabs::window::PointRows;

/// Columns, rows and layers of a tile.
const TILE: usize = 2;
/// Layers of sides and samples in sight: the two of a cell, and one on either side.
pub(crate) const SLOTS: usize = 4;

/// The corners of the cubes as the passes see them.
pub(crate) struct CubeGrid<'a> {
    pub(crate) lattice: &'a Lattice,
    /// Points a row, rows a layer, layers.
    pub(crate) size: [usize; 3],
    /// Words of bits a row.
    pub(crate) words: usize,
    /// Along each axis.
    pub(crate) at: [Vec<f32>; 3],
}

impl<'a> CubeGrid<'a> {
    pub(crate) fn new(lattice: &'a Lattice) -> Result<Self, TryReserveError> {
        Self::within(lattice, Default::default())
    }

    /// The same, with coordinates in vectors that are there.
    pub(crate) fn within(lattice: &'a Lattice, mut at: [Vec<f32>; 3]) -> Result<Self, TryReserveError> {
        let size = lattice.stored_grid().map(|n| n as usize);
        lattice.refit_in_line(Border::OnBox, &mut at)?;
        Ok(Self { lattice, size, words: size[0].div_ceil(64), at })
    }

    pub(crate) fn position(&self, place: [usize; 3]) -> Vec3 {
        Vec3::from_array([0, 1, 2].map(|axis| self.at[axis][place[axis]]))
    }

    /// The points of a word that have a next one in their row: those that cells begin at.
    #[inline(always)]
    pub(crate) fn with_next(&self, word: usize) -> u64 {
        between(word, 0, self.size[0] - 1)
    }
}

impl Points for CubeGrid<'_> {
    fn size(&self) -> [usize; 3] {
        self.size
    }

    fn side(&self) -> usize {
        TILE
    }

    fn depth(&self) -> usize {
        TILE
    }

    fn spacing(&self) -> f32 {
        self.lattice.spacing()
    }

    fn bounds(&self, columns: [usize; 2], rows: [usize; 2], layers: [usize; 2]) -> Bounds {
        let [min, max] = [0, 1].map(|end| self.position([columns[end], rows[end], layers[end]]));
        Bounds { min, max }
    }
}

impl PointRows for CubeGrid<'_> {
    type Columns = All;

    fn words(&self) -> usize {
        self.words
    }

    fn at(&self, axis: usize) -> &[f32] {
        &self.at[axis]
    }

    #[inline]
    fn columns(&self, _row: usize, _layer: usize) -> (All, &[f32], u64) {
        (All, &self.at[0], !0)
    }
}
