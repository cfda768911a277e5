//! How a cube is cut, and the lattice edges that come of it.

use std::sync::OnceLock;

use crate::lattice::Arrangement;
use crate::lattice::tetrahedra::EDGES;

/// A place or a step on the grid of stored points.
pub(super) type Step = [i8; 3];

/// A set of directions of a [`Cut`], one bit each.
pub(super) type Directions = u32;

/// A way to cut every cube of a lattice into tetrahedra, so that neighbours agree on their common face.
#[derive(Debug)]
pub(super) struct Cut {
    /// Stored points along a cube's edge, less one.
    pub(super) steps_a_cell: usize,
    /// The points of a cube that its tetrahedra use, from its lowest corner.
    pub(super) corners: Vec<Step>,
    /// Those of them, by number, of which one has a crossing where the cube has: every edge of the cube has an end
    /// there, or else their edges in the cube lead to all its points and to no other cube's.
    pub(super) telling: Vec<usize>,
    /// The tetrahedra of a cube whose indices have an even sum, and of one with an odd sum.
    pub(super) tetrahedra: [Vec<CutTetrahedron>; 2],
    /// From a point to its neighbours. In order of storage, so that the first half leads back.
    pub(super) steps: Vec<Step>,
    /// By class of point, the directions in which a lattice edge can leave it.
    pub(super) edges_of: [Directions; 8],
}

/// Corners as places in the cube, turning as [`crate::lattice::tetrahedra::CASES`] wants them.
#[derive(Debug)]
pub(super) struct CutTetrahedron {
    pub(super) corners: [Step; 4],
    /// In the order of [`EDGES`], each from the end that is stored first.
    pub(super) edges: [CutEdge; 6],
}

/// The corners that an edge joins, and the way there and back.
#[derive(Debug, Clone, Copy)]
pub(super) struct CutEdge {
    pub(super) from: u8,
    pub(super) to: u8,
    pub(super) direction: u8,
    pub(super) back: u8,
}

