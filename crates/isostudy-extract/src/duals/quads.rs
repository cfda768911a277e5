//! Quadrilateral pass: one round each crossed edge that four cells share, as two triangles.

use std::cmp::Ordering;
use std::collections::TryReserveError;

use glam::Vec3;

use super::plan::Plans;
use super::vertices::Record;
use crate::cubes::grid::CubeGrid;
use crate::cubes::records::Records;
use crate::cubes::sampling::Samples;
use crate::lattice::Part;
use crate::sampling::bits::between;
use crate::sampling::level::Level;
use crate::sampling::rows::next;
use crate::surface::triangulation::Triangulation;

/// Of the four cells round an edge along x, y or z, how many cells back each is, along the two other axes in cyclic order; counter-clockwise
/// seen against the edge.
pub(crate) const ROUND: [[usize; 2]; 4] = [[1, 1], [0, 1], [0, 0], [1, 0]];

/// Of each axis and cell, the corner of the cell that the edge begins at.
pub(super) const CORNERS: [[u8; 4]; 3] = {
    let mut corners = [[0; 4]; 3];
    let mut axis = 0;
    while axis < 3 {
        let mut cell = 0;
        while cell < 4 {
            let [first, second] = ROUND[cell];
            corners[axis][cell] = (first << ((axis + 1) % 3) | second << ((axis + 2) % 3)) as u8;
            cell += 1;
        }
        axis += 1;
    }
    corners
};

/// How far the diagonals pass each other where corners are not in one plane, in spacings.
const BENT: f32 = 1e-3;

/// The corners of a quadrilateral round an edge: that in the lowest cell, and on from there, counter-clockwise seen against the edge.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Quadrilateral {
    pub(super) corners: [u32; 4],
    /// Whether the edge leads out of the solid.
    pub(super) leads_out: bool,
}

impl Quadrilateral {
    /// The one that two triangles were made of.
    pub(super) fn of([first, second]: [[u32; 3]; 2]) -> Self {
        let leads_out = first[2] == second[1];
        let mut corners = match leads_out {
            true => [first[0], first[1], first[2], second[2]],
            false => [first[0], first[2], first[1], second[1]],
        };
        // Vertices are numbered by their cells, so that in the lowest has the least number. Cut the other way, it is the last.
        if corners[3] < corners[0] {
            corners.rotate_right(1);
        }
        Self { corners, leads_out }
    }

    /// Two triangles, on either side of the diagonal through the lowest cell or of the other.
    #[inline]
    pub(super) fn cut(self, by_other: bool) -> [[u32; 3]; 2] {
        let [a, b, c, d] = self.corners;
        let [a, b, c, d] = if by_other { [b, c, d, a] } else { [a, b, c, d] };
        if self.leads_out { [[a, b, c], [a, c, d]] } else { [[a, c, b], [a, d, c]] }
    }

    /// Two triangles, on either side of the shorter diagonal; of equal ones, of that through the lowest cell.
    pub(super) fn by_shorter_diagonal(self, positions: &[Vec3]) -> [[u32; 3]; 2] {
        self.cut(is_other_shorter(self.corners.map(|corner| positions[corner as usize])))
    }
}

/// Whether the diagonal from the second corner to the fourth is shorter than that through the lowest cell.
#[inline(always)]
fn is_other_shorter([a, b, c, d]: [Vec3; 4]) -> bool {
    b.distance_squared(d) < a.distance_squared(c)
}

/// Whether the diagonal from the second corner to the fourth is better than that through the lowest cell: shorter. Where tangent planes
/// were asked for and the corners are not in one plane, it is the one with its middle nearer to the isovalue: an edge of the object that
/// runs from corner to corner is a diagonal then. Where they are in one plane, none that leaves the quadrilateral is taken.
#[inline]
pub(crate) fn is_other_better(level: Option<Level>, corners: [Vec3; 4]) -> bool {
    let is_shorter = is_other_shorter(corners);
    match level {
        Some(level) if cfg!(feature = "dual-contouring") => is_other_sharper(level, corners, is_shorter),
        _ => is_shorter,
    }
}

