//! Vertex pass: the crossings round every point of a layer, clustered and placed.
//!
//! Signs are compared 64 points at a time. A point whose side differs from that of a neighbour builds the set of its
//! crossing edges and of those that are nearer to it, all by itself; every crossing is looked at from both its ends.

use glam::Vec3;

use super::grid::{Grid, LINES};
use super::records::{Numbering, Record, Records};
use super::rule::ClusterRule;
use super::signs::{MIXED, Signs, used_bits};
use crate::lattice::{DIRECTIONS, DirectionSet, members};

/// Samples, by row.
#[derive(Clone, Copy)]
pub(super) struct Samples<'a> {
    pub(super) values: &'a [f32],
    /// Layers kept: a ring, or all there are.
    pub(super) slots: usize,
    pub(super) size: [usize; 2],
}

impl Samples<'_> {
    #[inline]
    pub(super) fn row_start(&self, row: usize, layer: usize) -> usize {
        (layer % self.slots * self.size[1] + row) * self.size[0]
    }
}

/// What the pass reads.
pub(super) struct PointPass<'a, R> {
    pub(super) grid: &'a Grid,
    pub(super) rule: &'a R,
    pub(super) samples: Samples<'a>,
    pub(super) signs: &'a Signs,
    pub(super) isovalue: f32,
}

/// What the pass counts and writes.
#[derive(Debug, Default)]
pub(super) struct Placed {
    /// Vertices numbered so far, in the slab's own layers and in those below that it only needs the numbers of.
    pub(super) numbered: u64,
    /// Crossings seen, each once from either end.
    pub(super) crossing_ends: u64,
}

/// A point with a crossing.
struct Point {
    column: usize,
    position: Vec3,
    inside: bool,
    crossing: DirectionSet,
    present: DirectionSet,
}

