//! Polygons of crossed edges cut into triangles.

use crate::cell::Cell;

/// Cuts polygons of a cell's edges into triangles, by diagonals that lie in no face of the cell, nor along an edge that is divided.
///
/// A diagonal in a face would be the neighbour's too, and an edge of four triangles if both drew it. Along a divided edge it would be
/// that of the cell opposite.
#[derive(Debug, Clone)]
pub struct Triangulator {
    /// Of each edge, those that its crossing may be joined with, one bit each.
    partners: Vec<u64>,
}

impl Triangulator {
    /// One for the polygons of a cell.
    pub fn new(cell: &Cell) -> Self {
        let faces = cell.faces_at_edge();
        let place = |c: u8| cell.corners()[usize::from(c)];
        // Two halves of an edge have a corner in common, and their others are as far from it on either side.
        let are_in_line = |[a, b]: [u8; 2], [c, d]: [u8; 2]| {
            let [a, b, c, d] = [a, b, c, d].map(place);
            b == c && (0..3).all(|i| b[i] - a[i] == d[i] - c[i])
        };
        let within: Vec<bool> = (0..faces.len()).map(|e| cell.is_within_side(e)).collect();
        let may_join = |a: usize, b: usize| {
            let ends = [a, b].map(|e| cell.edges()[e]);
            let in_line = are_in_line(ends[0], ends[1]) || are_in_line(ends[1], ends[0]);
            (within[a] || !in_line) && faces[a] & faces[b] == 0
        };
        let edges = 0..faces.len();
        let partners = |a: usize| edges.clone().fold(0, |set, b| set | u64::from(may_join(a, b)) << b);
        Self { partners: edges.clone().map(partners).collect() }
    }

    /// Whether crossings of two edges have no face in common, and are of two edges.
    pub fn may_join(&self, a: u8, b: u8) -> bool {
        self.partners[usize::from(a)] >> b & 1 != 0
    }

    /// All triangles on one corner of the polygon, the first for which that can be. Where it can be for none, the first
    /// triangulation that there is. The triangles face where the polygon faces.
    pub fn fan(&self, polygon: &[u8]) -> Option<Vec<[u8; 3]>> {
        let n = polygon.len();
        let fan = |apex: usize| {
            let at = |i: usize| polygon[(apex + i) % n];
            let may = (2..n - 1).all(|i| self.may_join(at(0), at(i)));
            may.then(|| (1..n - 1).map(|i| [at(0), at(i), at(i + 1)]).collect())
        };
        (0..n).find_map(fan).or_else(|| self.cheapest(polygon, |_| 0.0))
    }

    /// The triangles with the least sum of costs; of several such, the one whose diagonals come first. `None` where a diagonal
    /// in a face cannot be avoided.
    pub fn cheapest(&self, polygon: &[u8], cost: impl FnMut([u8; 3]) -> f64) -> Option<Vec<[u8; 3]>> {
        let mut found = PolygonTriangles::default();
        self.find_cheapest(polygon, cost, &mut found).then_some(found.triangles)
    }

    /// The same into `found`, which is used again; `false` where there is none, and then `found` is empty.
    pub fn find_cheapest(
        &self,
        polygon: &[u8],
        mut cost: impl FnMut([u8; 3]) -> f64,
        found: &mut PolygonTriangles,
    ) -> bool {
        let of = |i: usize| polygon[i];
        let may_join = |i: usize, j: usize| self.may_join(of(i), of(j));
        let sum = found.find(polygon.len(), may_join, |triangle| cost(triangle.map(|i| of(usize::from(i)))));
        found.triangles.iter_mut().flatten().for_each(|corner| *corner = of(usize::from(*corner)));
        sum.is_some()
    }
}

/// The triangles that a polygon was cut into, and the room that it took to find them.
#[derive(Debug, Clone, Default)]
pub struct PolygonTriangles {
    triangles: Vec<[u8; 3]>,
    /// Of the part from one corner to another: its cost, and the third corner of the triangle on that side.
    best: Vec<(f64, usize)>,
    /// Parts that are not cut yet.
    parts: Vec<[usize; 2]>,
}

