//! Pairs of triangles that pass through each other.

mod exact;
mod fans;
mod pair;
mod tree;

use std::collections::HashMap;
use std::ops::ControlFlow;

use glam::Vec3;

use self::pair::{has_area, meet_beyond_what_they_share};
use self::tree::{Around, Tree, Visit};
use crate::{MeshError, TriangleMesh, used_vertices};

/// Counting ends with so many pairs.
pub const MOST_INTERSECTIONS: u64 = 1_000_000;
/// Round a corner with more triangles than this, boxes of triangles tell too little.
const MANY: usize = 32;
/// Looks at pairs of boxes, before the search is given up: so many, and so many per triangle.
const LOOKS: u64 = 10_000_000;
const LOOKS_EACH: u64 = 600;
/// Two triangles take as long as so many pairs of boxes.
const LOOKS_OF_MEETING: u64 = 32;

/// How many pairs of triangles of a mesh have a point in common that is no common vertex and lies on no common side. Touching counts: a
/// vertex that lies in another triangle, two triangles that lie on each other. Of more than [`MOST_INTERSECTIONS`] pairs, that number is
/// the answer: there are at least so many.
///
/// Vertices at one place count as one, whatever their numbers are. Triangles without area meet nothing. The answer is exact: signs of
/// volumes and areas are computed with as many digits as they need (Shewchuk 1997).
///
/// Takes O(n log n) where few boxes of triangles meet without the triangles: a second or two for a million of them. Triangles round one
/// corner or one side are told apart by their directions from it.
///
/// # Errors
/// As [`used_vertices`]; and [`MeshError::Entangled`] where so many boxes of triangles meet that the search is given up.
pub fn self_intersections(mesh: &TriangleMesh) -> Result<u64, MeshError> {
    used_vertices(mesh)?;
    let corners: Vec<[Vec3; 3]> =
        (0..mesh.triangles.len()).map(|t| mesh.corners(t)).filter(|corners| has_area(*corners)).collect();
    let looks = LOOKS + LOOKS_EACH * corners.len() as u64;
    let mut count = Count { corners: &corners, found: 0, looks };
    // Whether it is broken off, its numbers say.
    let _ = count.all();
    match count.looks {
        0 => Err(MeshError::Entangled { looks, found: count.found }),
        _ => Ok(count.found),
    }
}

struct Count<'a> {
    corners: &'a [[Vec3; 3]],
    found: u64,
    /// Looks that are left.
    looks: u64,
}

impl Visit for Count<'_> {
    fn look(&mut self) -> ControlFlow<()> {
        self.spend(1)
    }

    fn meet(&mut self, a: u32, b: u32) -> ControlFlow<()> {
        self.spend(LOOKS_OF_MEETING)?;
        let [a, b] = [a, b].map(|t| self.corners[t as usize]);
        self.found += u64::from(meet_beyond_what_they_share(a, b));
        if self.found >= MOST_INTERSECTIONS { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }
}

impl Count<'_> {
    fn spend(&mut self, looks: u64) -> ControlFlow<()> {
        self.looks = self.looks.saturating_sub(looks);
        if self.looks == 0 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }

    fn all(&mut self) -> ControlFlow<()> {
        let triangles: Vec<u32> = (0..self.corners.len() as u32).collect();
        let (single, fans) = self.fans(&triangles, &[]);
        let boxes: Vec<Around> =
            self.corners.iter().map(|of| Around::of(of.iter().map(|p| p.as_dvec3()))).collect();
        let groups: Vec<Vec<u32>> = fans.iter().map(|(_, fan)| fan.clone()).collect();
        Tree::of(&boxes, &single, &groups).pairs(self)?;
        for (apex, fan) in &fans {
            self.round_corner(*apex, fan)?;
        }
        ControlFlow::Continue(())
    }

    /// Pairs of triangles that have this corner.
    fn round_corner(&mut self, apex: Vec3, fan: &[u32]) -> ControlFlow<()> {
        let (single, books) = self.fans(fan, &[apex]);
        let (single, books) = (places(fan, &single), books);
        let boxes: Vec<Around> = self.boxes(fan, |of| fans::arc(of, apex));
        let groups: Vec<Vec<u32>> = books.iter().map(|(_, book)| places(fan, book)).collect();
        Tree::of(&boxes, &single, &groups).pairs(&mut Within { count: self, of: fan })?;
        for (other, book) in &books {
            let boxes: Vec<Around> = self.boxes(book, |of| fans::across(of, [apex, *other]));
            let all: Vec<u32> = (0..book.len() as u32).collect();
            Tree::of(&boxes, &all, &[]).pairs(&mut Within { count: self, of: book })?;
        }
        ControlFlow::Continue(())
    }

    fn boxes(&self, of: &[u32], around: impl Fn(&[Vec3; 3]) -> Around) -> Vec<Around> {
        of.iter().map(|&t| around(&self.corners[t as usize])).collect()
    }

    /// The triangles with a corner, beside those `known`, that more than [`MANY`] of them have, each with the one that most have; and
    /// the others. All keep their order.
    fn fans(&self, triangles: &[u32], known: &[Vec3]) -> (Vec<u32>, Vec<(Vec3, Vec<u32>)>) {
        let own = |t: u32| self.corners[t as usize].into_iter().filter(|corner| !known.contains(corner));
        let mut number_of: HashMap<[u32; 3], usize> = HashMap::new();
        for corner in triangles.iter().flat_map(|&t| own(t)) {
            *number_of.entry(key(corner)).or_default() += 1;
        }
        number_of.retain(|_, number| *number > MANY);
        let (mut single, mut fans) = (Vec::new(), Vec::<(Vec3, Vec<u32>)>::new());
        let mut place_of: HashMap<[u32; 3], usize> = HashMap::new();
        for &t in triangles {
            let number = |corner: &Vec3| number_of.get(&key(*corner)).copied();
            let Some(apex) = own(t).filter(|corner| number(corner).is_some()).max_by_key(number) else {
                single.push(t);
                continue;
            };
            let place = *place_of.entry(key(apex)).or_insert(fans.len());
            if place == fans.len() {
                fans.push((apex, Vec::new()));
            }
            fans[place].1.push(t);
        }
        (single, fans)
    }
}

/// Pairs of places in a list of triangles, as pairs of triangles.
struct Within<'a, 'b> {
    count: &'a mut Count<'b>,
    of: &'a [u32],
}

impl Visit for Within<'_, '_> {
    fn look(&mut self) -> ControlFlow<()> {
        self.count.look()
    }

    fn meet(&mut self, a: u32, b: u32) -> ControlFlow<()> {
        self.count.meet(self.of[a as usize], self.of[b as usize])
    }
}

/// Where some triangles stand in a list that has them in the same order.
fn places(list: &[u32], some: &[u32]) -> Vec<u32> {
    let mut rest = list.iter().zip(0..);
    let place = |t: &u32| rest.find(|(of, _)| *of == t).expect("it is one of them").1;
    some.iter().map(place).collect()
}

/// Both zeros are one place.
fn key(p: Vec3) -> [u32; 3] {
    (p + 0.0).to_array().map(f32::to_bits)
}
