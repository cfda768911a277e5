//! Which cells become larger cells.

use std::cmp::Reverse;
use std::ops::Range;

use glam::DVec3;

use super::super::sharp::Sharp;
use super::super::tangents::Tangent;
use super::hermite::{Hermite, Leaf};
use crate::cubes::grid::CubeGrid;
use crate::execution::threads::for_each_on_threads;
use crate::extraction::ExtractError;
use crate::memory::{collected, push, with_room};
use crate::source::Request;

/// A cell of some level that has leaves in it.
struct Node {
    /// That of its leaves without their last bits.
    code: u128,
    leaves: Range<usize>,
    /// Its corners that are inside, if the surface is as simple in it as in one leaf.
    inside: Option<u8>,
    /// The one vertex that does for all of it, where there is one.
    vertex: Option<DVec3>,
}

/// A cell that was merged: its leaves, its vertex, its lowest point, and how many leaves long it is.
pub(super) struct Merged {
    pub(super) leaves: Range<usize>,
    pub(super) vertex: DVec3,
    pub(super) low: [usize; 3],
    pub(super) size: usize,
}

/// What decides whether cells become one.
pub(super) struct Merging<'a> {
    pub(super) grid: &'a CubeGrid<'a>,
    pub(super) hermite: &'a Hermite,
    pub(super) sharp: Sharp,
    /// The farthest that a vertex may be from a tangent plane.
    pub(super) most: f64,
}

/// All cells that can be, those in other ones too: each before those in it.
pub(super) fn merged_cells(request: &Request, merging: &Merging) -> Result<Vec<Merged>, ExtractError> {
    let leaves = &merging.hermite.leaves;
    let leaf = |(i, leaf): (usize, &Leaf)| {
        let inside = leaf.is_regular.then_some(leaf.inside);
        Node { code: leaf.code, leaves: i..i + 1, inside, vertex: None }
    };
    let mut nodes: Vec<Node> = collected(leaves.iter().enumerate().map(leaf))?;
    let mut merged: Vec<Merged> = Vec::new();
    let mut level = 0;
    while nodes.iter().any(|node| node.inside.is_some()) {
        request.control.check()?;
        level += 1;
        let mut parents: Vec<Node> = with_room(nodes.len())?;
        let mut children: Vec<Range<usize>> = with_room(nodes.len())?;
        let mut first = 0;
        for of_one in nodes.chunk_by(|a, b| a.code >> 3 == b.code >> 3) {
            let leaves = of_one[0].leaves.start..of_one[of_one.len() - 1].leaves.end;
            parents.push(Node { code: of_one[0].code >> 3, leaves, inside: None, vertex: None });
            children.push(first..first + of_one.len());
            first += of_one.len();
        }
        for_each_on_threads(request.control.threads, &mut parents, |i, parent| {
            merging.decide(parent, &nodes[children[i].clone()], level);
        })?;
        for parent in parents.iter() {
            let Some(vertex) = parent.vertex else { continue };
            let low = place(parent.code).map(|i| i << level);
            push(&mut merged, Merged { leaves: parent.leaves.clone(), vertex, low, size: 1 << level })?;
        }
        nodes = parents;
    }
    // Each before those in it.
    merged.sort_by_key(|of| (of.leaves.start, Reverse(of.leaves.end)));
    Ok(merged)
}

impl Merging<'_> {
    /// What comes of the children of a cell. One whose children have no vertex that is near enough may have one.
    fn decide(&self, parent: &mut Node, children: &[Node], level: u32) {
        let low = place(parent.code).map(|i| i << level);
        let high = low.map(|i| i + (1 << level));
        if (0..3).any(|axis| high[axis] >= self.grid.size[axis]) {
            return;
        }
        let is_regular = |inside: &u8| self.hermite.regular[usize::from(*inside)];
        parent.inside = coarse_corners(children).filter(is_regular);
        if parent.inside.is_some() {
            let crossings = self.hermite.crossings(self.grid, parent.leaves.clone());
            let [low, high] = [low, high].map(|corner| self.grid.position(corner).as_dvec3());
            let vertex = self.sharp.vertex(&crossings, low, high);
            let is_near =
                |&(p, normal): &Tangent| normal.is_some_and(|n| n.dot(vertex - p).abs() <= self.most);
            let is_in = vertex.cmpge(low).all() && vertex.cmple(high).all();
            parent.vertex = (is_in && crossings.iter().all(is_near)).then_some(vertex);
        }
    }
}

/// Where a cell of some level is, in cells of that level.
fn place(code: u128) -> [usize; 3] {
    [0, 1, 2].map(|axis| (0..32).fold(0, |place, i| place | ((code >> (3 * i + axis) & 1) as usize) << i))
}

/// The corners of a cell that are inside, by those of its children: of its eight parts those that the surface crosses. `None` if one of
/// them is not simple, or something is lost: the middle of an edge, a face or the cell on a side that none of its corners is on.
fn coarse_corners(children: &[Node]) -> Option<u8> {
    // Three points along each axis, x fastest.
    let at = |octant: usize, c: usize| {
        let along = |axis: usize| (octant >> axis & 1) + (c >> axis & 1);
        along(0) + 3 * along(1) + 9 * along(2)
    };
    let (mut inside, mut crossed) = (0_u32, 0_u8);
    for child in children {
        let corners = child.inside?;
        let octant = (child.code & 7) as usize;
        crossed |= 1 << octant;
        inside |= (0..8).fold(0, |set, c| set | u32::from(corners >> c & 1) << at(octant, c));
    }
    // A part without surface is on the side of the middle, which is a corner of all parts.
    let is_inside = |point: usize| inside >> point & 1 != 0;
    if is_inside(13) {
        for octant in (0..8).filter(|octant| crossed >> octant & 1 == 0) {
            inside |= (0..8).fold(0, |set, c| set | 1 << at(octant, c));
        }
    }
    let is_inside = |point: usize| inside >> point & 1 != 0;
    let corners: [usize; 8] = std::array::from_fn(|c| 2 * (c & 1) + 6 * (c >> 1 & 1) + 18 * (c >> 2));
    // Each point with the corners of the edge, face or cell that it is the middle of.
    let is_kept = |point: usize| {
        let along = [point % 3, point / 3 % 3, point / 9];
        let mut round =
            (0..8).filter(|c| (0..3).all(|axis| along[axis] == 1 || along[axis] / 2 == c >> axis & 1));
        round.any(|c| is_inside(corners[c]) == is_inside(point))
    };
    let kept = (0..27).all(is_kept);
    kept.then(|| (0..8).fold(0, |set, c| set | u8::from(is_inside(corners[c])) << c))
}
