//! What was published for finding the active cells of one isovalue after another, to be held against the library's bricks: see
//! docs/isovalues.md.
//!
//! | structure | looks at | source |
//! |---|---|---|
//! | [`Scan`] | every cell | |
//! | [`Octree`] | nodes whose range holds the isovalue, from the root on | Wilhelms & Van Gelder 1992 |
//! | [`SpanSpace`] | the lists of cells in rows of span space | Shen, Hansen, Livnat & Johnson 1996 |
//! | [`KdTree`] | a tree over span space, halved along both axes by turns | Livnat, Shen & Johnson 1996 |
//! | [`IntervalTree`] | two sorted lists for each node on one way down | Cignoni et al. 1997 |
//! | [`SeedSet`] | an interval tree of a few cells, and their neighbours from there on | Bajaj, Pascucci & Schikore 1996 |
//!
//! Each gives exactly the cells of [`Scan`], for any samples and any isovalue, infinite ones and `NaN` included.

mod interval_tree;
mod kd_tree;
mod memory;
mod octree;
mod scan;
mod seed_set;
mod span_space;
mod spans;

use isostudy_extract::active::GridSamples;

pub(crate) use interval_tree::IntervalTree;
pub(crate) use kd_tree::KdTree;
pub(crate) use octree::Octree;
pub(crate) use scan::Scan;
pub(crate) use seed_set::SeedSet;
pub(crate) use span_space::SpanSpace;

/// Cells of a grid, by number and by place.
trait OfCells<'a> {
    /// The four rows of samples that the cells of a row are between.
    fn rows_of_cells(&self, y: usize, z: usize) -> [&'a [f32]; 4];

    /// The number of a cell.
    fn cell(&self, place: [usize; 3]) -> u32;

    /// The cell of a number.
    fn place(&self, cell: u32) -> [usize; 3];
}

impl<'a> OfCells<'a> for GridSamples<'a> {
    fn rows_of_cells(&self, y: usize, z: usize) -> [&'a [f32]; 4] {
        let [nx, ny, _] = self.counts();
        [[y, z], [y + 1, z], [y, z + 1], [y + 1, z + 1]]
            .map(|[y, z]| &self.values()[(z * ny + y) * nx..][..nx])
    }

    fn cell(&self, [x, y, z]: [usize; 3]) -> u32 {
        let [nx, ny, _] = self.cells();
        (x + nx * (y + ny * z)) as u32
    }

    fn place(&self, cell: u32) -> [usize; 3] {
        let ([nx, ny, _], cell) = (self.cells(), cell as usize);
        [cell % nx, cell / nx % ny, cell / nx / ny]
    }
}