/// The same where tangent planes were asked for.
fn is_other_sharper(level: Level, corners: [Vec3; 4], is_shorter: bool) -> bool {
    let [a, b, c, d] = corners;
    let normal = (c - a).cross(d - b);
    let apart = (b - a).dot(normal).abs();
    // Not a number is in the plane.
    if apart > BENT * level.spacing * normal.length() {
        let [lowest, other] = [a.midpoint(c), b.midpoint(d)].map(|middle| level.difference(middle).abs());
        return match other.partial_cmp(&lowest) {
            Some(Ordering::Less) => true,
            Some(Ordering::Greater) => false,
            _ => is_shorter,
        };
    }
    // On either side of a diagonal within there is a triangle that faces as the other does.
    let faces = |[a, b, c]: [Vec3; 3]| (b - a).cross(c - a);
    let lowest = faces([a, b, c]).dot(faces([a, c, d]));
    let other = faces([b, c, d]).dot(faces([b, d, a]));
    if (lowest > 0.0) == (other > 0.0) { is_shorter } else { other > 0.0 }
}

/// What the pass reads. Records are those of the cells above a layer of points and below it.
pub(super) struct QuadPass<'a> {
    pub(super) grid: &'a CubeGrid<'a>,
    pub(super) samples: &'a Samples,
    pub(super) plans: &'a Plans,
    pub(super) records: &'a Records<Record>,
    /// By the numbers in the records.
    pub(super) positions: &'a [Vec3],
    /// Of a field that decides on diagonals.
    pub(super) level: Option<Level<'a>>,
    /// The points whose edges have quadrilaterals.
    pub(super) part: Part,
}

