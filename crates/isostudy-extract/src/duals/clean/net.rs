//! Which quadrilaterals stay in the envelopes of their edges, and what the others need.

use glam::Vec3;

use super::face::{Edge, Face, corner_between, divides, is_on_face, orientation};
use crate::cubes::grid::CubeGrid;
use crate::duals::plan::{Loop, Plans, Table, VertexPer};
use crate::duals::quads::{Quadrilateral, is_other_better};
use crate::sampling::level::Level;
use crate::surface::trace::VertexKey;

/// Shares of a face's edges by which a point is certain to be in it, whatever was rounded: `f32` has 2²⁴ steps, and a share is known to a few
/// times 2⁻⁵² of them.
const SURE: f64 = 1e-6;

/// A net as it was extracted, with cells of it merged.
pub(super) struct Net<'a> {
    pub(super) level: Level<'a>,
    pub(super) grid: &'a CubeGrid<'a>,
    /// By vertex, the one that stands for it; none where no cells were merged.
    pub(super) stands_for: &'a [u32],
    pub(super) positions: &'a [Vec3],
    /// The cell that each vertex is in: its lowest point, and its size in leaves; none where no cells were merged.
    pub(super) cells: &'a [([usize; 3], usize)],
    /// Which say the leaf that each is of.
    pub(super) keys: &'a [VertexKey],
    pub(super) origin: [i32; 3],
    pub(super) plans: &'a Plans,
    /// Of each vertex its plan, and its number in it.
    pub(super) numbers: &'a [(u32, usize)],
    /// That of a merged cell.
    pub(super) merged: &'a Loop,
}

/// A quadrilateral, and what it needs.
#[derive(Debug, Clone, Copy)]
pub(super) struct Judged {
    pub(super) quad: Quadrilateral,
    /// The sides that need a vertex in their face, one bit each. The first goes from the first corner to the second.
    pub(super) sides: u8,
    pub(super) cut: Cut,
}

/// What becomes of a quadrilateral.
#[derive(Debug, Clone, Copy)]
pub(super) enum Cut {
    /// Its edge lies within a merged cell, or in one face of two.
    Nothing,
    Triangle([u32; 3]),
    Two([[u32; 3]; 2]),
    /// It needs vertices.
    Polygon,
}

impl Default for Judged {
    fn default() -> Self {
        let quad = Quadrilateral { corners: [0; 4], leads_out: false };
        Self { quad, sides: 0, cut: Cut::Nothing }
    }
}

