//! Which part of a cell belongs to a loop of surface round it.
//!
//! Where two loops go round one cell, a plane through corners of the cell has one of them on each side: that which cuts off one corner,
//! `x + y + z = 1`, or that which cuts off one edge, `y + z = 1`. A region is the cell on one side of such planes: a convex part of it, with
//! the loop on its rim. So whatever is spanned between points of a region and of its loop's edges stays in the region, and the regions of a
//! cell have nothing in common but those planes.

use glam::DVec3;

/// How far vertices stay within a cell or a face and off its planes, in shares of its edges, but for the steps of `f32`.
const MARGIN: f64 = 1.0 / 1024.0;
/// The same is never more, however coarse `f32` is there.
const MOST_MARGIN: f64 = 0.125;
/// Steps of `f32` that it is at least.
const STEPS: f64 = 2.0;

/// How far a vertex between two corners of the lattice, so many cells apart, stays off all sides, in shares of the way. Rounded to `f32` it is
/// still off them, where cells are 32 or more steps of `f32` long.
pub(super) fn margin(low: DVec3, high: DVec3, cells: usize) -> f64 {
    let step = f64::from(f32::EPSILON) * low.abs().max(high.abs()).max_element();
    let length = (high - low).max_element();
    (STEPS * step / length).max(MARGIN / cells as f64).min(MOST_MARGIN)
}

/// The cell on one side of planes through its corners, in shares of its edges.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) struct Region {
    /// One bit for each corner, on whose side of its plane the region is.
    near: u8,
    /// One bit for each corner, beyond whose plane the region is.
    beyond: u8,
    /// One bit for each edge along x, y and z, in the order of the corners that they begin at, on whose side of its plane the region is.
    along: [u8; 3],
}

/// One of the planes: the way from a corner or an edge in shares along some axes, which is 1 on it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Plane {
    corner: u8,
    /// The axis of an edge; `None` for a corner.
    along: Option<usize>,
}

impl Plane {
    fn all() -> impl Iterator<Item = Self> {
        let corners = (0..8).map(|corner| Self { corner, along: None });
        let edges = (0..3).flat_map(|axis| {
            (0..8)
                .filter(move |corner| corner >> axis & 1 == 0)
                .map(move |corner| Self { corner, along: Some(axis) })
        });
        corners.chain(edges)
    }

    /// The way from its corner or edge to a point.
    fn way(self, at: DVec3) -> f64 {
        let axes = (0..3).filter(|&axis| self.along != Some(axis));
        axes.map(|axis| if self.corner >> axis & 1 == 0 { at[axis] } else { 1.0 - at[axis] }).sum()
    }

    /// Whether edges lie on the side of the corner or beyond, no point between their ends on the plane.
    fn has(self, edges: &[u8], is_near: bool, edge: &impl Fn(u8) -> (u8, u8)) -> bool {
        edges.iter().all(|&number| {
            let (from, axis) = edge(number);
            let ways = [from, from | 1 << axis].map(|corner| self.way(corner_at(corner)));
            let (least, most) = (ways[0].min(ways[1]), ways[0].max(ways[1]));
            if is_near { most <= 1.0 && least < 1.0 } else { least >= 1.0 && most > 1.0 }
        })
    }
}

fn corner_at(corner: u8) -> DVec3 {
    DVec3::from_array([0, 1, 2].map(|axis| f64::from(corner >> axis & 1)))
}

impl Region {
    /// That of a loop among others, by the edges that they cross. `edge` gives the corner that an edge begins at, and its axis.
    pub(super) fn of<'a>(
        own: &[u8],
        others: impl Iterator<Item = &'a [u8]>,
        edge: impl Fn(u8) -> (u8, u8),
    ) -> Self {
        let mut region = Self::default();
        for other in others {
            let parts = |plane: Plane, is_near: bool| {
                plane.has(own, is_near, &edge) && plane.has(other, !is_near, &edge)
            };
            let (plane, is_near) = Plane::all()
                .find_map(|plane| {
                    [true, false].into_iter().find(|&near| parts(plane, near)).map(|near| (plane, near))
                })
                .expect("two loops of a cell have a plane between them");
            match (plane.along, is_near) {
                (None, true) => region.near |= 1 << plane.corner,
                (None, false) => region.beyond |= 1 << plane.corner,
                (Some(axis), true) => region.along[axis] |= 1 << plane.corner,
                // Beyond the plane of an edge is the side of the opposite one.
                (Some(axis), false) => region.along[axis] |= 1 << (7 ^ plane.corner ^ 1 << axis),
            }
        }
        region
    }

    /// The whole cell.
    #[cfg(test)]
    pub(super) fn is_whole(self) -> bool {
        self == Self::default()
    }

    /// The planes, and whether the region is on the side of their corner.
    fn planes(self) -> impl Iterator<Item = (Plane, bool)> {
        Plane::all().filter_map(move |plane| {
            let bit = |set: u8| set >> plane.corner & 1 != 0;
            match plane.along {
                None if bit(self.near) => Some((plane, true)),
                None if bit(self.beyond) => Some((plane, false)),
                Some(axis) if bit(self.along[axis]) => Some((plane, true)),
                _ => None,
            }
        })
    }

    /// The point of the way from `anchor`, which is in the region, to a point of the cell that is nearest to that point and in the region, so far
    /// from its planes and the sides of the cell.
    pub(super) fn nearest(self, anchor: DVec3, point: DVec3, margin: f64) -> DVec3 {
        let point = point.clamp(DVec3::splat(margin), DVec3::splat(1.0 - margin));
        let mut share: f64 = 1.0;
        for (plane, is_near) in self.planes() {
            let depth = |at: DVec3| if is_near { 1.0 - plane.way(at) } else { plane.way(at) - 1.0 } - margin;
            let (here, there) = (depth(anchor), depth(point));
            if there < 0.0 {
                share = share.min((here / (here - there)).max(0.0));
            }
        }
        anchor + (point - anchor) * share
    }

    /// The corner of the cell's low or high face across an axis that the region has the half round, in bits along the next axis and the one
    /// after; `None` where it has the whole face.
    pub(super) fn half(self, across: usize, is_high: bool) -> Option<[bool; 2]> {
        let of = |(plane, is_near): (Plane, bool)| {
            let bit = |axis: usize| plane.corner >> axis & 1 != 0;
            let [next, last] = [(across + 1) % 3, (across + 2) % 3];
            let is_cut = match plane.along {
                None => bit(across) == is_high,
                Some(axis) => axis == across,
            };
            is_cut.then(|| [bit(next), bit(last)].map(|bit| bit == is_near))
        };
        self.planes().find_map(of)
    }
}

