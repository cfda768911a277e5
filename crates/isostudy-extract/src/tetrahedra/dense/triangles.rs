//! Geometry stage: the triangles of every tetrahedron that the surface crosses.

use std::collections::TryReserveError;

use crate::lattice::{Arrangement, DirectionSet, Lattice, Layout};
use crate::surface::trace::Trace;
use crate::tetrahedra::cases::{CASES, Case, Tetrahedron, belongs_to_an_earlier_cell, spokes};
use crate::tetrahedra::dense::edges::EdgeTable;
use crate::tetrahedra::dense::sides::Sides;

/// The most triangles of a cell: two in each tetrahedron, of which a cell in a lowest corner of the box has 24.
pub(crate) const MOST_TRIANGLES_A_CELL: usize = 48;

/// Triangles, and how many there would have been.
#[derive(Debug, Default)]
pub(crate) struct Triangulation {
    pub(crate) triangles: Vec<[u32; 3]>,
    /// Cells that were not skipped.
    pub(crate) cells_visited: u64,
    /// Their tetrahedra.
    pub(crate) tetrahedra_evaluated: u64,
    /// Triangles left out because two corners are the same vertex.
    pub(crate) discarded: u64,
    /// The same as the original counts them: two whenever the second and third corner coincide, even in a
    /// tetrahedron that has one triangle only (Costen 2026).
    pub(crate) discarded_as_published: u64,
    /// The cell of each triangle, where that is asked for.
    pub(crate) trace: Option<Trace>,
}

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
                            let points =
                                tetrahedron.corners.map(|d| base.strict_add_signed(steps[d as usize]));
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

impl Triangulation {
    pub(crate) fn add(&mut self, case: Case, vertex: impl Fn(u8) -> u32) {
        match case {
            Case::Empty => {}
            Case::Triangle(edges) => {
                let triangle = edges.map(vertex);
                let [_, q1, q2] = triangle;
                self.discarded_as_published += u64::from(q1 == q2);
                self.keep_or_discard(triangle);
            }
            Case::Quad(edges) => {
                let [q0, q1, q2, q3] = edges.map(vertex);
                self.keep_or_discard([q0, q1, q2]);
                self.keep_or_discard([q3, q2, q1]);
            }
        }
    }

    fn keep_or_discard(&mut self, triangle: [u32; 3]) {
        let [a, b, c] = triangle;
        if a == b || b == c || c == a {
            self.discarded += 1;
            self.discarded_as_published += 1;
        } else {
            self.triangles.push(triangle);
        }
    }
}

/// The edges at the base point that tell whether the surface meets the cell: all of a centre's, and of a lowest
/// corner those to the cube's other seven corners.
pub(crate) fn deciding_edges(arrangement: Arrangement) -> DirectionSet {
    let offsets = &arrangement.directions().offsets;
    (0..offsets.len())
        .filter(|&d| arrangement == Arrangement::BodyCentred || offsets[d].iter().all(|&o| o >= 0))
        .fold(0, |set, d| set | 1 << d)
}

/// The number of the case: one bit a corner.
fn corners_inside(tetrahedron: &Tetrahedron, base_inside: bool, crossing: DirectionSet) -> usize {
    let base = usize::from(base_inside);
    tetrahedron.corners.iter().enumerate().fold(base, |case, (i, &direction)| {
        let other_side = usize::from(crossing >> direction & 1);
        case | (base ^ other_side) << (i + 1)
    })
}
