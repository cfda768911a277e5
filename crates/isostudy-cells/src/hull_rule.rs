//! The hull rule: the surface is the part of a convex hull that is not in the cell's own faces.

use crate::cell::Cell;
use crate::hull::{Hull, Place, dot, hull, minus, normal, plus, polygon};

/// Where a corner is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Label {
    /// Below the isovalue.
    Outside,
    /// On the surface.
    On,
    /// Above the isovalue.
    Inside,
}

/// Where a corner of a patch is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Point {
    /// At a corner of the cell that is on the surface.
    Corner(u8),
    /// On an edge of the cell between inside and outside.
    Edge(u8),
}

impl Cell {
    /// The patch of surface in the cell by the hull rule, as triangles counter-clockwise seen from outside.
    ///
    /// Of the convex hull of all inside corners, corners on the surface and middles of crossed edges, those facets that lie in
    /// no face of the cell. Where all of these lie in one face they are the patch, facing away from the cell's inside corners,
    /// of which there are none: into the cell. Anything else that is flat is no patch.
    ///
    /// # Panics
    /// If there are not as many labels as corners, or more than 32 points.
    pub fn hull_patch(&self, labels: &[Label]) -> Vec<[Point; 3]> {
        assert_eq!(labels.len(), self.corners().len(), "a label for each corner");
        let mut points: Vec<(Place, Option<Point>, u32)> = Vec::new();
        for (c, &label) in labels.iter().enumerate() {
            let place = self.corners()[c].map(|x| 2 * x);
            let point = match label {
                Label::Outside => continue,
                Label::On => Some(Point::Corner(c as u8)),
                Label::Inside => None,
            };
            points.push((place, point, self.faces_at_corner()[c]));
        }
        for (e, &[a, b]) in self.edges().iter().enumerate() {
            let [at_a, at_b] = [a, b].map(|c| labels[usize::from(c)]);
            if matches!((at_a, at_b), (Label::Inside, Label::Outside) | (Label::Outside, Label::Inside)) {
                let place = plus(self.corners()[usize::from(a)], self.corners()[usize::from(b)]);
                points.push((place, Some(Point::Edge(e as u8)), self.faces_at_edge()[e]));
            }
        }
        assert!(points.len() <= 32, "a set of points is 32 bits");
        // In space, so that how facets are cut does not hang on how corners and edges are numbered.
        points.sort_unstable_by_key(|&([x, y, z], ..)| [z, y, x]);
        let places: Vec<Place> = points.iter().map(|&(place, ..)| place).collect();
        let common = |members: &[u8]| members.iter().fold(!0, |set, &p| set & points[usize::from(p)].2);
        let all: Vec<u8> = (0..points.len() as u8).collect();
        let facets = match hull(&places) {
            Hull::Solid(facets) => facets,
            Hull::Flat if points.len() < 3 || common(&all) == 0 => Vec::new(),
            Hull::Flat => {
                let face = common(&all).trailing_zeros() as usize;
                let corner = |i: usize| self.corners()[usize::from(self.faces()[face][i])];
                let outward = normal([corner(0), corner(1), corner(2)]);
                debug_assert!(dot(outward, minus(corner(0), corner(1))) == 0, "a face is flat");
                vec![polygon(&places, !(!0 << points.len()), outward.map(|n| -n))]
            }
        };
        let is_flat = common(&all) != 0;
        facets
            .iter()
            .filter(|facet| is_flat || common(facet) == 0)
            .flat_map(|facet| {
                let point =
                    |p: u8| points[usize::from(p)].1.expect("facets off the faces have no inside corner");
                ears(facet).into_iter().map(|triangle| triangle.map(point)).collect::<Vec<_>>()
            })
            .collect()
    }
}

/// A convex polygon cut into triangles: its last point off, then the next to last, as if the points had come one by one.
fn ears(polygon: &[u8]) -> Vec<[u8; 3]> {
    let mut left = polygon.to_vec();
    let mut triangles = Vec::new();
    while left.len() >= 3 {
        let n = left.len();
        let last = (0..n).max_by_key(|&i| left[i]).expect("there are three");
        triangles.push([left[(last + n - 1) % n], left[last], left[(last + 1) % n]]);
        left.remove(last);
    }
    triangles
}
