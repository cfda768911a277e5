//! The triangles of a transition cell: of 512 patterns of signs and what ambiguous squares join, derived by the rules of [`isostudy_cells`].

use std::collections::HashMap;
use std::ops::Range;
use std::sync::OnceLock;

use isostudy_cells::{Cell, Triangulator, radius_ratio};

/// Squares with a choice: four fine ones, then the coarse one.
pub(super) const SQUARES: usize = 5;
/// The fine points at the corners of each square in order round it.
pub(super) const CORNERS: [[u8; 4]; SQUARES] =
    [[0, 1, 4, 3], [1, 2, 5, 4], [3, 4, 7, 6], [4, 5, 8, 7], [0, 2, 8, 6]];

/// What an edge of a transition cell is an edge of. Points are in steps of the fine grid.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Edge {
    /// The fine grid.
    Fine {
        /// Where it begins.
        from: [u8; 2],
        /// 0 or 1.
        along: u8,
    },
    /// The coarse grid.
    Coarse {
        /// Where it begins.
        from: [u8; 2],
        /// 0 or 1.
        along: u8,
    },
    /// Neither: it leads from one to the other and is never crossed.
    Between,
}

/// The triangles of all patterns.
pub(super) struct Patterns {
    edges: Vec<Edge>,
    triangles: Vec<[u8; 3]>,
    /// By fine corners inside and joined squares, one bit each.
    ranges: HashMap<(u16, u8), Range<usize>>,
    ambiguous: Vec<u8>,
}

impl Patterns {
    /// Made when they are first asked for.
    pub(super) fn get() -> &'static Self {
        static PATTERNS: OnceLock<Patterns> = OnceLock::new();
        PATTERNS.get_or_init(Self::new)
    }

    fn new() -> Self {
        let cell = Cell::transition();
        let triangulator = Triangulator::new(&cell);
        let edge = |&[low, high]: &[u8; 2]| {
            let [a, b] = [low, high].map(|c| cell.corners()[usize::from(c)]);
            let (from, along) = ([a[0] as u8, a[1] as u8], u8::from(a[1] != b[1]));
            match (a[2], b[2]) {
                (0, 0) => Edge::Fine { from, along },
                (1, 1) => Edge::Coarse { from, along },
                _ => Edge::Between,
            }
        };
        let mut made = Self {
            edges: cell.edges().iter().map(edge).collect(),
            triangles: Vec::new(),
            ranges: HashMap::new(),
            ambiguous: Vec::new(),
        };
        for fine in 0..512u16 {
            let coarse = [0, 2, 6, 8].into_iter().enumerate();
            let inside =
                coarse.fold(u32::from(fine), |set, (c, of)| set | u32::from(fine >> of & 1) << (9 + c));
            let ambiguous = cell.ambiguous_faces(inside) as u8;
            made.ambiguous.push(ambiguous);
            for joined in (0..1 << SQUARES).filter(|joined| joined & !ambiguous == 0) {
                let start = made.triangles.len();
                for polygon in cell.loops(inside, joined.into()) {
                    let best = triangulator.cheapest(&polygon, |triangle| cost(&cell, triangle));
                    made.triangles.extend(best.expect("isostudy-cells/tests/it/transition.rs tries all"));
                }
                made.ranges.insert((fine, joined), start..made.triangles.len());
            }
        }
        made
    }

    /// The squares that have a choice, one bit each.
    pub(super) fn ambiguous(&self, inside: u16) -> u8 {
        self.ambiguous[usize::from(inside)]
    }

    /// The triangles of fine corners inside, 3 by 3 of them, and joined squares, all of which are ambiguous. Seen from outside
    /// they run counter-clockwise, if the coarse square is where x cross y leads.
    pub(super) fn triangles(&self, inside: u16, joined: u8) -> impl Iterator<Item = [Edge; 3]> {
        let range = self.ranges.get(&(inside, joined)).cloned().unwrap_or_default();
        self.triangles[range].iter().map(|triangle| triangle.map(|edge| self.edges[usize::from(edge)]))
    }
}

/// First of all a triangle does not lie in the fine squares: such a one stands square on a surface that is anything but parallel to them.
/// Then it is well shaped where crossings are in the middles of their edges.
fn cost(cell: &Cell, triangle: [u8; 3]) -> f64 {
    let corners =
        triangle.map(|edge| cell.edges()[usize::from(edge)].map(|c| cell.corners()[usize::from(c)]));
    let is_flat = corners.iter().flatten().all(|corner| corner[2] == 0);
    let middle = |[a, b]: [[i32; 3]; 2]| [0, 1, 2].map(|axis| 0.5 * f64::from(a[axis] + b[axis]));
    (if is_flat { 100.0 } else { 0.0 }) + 1.0 - radius_ratio(corners.map(middle))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn squares_have_their_corners_in_order() {
        let cell = Cell::transition();
        for (face, corners) in CORNERS.iter().enumerate() {
            let places: Vec<[i32; 2]> =
                corners.iter().map(|&c| [i32::from(c % 3), i32::from(c / 3)]).collect();
            let of_face: Vec<[i32; 2]> = cell.faces()[face]
                .iter()
                .map(|&c| cell.corners()[usize::from(c)])
                .map(|[x, y, _]| [x, y])
                .collect();
            let rotations = (0..4).flat_map(|i| {
                let mut round = of_face.clone();
                round.rotate_left(i);
                let back = round.iter().rev().copied().collect();
                [round, back]
            });
            assert!(rotations.into_iter().any(|round| round == places), "{face}");
        }
    }

    #[test]
    fn a_triangle_never_has_an_edge_between() {
        let patterns = Patterns::get();
        for inside in 0..512 {
            let ambiguous = patterns.ambiguous(inside);
            for joined in (0..1 << SQUARES).filter(|joined| joined & !ambiguous == 0) {
                assert!(patterns.triangles(inside, joined).flatten().all(|edge| edge != Edge::Between));
                assert_eq!(patterns.triangles(inside, joined).next().is_none(), matches!(inside, 0 | 511));
            }
        }
    }
}
