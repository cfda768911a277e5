//! Quadrilateral pass: one round each crossed edge that four cells share, as two triangles.

use std::cmp::Ordering;
use std::collections::TryReserveError;

use glam::Vec3;

use super::super::grid::Grid;
use super::super::records::Records;
use super::super::rows::next;
use super::super::sampling::Samples;
use super::plan::Plans;
use super::vertices::Record;
use crate::bits::between;
use crate::level::Level;
use crate::triangles::Triangulation;

/// Of the four cells round an edge along x, y or z, how many cells back each is, along the two other axes in cyclic order; counter-clockwise
/// seen against the edge.
const ROUND: [[usize; 2]; 4] = [[1, 1], [0, 1], [0, 0], [1, 0]];

/// How far the diagonals pass each other where corners are not in one plane, in spacings.
const BENT: f32 = 1e-3;

/// What the pass reads. Records are those of the cells above a layer of points and below it.
pub(super) struct QuadPass<'a> {
    pub(super) grid: &'a Grid<'a>,
    pub(super) samples: &'a Samples,
    pub(super) plans: &'a Plans,
    pub(super) records: &'a Records<Record>,
    /// By the numbers in the records.
    pub(super) positions: &'a [Vec3],
    /// Of a field that decides on diagonals.
    pub(super) level: Option<Level<'a>>,
}

impl QuadPass<'_> {
    /// Visits the edges that begin in a layer of points, and says how many are crossed. Those in a face of the box have no
    /// quadrilateral: two of their cells are missing.
    pub(super) fn layer(&self, z: usize, result: &mut Triangulation) -> Result<u64, TryReserveError> {
        let [_, ny, nz] = self.grid.size;
        let mut crossings = 0;
        for y in 0..ny {
            for word in 0..self.grid.words {
                let Some((here, crossed)) = self.crossed([y, z], word) else { break };
                crossings += crossed.iter().map(|bits| u64::from(bits.count_ones())).sum::<u64>();
                let inner = between(word, 1, self.grid.size[0] - 1);
                let (y_inner, z_inner) = (0 < y && y + 1 < ny, 0 < z && z + 1 < nz);
                let shared = [
                    if y_inner && z_inner { crossed[0] } else { 0 },
                    if z_inner { crossed[1] & inner } else { 0 },
                    if y_inner { crossed[2] & inner } else { 0 },
                ];
                let mut left = shared[0] | shared[1] | shared[2];
                while left != 0 {
                    let bit = left.trailing_zeros();
                    left &= left - 1;
                    let place = [64 * word + bit as usize, y, z];
                    result.triangles.try_reserve(6)?;
                    for axis in (0..3).filter(|&axis| shared[axis] >> bit & 1 != 0) {
                        result.triangles.extend(self.quadrilateral(place, axis, here >> bit & 1 != 0));
                    }
                    if let Some(trace) = &mut result.trace {
                        trace.close_cell(self.grid.lattice, place, result.triangles.len())?;
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
        if self.samples.is_uniform(grid, &rows) {
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

    /// The two triangles round an edge, on either side of the better diagonal.
    fn quadrilateral(&self, place: [usize; 3], axis: usize, leads_out: bool) -> [[u32; 3]; 2] {
        let across = [(axis + 1) % 3, (axis + 2) % 3];
        let mut corners = ROUND.map(|back| {
            let (mut cell, mut corner) = (place, 0);
            for (axis, back) in across.into_iter().zip(back) {
                cell[axis] -= back;
                corner |= (back as u8) << axis;
            }
            let [x, y, z] = cell;
            let record = self.records.at(self.records.start(y, z) + x);
            let edge = self.plans.table.number(corner, axis);
            record.first + self.plans.at(record.plan).of_edge(edge)
        });
        if self.is_other_better(corners.map(|corner| self.positions[corner as usize])) {
            corners.rotate_left(1);
        }
        let [a, b, c, d] = corners;
        if leads_out { [[a, b, c], [a, c, d]] } else { [[a, c, b], [a, d, c]] }
    }

    /// Whether the diagonal from the second corner to the fourth is better than that through the lowest cell: shorter; or where tangent
    /// planes were asked for and the corners are not in one plane, with its middle nearer to the isovalue. An edge of the object
    /// that runs from corner to corner is a diagonal then.
    fn is_other_better(&self, [a, b, c, d]: [Vec3; 4]) -> bool {
        let is_shorter = b.distance_squared(d) < a.distance_squared(c);
        let Some(level) = self.level else { return is_shorter };
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
        is_shorter
    }
}
