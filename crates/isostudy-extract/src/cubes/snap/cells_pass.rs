//! Cell passes: which patch each cell of a layer has, and later its triangles.

use std::collections::TryReserveError;

use super::super::Flat;
use super::super::grid::CubeGrid;
use super::super::records::Records;
use super::super::vertices::corner_of;
use super::labels::Labels;
use super::table::{CORNER, MOST_TRIANGLES, Table};
use super::vertices::Record;
use crate::memory::reset;
use crate::sampling::rows::{Rows, next};
use crate::surface::triangulation::Triangulation;

/// The patches of two layers of cells, and the points on the surface that they use.
#[derive(Default)]
pub(super) struct Chosen {
    /// Cells with a patch.
    live: Rows,
    numbers: Vec<u16>,
    pub(super) used: Rows,
    size: [usize; 2],
}

impl Chosen {
    /// Makes room, with none chosen.
    pub(super) fn fit(&mut self, grid: &CubeGrid) -> Result<(), TryReserveError> {
        let [nx, ny, _] = grid.size;
        self.size = [nx, ny];
        self.live.fit(grid.words, ny, 2)?;
        reset(&mut self.numbers, 2 * nx * ny, 0)?;
        self.used.fit(grid.words, ny, 2)
    }

    fn start(&self, row: usize, layer: usize) -> usize {
        (layer % 2 * self.size[1] + row) * self.size[0]
    }

    /// Forgets which points of a layer are used.
    pub(super) fn clear_used(&mut self, layer: usize) {
        (0..self.size[1]).for_each(|row| self.used.row_mut(row, layer).fill(0));
    }

    /// Chooses the patches of layer `z` of cells. Labels are known from the layer of points below to two above it.
    ///
    /// A patch in a face is the other cell's too, facing the other way, if that has no other corner inside or on the surface.
    pub(super) fn layer(&mut self, grid: &CubeGrid, labels: &Labels, table: &Table, flat: Flat, z: usize) {
        self.clear_used(z + 1);
        for y in 0..grid.size[1] - 1 {
            self.live.row_mut(y, z).fill(0);
            let rows = [[y, z], [y + 1, z], [y, z + 1], [y + 1, z + 1]];
            if labels.is_uniform(&rows) {
                continue;
            }
            let start = self.start(y, z);
            for word in 0..grid.words {
                let corners = |lines: &Rows| -> [u64; 8] {
                    std::array::from_fn(|c| {
                        let [y, z] = rows[c >> 1];
                        let line = lines.row(y, z);
                        if c & 1 == 0 { line[word] } else { next(line, word) }
                    })
                };
                let (inside, on) = (corners(&labels.inside), corners(&labels.on));
                let any = inside.iter().chain(&on).fold(0, |any, bits| any | bits);
                let all = (0..8).fold(!0, |all, c| all & (inside[c] | on[c]));
                let mut left = any & !all & grid.with_next(word);
                while left != 0 {
                    let bit = left.trailing_zeros();
                    left &= left - 1;
                    let set =
                        |bits: &[u64; 8]| (0..8).fold(0, |set, c| set | ((bits[c] >> bit & 1) as u8) << c);
                    let number = Table::number(set(&inside), set(&on));
                    let patch = table.at(number);
                    let place = [64 * word + bit as usize, y, z];
                    let is_left_out = |face| flat == Flat::Neither && is_twice(labels, place, face);
                    if patch.triangles.is_empty() || patch.face.is_some_and(is_left_out) {
                        continue;
                    }
                    self.live.row_mut(y, z)[word] |= 1 << bit;
                    self.numbers[start + place[0]] = number;
                    for c in (0..8).filter(|c| patch.corners >> c & 1 != 0) {
                        let [x, y, z] = corner_of(place, c);
                        self.used.row_mut(y, z)[x / 64] |= 1 << (x % 64);
                    }
                }
            }
        }
    }

    /// Adds the triangles of layer `z` of cells. Of the layers of points below and above it, records are known.
    pub(super) fn triangulate(
        &self,
        grid: &CubeGrid,
        table: &Table,
        records: &Records<Record>,
        z: usize,
        result: &mut Triangulation,
    ) -> Result<(), TryReserveError> {
        for y in 0..grid.size[1] - 1 {
            let starts = [[y, z], [y + 1, z], [y, z + 1], [y + 1, z + 1]].map(|[y, z]| records.start(y, z));
            let live = &self.live.row(y, z)[..grid.words];
            for (word, &live) in live.iter().enumerate().filter(|(_, live)| **live != 0) {
                let mut left = live;
                result.cells_visited += u64::from(left.count_ones());
                result.triangles.try_reserve(MOST_TRIANGLES * left.count_ones() as usize)?;
                while left != 0 {
                    let x = 64 * word + left.trailing_zeros() as usize;
                    left &= left - 1;
                    let patch = table.at(self.numbers[self.start(y, z) + x]);
                    let at = |corner: u8| {
                        let corner = usize::from(corner);
                        records.at(starts[corner >> 1] + x + (corner & 1))
                    };
                    let mut vertices = [0; 20];
                    for &edge in &patch.edges {
                        let (corner, axis) = table.edge(edge);
                        vertices[usize::from(edge)] = at(corner).vertex(axis);
                    }
                    for corner in (0..8).filter(|corner| patch.corners >> corner & 1 != 0) {
                        vertices[usize::from(CORNER + corner)] = at(corner).vertex(0);
                    }
                    let numbered = |triangle: &[u8; 3]| triangle.map(|code| vertices[usize::from(code)]);
                    result.triangles.extend(patch.triangles.iter().map(numbered));
                    if let Some(trace) = &mut result.trace {
                        trace.close_cell(grid.lattice.cell_number([x, y, z]), result.triangles.len())?;
                    }
                }
            }
        }
        Ok(())
    }
}

/// Whether the cell on the other side of a face has no corner inside or on the surface but those of the face.
fn is_twice(labels: &Labels, cell: [usize; 3], (axis, is_far): (usize, bool)) -> bool {
    (0..8).filter(|corner| (corner >> axis & 1 != 0) != is_far).all(|corner| {
        let mut place = corner_of(cell, corner).map(Some);
        let at = cell[axis];
        place[axis] = if is_far { Some(at + 2) } else { at.checked_sub(1) };
        labels.is_outside(place)
    })
}
