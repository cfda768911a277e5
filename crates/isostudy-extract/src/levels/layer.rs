//! Cells of a finer neighbour along a side or an edge of a chunk, and where a grid's corners are.

use super::neighbours::Neighbours;
use crate::lattice::CellBox;
use crate::lattice::endless::Grid;

/// The boxes of fine cells, one thick, that have all of the fine grid's edges in a chunk's sides and edges at finer neighbours. `cells` are
/// the chunk's.
pub(super) fn layers(cells: CellBox, neighbours: &Neighbours) -> impl Iterator<Item = CellBox> {
    let corners = [cells.start, cells.end].map(|corner| corner.map(|i| i.saturating_mul(2)));
    neighbours.dividing().map(move |direction| {
        let [mut start, mut end] = corners;
        for axis in (0..3).filter(|&axis| direction[axis] != 0) {
            start[axis] = corners[usize::from(direction[axis] > 0)][axis];
            end[axis] = start[axis].saturating_add(1);
        }
        CellBox { start, end }
    })
}

/// Where a grid's corner is, as fields are asked.
pub(super) fn point(grid: &Grid, corner: [i32; 3]) -> [f32; 3] {
    grid.position(corner).map(|c| c as f32)
}
