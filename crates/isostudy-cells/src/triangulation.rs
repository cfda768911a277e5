//! Polygons of crossed edges cut into triangles.

use crate::cell::Cell;

/// Cuts polygons of a cell's edges into triangles, by diagonals that lie in no face of the cell.
///
/// A diagonal in a face would be the neighbour's too, and an edge of four triangles if both drew it.
#[derive(Debug, Clone)]
pub struct Triangulator {
    faces_at_edge: Vec<u32>,
}

impl Triangulator {
    /// One for the polygons of a cell.
    pub fn new(cell: &Cell) -> Self {
        Self { faces_at_edge: cell.faces_at_edge().to_vec() }
    }

    /// Whether crossings of two edges have no face in common.
    pub fn may_join(&self, a: u8, b: u8) -> bool {
        self.faces_at_edge[usize::from(a)] & self.faces_at_edge[usize::from(b)] == 0
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
        let n = polygon.len();
        let may = |i: usize, j: usize| {
            j - i == 1 || (i == 0 && j == n - 1) || self.may_join(polygon[i], polygon[j])
        };
        let PolygonTriangles { triangles, best, parts } = found;
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
                            let sum = sum + cost([polygon[i], polygon[k], polygon[j]]);
                            if sum < least.0 {
                                least = (sum, k);
                            }
                        }
                    }
                }
                best[i * n + j] = least;
            }
        }
        if best[n - 1].0 == f64::INFINITY {
            return false;
        }
        parts.clear();
        parts.push([0, n - 1]);
        while let Some([i, j]) = parts.pop() {
            if j - i >= 2 {
                let k = best[i * n + j].1;
                triangles.push([polygon[i], polygon[k], polygon[j]]);
                parts.extend([[k, j], [i, k]]);
            }
        }
        true
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