impl QuadPass<'_> {
    /// Visits the edges that begin in a layer of points, and says how many are crossed. Those in a face of the box have no
    /// quadrilateral: two of their cells are missing.
    pub(super) fn layer(&self, z: usize, result: &mut Triangulation) -> Result<u64, TryReserveError> {
        let [_, ny, nz] = self.grid.size;
        let mut crossings = 0;
        let Part { start, end } = self.part;
        if !self.part.has(2, z) {
            return Ok(crossings);
        }
        // Beyond the last cells there are points, whose edges are counted.
        let end =
            [0, 1].map(|axis| if end[axis] + 1 == self.grid.size[axis] { end[axis] + 1 } else { end[axis] });
        for y in start[1]..end[1] {
            // Of the rows of cells round an edge; the lower ones of the first row and layer are asked for by none.
            let (back, below) = (y.saturating_sub(1), z.saturating_sub(1));
            let rows = [[back, below], [y, below], [back, z], [y, z]].map(|[y, z]| self.records.start(y, z));
            for word in 0..self.grid.words {
                let Some((here, crossed)) = self.crossed([y, z], word) else { break };
                crossings += crossed.iter().map(|bits| u64::from(bits.count_ones())).sum::<u64>();
                let of_part = between(word, start[0], end[0]);
                let inner = between(word, 1, self.grid.size[0] - 1) & of_part;
                let (y_inner, z_inner) = (0 < y && y + 1 < ny, 0 < z && z + 1 < nz);
                let shared = [
                    if y_inner && z_inner { crossed[0] & of_part } else { 0 },
                    if z_inner { crossed[1] & inner } else { 0 },
                    if y_inner { crossed[2] & inner } else { 0 },
                ];
                let mut left = shared[0] | shared[1] | shared[2];
                let quadrilaterals = shared.iter().map(|bits| bits.count_ones() as usize).sum::<usize>();
                result.triangles.try_reserve(2 * quadrilaterals)?;
                while left != 0 {
                    let bit = left.trailing_zeros();
                    left &= left - 1;
                    let place = [64 * word + bit as usize, y, z];
                    let (x, leads_out) = (place[0], here >> bit & 1 != 0);
                    let is_shared = |axis: usize| shared[axis] >> bit & 1 != 0;
                    let [low_low, high_low, low_high, high_high] = rows;
                    if is_shared(0) {
                        let cells = [low_low + x, high_low + x, high_high + x, low_high + x];
                        result.triangles.extend_from_slice(&self.quadrilateral(cells, 0, leads_out));
                    }
                    if is_shared(1) {
                        let cells = [high_low + x - 1, high_high + x - 1, high_high + x, high_low + x];
                        result.triangles.extend_from_slice(&self.quadrilateral(cells, 1, leads_out));
                    }
                    if is_shared(2) {
                        let cells = [low_high + x - 1, low_high + x, high_high + x, high_high + x - 1];
                        result.triangles.extend_from_slice(&self.quadrilateral(cells, 2, leads_out));
                    }
                    if let Some(trace) = &mut result.trace {
                        trace.close_cell(self.part.number(place), result.triangles.len())?;
                    }
                }
            }
        }
        Ok(crossings)
    }

    /// How many edges that begin in a layer of points are crossed.
    pub(super) fn crossings(&self, z: usize) -> u64 {
        let words = |y| (0..self.grid.words).filter_map(move |word| self.crossed([y, z], word));
        let count = |(_, crossed): (u64, [u64; 3])| {
            crossed.iter().map(|bits| u64::from(bits.count_ones())).sum::<u64>()
        };
        (0..self.grid.size[1]).flat_map(words).map(count).sum()
    }

    /// The points of a word that are inside, and those at which crossed edges along x, y and z begin; `None` if the row has none.
    fn crossed(&self, [y, z]: [usize; 2], word: usize) -> Option<(u64, [u64; 3])> {
        let grid = self.grid;
        let [nx, ny, nz] = grid.size;
        // Where there is no next row or layer, this one: no edge leads there.
        let rows = [[y, z], [(y + 1).min(ny - 1), z], [y, (z + 1).min(nz - 1)]];
        if self.samples.is_uniform(&rows) {
            return None;
        }
        let lines = rows.map(|[y, z]| self.samples.sides.row(y, z));
        let (here, points) = (lines[0][word], between(word, 0, nx));
        let crossed = [
            (here ^ next(lines[0], word)) & grid.with_next(word),
            (here ^ lines[1][word]) & points,
            (here ^ lines[2][word]) & points,
        ];
        Some((here, crossed))
    }

    /// The two triangles round an edge along an axis, on either side of the better diagonal. `cells` are the places of the records of the
    /// cells round it, as [`ROUND`] has them.
    #[inline(always)]
    fn quadrilateral(&self, cells: [usize; 4], axis: usize, leads_out: bool) -> [[u32; 3]; 2] {
        let [a, b, c, d] = cells;
        let of = CORNERS[axis];
        let corners = [
            self.vertex(a, of[0], axis),
            self.vertex(b, of[1], axis),
            self.vertex(c, of[2], axis),
            self.vertex(d, of[3], axis),
        ];
        let [a, b, c, d] = corners;
        let place = |v: u32| self.positions[v as usize];
        let by_other = is_other_better(self.level, [place(a), place(b), place(c), place(d)]);
        Quadrilateral { corners, leads_out }.cut(by_other)
    }

    /// The vertex of a cell that the edge from one of its corners along an axis leads to.
    #[inline(always)]
    fn vertex(&self, place: usize, corner: u8, axis: usize) -> u32 {
        let record = self.records.at(place);
        record.first.wrapping_add(self.plans.vertex(record.plan, self.plans.table.number(corner, axis)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn triangles_say_what_they_were_made_of() {
        for corners in [[2, 3, 9, 4], [0, 5, 7, 1]] {
            for leads_out in [false, true] {
                let quadrilateral = Quadrilateral { corners, leads_out };
                for by_other in [false, true] {
                    assert_eq!(Quadrilateral::of(quadrilateral.cut(by_other)), quadrilateral);
                }
            }
        }
    }
}