#[cfg(test)]
mod tests {
    use super::super::plan::{Table, VertexPer};
    use super::*;

    /// All loops of all cells, by the inside corners and the face whose inside corners are joined.
    fn each_plan(mut visit: impl FnMut(u8, Option<u8>, &[super::super::plan::Loop], &Table)) {
        let table = Table::get(VertexPer::Loop);
        for inside in 0..=255u8 {
            for joined in [None, table.joinable(inside)] {
                let mut plans = super::super::plan::Plans::new(table);
                let number = plans.number(inside, joined, 0);
                visit(inside, joined, &plans.at(number).loops, table);
            }
        }
    }

    /// By the corners of the cell cut finely: no point is in two regions, and those of a loop's edges are in its own alone.
    #[test]
    fn regions_have_nothing_in_common_and_their_loops_on_the_rim() {
        let is_in = |region: Region, at: DVec3| {
            region
                .planes()
                .all(|(plane, is_near)| if is_near { plane.way(at) < 1.0 } else { plane.way(at) > 1.0 })
        };
        let mut shared = 0;
        each_plan(|inside, joined, loops, table| {
            shared += usize::from(loops.len() > 1);
            assert!(loops.len() != 1 || loops[0].region.is_whole());
            for i in 0..17 * 17 * 17 {
                // None of these is on a plane.
                let at = DVec3::new((i % 17) as f64, (i / 17 % 17) as f64, (i / 289) as f64);
                let at = (at + DVec3::new(0.31, 0.43, 0.57)) / 17.9;
                assert!(loops.iter().filter(|of| is_in(of.region, at)).count() <= 1, "{inside} {joined:?}");
            }
            for (l, of) in loops.iter().enumerate() {
                for &edge in &of.edges {
                    let (corner, axis) = table.edge(edge);
                    for share in [1e-3, 0.5, 0.999] {
                        let mut at = corner_at(corner);
                        at[usize::from(axis)] = share;
                        for (k, other) in loops.iter().enumerate() {
                            assert_eq!(is_in(other.region, at), k == l, "{inside} {joined:?} {l} {k}");
                        }
                    }
                }
            }
        });
        assert_eq!(shared, 2 * (82 + 8 + 2) + 36, "cells with several loops");
    }

    /// A face that a region has half of is crossed by its loop round the corner of that half, and a face that two loops cross is divided
    /// between them.
    #[test]
    fn halves_of_faces_are_those_round_the_corners_that_loops_cut_off() {
        each_plan(|inside, joined, loops, table| {
            for face in 0..6 {
                let (across, is_high) = (face / 2, face % 2 != 0);
                let [next, last] = [(across + 1) % 3, (across + 2) % 3];
                let on_face = |edge: &&u8| {
                    let (corner, axis) = table.edge(**edge);
                    usize::from(axis) != across && (corner >> across & 1 != 0) == is_high
                };
                let crossing = loops.iter().filter(|of| of.edges.iter().any(|edge| on_face(&edge)));
                let crossing: Vec<_> = crossing.collect();
                for of in &crossing {
                    let own: Vec<u8> = of.edges.iter().filter(on_face).copied().collect();
                    let half = of.region.half(across, is_high);
                    assert!(half.is_some() || crossing.len() == 1, "{inside} {joined:?} {face}");
                    let Some([a, b]) = half else { continue };
                    assert_eq!(own.len(), 2, "{inside} {joined:?} {face}");
                    for edge in own {
                        let (from, axis) = table.edge(edge);
                        // One of its ends is the corner.
                        let ends = [from, from | 1 << axis];
                        let is_corner = |c: &u8| (c >> next & 1 != 0) == a && (c >> last & 1 != 0) == b;
                        assert!(ends.iter().any(is_corner), "{inside} {joined:?} {face}");
                    }
                    // No other plane cuts the face.
                    let halves = of.region.planes().filter_map(|(plane, is_near)| {
                        let mut alone = Region::default();
                        match (plane.along, is_near) {
                            (None, true) => alone.near = 1 << plane.corner,
                            (None, false) => alone.beyond = 1 << plane.corner,
                            (Some(axis), _) => alone.along[axis] = 1 << plane.corner,
                        }
                        alone.half(across, is_high)
                    });
                    assert!(halves.into_iter().all(|other| other == [a, b]), "{inside} {joined:?} {face}");
                }
            }
        });
    }
}
