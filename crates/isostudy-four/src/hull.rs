//! The hull rule in any number of dimensions: which facets of a convex hull are surface.

use crate::cube::{Cube, doubled};

/// The facets of the convex hull of all inside corners and all middles of crossed edges, but for those in a facet of the cube. Each is
/// the set of edges whose middles are its vertices, one bit each; in order.
///
/// At an inside corner the hull is the cube, so no inside corner is a vertex of such a facet. Each middle is a vertex of the hull: the
/// hull has half of its edge.
pub(crate) fn patch_facets<const D: usize>(cube: &Cube<D>, inside: u32) -> Vec<u32> {
    let crossed = cube.crossed(inside);
    let mut search = Search {
        cube,
        sides: (0..2 * D).map(|side| cube.facet(side >> 1, side & 1)).collect(),
        corners: (0..Cube::<D>::CORNERS as u8).filter(|c| inside >> c & 1 != 0).map(doubled).collect(),
        edges: (0..cube.edges().len() as u8).filter(|e| crossed >> e & 1 != 0).collect(),
        found: Vec::new(),
    };
    search.choose(0, &mut Vec::new());
    search.found.sort_unstable();
    search.found
}

struct Search<'a, const D: usize> {
    cube: &'a Cube<D>,
    /// The edges in each facet of the cube.
    sides: Vec<u32>,
    corners: Vec<[i32; D]>,
    edges: Vec<u8>,
    found: Vec<u32>,
}

impl<const D: usize> Search<'_, D> {
    /// Tries the plane through each `D` of the middles.
    fn choose(&mut self, from: usize, chosen: &mut Vec<u8>) {
        if chosen.len() == D {
            return self.try_plane(chosen);
        }
        for next in from..self.edges.len() {
            chosen.push(self.edges[next]);
            self.choose(next + 1, chosen);
            chosen.pop();
        }
    }

    fn try_plane(&mut self, chosen: &[u8]) {
        let set = chosen.iter().fold(0u32, |set, e| set | 1 << e);
        if self.sides.iter().chain(&self.found).any(|facet| facet & set == set) {
            return;
        }
        let at = |e: u8| self.cube.edges()[usize::from(e)].middle;
        let origin = at(chosen[0]);
        let rows: Vec<[i32; D]> = chosen[1..].iter().map(|&e| minus(at(e), origin)).collect();
        let normal: [i32; D] = std::array::from_fn(|column| {
            let sign = if column % 2 == 0 { 1 } else { -1 };
            sign * minor(&rows, !(1 << column))
        });
        if normal == [0; D] {
            return;
        }
        let side = |point: [i32; D]| {
            minus(point, origin).iter().zip(normal).map(|(a, b)| a * b).sum::<i32>().signum()
        };
        let mut inner = 0;
        let mut members = 0;
        for &corner in &self.corners {
            match side(corner) {
                // No inside corner is on a facet that is surface.
                0 => return,
                side if inner == -side => return,
                side => inner = side,
            }
        }
        for &e in &self.edges {
            match side(at(e)) {
                0 => members |= 1 << e,
                side if side != inner => return,
                _ => {}
            }
        }
        self.found.push(members);
    }
}

pub(crate) fn minus<const D: usize>(a: [i32; D], b: [i32; D]) -> [i32; D] {
    std::array::from_fn(|i| a[i] - b[i])
}

/// The determinant of the columns in a set, as many as there are rows.
pub(crate) fn minor<const D: usize>(rows: &[[i32; D]], columns: u32) -> i32 {
    let Some((first, rest)) = rows.split_first() else { return 1 };
    let mut sum = 0;
    let mut sign = 1;
    for column in (0..D).filter(|column| columns >> column & 1 != 0) {
        if first[column] != 0 {
            sum += sign * first[column] * minor(rest, columns & !(1 << column));
        }
        sign = -sign;
    }
    sum
}