impl PolygonTriangles {
    /// Finds the triangles of a polygon of `n` corners with the least sum of costs, by diagonals that may be; of several such, those whose
    /// diagonals come first. Corners are numbered in order. The sum, or `None` where there are none.
    pub fn find(
        &mut self,
        n: usize,
        may_join: impl Fn(usize, usize) -> bool,
        mut cost: impl FnMut([u8; 3]) -> f64,
    ) -> Option<f64> {
        let may = |i: usize, j: usize| j - i == 1 || (i == 0 && j == n - 1) || may_join(i, j);
        let Self { triangles, best, parts } = self;
        triangles.clear();
        best.clear();
        best.resize(n * n, (0.0, 0));
        for width in 2..n {
            for i in 0..n - width {
                let j = i + width;
                let mut least = (f64::INFINITY, 0);
                if may(i, j) {
                    for k in i + 1..j {
                        let sum = best[i * n + k].0 + best[k * n + j].0;
                        if sum < least.0 {
                            let sum = sum + cost([i, k, j].map(|corner| corner as u8));
                            if sum < least.0 {
                                least = (sum, k);
                            }
                        }
                    }
                }
                best[i * n + j] = least;
            }
        }
        let sum = best[n - 1].0;
        if sum == f64::INFINITY {
            return None;
        }
        parts.clear();
        parts.push([0, n - 1]);
        while let Some([i, j]) = parts.pop() {
            if j - i >= 2 {
                let k = best[i * n + j].1;
                triangles.push([i, k, j].map(|corner| corner as u8));
                parts.extend([[k, j], [i, k]]);
            }
        }
        Some(sum)
    }

    /// They face where the polygon faces.
    pub fn triangles(&self) -> &[[u8; 3]] {
        &self.triangles
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_cheapest_is_that_of_all() {
        /// Every triangulation, by the triangle on the last side.
        fn all(polygon: &[u8]) -> Vec<Vec<[u8; 3]>> {
            let n = polygon.len();
            if n < 3 {
                return vec![vec![]];
            }
            let mut found = Vec::new();
            for k in 1..n - 1 {
                for left in all(&polygon[..=k]) {
                    for right in all(&polygon[k..]) {
                        let here = [[polygon[0], polygon[k], polygon[n - 1]]];
                        found.push([&here[..], &left, &right].concat());
                    }
                }
            }
            found
        }
        let cube = Cell::cube();
        let triangulator = Triangulator::new(&cube);
        let cost = |[a, b, c]: [u8; 3]| f64::from((7 * a as u32 + 5 * b as u32 + 3 * c as u32) % 11);
        for (inside, joined) in (0..256).flat_map(|inside| [(inside, 0), (inside, 63)]) {
            for polygon in cube.loops(inside, joined) {
                let is_side = |a: u8, b: u8| {
                    let n = polygon.len();
                    (0..n).any(|i| {
                        let side = [polygon[i], polygon[(i + 1) % n]];
                        side == [a, b] || side == [b, a]
                    })
                };
                let legal = |t: &[u8; 3]| {
                    (0..3)
                        .all(|i| is_side(t[i], t[(i + 1) % 3]) || triangulator.may_join(t[i], t[(i + 1) % 3]))
                };
                let least = all(&polygon)
                    .into_iter()
                    .filter(|triangles| triangles.iter().all(legal))
                    .map(|triangles| triangles.into_iter().map(cost).sum::<f64>())
                    .fold(f64::INFINITY, f64::min);
                let found = triangulator.cheapest(&polygon, cost);
                let sum = found.map_or(f64::INFINITY, |triangles| triangles.into_iter().map(cost).sum());
                assert_eq!(sum, least, "{polygon:?}");
            }
        }
    }
}