impl Net<'_> {
    pub(super) fn judge(&self, pair: [[u32; 3]; 2]) -> Judged {
        let quad = Quadrilateral::of(pair);
        let standing = quad.corners.map(|v| self.standing(v));
        let mut polygon = [0; 4];
        let (mut count, mut sides) = (0, 0);
        for (side, &v) in standing.iter().enumerate().filter(|&(i, v)| *v != standing[(i + 1) % 4]) {
            polygon[count] = v;
            count += 1;
            sides |= u8::from(self.needs_vertex(quad, side)) << side;
        }
        let cut = match count {
            _ if count < 3 => Cut::Nothing,
            _ if sides != 0 => Cut::Polygon,
            3 => {
                let [a, b, c, _] = polygon;
                let triangle = if quad.leads_out { [a, b, c] } else { [a, c, b] };
                if self.divide(quad, &[triangle]) { Cut::Triangle(triangle) } else { Cut::Polygon }
            }
            _ => {
                let merged = Quadrilateral { corners: standing, leads_out: quad.leads_out };
                let prefers_other = match standing == quad.corners {
                    true => pair != quad.cut(false),
                    false => is_other_better(Some(self.level), standing.map(|v| self.positions[v as usize])),
                };
                let cuts = [prefers_other, !prefers_other].map(|by_other| merged.cut(by_other));
                cuts.into_iter().find(|cut| self.divide(quad, cut)).map_or(Cut::Polygon, Cut::Two)
            }
        };
        Judged { quad, sides, cut }
    }

    /// The vertex that stands for one.
    pub(super) fn standing(&self, v: u32) -> u32 {
        self.stands_for.get(v as usize).copied().unwrap_or(v)
    }

    /// The cell of the uniform net that a vertex is of.
    pub(super) fn leaf(&self, v: u32) -> [usize; 3] {
        let cell = self.keys[v as usize].cell();
        [0, 1, 2].map(|axis| cell[axis].wrapping_sub(self.origin[axis]) as usize)
    }

    /// The cell that it is in, and how many leaves long that is.
    fn cell(&self, v: u32) -> ([usize; 3], usize) {
        self.cells.get(v as usize).copied().unwrap_or_else(|| (self.leaf(v), 1))
    }

    /// The loop that it stands for.
    pub(super) fn loop_of(&self, v: u32) -> &Loop {
        if self.cells.get(v as usize).is_some_and(|(_, size)| *size > 1) {
            return self.merged;
        }
        let (plan, number) = self.numbers[v as usize];
        &self.plans.at(plan).loops[number]
    }

    /// Whether each of some triangles has the ends of a quadrilateral's edge strictly on its sides.
    fn divide(&self, quad: Quadrilateral, triangles: &[[u32; 3]]) -> bool {
        let ends = self.edge(quad).ends(quad.leads_out).map(|end| self.grid.position(end));
        triangles.iter().all(|of| divides(of.map(|v| self.positions[v as usize]), ends))
    }

    /// The edge that a quadrilateral goes round.
    pub(super) fn edge(&self, quad: Quadrilateral) -> Edge {
        let [lowest, _, highest, _] = quad.corners.map(|v| self.leaf(v));
        // The leaves differ along both other axes, by one.
        let axis = (0..3).find(|&axis| lowest[axis] == highest[axis]).unwrap_or(0);
        Edge { from: highest, axis }
    }

    /// Whether the segment along a side of a quadrilateral leaves the face between its cells, or one of its ends is to be joined to a vertex
    /// in it.
    fn needs_vertex(&self, quad: Quadrilateral, side: usize) -> bool {
        let (face, between) = self.face(quad, side);
        if self.filled_beyond(quad, face, between).is_some() {
            return true;
        }
        !self.passes(face, between.map(|v| self.positions[v as usize]))
    }

    /// Whether the segment between points below and above a face passes through the inside of its part.
    fn passes(&self, face: Face, between: [Vec3; 2]) -> bool {
        let [low, high] = between.map(Vec3::as_dvec3);
        let [least, most] = [[false; 2], [true; 2]].map(|of| self.grid.position(face.corner(of)).as_dvec3());
        let plane = least[face.across];
        let ways = [plane - low[face.across], high[face.across] - plane];
        // Both are of positive length, but where numbers are too coarse for points within cells.
        if !(ways[0] > 0.0 && ways[1] > 0.0) {
            return false;
        }
        let at = low + (high - low) * (ways[0] / (ways[0] + ways[1]));
        let [a, b] = face.axes().map(|axis| (at[axis] - least[axis]) / (most[axis] - least[axis]));
        let room = match face.half {
            None => a.min(1.0 - a).min(b).min(1.0 - b),
            Some(half) => {
                let [a, b] = [if half[0] { 1.0 - a } else { a }, if half[1] { 1.0 - b } else { b }];
                a.min(b).min(1.0 - a - b)
            }
        };
        if room.abs() > SURE {
            return room > 0.0;
        }
        let (rim, corners) = face.rim();
        let side = |i: usize| {
            let [p, q] = [rim[i], rim[(i + 1) % corners]].map(|corner| self.grid.position(corner));
            orientation([between[0], between[1], p, q])
        };
        let first = side(0);
        first != 0.0 && (1..corners).all(|i| side(i) * first.signum() > 0.0)
    }

    /// The face that a side passes, as far as it is its loops', and the vertices on its low and its high side. Of cells of two sizes it is
    /// that of the smaller one.
    fn face(&self, quad: Quadrilateral, side: usize) -> (Face, [u32; 2]) {
        let [a, b] = [quad.corners[side], quad.corners[(side + 1) % 4]];
        let [of_a, of_b] = [a, b].map(|v| self.leaf(v));
        let across = (0..3).find(|&axis| of_a[axis] != of_b[axis]).unwrap_or(0);
        let [low, high] = if of_a[across] < of_b[across] { [a, b] } else { [b, a] };
        let half = |v: u32, is_high: bool| self.loop_of(v).region.half(across, is_high);
        let half = half(low, true).or(half(high, false));
        let cells = [low, high].map(|v| self.cell(v));
        let (mut lowest, size) = if cells[0].1 < cells[1].1 { cells[0] } else { cells[1] };
        lowest[across] = self.leaf(high)[across];
        (Face { lowest, size, across, half }, [low, high].map(|v| self.standing(v)))
    }

    /// The face that gets a vertex for a side.
    pub(super) fn face_of_vertex(&self, quad: Quadrilateral, side: usize) -> Face {
        let (face, between) = self.face(quad, side);
        // What fills a loop does not know the regions beyond, and puts its vertex where it fits all that there can be.
        match self.filled_beyond(quad, face, between) {
            Some(half) => Face { half, ..face },
            None => face,
        }
    }

    /// If a loop on either side is cut, and goes on from the quadrilateral's edge across the face to an edge without one: the corner that it
    /// goes round in the face, if it is one.
    fn filled_beyond(
        &self,
        quad: Quadrilateral,
        face: Face,
        [low, high]: [u32; 2],
    ) -> Option<Option<[bool; 2]>> {
        let table = Table::get(VertexPer::Loop);
        let edge = self.edge(quad);
        [(low, true), (high, false)].into_iter().find_map(|(v, is_high)| {
            let of = self.loop_of(v);
            if of.open == 0 || !of.is_cut() {
                return None;
            }
            let cell = self.leaf(v);
            let corner = (0..3).fold(0, |set, axis| set | u8::from(edge.from[axis] > cell[axis]) << axis);
            let own = table.number(corner, edge.axis);
            let at = of.edges.iter().position(|&other| other == own)?;
            let count = of.edges.len();
            let beside = [(at + 1) % count, (at + count - 1) % count].map(|beside| of.edges[beside]);
            let next = beside.into_iter().find(|&other| is_on_face(table, other, face.across, is_high))?;
            (of.open >> next & 1 != 0).then(|| corner_between(table, [own, next], face.across))
        })
    }
}
