//! The tetrahedra of a cell and what the surface does in each.
//!
//! A cell's tetrahedra stand in rings round lattice edges that start at its base point, the *spokes*: body-centred,
//! four round each axis edge of the centre; simple cubic, six round the cube's main diagonal. A tetrahedron is the
//! spoke's two ends and two consecutive points of its ring, always turning the same way. So corners have roles: base,
//! far end, then the two ring points. The roles fix which edge comes first in a triangle.

use isostudy_cells::{Cell, Table};

/// The most triangles of a cell: two in each tetrahedron, of which a cell in a lowest corner of the box has 24.
pub(crate) const MOST_TRIANGLES_A_CELL: usize = 48;

use crate::lattice::{Arrangement, DirectionSet, Directions, Uniform, members};

/// The tetrahedra round one lattice edge.
#[derive(Debug, Clone)]
pub(crate) struct Spoke {
    /// From the base point along the edge.
    pub(crate) direction: u8,
    pub(crate) ring: Vec<Tetrahedron>,
}

/// Four corners; corner 0 is the base point. With `e1, e2, e3` from the base to the others, `det(e1, e2, e3) > 0`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Tetrahedron {
    /// From the base point to corners 1, 2, 3.
    pub(crate) corners: [u8; 3],
    /// In the order of [`EDGES`].
    pub(crate) edges: [TetrahedronEdge; 6],
}

/// A lattice edge, from the end that is stored first. Which end that is does not depend on the tetrahedron, so all
/// tetrahedra round an edge agree on its vertex even when both ends have one.
#[derive(Debug, Clone, Copy)]
pub(crate) struct TetrahedronEdge {
    /// Corners of the tetrahedron.
    pub(crate) from: u8,
    pub(crate) to: u8,
    /// Lattice direction, there and back.
    pub(crate) direction: u8,
    pub(crate) back: u8,
}

/// The corners that the six edges join.
pub(crate) const EDGES: [(u8, u8); 6] = [(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)];

/// The surface in a tetrahedron: the edges it crosses, by number in [`EDGES`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Case {
    Empty,
    /// One triangle.
    Triangle([u8; 3]),
    /// Two triangles, `q0 q1 q2` and `q3 q2 q1`: the diagonal is `q1 q2`.
    Quad([u8; 4]),
}

use Case::{Empty, Quad, Triangle};

/// By the set of corners inside, corner 0 in the lowest bit. Counter-clockwise seen from outside. Which edge is first
/// and which diagonal splits a quad are the original's choices (Costen 2026): its aspect ratio looks only at the two
/// sides that meet in a triangle's first corner.
pub(crate) const CASES: [Case; 16] = [
    Empty,
    Triangle([0, 1, 2]),
    Triangle([0, 4, 3]),
    Quad([2, 4, 1, 3]),
    Triangle([3, 5, 1]),
    Quad([5, 2, 3, 0]),
    Quad([0, 4, 1, 5]),
    Triangle([5, 2, 4]),
    Triangle([5, 4, 2]),
    Quad([5, 4, 1, 0]),
    Quad([0, 2, 3, 5]),
    Triangle([1, 5, 3]),
    Quad([4, 2, 3, 1]),
    Triangle([0, 3, 4]),
    Triangle([1, 0, 2]),
    Empty,
];

/// The lattice edges at a cell's base point round which its tetrahedra stand.
pub(crate) fn spokes(arrangement: Arrangement) -> Vec<Spoke> {
    let directions = arrangement.directions();
    (0..directions.offsets.len() as u8)
        .filter(|&d| {
            let offset = directions.offsets[d as usize];
            match arrangement.expect_uniform() {
                Uniform::BodyCentred => offset.contains(&0),
                Uniform::SimpleCubic => offset == [2, 2, 2],
            }
        })
        .map(|d| Spoke::new(directions, d))
        .collect()
}

