//! Marching tetrahedra over a grid.
//!
//! Each tetrahedron has 16 patterns of points inside and outside; 14 of them have one triangle or two. There is a vertex per crossed edge,
//! where the value that is interpolated along it is the isovalue. So the surface is that of the linear interpolant, to rounding
//! (Doi and Koide, *An Efficient Method of Triangulating Equi-Valued Surfaces by Using Tetrahedral Cells*, IEICE 1991).

use glam::DVec3;
use isostudy_mesh::TriangleMesh;
use isostudy_mesh::normals::area_weighted_normals;

use crate::grid::Grid;

/// A surface, and where its vertices lie on the grid.
#[derive(Debug, Clone, PartialEq)]
pub struct Surface {
    /// The triangles. They face the lower values.
    pub mesh: TriangleMesh,
    /// The crossing that each vertex is.
    pub crossings: Vec<Crossing>,
    /// Tetrahedra that the surface goes through.
    pub crossed_tetrahedra: u64,
}

/// Where a surface crosses an edge of the grid.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Crossing {
    /// The points of the edge, the smaller number first.
    pub ends: [u32; 2],
    /// How far from the first towards the second, from 0 to 1.
    pub share: f64,
}

/// Of a pattern of points inside, an even order of the four in which those inside come first, or the one outside does.
const ORDERS: [[usize; 4]; 16] = [
    [0, 1, 2, 3],
    [0, 1, 2, 3],
    [1, 0, 3, 2],
    [0, 1, 2, 3],
    [2, 3, 0, 1],
    [0, 2, 3, 1],
    [1, 2, 0, 3],
    [3, 2, 1, 0],
    [3, 2, 1, 0],
    [0, 3, 1, 2],
    [1, 3, 2, 0],
    [2, 3, 0, 1],
    [2, 3, 0, 1],
    [1, 0, 3, 2],
    [0, 1, 2, 3],
    [0, 1, 2, 3],
];

/// On which side of the isovalue a point is.
const INSIDE: u8 = 1;
/// A bit that no sum of sides reaches otherwise.
const NO_VALUE: u8 = 1 << 4;

impl Grid {
    /// The surface at an isovalue: inside is above. Vertices come in the order of the tetrahedra that have them first.
    pub fn extract(&self, isovalue: f64) -> Surface {
        let sides: Vec<u8> = self.values().iter().map(|&value| side(value, isovalue)).collect();
        let pattern = |of: &[u32; 4]| {
            let [a, b, c, d] = of.map(|point| sides[point as usize]);
            (a | b << 1 | c << 2 | d << 3, (a | b | c | d) & NO_VALUE)
        };
        let mut crossed: Vec<(u32, u8)> = Vec::new();
        for (number, of) in self.tetrahedra().iter().enumerate() {
            let (pattern, no_value) = pattern(of);
            if no_value == 0 && pattern != 0 && pattern != 15 {
                crossed.push((number as u32, pattern));
            }
        }
        let mut passes = Passes {
            grid: self,
            isovalue,
            edges: Edges::for_crossed(crossed.len()),
            places: Vec::new(),
            crossings: Vec::new(),
            triangles: Vec::with_capacity(crossed.len() * 3 / 2),
        };
        for &(number, pattern) in &crossed {
            passes.tetrahedron(self.tetrahedra()[number as usize], pattern);
        }
        let Passes { places, crossings, triangles, .. } = passes;
        let positions: Vec<_> = places.iter().map(|place| place.as_vec3()).collect();
        let mut normals = area_weighted_normals(&positions, &triangles);
        // A vertex whose triangles have no area points anywhere.
        normals.iter_mut().filter(|normal| !normal.is_finite()).for_each(|normal| *normal = glam::Vec3::Z);
        let mesh = TriangleMesh { positions, normals, triangles };
        Surface { mesh, crossings, crossed_tetrahedra: crossed.len() as u64 }
    }
}

fn side(value: f64, isovalue: f64) -> u8 {
    match value {
        value if !value.is_finite() => NO_VALUE,
        value if value > isovalue => INSIDE,
        _ => 0,
    }
}

