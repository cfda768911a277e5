//! Geometry stage: the triangles of every tetrahedron that the surface crosses.

use std::collections::TryReserveError;

use crate::lattice::tetrahedra::{
    CASES, Case, MOST_TRIANGLES_A_CELL, Tetrahedron, belongs_to_an_earlier_cell, deciding_edges, spokes,
};
use crate::lattice::{DirectionSet, Lattice, Layout};
use crate::surface::triangulation::Triangulation;
use crate::tetrahedra::dense::edges::EdgeTable;
use crate::tetrahedra::dense::sides::Sides;

/// Walks the cells in storage order and skips those that no lattice edge of theirs crosses.
pub(crate) fn triangulate(
    lattice: &Lattice,
    layout: &Layout,
    sides: &Sides,
    edges: &EdgeTable,
) -> Result<Triangulation, TryReserveError> {
    let spokes = spokes(lattice.arrangement());
    let deciding = deciding_edges(lattice.arrangement());
    let steps = layout.steps(layout.base_kind());
    let mut result = Triangulation::default();
    let [nx, ny, nz] = lattice.cells().map(|n| n as usize);
    for z in 0..nz {
        for y in 0..ny {
            let first = layout.base([0, y, z]);
            for x in 0..nx {
                let base = first + x;
                let crossing = edges.crossing(base);
                if crossing & deciding == 0 {
                    continue;
                }
                result.triangles.try_reserve(MOST_TRIANGLES_A_CELL)?;
                result.cells_visited += 1;
                let inside = sides.is_inside(base);
                for spoke in &spokes {
                    if belongs_to_an_earlier_cell(lattice.arrangement(), spoke, [x, y, z]) {
                        continue;
                    }
                    for tetrahedron in &spoke.ring {
                        result.tetrahedra_evaluated += 1;
                        let case = CASES[corners_inside(tetrahedron, inside, crossing)];
                        if case != Case::Empty {
                            let points = tetrahedron.corners.map(|d| {
                                base.checked_add_signed(steps[d as usize]).expect("a point of the lattice")
                            });
                            let points = [base, points[0], points[1], points[2]];
                            result.add(case, |edge| {
                                let edge = &tetrahedron.edges[edge as usize];
                                let (from, to) = (points[edge.from as usize], points[edge.to as usize]);
                                edges.vertex(from, edge.direction, to, edge.back)
                            });
                        }
                    }
                }
            }
        }
    }
    Ok(result)
}

/// The number of the case: one bit a corner.
fn corners_inside(tetrahedron: &Tetrahedron, base_inside: bool, crossing: DirectionSet) -> usize {
    let base = usize::from(base_inside);
    tetrahedron.corners.iter().enumerate().fold(base, |case, (i, &direction)| {
        let other_side = usize::from(crossing >> direction & 1);
        case | (base ^ other_side) << (i + 1)
    })
}