/// The tables of the tetrahedra of a cube's worth of the lattice, corners in half cells from its base point; none of the
/// arrangements that are cut cube by cube.
pub(crate) fn tables(arrangement: Arrangement) -> Vec<Table> {
    if arrangement.uniform().is_none() {
        return Vec::new();
    }
    let offsets = &arrangement.directions().offsets;
    // An edge between centres has its tetrahedra in both of their cells.
    let is_own = |spoke: &Spoke| offsets[usize::from(spoke.direction)].iter().all(|&offset| offset >= 0);
    let tetrahedra = spokes(arrangement).into_iter().filter(is_own).flat_map(|spoke| spoke.ring);
    let table = |tetrahedron: Tetrahedron| {
        let place = |d: u8| offsets[usize::from(d)].map(i32::from);
        let [a, b, c] = tetrahedron.corners.map(place);
        // Its edges stand in the order of `EDGES`.
        let cell = Cell::try_new(&[[0; 3], a, b, c]).expect("a tetrahedron is a cell");
        Table::try_new(cell, CASES.map(triangles).to_vec()).expect("cases fit together")
    };
    tetrahedra.map(table).collect()
}

fn triangles(case: Case) -> Vec<[u8; 3]> {
    match case {
        Empty => Vec::new(),
        Triangle(triangle) => vec![triangle],
        Quad([a, b, c, d]) => vec![[a, b, c], [d, c, b]],
    }
}

/// Two centres share the tetrahedra round the edge between them; the lower one has them, unless it lies outside.
pub(crate) fn belongs_to_an_earlier_cell(arrangement: Arrangement, spoke: &Spoke, cell: [usize; 3]) -> bool {
    let offset = arrangement.directions().offsets[spoke.direction as usize];
    (0..3).any(|axis| offset[axis] < 0 && cell[axis] > 0)
}

impl Spoke {
    /// All tetrahedra round the edge that leaves the base point in `direction`.
    pub(crate) fn new(directions: &Directions, direction: u8) -> Self {
        let ring = directions.links[direction as usize];
        let follows = |a: u8, b: u8| {
            directions.links[a as usize] >> b & 1 == 1 && turn(directions, [direction, a, b]) > 0
        };
        let first = ring.trailing_zeros() as u8;
        let mut tetrahedra = Vec::new();
        let mut corner = first;
        loop {
            let next = members(ring)
                .map(|d| d as u8)
                .find(|&next| follows(corner, next))
                .expect("the ring round a lattice edge closes");
            tetrahedra.push(Tetrahedron::new(directions, [direction, corner, next]));
            corner = next;
            if corner == first {
                return Self { direction, ring: tetrahedra };
            }
        }
    }
}

impl Tetrahedron {
    fn new(directions: &Directions, corners: [u8; 3]) -> Self {
        let edges = EDGES.map(|(from, to)| {
            let end = corners[to as usize - 1];
            let direction = match from {
                0 => end,
                _ => directions
                    .between(corners[from as usize - 1], end)
                    .expect("corners of a tetrahedron are lattice neighbours"),
            };
            let back = directions.opposite[direction as usize];
            if directions.is_forward(direction) {
                TetrahedronEdge { from, to, direction, back }
            } else {
                TetrahedronEdge { from: to, to: from, direction: back, back: direction }
            }
        });
        Self { corners, edges }
    }
}

/// Determinant of three offsets: positive when they turn counter-clockwise seen from their far ends.
fn turn(directions: &Directions, [a, b, c]: [u8; 3]) -> i32 {
    let [a, b, c] = [a, b, c].map(|d| directions.offsets[d as usize].map(i32::from));
    a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0])
        + a[2] * (b[0] * c[1] - b[1] * c[0])
}

