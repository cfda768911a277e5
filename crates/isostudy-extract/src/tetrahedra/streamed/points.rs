//! Vertex pass: the crossings round every point of a layer, clustered and placed.
//!
//! Signs are compared 64 points at a time. A point whose side differs from that of a neighbour builds the set of its
//! crossing edges and of those that are nearer to it, all by itself; every crossing is looked at from both its ends.

use std::collections::TryReserveError;

use glam::{Vec3, Vec3A};

use super::crossings::{Crossings, Lines};
use super::grid::{LINES, UniformGrid};
use super::records::{Numbering, Record, Records};
use super::rule::ClusterRule;
use super::signs::Signs;
use crate::lattice::{DIRECTIONS, DirectionSet, members};
use crate::placement::spot::{Apart, Company, linear_ratio};
use crate::placement::{CrossingPlacer, Surroundings};
use crate::slabs::Vertices;
use crate::surface::trace::VertexKey;

/// Samples, by row.
#[derive(Clone, Copy)]
pub(super) struct Samples<'a> {
    pub(super) values: &'a [f32],
    /// Layers kept: a ring, or all there are.
    pub(super) slots: usize,
}

/// What the pass reads.
pub(super) struct PointPass<'a, R> {
    pub(super) grid: &'a UniformGrid,
    pub(super) rule: &'a R,
    pub(super) samples: Samples<'a>,
    pub(super) signs: &'a Signs,
    pub(super) isovalue: f32,
    pub(super) apart: Apart,
    /// Places the vertices of the slab's own layers once more.
    pub(super) placer: Option<&'a CrossingPlacer<'a>>,
    /// Whether vertices have more than a position.
    pub(super) has_more: bool,
}

/// A point with a crossing.
struct Point {
    column: usize,
    row: usize,
    position: Vec3,
    inside: bool,
    crossing: DirectionSet,
    present: DirectionSet,
    /// Whether all neighbours are as far as the spacing says.
    regular: bool,
}

