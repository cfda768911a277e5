//! Vertices and triangles of the cubes that were visited.

use std::collections::TryReserveError;

use glam::Vec3;

use super::Map;
use super::corners::Corners;
use super::seeds::ContinuedCells;
use super::visit::Visited;
use crate::cubes::Rule;
use crate::cubes::grid::CubeGrid;
use crate::cubes::patches::{Patch, Patches};
use crate::cubes::tubes::INNER;
use crate::cubes::vertices::{Placer, corner_of};
use crate::lattice::tetrahedra::{CASES, Case, EDGES};
use crate::memory::push;

/// The six tetrahedra of a cube, corners `x + 2 y + 4 z`: Bloomenthal's (1994). With `e1, e2, e3` from the first to the others,
/// `det(e1, e2, e3) > 0`.
const TETRAHEDRA: [[u8; 4]; 6] =
    [[0, 1, 2, 4], [3, 2, 1, 4], [3, 2, 4, 6], [3, 1, 5, 4], [3, 4, 5, 6], [3, 6, 5, 7]];

/// The end at which an edge begins, by the axes that it goes along as bits: a corner of the least box round it. The other end is the corner
/// across. Of the diagonals of a face the tetrahedra have one.
const BEGIN: [u8; 8] = [0, 0, 0, 1, 0, 1, 2, 3];

/// Codes of what a vertex lies on, below the 16 that a point has: an edge, by its axes; from here on, nothing but its cell.
const IN_CELL: u64 = 8;
const CODES: u64 = 16;

/// What vertices and triangles are made of.
pub(super) struct Surface<'a> {
    grid: &'a CubeGrid<'a>,
    corners: &'a Corners<'a>,
    placer: &'a Placer<'a>,
    rule: Rule,
    patches: &'a Patches,
    kind: ContinuedCells,
    cells: &'a [Visited],
}

/// The vertices, in storage order of the points that they are named after.
pub(super) struct Numbered {
    keys: Vec<u64>,
    numbers: Map<u32>,
}

impl<'a> Surface<'a> {
    pub(super) fn new(
        grid: &'a CubeGrid<'a>,
        corners: &'a Corners<'a>,
        placer: &'a Placer<'a>,
        rule: Rule,
        kind: ContinuedCells,
        cells: &'a [Visited],
    ) -> Self {
        Self { grid, corners, placer, rule, patches: Patches::get(rule), kind, cells }
    }

    /// Numbers the vertices of all cells.
    pub(super) fn numbered(&self) -> Result<Numbered, TryReserveError> {
        let mut keys = Vec::new();
        for &cell in self.cells {
            let mut result = Ok(());
            self.for_each_key(cell, |key| {
                if result.is_ok() {
                    result = push(&mut keys, key);
                }
            });
            result?;
        }
        keys.sort_unstable();
        keys.dedup();
        let mut numbers = Map::default();
        numbers.try_reserve(keys.len())?;
        numbers.extend(keys.iter().enumerate().map(|(number, &key)| (key, number as u32)));
        Ok(Numbered { keys, numbers })
    }

    /// The vertices of a cell, by what they lie on.
    fn for_each_key(&self, cell: Visited, mut visit: impl FnMut(u64)) {
        let place = self.corners.place(cell.number);
        match self.kind {
            ContinuedCells::Cubes => {
                let patch = self.patch(cell, place);
                let inner = 0..patch.inner.len() as u8;
                let vertices = patch.crossed.iter().copied().chain(inner.map(|v| INNER + v));
                vertices.for_each(|vertex| visit(self.key(place, vertex)));
            }
            ContinuedCells::Tetrahedra => {
                for corners in &TETRAHEDRA {
                    for &(from, to) in &EDGES {
                        let [a, b] = [from, to].map(|c| corners[usize::from(c)]);
                        if (cell.inside >> a ^ cell.inside >> b) & 1 != 0 {
                            visit(self.key_of_edge(place, a, b));
                        }
                    }
                }
            }
        }
    }

    fn patch(&self, cell: Visited, place: [usize; 3]) -> &'a Patch {
        let values = || std::array::from_fn(|c| self.corners.value(corner_of(place, c as u8)));
        let isovalue = self.corners.isovalue;
        self.patches.at(self.patches.choose(self.rule.faces, cell.inside, isovalue, values))
    }

    /// The key of a patch's vertex.
    fn key(&self, cell: [usize; 3], vertex: u8) -> u64 {
        match vertex.checked_sub(INNER) {
            Some(inner) => CODES * self.corners.number(cell) + IN_CELL + u64::from(inner),
            None => {
                let (corner, axis) = self.patches.edge(vertex);
                self.key_of_edge(cell, corner, corner | 1 << axis)
            }
        }
    }

    /// The key of the edge between two corners of a cell: the least point of the box round it, and its axes.
    fn key_of_edge(&self, cell: [usize; 3], a: u8, b: u8) -> u64 {
        CODES * self.corners.number(corner_of(cell, a & b)) + u64::from(a ^ b)
    }

    fn position(&self, key: u64) -> Vec3 {
        let (place, code) = (self.corners.place(key / CODES), key % CODES);
        match code.checked_sub(IN_CELL) {
            Some(inner) => {
                let number = self.corners.number(place);
                let found = self.cells.binary_search_by_key(&number, |cell| cell.number);
                let cell = self.cells[found.expect("vertices are named after visited cells")];
                let edges = &self.patch(cell, place).inner[inner as usize];
                let mut sum = Vec3::ZERO;
                for &edge in edges {
                    let (corner, axis) = self.patches.edge(edge);
                    sum += self.crossing(corner_of(place, corner), 1 << axis);
                }
                sum / edges.len() as f32
            }
            None => self.crossing(place, code as u8),
        }
    }

    /// The crossing of the edge in the box at a place that goes along some axes.
    fn crossing(&self, place: [usize; 3], axes: u8) -> Vec3 {
        let [from, to] =
            [BEGIN[usize::from(axes)], BEGIN[usize::from(axes)] ^ axes].map(|c| corner_of(place, c));
        let values = [from, to].map(|place| self.corners.value(place));
        match axes {
            1 | 2 | 4 => self.placer.position(self.grid, from, axes.trailing_zeros() as usize, values),
            _ => self.placer.position_between(self.grid.position(from), self.grid.position(to), values),
        }
    }
}