/// The edges at the base point that tell whether the surface meets the cell: all of a centre's, and of a lowest
/// corner those to the cube's other seven corners.
pub(crate) fn deciding_edges(arrangement: Arrangement) -> DirectionSet {
    let offsets = &arrangement.directions().offsets;
    (0..offsets.len())
        .filter(|&d| arrangement == Arrangement::BodyCentred || offsets[d].iter().all(|&o| o >= 0))
        .fold(0, |set, d| set | 1 << d)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;
    use std::collections::BTreeSet;

    fn crossed(inside: usize) -> BTreeSet<u8> {
        let is_inside = |corner: u8| inside >> corner & 1;
        (0..6).filter(|&e| is_inside(EDGES[e as usize].0) != is_inside(EDGES[e as usize].1)).collect()
    }

    fn used(case: Case) -> Vec<u8> {
        match case {
            Empty => vec![],
            Triangle(edges) => edges.to_vec(),
            Quad(edges) => edges.to_vec(),
        }
    }

    fn faces(case: Case) -> Vec<[u8; 3]> {
        match case {
            Empty => vec![],
            Triangle(t) => vec![t],
            Quad([a, b, c, d]) => vec![[a, b, c], [d, c, b]],
        }
    }

    #[test]
    fn each_case_uses_its_crossed_edges_once() {
        for (inside, case) in CASES.into_iter().enumerate() {
            let edges = used(case);
            assert_eq!(edges.len(), crossed(inside).len(), "case {inside:04b}");
            assert_eq!(edges.into_iter().collect::<BTreeSet<_>>(), crossed(inside), "case {inside:04b}");
        }
    }

    #[test]
    fn complementary_cases_are_the_same_surface_turned_over() {
        /// The rim of the surface in the tetrahedron: directed sides without an opposite.
        fn rim(case: Case) -> BTreeSet<(u8, u8)> {
            let sides: BTreeSet<(u8, u8)> =
                faces(case).iter().flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)]).collect();
            sides.iter().copied().filter(|&(a, b)| !sides.contains(&(b, a))).collect()
        }
        for inside in 0..16 {
            let turned: BTreeSet<_> = rim(CASES[15 - inside]).into_iter().map(|(a, b)| (b, a)).collect();
            assert_eq!(rim(CASES[inside]), turned, "case {inside:04b}");
        }
    }

    #[test]
    fn triangles_face_outward_in_every_tetrahedron() {
        for arrangement in [Arrangement::BodyCentred, Arrangement::SimpleCubic] {
            let directions = arrangement.directions();
            let at = |d: u8| Vec3::from_array(directions.offsets[d as usize].map(f32::from));
            let spokes = match arrangement {
                Arrangement::BodyCentred => 0..6,
                _ => 12..13,
            };
            for tetrahedron in spokes.flat_map(|d| Spoke::new(directions, d).ring) {
                let [a, b, c] = tetrahedron.corners.map(at);
                assert!(a.cross(b).dot(c) > 0.0);
                let corners = [Vec3::ZERO, a, b, c];
                for (inside, case) in CASES.into_iter().enumerate().take(15).skip(1) {
                    let middle = |side: usize| {
                        let of_side: Vec<Vec3> =
                            (0..4).filter(|i| inside >> i & 1 == side).map(|i| corners[i]).collect();
                        of_side.iter().sum::<Vec3>() / of_side.len() as f32
                    };
                    let outward = middle(0) - middle(1);
                    for face in faces(case) {
                        let [p, q, r] = face.map(|e| {
                            let (from, to) = EDGES[e as usize];
                            corners[from as usize].midpoint(corners[to as usize])
                        });
                        assert!((q - p).cross(r - p).dot(outward) > 0.0, "{arrangement:?} case {inside:04b}");
                    }
                }
            }
        }
    }

    #[test]
    fn a_spoke_has_four_or_six_tetrahedra() {
        let body = Arrangement::BodyCentred.directions();
        assert!((0..6).all(|d| Spoke::new(body, d).ring.len() == 4));
        assert_eq!(Spoke::new(Arrangement::SimpleCubic.directions(), 12).ring.len(), 6);
    }

    #[test]
    fn edges_join_the_corners_they_name() {
        for arrangement in [Arrangement::BodyCentred, Arrangement::SimpleCubic] {
            let directions = arrangement.directions();
            let spoke = Spoke::new(directions, if arrangement == Arrangement::BodyCentred { 3 } else { 12 });
            for tetrahedron in spoke.ring {
                let offset = |corner: u8| match corner {
                    0 => [0; 3],
                    _ => directions.offsets[tetrahedron.corners[corner as usize - 1] as usize],
                };
                for edge in tetrahedron.edges {
                    let (from, to) = (offset(edge.from), offset(edge.to));
                    let along = [to[0] - from[0], to[1] - from[1], to[2] - from[2]];
                    assert_eq!(directions.offsets[edge.direction as usize], along);
                    assert_eq!(directions.opposite[edge.direction as usize], edge.back);
                    assert!(directions.is_forward(edge.direction));
                }
            }
        }
    }
}
