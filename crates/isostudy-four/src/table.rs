//! The table of the hull rule: the simplices of every pattern of inside corners of a cube.

use std::sync::LazyLock;

use isostudy_cells::{Symmetry, symmetries};
use rayon::prelude::*;

use crate::cube::{Cube, doubled};
use crate::hull::{minor, minus, patch_facets};
use crate::pulling::pull;

/// The surface in a cube of `D` dimensions by the hull rule (Bhaniramka, Wenger & Crawfis 2004, section 3), for each set of inside
/// corners: 256 entries of triangles in three dimensions, and 65,536 of tetrahedra in four.
///
/// The surface is those facets of the convex hull of inside corners and middles of crossed edges that lie in no facet of the cube. They
/// are found once a class of entries, of which there are 22 and 402, and cut into simplices by pulling, each to its first vertex in the
/// order of [`Cube::edges`].
///
/// # Guaranteed
/// - In each facet of the cube the surface is that of the table with one dimension less, cut in the same way. So neighbours fit.
/// - The vertices of a simplex `a b c d` are numbers of edges, and `det(n, b - a, c - a, d - a) > 0` for the normal `n` that points away
///   from the inside. In three dimensions triangles run counter-clockwise seen from outside.
///
/// # Not guaranteed
/// - Complements do not have the same surface. Where inside and outside corners alternate, the hull joins what is inside.
#[derive(Debug, PartialEq, Eq)]
pub struct Table<const D: usize> {
    cube: Cube<D>,
    classes: Vec<u32>,
    starts: Vec<u32>,
    simplices: Vec<[u8; D]>,
}

static THREE: LazyLock<Table<3>> = LazyLock::new(Table::build);
static FOUR: LazyLock<Table<4>> = LazyLock::new(Table::build);

impl Table<3> {
    /// The table of three dimensions, made at first use.
    pub fn get() -> &'static Self {
        &THREE
    }
}

impl Table<4> {
    /// The table of four dimensions, made at first use.
    pub fn get() -> &'static Self {
        &FOUR
    }
}

impl<const D: usize> Table<D> {
    /// Of a class of entries that are the same but for a symmetry of the cube, hulls are taken once.
    fn build() -> Self {
        let cube = Cube::<D>::new();
        let corners: Vec<Vec<i32>> =
            (0..Cube::<D>::CORNERS as u8).map(|c| doubled::<D>(c).to_vec()).collect();
        let group: Vec<Turn> =
            symmetries(&corners).into_iter().map(|symmetry| Turn::new(&cube, symmetry)).collect();
        let count = 1usize << Cube::<D>::CORNERS;
        let (mut classes, mut from) = (Vec::new(), vec![None; count]);
        for entry in 0..count as u32 {
            if from[entry as usize].is_none() {
                for (number, turn) in group.iter().enumerate() {
                    from[turn.corners(entry) as usize].get_or_insert((classes.len(), number));
                }
                classes.push(entry);
            }
        }
        let facets: Vec<Vec<u32>> = classes.par_iter().map(|&entry| patch_facets(&cube, entry)).collect();
        let entries: Vec<Vec<[u8; D]>> = (0..count)
            .into_par_iter()
            .map(|entry| {
                let (class, turn) = from[entry].expect("each entry is in a class");
                let facets = facets[class].iter().map(|&facet| group[turn].edges(facet)).collect();
                simplices(&cube, entry as u32, facets)
            })
            .collect();
        let mut starts = vec![0];
        starts.extend(entries.iter().scan(0, |end, simplices| {
            *end += simplices.len() as u32;
            Some(*end)
        }));
        Self { cube, classes, starts, simplices: entries.concat() }
    }

    /// The cube whose edges the vertices are on.
    pub fn cube(&self) -> &Cube<D> {
        &self.cube
    }

    /// The simplices of an entry: the surface where exactly these corners are inside, one bit each.
    ///
    /// # Panics
    /// If there is no such entry.
    pub fn entry(&self, inside: u32) -> &[[u8; D]] {
        let [start, end] = [0, 1].map(|i| self.starts[inside as usize + i] as usize);
        &self.simplices[start..end]
    }

    /// The first entry of each class of entries that are the same but for a rotation or a reflection.
    pub fn classes(&self) -> &[u32] {
        &self.classes
    }
}

/// A symmetry, as a map of edges too.
struct Turn {
    corners: Vec<u8>,
    edges: Vec<u8>,
}

impl Turn {
    fn new<const D: usize>(cube: &Cube<D>, Symmetry { to, .. }: Symmetry) -> Self {
        let image = |edge: &crate::cube::Edge<D>| {
            let mut ends = edge.corners.map(|c| to[usize::from(c)]);
            ends.sort_unstable();
            let number = cube.edges().iter().position(|other| other.corners == ends);
            number.expect("edges are taken to edges") as u8
        };
        Self { edges: cube.edges().iter().map(image).collect(), corners: to }
    }

    fn corners(&self, set: u32) -> u32 {
        image(&self.corners, set)
    }

    fn edges(&self, set: u32) -> u32 {
        image(&self.edges, set)
    }
}

fn image(to: &[u8], set: u32) -> u32 {
    to.iter().enumerate().filter(|(i, _)| set >> i & 1 != 0).fold(0, |image, (_, to)| image | 1 << to)
}

/// The facets of an entry's surface as simplices, in order, each facing away from the inside.
fn simplices<const D: usize>(cube: &Cube<D>, inside: u32, surface: Vec<u32>) -> Vec<[u8; D]> {
    let crossed = cube.crossed(inside);
    let sides = (0..2 * D).map(|side| cube.facet(side >> 1, side & 1) & crossed);
    let all: Vec<u32> = surface.iter().copied().chain(sides).collect();
    let mut simplices = Vec::new();
    surface.iter().for_each(|&facet| pull(facet, &all, &mut simplices));
    simplices.sort_unstable();
    let within = doubled::<D>(inside.trailing_zeros() as u8);
    for simplex in &mut simplices {
        let mut rows = simplex.map(|e| cube.edges()[usize::from(e)].middle);
        let origin = std::mem::replace(&mut rows[0], within);
        match minor(&rows.map(|point| minus(point, origin)), !0) {
            0 => unreachable!("an inside corner lies on no facet of the surface"),
            1.. => simplex.swap(D - 2, D - 1),
            _ => {}
        }
    }
    simplices
}