impl Numbered {
    /// How many vertices there are.
    pub(super) fn len(&self) -> usize {
        self.keys.len()
    }

    /// How many of them lie on lattice edges.
    pub(super) fn crossings(&self) -> u64 {
        self.keys.iter().filter(|&key| key % CODES < IN_CELL).count() as u64
    }

    pub(super) fn positions(&self, surface: &Surface) -> Result<Vec<Vec3>, TryReserveError> {
        crate::memory::collected(self.keys.iter().map(|&key| surface.position(key)))
    }

    /// Cell by cell.
    pub(super) fn triangles(&self, surface: &Surface) -> Result<Vec<[u32; 3]>, TryReserveError> {
        let mut triangles = Vec::new();
        for &cell in surface.cells {
            let place = surface.corners.place(cell.number);
            match surface.kind {
                ContinuedCells::Cubes => {
                    let patch = surface.patch(cell, place);
                    triangles.try_reserve(patch.triangles.len())?;
                    let number = |vertex: u8| self.numbers[&surface.key(place, vertex)];
                    triangles.extend(patch.triangles.iter().map(|triangle| triangle.map(number)));
                }
                ContinuedCells::Tetrahedra => {
                    triangles.try_reserve(2 * TETRAHEDRA.len())?;
                    for corners in &TETRAHEDRA {
                        let is_inside = |c: usize| usize::from(cell.inside >> corners[c] & 1);
                        let case = (0..4).fold(0, |case, c| case | is_inside(c) << c);
                        let number = |edge: u8| {
                            let (from, to) = EDGES[usize::from(edge)];
                            let [a, b] = [from, to].map(|c| corners[usize::from(c)]);
                            self.numbers[&surface.key_of_edge(place, a, b)]
                        };
                        match CASES[case] {
                            Case::Empty => {}
                            Case::Triangle(edges) => triangles.push(edges.map(number)),
                            Case::Quad(edges) => {
                                let [a, b, c, d] = edges.map(number);
                                triangles.extend([[a, b, c], [d, c, b]]);
                            }
                        }
                    }
                }
            }
        }
        Ok(triangles)
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;
    use glam::DVec3;

    fn point(corner: u8) -> DVec3 {
        DVec3::new(f64::from(corner & 1), f64::from(corner >> 1 & 1), f64::from(corner >> 2))
    }

    /// They fill the cube, are turned one way, and cut opposite faces along one diagonal.
    #[test]
    fn six_tetrahedra_fill_the_cube_and_fit_to_those_beside() {
        let mut volume = 0.0;
        // Of each face of a tetrahedron, how often it is there; those of the cube moved to its lower side.
        let mut faces: BTreeMap<Vec<u8>, usize> = BTreeMap::new();
        for corners in TETRAHEDRA {
            let [a, b, c, d] = corners.map(point);
            let determinant = (b - a).dot((c - a).cross(d - a));
            assert!(determinant > 0.0, "{corners:?}");
            volume += determinant / 6.0;
            for left_out in 0..4 {
                let mut face: Vec<u8> = (0..4).filter(|&k| k != left_out).map(|k| corners[k]).collect();
                for axis in 0..3 {
                    if face.iter().all(|corner| corner >> axis & 1 != 0) {
                        face.iter_mut().for_each(|corner| *corner &= !(1 << axis));
                    }
                }
                face.sort_unstable();
                *faces.entry(face).or_default() += 1;
            }
        }
        assert!((volume - 1.0).abs() < 1e-12);
        assert!(faces.values().all(|&count| count == 2), "{faces:?}");
    }

    #[test]
    fn an_edge_begins_at_one_end_in_every_tetrahedron() {
        for corners in TETRAHEDRA {
            for (from, to) in EDGES {
                let [a, b] = [from, to].map(|c| corners[usize::from(c)]);
                // As corners of the least box round the edge.
                let ends = [a, b].map(|c| c & (a ^ b));
                assert!(ends.contains(&BEGIN[usize::from(a ^ b)]), "{a} {b}");
            }
        }
    }
}