impl<R: ClusterRule> PointPass<'_, R> {
    /// Visits a layer. Vertices go to `positions`, if there are any to be kept.
    pub(super) fn layer(
        &self,
        layer: usize,
        records: &mut Records,
        placed: &mut Vertices,
        mut positions: Option<&mut Vec<Vec3>>,
    ) -> Result<(), TryReserveError> {
        records.open_layer(layer);
        let kind = self.grid.layout.kind(layer);
        let rows = self.grid.layout.used(kind)[1];
        let layers = self.grid.layers(kind, layer);
        let around = self.grid.neighbourhood(kind);
        let used = self.grid.layout.used(kind)[0];
        let [signs, samples] = [self.signs.slots, self.samples.slots]
            .map(|slots| layers.map(|layer| layer % slots * self.grid.size[1]));
        for row in 0..rows {
            let rows = self.grid.rows(kind, row, layer, &layers);
            let Some(lines) = Lines::new(self.signs, around, &rows, &signs, used) else { continue };
            let samples = std::array::from_fn(|i| (samples[rows[i].0] + rows[i].1) * self.grid.size[0]);
            self.row([row, layer], &lines, &samples, records, placed, positions.as_deref_mut())?;
        }
        Ok(())
    }

    fn row(
        &self,
        [row, layer]: [usize; 2],
        lines: &Lines,
        samples: &[usize; LINES],
        records: &mut Records,
        placed: &mut Vertices,
        mut positions: Option<&mut Vec<Vec3>>,
    ) -> Result<(), TryReserveError> {
        let grid = self.grid;
        let kind = grid.layout.kind(layer);
        let around = grid.neighbourhood(kind);
        let used = grid.layout.used(kind)[0];
        let incident = grid.incident(kind, row, layer);
        let neighbours: [usize; 16] = std::array::from_fn(|d| {
            let d = d % DIRECTIONS;
            samples[around.line[d]].wrapping_add_signed(around.shift[d])
        });
        let record_start = records.row_start(row, layer);
        let coordinates = &grid.coordinates;
        let regular_row = coordinates.is_regular_along(1, row) && coordinates.is_regular_along(2, layer);
        let x = grid.coordinates.x(kind);
        let (y, z) = (grid.coordinates.y(kind)[row], grid.coordinates.z()[layer]);
        lines.visit(grid, |Crossings { word, sides, mut active, differ }| {
            // So that memory running out is an error, and pushing never grows by itself. By word: a row can be long.
            let points = active.count_ones() as usize;
            if let Some(positions) = positions.as_deref_mut() {
                positions.try_reserve(points * DIRECTIONS)?;
                if self.placer.is_some() {
                    placed.targets.try_reserve(points * DIRECTIONS)?;
                }
                if let Some(keys) = &mut placed.keys {
                    keys.try_reserve(points * DIRECTIONS)?;
                }
            }
            records.reserve_lists(layer, points)?;
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
                let inside = sides >> bit & 1 != 0;
                let regular = regular_row && coordinates.is_regular_along(0, column);
                let point = Point { column, row, position, inside, crossing, present, regular };
                let record = self.point(
                    &point,
                    samples[0],
                    &neighbours,
                    layer,
                    records,
                    placed,
                    positions.as_deref_mut(),
                );
                records.set(record_start + column, record);
            }
            records.set_active(row, layer, word, active);
            Ok(())
        })
    }

    #[inline(always)]
    #[allow(clippy::too_many_arguments, reason = "the body of the innermost loop")]
    fn point(
        &self,
        point: &Point,
        row_start: usize,
        neighbours: &[usize; 16],
        layer: usize,
        records: &mut Records,
        placed: &mut Vertices,
        mut positions: Option<&mut Vec<Vec3>>,
    ) -> Record {
        let &Point { column, inside, crossing, present, .. } = point;
        let values = self.samples.values;
        let value = values[row_start + column];
        let difference = self.isovalue - value;
        placed.crossing_ends += u64::from(crossing.count_ones());

        let mut near = 0;
        let mut there = [0.0; 16];
        let mut left = crossing;
        while left != 0 {
            let direction = left.trailing_zeros() as usize & 15;
            left &= left - 1;
            let neighbour = values[neighbours[direction].wrapping_add(column)];
            there[direction] = neighbour;
            let is_near = R::TIES.is_near(inside, difference, self.isovalue - neighbour);
            near |= DirectionSet::from(is_near) << direction;
        }
        let first = placed.numbered as u32;
        if near == 0 {
            return Record::new(first, near, crossing, inside, Numbering::One);
        }
        let place = |cluster: DirectionSet, company: Company| {
            self.place(point, layer, cluster, company, value, difference, &there)
        };
        if self.rule.is_one(crossing, near, present) {
            placed.numbered += 1;
            if let Some(positions) = positions {
                positions.push(place(near, Company::Alone));
                if self.has_more {
                    self.add_more(point, layer, &[near], row_start, neighbours, placed);
                }
            }
            return Record::new(first, near, crossing, inside, Numbering::One);
        }
        let clusters = self.rule.partition(crossing, near, present);
        let count = clusters.sets().len();
        let company = Company::of(count, near.count_ones());
        placed.numbered += count as u64;
        if let Some(positions) = &mut positions {
            positions.extend(clusters.sets().iter().map(|&cluster| place(cluster, company)));
            if self.has_more {
                self.add_more(point, layer, clusters.sets(), row_start, neighbours, placed);
            }
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

    /// The keys of the clusters' vertices, and where the placer wants them, if there is one.
    #[cold]
    #[inline(never)]
    fn add_more(
        &self,
        point: &Point,
        layer: usize,
        clusters: &[DirectionSet],
        row_start: usize,
        neighbours: &[usize; 16],
        placed: &mut Vertices,
    ) {
        if let Some(keys) = &mut placed.keys {
            let lattice = &self.grid.lattice;
            let (arrangement, stored) =
                (lattice.arrangement(), lattice.stored([point.column, point.row, layer]));
            let key = |set: &DirectionSet| VertexKey::new(arrangement, stored, set.trailing_zeros() as usize);
            keys.extend(clusters.iter().map(key));
        }
        let Some(placer) = self.placer else { return };
        let values = self.samples.values;
        let difference = |place: usize| values[place] - self.isovalue;
        let mut around = Surroundings {
            position: point.position,
            difference: difference(row_start + point.column),
            neighbours: [f32::NAN; DIRECTIONS],
            ways: (!point.regular).then(|| self.ways(point, layer)),
        };
        for d in members(point.present) {
            around.neighbours[d] = difference(neighbours[d].wrapping_add(point.column));
        }
        placed.targets.extend(clusters.iter().map(|&cluster| placer.place(&around, cluster)));
    }

    /// The unweighted mean of the cluster's crossings, clamped to the box.
    #[inline(always)]
    #[allow(clippy::too_many_arguments, reason = "the body of the innermost loop")]
    fn place(
        &self,
        point: &Point,
        layer: usize,
        cluster: DirectionSet,
        company: Company,
        value: f32,
        difference: f32,
        there: &[f32; 16],
    ) -> Vec3 {
        let (grid, position) = (self.grid, Vec3A::from(point.position));
        let apart = self.apart.at(point.position);
        let ratio = |direction: usize| {
            apart.ratio(company, direction, linear_ratio(difference, value, there[direction]))
        };
        if !point.regular {
            return self.place_at_border(point, layer, cluster, ratio);
        }
        let mut sum = Vec3A::ZERO;
        let mut left = cluster;
        while left != 0 {
            let direction = left.trailing_zeros() as usize & 15;
            left &= left - 1;
            sum += grid.edges[direction] * ratio(direction) + position;
        }
        let mean = sum / cluster.count_ones() as f32;
        let is_inside = mean.cmpgt(grid.low) & mean.cmplt(grid.high);
        let bounds = grid.lattice.bounds();
        if is_inside.all() { Vec3::from(mean) } else { Vec3::from(mean).min(bounds.max).max(bounds.min) }
    }

    /// The same next to the box.
    #[cold]
    #[inline(never)]
    fn place_at_border(
        &self,
        point: &Point,
        layer: usize,
        cluster: DirectionSet,
        ratio: impl Fn(usize) -> f32,
    ) -> Vec3 {
        let (ways, bounds) = (self.ways(point, layer), self.grid.lattice.bounds());
        let mut sum = Vec3::ZERO;
        for direction in members(cluster) {
            sum += ways[direction] * ratio(direction) + point.position;
        }
        (sum / cluster.count_ones() as f32).min(bounds.max).max(bounds.min)
    }

    fn ways(&self, point: &Point, layer: usize) -> [Vec3; DIRECTIONS] {
        let UniformGrid { coordinates, layout, directions, .. } = self.grid;
        coordinates.ways(layout, [point.column, point.row, layer], point.present, &directions.offsets)
    }
}

/// One bit of each word.
#[inline(always)]
fn gather(words: &[u64; DIRECTIONS], bit: u32) -> DirectionSet {
    words.iter().enumerate().fold(0, |set, (d, &word)| set | ((word >> bit & 1) as DirectionSet) << d)
}
