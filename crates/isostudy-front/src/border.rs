//! The closed curves in which the surface meets the box's faces: the first fronts.
//!
//! Marching squares runs over a grid on the box's whole border, whose faces share their samples. So its curves are closed. Each is cut
//! where it passes an edge of the box, and the parts are divided evenly. New points go to the curve by Newton's method in the face.

use std::collections::BTreeMap;

use glam::DVec3;
use isostudy_mesh::Bounds;

use crate::probe::{Foot, Miss, Probe, rounded};
use crate::sizes::Sizes;

type Point = [u32; 3];

/// The field is asked for the range of its values in squares of so many points a side.
const BLOCK: usize = 8;

/// Closed curves of points on the border, the surface on the left of each.
pub(crate) fn loops(
    probe: &Probe<'_>,
    bounds: Bounds,
    sizes: &Sizes,
    step: f64,
) -> Result<Vec<Vec<Foot>>, Miss> {
    let grid = Grid::of(bounds, step);
    let crossings = grid.crossings(probe);
    let mut feet = Vec::new();
    for [a, b] in &crossings.edges {
        feet.push(probe.root(grid.place(*a), grid.place(*b))?);
    }
    let mut is_done = vec![false; feet.len()];
    let mut loops = Vec::new();
    for start in 0..feet.len() {
        let mut curve = Vec::new();
        let mut at = start;
        while !is_done[at] {
            is_done[at] = true;
            curve.push((feet[at], grid.is_on_edge(crossings.edges[at])));
            at = crossings.next[at];
        }
        let curve = without_repeats(curve, sizes);
        if curve.len() >= 3 {
            loops.push(divided(probe, bounds, sizes, &curve)?);
        }
    }
    Ok(loops)
}

struct Grid {
    min: DVec3,
    max: DVec3,
    cells: Point,
}

/// A face of the box.
struct Face {
    axis: usize,
    is_far: bool,
    /// Along its two axes.
    cells: [u32; 2],
    /// The number of the far face.
    at: u32,
    inside: Vec<bool>,
}

impl Face {
    fn index(&self, i: u32, j: u32) -> usize {
        (i * (self.cells[1] + 1) + j) as usize
    }

    fn point(&self, i: u32, j: u32) -> Point {
        let mut p = [0; 3];
        p[self.axis] = if self.is_far { self.at } else { 0 };
        (p[(self.axis + 1) % 3], p[(self.axis + 2) % 3]) = (i, j);
        p
    }

    /// The corners of a cell, counter-clockwise seen from outside of the box.
    fn corners(&self, i: u32, j: u32) -> [[u32; 2]; 4] {
        let [a, b, c, d] = [[i, j], [i + 1, j], [i + 1, j + 1], [i, j + 1]];
        if self.is_far { [a, b, c, d] } else { [a, d, c, b] }
    }
}

/// Edges of the grid that cross the surface, and for each the next along its curve.
struct Crossings {
    edges: Vec<[Point; 2]>,
    next: Vec<usize>,
}

impl Grid {
    fn of(bounds: Bounds, step: f64) -> Self {
        let (min, max) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
        Self { min, max, cells: ((max - min) / step).to_array().map(|n| (n.ceil() as u32).max(2)) }
    }

    /// Points on faces lie there exactly.
    fn place(&self, p: Point) -> DVec3 {
        let along = |axis: usize| match p[axis] {
            n if n == self.cells[axis] => self.max[axis],
            n => {
                self.min[axis]
                    + (self.max[axis] - self.min[axis]) * f64::from(n) / f64::from(self.cells[axis])
            }
        };
        rounded(DVec3::new(along(0), along(1), along(2)))
    }

    fn is_on_edge(&self, [a, b]: [Point; 2]) -> bool {
        let is_shared =
            |axis: &usize| a[*axis] == b[*axis] && (a[*axis] == 0 || a[*axis] == self.cells[*axis]);
        (0..3).filter(is_shared).count() == 2
    }

