//! Edges and faces of the lattice, and on which sides of what points are.

use glam::Vec3;
use robust::Coord3D;

use crate::duals::plan::Table;

/// An edge of the lattice: the point that it begins at, and its axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Edge {
    pub(super) from: [usize; 3],
    pub(super) axis: usize,
}

impl Edge {
    /// The points at its ends: in the solid, and outside.
    pub(super) fn ends(self, leads_out: bool) -> [[usize; 3]; 2] {
        let mut to = self.from;
        to[self.axis] += 1;
        if leads_out { [self.from, to] } else { [to, self.from] }
    }
}

/// A face between two cells, or a part of one: its lowest point, its size, the axis across it, and the corner round which it is halved.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Face {
    pub(super) lowest: [usize; 3],
    pub(super) size: usize,
    pub(super) across: usize,
    pub(super) half: Option<[bool; 2]>,
}

impl Face {
    /// The axes along it.
    pub(super) fn axes(self) -> [usize; 2] {
        [(self.across + 1) % 3, (self.across + 2) % 3]
    }

    /// A corner, by whether it is the higher one along each axis.
    pub(super) fn corner(self, [a, b]: [bool; 2]) -> [usize; 3] {
        let mut corner = self.lowest;
        let axes = self.axes();
        corner[axes[0]] += self.size * usize::from(a);
        corner[axes[1]] += self.size * usize::from(b);
        corner
    }

    /// The corners of the part, in order.
    pub(super) fn rim(self) -> ([[usize; 3]; 4], usize) {
        match self.half {
            None => {
                ([[false, false], [true, false], [true, true], [false, true]].map(|of| self.corner(of)), 4)
            }
            Some([a, b]) => {
                let [at, first, second] = [[a, b], [!a, b], [a, !b]].map(|of| self.corner(of));
                // Counter-clockwise as above.
                if a == b { ([at, first, second, at], 3) } else { ([at, second, first, at], 3) }
            }
        }
    }

    /// The edges of the rim that the part has, each as long as the face.
    pub(super) fn edges(self) -> impl Iterator<Item = Edge> {
        let axes = self.axes();
        let edge = move |(along, is_high): (usize, bool)| {
            let mut from = self.lowest;
            from[axes[1 - along]] += self.size * usize::from(is_high);
            Edge { from, axis: axes[along] }
        };
        let is_of_part =
            move |&(along, is_high): &(usize, bool)| self.half.is_none_or(|of| of[1 - along] == is_high);
        [(0, false), (0, true), (1, false), (1, true)].into_iter().filter(is_of_part).map(edge)
    }
}

/// Positive where the last point is below the plane of the others, which are counter-clockwise seen from above; exact.
pub(super) fn orientation(of: [Vec3; 4]) -> f64 {
    let [a, b, c, d] = of.map(|p| {
        let [x, y, z] = p.to_array().map(f64::from);
        Coord3D { x, y, z }
    });
    robust::orient3d(a, b, c, d)
}

/// Whether a triangle that faces out of the solid has a point of the solid and one outside strictly on its sides.
pub(super) fn divides([a, b, c]: [Vec3; 3], [inside, outside]: [Vec3; 2]) -> bool {
    orientation([a, b, c, inside]) > 0.0 && orientation([a, b, c, outside]) < 0.0
}

/// Whether an edge of a cell lies in its low or high face across an axis.
pub(super) fn is_on_face(table: &Table, edge: u8, across: usize, is_high: bool) -> bool {
    let (corner, axis) = table.edge(edge);
    usize::from(axis) != across && (corner >> across & 1 != 0) == is_high
}

/// The corner of a face across an axis that two of its edges have in common, as [`Face::corner`] takes it.
pub(super) fn corner_between(table: &Table, edges: [u8; 2], across: usize) -> Option<[bool; 2]> {
    let [(from, axis), (other, along)] = edges.map(|edge| table.edge(edge));
    if axis == along {
        return None;
    }
    // Along its own axis an edge has both ends; the other edge has one of them.
    let bit = |k: usize| (if k == usize::from(axis) { other } else { from }) >> k & 1 != 0;
    Some([(across + 1) % 3, (across + 2) % 3].map(bit))
}
