//! Triangle pass: the cells of a layer in storage order, but for those whose points are all on one side.

use std::collections::TryReserveError;

use super::grid::{CORNERS, CutGrid};
use super::points::{Record, Records};
use super::sampling::BitRows;
use crate::lattice::tetrahedra::{CASES, Case};
use crate::sampling::bits::between;
use crate::sampling::rows::{is_set, shifted};
use crate::surface::triangulation::Triangulation;

/// Two in each of 24 tetrahedra.
const MOST_TRIANGLES_A_CELL: usize = 48;

/// Adds the triangles of layer `z` of the cells. Of the layers of points round it, sides and records are known.
pub(super) fn triangulate_layer(
    grid: &CutGrid,
    sides: &BitRows,
    active: &BitRows,
    records: &Records,
    z: usize,
    result: &mut Triangulation,
) -> Result<(), TryReserveError> {
    let steps = grid.cut.steps_a_cell;
    let [nx, ny, _] = grid.lattice.cells().map(|n| n as usize);
    let corners = &grid.cut.corners;
    let all = !(!0u32 << corners.len());
    for y in 0..ny {
        // Of a corner of each cell of this row.
        let row_of = |corner: usize| {
            let [_, dy, dz] = corners[corner % corners.len()].map(|i| i as usize);
            [y * steps + dy, z * steps + dz]
        };
        let rows: [[usize; 2]; CORNERS] = std::array::from_fn(row_of);
        let sides = rows.map(|[row, layer]| sides.row(row, layer));
        let marks = rows.map(|[row, layer]| active.row(row, layer));
        let records = rows.map(|row| records.row(grid, row, active));
        for word in 0..grid.words {
            // Lowest corners of cells of which a point that tells has a crossing.
            let mut left = grid.cut.telling.iter().fold(0, |cells, &corner| {
                cells | shifted(marks[corner], word, isize::from(corners[corner][0]))
            });
            left &= grid.lowest_corners & between(word, 0, nx * steps);
            while left != 0 {
                let column = 64 * word + left.trailing_zeros() as usize;
                left &= left - 1;
                let at = |corner: usize| column + corners[corner][0] as usize;
                let inside = (0..corners.len())
                    .fold(0, |set, corner| set | u32::from(is_set(sides[corner], at(corner))) << corner);
                if inside == 0 || inside == all {
                    continue;
                }
                result.triangles.try_reserve(MOST_TRIANGLES_A_CELL)?;
                let mut of_corner = [Record::default(); CORNERS];
                for (corner, record) in of_corner.iter_mut().enumerate().take(corners.len()) {
                    *record = records[corner].at(at(corner));
                }
                result.cells_visited += 1;
                let x = column / steps;
                for tetrahedron in grid.tetrahedra([x, y, z]) {
                    result.tetrahedra_evaluated += 1;
                    let case = (0..4)
                        .fold(0, |case, i| case | ((inside >> tetrahedron.corners[i] & 1) as usize) << i);
                    if CASES[case] != Case::Empty {
                        result.add(CASES[case], |edge| {
                            let edge = &tetrahedron.edges[usize::from(edge)];
                            // Of the end that is stored first, or else of the other.
                            let [from, to] = [edge.from, edge.to].map(|end| of_corner[usize::from(end)]);
                            let vertex = from.vertex(edge.direction).or_else(|| to.vertex(edge.back));
                            vertex.expect("a crossing edge has a vertex at one of its ends")
                        });
                    }
                }
                let triangles = result.triangles.len();
                if let Some(trace) = &mut result.trace {
                    trace.close_cell(grid.lattice.cell_number([x, y, z]), triangles)?;
                }
            }
        }
    }
    Ok(())
}