    /// The points of a face, the second of its axes fastest, and for each whether it is inside.
    fn face(&self, probe: &Probe<'_>, face: usize) -> Face {
        let (axis, is_far) = (face / 2, face % 2 == 1);
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        let mut of = Face {
            axis,
            is_far,
            cells: [self.cells[u], self.cells[v]],
            at: self.cells[axis],
            inside: Vec::new(),
        };
        of.inside = vec![false; ((of.cells[0] + 1) * (of.cells[1] + 1)) as usize];
        for i in (0..=of.cells[0]).step_by(BLOCK) {
            for j in (0..=of.cells[1]).step_by(BLOCK) {
                let last = [(i + BLOCK as u32 - 1).min(of.cells[0]), (j + BLOCK as u32 - 1).min(of.cells[1])];
                let corners = [of.point(i, j), of.point(last[0], last[1])].map(|p| self.place(p));
                let known = probe.side_of_box(corners[0].min(corners[1]), corners[0].max(corners[1]));
                for (i, j) in (i..=last[0]).flat_map(|i| (j..=last[1]).map(move |j| (i, j))) {
                    let index = of.index(i, j);
                    of.inside[index] = known.unwrap_or_else(|| probe.value(self.place(of.point(i, j))) > 0.0);
                }
            }
        }
        of
    }

    fn crossings(&self, probe: &Probe<'_>) -> Crossings {
        let mut numbers: BTreeMap<[Point; 2], usize> = BTreeMap::new();
        let mut found = Crossings { edges: Vec::new(), next: Vec::new() };
        for face in (0..6).map(|face| self.face(probe, face)) {
            for (i, j) in (0..face.cells[0]).flat_map(|i| (0..face.cells[1]).map(move |j| (i, j))) {
                let corners = face.corners(i, j);
                let is_inside = corners.map(|[i, j]| face.inside[face.index(i, j)]);
                if is_inside == [is_inside[0]; 4] {
                    continue;
                }
                let corners = corners.map(|[i, j]| face.point(i, j));
                self.join(probe, corners, is_inside, &mut numbers, &mut found);
            }
        }
        found
    }

    /// What a cell joins.
    fn join(
        &self,
        probe: &Probe<'_>,
        corners: [Point; 4],
        is_inside: [bool; 4],
        numbers: &mut BTreeMap<[Point; 2], usize>,
        found: &mut Crossings,
    ) {
        let mut number = |i: usize| {
            let (a, b) = (corners[i], corners[(i + 1) % 4]);
            *numbers.entry([a.min(b), a.max(b)]).or_insert_with(|| {
                found.edges.push([a.min(b), a.max(b)]);
                found.next.push(usize::MAX);
                found.edges.len() - 1
            })
        };
        // Edges by which the way round the cell enters the solid, and by which it leaves it.
        let enters: Vec<usize> = (0..4).filter(|&i| !is_inside[i] && is_inside[(i + 1) % 4]).collect();
        let step = if enters.len() == 2 && self.is_middle_inside(probe, corners) { 3 } else { 1 };
        let mut pairs = Vec::new();
        for i in enters {
            let mut leaves = (i + step) % 4;
            while !is_inside[leaves] || is_inside[(leaves + 1) % 4] {
                leaves = (leaves + step) % 4;
            }
            pairs.push((number(i), number(leaves)));
        }
        pairs.into_iter().for_each(|(from, to)| found.next[from] = to);
    }

    fn is_middle_inside(&self, probe: &Probe<'_>, corners: [Point; 4]) -> bool {
        probe.value(corners.iter().map(|&p| self.place(p)).sum::<DVec3>() * 0.25) > 0.0
    }
}