/// What grows while tetrahedra are visited.
struct Passes<'a> {
    grid: &'a Grid,
    isovalue: f64,
    edges: Edges,
    places: Vec<DVec3>,
    crossings: Vec<Crossing>,
    triangles: Vec<[u32; 3]>,
}

impl Passes<'_> {
    fn tetrahedron(&mut self, of: [u32; 4], pattern: u8) {
        let [a, b, c, d] = ORDERS[pattern as usize].map(|i| of[i]);
        match pattern.count_ones() {
            // One point inside: the triangle is seen from the other three.
            1 => {
                let corners = [[a, b], [a, c], [a, d]].map(|ends| self.vertex(ends));
                self.triangles.push(corners);
            }
            3 => {
                let corners = [[a, b], [a, d], [a, c]].map(|ends| self.vertex(ends));
                self.triangles.push(corners);
            }
            _ => {
                let quad = [[a, c], [a, d], [b, d], [b, c]].map(|ends| self.vertex(ends));
                let across = |i: usize| {
                    let [p, q] = [quad[i], quad[i + 2]].map(|vertex| self.places[vertex as usize]);
                    p.distance_squared(q)
                };
                let [p, q, r, s] = quad;
                // The shorter diagonal makes the rounder triangles.
                if across(0) <= across(1) {
                    self.triangles.extend([[p, q, r], [p, r, s]]);
                } else {
                    self.triangles.extend([[p, q, s], [q, r, s]]);
                }
            }
        }
    }

    /// The vertex on an edge, made when it is first asked for.
    fn vertex(&mut self, [a, b]: [u32; 2]) -> u32 {
        let ends = [a.min(b), a.max(b)];
        let next = self.places.len() as u32;
        let vertex = self.edges.get_or_insert(ends, next);
        if vertex == next {
            let [from, to] = ends.map(|point| self.grid.values()[point as usize]);
            let [start, end] = ends.map(|point| self.grid.point(point));
            let share = share(from, to, self.isovalue);
            self.places.push(start + share * (end - start));
            self.crossings.push(Crossing { ends, share });
        }
        vertex
    }
}

/// Where between two values, one of them above the isovalue and the other not, the isovalue is.
fn share(from: f64, to: f64, isovalue: f64) -> f64 {
    let span = to - from;
    let share = match span.is_finite() {
        true => (isovalue - from) / span,
        // Values at both ends of double precision.
        false => (0.5 * isovalue - 0.5 * from) / (0.5 * to - 0.5 * from),
    };
    share.clamp(0.0, 1.0)
}

/// From edges to vertices: a table with open addressing, of which the standard one takes three times the time.
struct Edges {
    slots: Vec<(u64, u32)>,
    used: usize,
}

/// No edge: its ends would be one point.
const EMPTY: u64 = u64::MAX;

impl Edges {
    /// A table for the edges of so many tetrahedra. A closed surface has about two thirds of a vertex in each.
    fn for_crossed(tetrahedra: usize) -> Self {
        Self { slots: vec![(EMPTY, 0); (2 * tetrahedra).next_power_of_two().max(16)], used: 0 }
    }

    /// The vertex of an edge; `new` from now on, if it has none.
    fn get_or_insert(&mut self, [a, b]: [u32; 2], new: u32) -> u32 {
        if 2 * self.used >= self.slots.len() {
            self.grow();
        }
        let key = u64::from(a) << 32 | u64::from(b);
        let slot = self.slot(key);
        if self.slots[slot].0 == EMPTY {
            self.slots[slot] = (key, new);
            self.used += 1;
        }
        self.slots[slot].1
    }

    /// Where a key is or would be.
    fn slot(&self, key: u64) -> usize {
        let mask = self.slots.len() - 1;
        let mixed = key.wrapping_mul(0x9e37_79b9_7f4a_7c15);
        let mut slot = (mixed ^ mixed >> 32) as usize & mask;
        while self.slots[slot].0 != EMPTY && self.slots[slot].0 != key {
            slot = (slot + 1) & mask;
        }
        slot
    }

    fn grow(&mut self) {
        let larger = vec![(EMPTY, 0); 2 * self.slots.len()];
        for (key, vertex) in std::mem::replace(&mut self.slots, larger) {
            if key != EMPTY {
                let slot = self.slot(key);
                self.slots[slot] = (key, vertex);
            }
        }
    }
}