impl<R: ClusterRule> PointPass<'_, R> {
    /// Visits a layer. Vertices go to `positions`, if there are any to be kept.
    pub(super) fn layer(
        &self,
        layer: usize,
        records: &mut Records,
        placed: &mut Placed,
        mut positions: Option<&mut Vec<Vec3>>,
    ) -> Result<(), std::collections::TryReserveError> {
        records.open_layer(layer);
        let kind = self.grid.layout.kind(layer);
        let rows = self.grid.layout.used(kind)[1];
        for row in 0..rows {
            let lines = self.grid.lines(kind, row, layer);
            let state = self.signs.state(row, layer);
            if state != MIXED && lines.iter().all(|&[y, z]| self.signs.state(y, z) == state) {
                continue;
            }
            if let Some(positions) = positions.as_deref_mut() {
                // So that memory running out is an error, and pushing never grows by itself.
                positions.try_reserve(self.grid.size[0] * DIRECTIONS)?;
            }
            self.row(row, layer, &lines, records, placed, positions.as_deref_mut());
        }
        Ok(())
    }

    fn row(
        &self,
        row: usize,
        layer: usize,
        lines: &[[usize; 2]; LINES],
        records: &mut Records,
        placed: &mut Placed,
        mut positions: Option<&mut Vec<Vec3>>,
    ) {
        let grid = self.grid;
        let kind = grid.layout.kind(layer);
        let around = grid.neighbourhood(kind);
        let used = grid.layout.used(kind)[0];
        let incident = grid.incident(kind, row, layer);
        let signs = lines.map(|[y, z]| self.signs.row(y, z));
        let samples = lines.map(|[y, z]| self.samples.row_start(y, z));
        let neighbours: [usize; DIRECTIONS] =
            std::array::from_fn(|d| samples[around.line[d]].wrapping_add_signed(around.shift[d]));
        let record_start = records.row_start(row, layer);
        let x = grid.coordinates.x(kind);
        let (y, z) = (grid.coordinates.y(kind)[row], grid.coordinates.z()[layer]);

        for word in 0..grid.words {
            if is_uniform(&signs, word + 1) {
                continue;
            }
            let own = signs[0][word + 1];
            let mut differ = [0; DIRECTIONS];
            let mut any = 0;
            for (d, differ) in differ.iter_mut().enumerate() {
                *differ = own ^ shifted(signs[around.line[d]], word + 1, around.shift[d]);
                any |= *differ;
            }
            let mut active = any & used_bits(word, used);
            let mut left = active;
            while left != 0 {
                let bit = left.trailing_zeros();
                left &= left - 1;
                let column = 64 * word + bit as usize;
                let present = match column {
                    0 => incident[0],
                    _ if column + 1 == used => incident[2],
                    _ => incident[1],
                };
                let crossing = gather(&differ, bit) & present;
                if crossing == 0 {
                    active &= !(1 << bit);
                    continue;
                }
                let position = Vec3::new(x[column], y, z);
                let inside = own >> bit & 1 != 0;
                let point = Point { column, position, inside, crossing, present };
                let record =
                    self.point(&point, samples[0], &neighbours, layer, records, placed, positions.as_deref_mut());
                records.set(record_start + column, record);
            }
            records.set_active(row, layer, word, active);
        }
    }

    #[inline]
    #[allow(clippy::too_many_arguments, reason = "the body of the innermost loop")]
    fn point(
        &self,
        point: &Point,
        row_start: usize,
        neighbours: &[usize; DIRECTIONS],
        layer: usize,
        records: &mut Records,
        placed: &mut Placed,
        mut positions: Option<&mut Vec<Vec3>>,
    ) -> Record {
        let &Point { column, inside, crossing, present, .. } = point;
        let values = self.samples.values;
        let value = values[row_start + column];
        let difference = self.isovalue - value;
        placed.crossing_ends += u64::from(crossing.count_ones());

        let mut near = 0;
        let mut there = [0.0; 16];
        for direction in members(crossing) {
            let neighbour = values[neighbours[direction & 15].wrapping_add(column)];
            there[direction & 15] = neighbour;
            let is_near = R::TIES.is_near(inside, difference, self.isovalue - neighbour);
            near |= DirectionSet::from(is_near) << direction;
        }
        let first = placed.numbered as u32;
        if near == 0 {
            return Record::new(first, near, crossing, inside, Numbering::One);
        }
        let place = |cluster: DirectionSet| self.place(point, cluster, value, difference, &there);
        if self.rule.is_one(crossing, near, present) {
            placed.numbered += 1;
            if let Some(positions) = positions {
                positions.push(place(near));
            }
            return Record::new(first, near, crossing, inside, Numbering::One);
        }
        let clusters = self.rule.partition(crossing, near, present);
        let count = clusters.sets().len();
        placed.numbered += count as u64;
        if let Some(positions) = &mut positions {
            positions.extend(clusters.sets().iter().map(|&cluster| place(cluster)));
        }
        if count == 1 {
            Record::new(first, near, crossing, inside, Numbering::One)
        } else if count == near.count_ones() as usize {
            Record::new(first, near, crossing, inside, Numbering::Ranked)
        } else {
            let place = records.list(layer, first, &clusters);
            Record::new(place, near, crossing, inside, Numbering::Listed)
        }
    }

    /// The unweighted mean of the cluster's crossings, clamped to the box.
    #[inline]
    fn place(
        &self,
        point: &Point,
        cluster: DirectionSet,
        value: f32,
        difference: f32,
        there: &[f32; 16],
    ) -> Vec3 {
        let mut sum = Vec3::ZERO;
        for direction in members(cluster) {
            let ratio = difference / (there[direction & 15] - value);
            // Samples that are not numbers, or two infinities, say nothing about the place.
            let ratio = if ratio.is_finite() { ratio } else { 0.5 };
            sum += self.grid.edges[direction] * ratio + point.position;
        }
        let bounds = self.grid.lattice.bounds();
        (sum / cluster.count_ones() as f32).min(bounds.max).max(bounds.min)
    }
}

/// Whether the points of a word and all their neighbours are on one side.
#[inline]
fn is_uniform(signs: &[&[u64]; LINES], word: usize) -> bool {
    let (mut any, mut all) = (0, !0);
    for line in signs {
        let (before, here, after) = (line[word - 1], line[word], line[word + 1]);
        any |= here | before >> 63 | after & 1;
        all &= here & !(!before >> 63) & !(!after & 1);
    }
    any == 0 || all == !0
}

/// A word of the row as seen from one point earlier or later.
#[inline]
fn shifted(line: &[u64], word: usize, shift: isize) -> u64 {
    match shift {
        0 => line[word],
        1 => line[word] >> 1 | line[word + 1] << 63,
        _ => line[word] << 1 | line[word - 1] >> 63,
    }
}

/// One bit of each word.
#[inline]
fn gather(words: &[u64; DIRECTIONS], bit: u32) -> DirectionSet {
    words.iter().enumerate().fold(0, |set, (d, &word)| set | ((word >> bit & 1) as DirectionSet) << d)
}