impl Cut {
    /// The cut of an arrangement.
    ///
    /// # Panics
    /// If the arrangement is uniform: its tetrahedra stand round edges and not in cubes.
    pub(super) fn get(arrangement: Arrangement) -> &'static Self {
        static CUTS: [OnceLock<Cut>; 2] = [const { OnceLock::new() }; 2];
        CUTS[usize::from(arrangement == Arrangement::FaceCentred)].get_or_init(|| Self::of(arrangement))
    }

    /// The same, made anew.
    pub(super) fn of(arrangement: Arrangement) -> Self {
        match arrangement {
            Arrangement::FiveTetrahedra => Self::new(1, [0, 1].map(five)),
            Arrangement::FaceCentred => Self::new(2, [(); 2].map(|()| twenty_four())),
            Arrangement::BodyCentred | Arrangement::SimpleCubic => {
                panic!("{arrangement:?} is not cut cube by cube")
            }
        }
    }

    fn new(steps_a_cell: usize, corners: [Vec<[Step; 4]>; 2]) -> Self {
        let mut steps: Vec<Step> = Vec::new();
        for tetrahedron in corners.iter().flatten() {
            for (from, to) in EDGES {
                let step = minus(tetrahedron[usize::from(to)], tetrahedron[usize::from(from)]);
                steps.extend([step, minus([0; 3], step)]);
            }
        }
        steps.sort_unstable_by_key(|&[x, y, z]| (z, y, x));
        steps.dedup();
        let mut cut = Self {
            steps_a_cell,
            corners: Vec::new(),
            telling: Vec::new(),
            tetrahedra: [vec![], vec![]],
            steps,
            edges_of: [0; 8],
        };
        for (parity, corners) in corners.into_iter().enumerate() {
            cut.corners.extend(corners.iter().flatten());
            cut.tetrahedra[parity] = corners.into_iter().map(|corners| cut.tetrahedron(corners)).collect();
            // Where a cube of this parity lies.
            let lowest = [parity, 0, 0].map(|i| i * steps_a_cell);
            for t in 0..cut.tetrahedra[parity].len() {
                let tetrahedron = &cut.tetrahedra[parity][t];
                let edges = tetrahedron.edges;
                let classes = tetrahedron.corners.map(|corner| {
                    cut.class([0, 1, 2].map(|axis| (lowest[axis] + corner[axis] as usize) as i64))
                });
                for edge in edges {
                    cut.edges_of[classes[usize::from(edge.from)]] |= 1 << edge.direction;
                    cut.edges_of[classes[usize::from(edge.to)]] |= 1 << edge.back;
                }
            }
        }
        cut.corners.sort_unstable();
        cut.corners.dedup();
        cut.telling = match cut.corners.iter().position(|&corner| corner == [1; 3]) {
            // The centre of a cube of two steps.
            Some(centre) if steps_a_cell == 2 => vec![centre],
            _ => (0..cut.corners.len()).collect(),
        };
        cut
    }

    fn tetrahedron(&self, mut corners: [Step; 4]) -> CutTetrahedron {
        if turn(corners) < 0 {
            corners.swap(2, 3);
        }
        let edges = EDGES.map(|(from, to)| {
            let step = minus(corners[usize::from(to)], corners[usize::from(from)]);
            let [direction, back] = [step, minus([0; 3], step)].map(|step| self.direction(step));
            if direction > back {
                CutEdge { from, to, direction, back }
            } else {
                CutEdge { from: to, to: from, direction: back, back: direction }
            }
        });
        CutTetrahedron { corners, edges }
    }

    fn direction(&self, step: Step) -> u8 {
        self.steps.iter().position(|&s| s == step).expect("a step along a lattice edge") as u8
    }

    /// Points of one class have the same lattice edges, unless the lattice ends there. From its place in the whole
    /// lattice: with one step a cube the parity of all indices together, with two that of each.
    pub(super) fn class(&self, [x, y, z]: [i64; 3]) -> usize {
        let odd = |i: i64| i.rem_euclid(2) as usize;
        match self.steps_a_cell {
            1 => odd(x + y + z),
            _ => odd(x) + 2 * odd(y) + 4 * odd(z),
        }
    }
}

/// A tetrahedron on the four corners with an even sum of indices, then one at each other corner. `parity` is that of
/// the cube's lowest corner.
fn five(parity: i8) -> Vec<[Step; 4]> {
    let corners = (0..8i8).map(|i| [i & 1, i >> 1 & 1, i >> 2]);
    let (even, odd): (Vec<Step>, Vec<Step>) =
        corners.partition(|corner| (corner.iter().sum::<i8>() + parity) % 2 == 0);
    let at = |[x, y, z]: Step| [[x, y, z], [1 - x, y, z], [x, 1 - y, z], [x, y, 1 - z]];
    std::iter::once([even[0], even[1], even[2], even[3]]).chain(odd.into_iter().map(at)).collect()
}

/// Four tetrahedra on each face, all on the cube's centre.
fn twenty_four() -> Vec<[Step; 4]> {
    let mut all = Vec::new();
    for (axis, side) in (0..3).flat_map(|axis| [0, 2].map(|side| (axis, side))) {
        let on_face = |u: i8, v: i8| {
            let mut place = [side; 3];
            place[(axis + 1) % 3] = u;
            place[(axis + 2) % 3] = v;
            place
        };
        let round = [on_face(0, 0), on_face(2, 0), on_face(2, 2), on_face(0, 2)];
        all.extend((0..4).map(|k| [[1; 3], on_face(1, 1), round[k], round[(k + 1) % 4]]));
    }
    all
}

fn minus(a: Step, b: Step) -> Step {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// Six times the volume, positive when the last three corners turn counter-clockwise seen from beyond them.
pub(super) fn turn([o, a, b, c]: [Step; 4]) -> i32 {
    let [a, b, c] = [a, b, c].map(|corner| minus(corner, o).map(i32::from));
    a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0])
        + a[2] * (b[0] * c[1] - b[1] * c[0])
}