/// A curve whose points keep off each other: where the surface meets a corner of a cell or of the box, several roots are one. Points on
/// edges of the box stay before others.
fn without_repeats(curve: Vec<(DVec3, bool)>, sizes: &Sizes) -> Vec<(DVec3, bool)> {
    let is_same = |a: DVec3, b: DVec3| a.distance(b) < 1e-3 * sizes.at(a);
    let mut kept: Vec<(DVec3, bool)> = Vec::new();
    for of in curve {
        match kept.last_mut() {
            Some(last) if is_same(last.0, of.0) => {
                if of.1 && !last.1 {
                    *last = of;
                }
            }
            _ => kept.push(of),
        }
    }
    while let ([first, .., last], true) = (&kept[..], kept.len() > 1)
        && is_same(first.0, last.0)
    {
        if last.1 && !first.1 {
            kept.swap_remove(0);
        } else {
            kept.pop();
        }
    }
    kept
}

/// A curve of roots, divided into edges of the wanted length. Roots on edges of the box stay.
fn divided(
    probe: &Probe<'_>,
    bounds: Bounds,
    sizes: &Sizes,
    curve: &[(DVec3, bool)],
) -> Result<Vec<Foot>, Miss> {
    let first = curve.iter().position(|of| of.1).unwrap_or(0);
    let count = curve.len();
    let places: Vec<(DVec3, bool)> = (0..=count).map(|i| curve[(first + i) % count]).collect();
    let mut parts: Vec<Vec<DVec3>> = vec![vec![places[0].0]];
    for &(p, is_fixed) in &places[1..] {
        if let Some(part) = parts.last_mut() {
            part.push(p);
        }
        if is_fixed {
            parts.push(vec![p]);
        }
    }
    parts.retain(|part| part.len() > 1);
    let least = if parts.len() >= 3 { 1 } else { 3_usize.div_ceil(parts.len()) };
    let mut feet = Vec::new();
    for part in parts {
        // Lengths in wanted edges.
        let mut ways = vec![0.0];
        for ends in part.windows(2) {
            let middle = 0.5 * (ends[0] + ends[1]);
            ways.push(ways[ways.len() - 1] + ends[0].distance(ends[1]) / sizes.at(middle));
        }
        let whole = ways[ways.len() - 1];
        let edges = (whole.round() as usize).max(least);
        feet.push(Foot { place: part[0], normal: probe.normal(part[0])? });
        for i in 1..edges {
            let way = whole * i as f64 / edges as f64;
            let after = ways.partition_point(|&of| of <= way).clamp(1, part.len() - 1);
            let share = (way - ways[after - 1]) / (ways[after] - ways[after - 1]).max(1e-30);
            let between = part[after - 1].lerp(part[after], share);
            feet.push(in_face(probe, bounds, between, sizes.at(between))?);
        }
    }
    Ok(feet)
}

/// The nearby root in the face that a point lies on.
fn in_face(probe: &Probe<'_>, bounds: Bounds, p: DVec3, reach: f64) -> Result<Foot, Miss> {
    let (min, max) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
    // The nearest face, on which a point between two points of a face lies but for rounding.
    let gap = |axis: usize| (p[axis] - min[axis]).abs().min((max[axis] - p[axis]).abs());
    let axis = (0..3).min_by(|&a, &b| gap(a).total_cmp(&gap(b))).unwrap_or(0);
    let mut start = p;
    start[axis] =
        if (p[axis] - min[axis]).abs() < (max[axis] - p[axis]).abs() { min[axis] } else { max[axis] };
    let within = |mut g: DVec3| {
        g[axis] = 0.0;
        g
    };
    match probe.project_within(start, reach, within) {
        Ok(foot) if foot.place == foot.place.clamp(min, max) => Ok(foot),
        // Beyond an edge of the box, or past a kink: the point of the polygon is near enough.
        Ok(_) | Err(Miss::Far) => Ok(Foot { place: rounded(start), normal: probe.normal(start)? }),
        Err(Miss::Flat(_)) => Ok(Foot { place: rounded(start), normal: probe.normal(start)? }),
        Err(miss) => Err(miss),
    }
}
