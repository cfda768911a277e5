//! The points of the lattice: their sides, their crossings, the vertices that belong to them.

use std::collections::TryReserveError;

use glam::{DVec3, Vec3};

use super::Coordinates;
use super::cut::{Cut, Directions, Step};
use crate::ExtractError;
use crate::lattice::{Border, Lattice};
use crate::level::Level;
use crate::memory::filled;
use crate::placement::crossing_ratio;
use crate::settings::{ExtractSettings, Placement};
use crate::spot::{Apart, Company, linear_ratio};
use crate::trace::VertexKey;
use crate::vertices::Ties;

/// All points of the lattice, and what is known of those with a crossing.
pub(super) struct Points<'a> {
    lattice: &'a Lattice,
    cut: &'a Cut,
    grid: [usize; 3],
    /// 1 inside.
    sides: Vec<u8>,
    /// One more than the number of the point's record; 0 is none.
    record_of: Vec<u32>,
    records: Vec<Record>,
}

/// The crossings that belong to a point; their vertices are numbered from `first` on, by direction.
#[derive(Debug, Clone, Copy)]
struct Record {
    first: u32,
    near: Directions,
}

/// The vertices of all points.
#[derive(Debug, Default)]
pub(super) struct Vertices {
    pub(super) positions: Vec<Vec3>,
    /// Where the settings want them, if elsewhere.
    pub(super) targets: Vec<Vec3>,
    /// Lattice edges that cross the surface.
    pub(super) crossings: u64,
}

impl<'a> Points<'a> {
    pub(super) fn new(lattice: &'a Lattice, cut: &'a Cut) -> Result<Self, TryReserveError> {
        let grid = lattice.stored_grid().map(|n| n as usize);
        let len = grid.iter().product();
        Ok(Self {
            lattice,
            cut,
            grid,
            sides: filled(len, 0)?,
            record_of: filled(len, 0)?,
            records: Vec::new(),
        })
    }

    /// How many there are.
    pub(super) fn len(&self) -> usize {
        self.sides.len()
    }

    /// Points a row, rows a layer, layers.
    pub(super) fn grid(&self) -> [usize; 3] {
        self.grid
    }

    /// The place of a point in storage.
    pub(super) fn index(&self, [x, y, z]: [usize; 3]) -> usize {
        (z * self.grid[1] + y) * self.grid[0] + x
    }

    /// How much farther a place in a cube is stored than its lowest corner.
    pub(super) fn step(&self, place: Step) -> usize {
        self.index(place.map(|i| i as usize))
    }

    pub(super) fn is_inside(&self, point: usize) -> bool {
        self.sides[point] != 0
    }

    /// Inside is a value above the isovalue; equal is outside, and so is `NaN`.
    pub(super) fn find_sides(&mut self, samples: &[f32], isovalue: f32) {
        for (side, value) in self.sides.iter_mut().zip(samples) {
            *side = u8::from(isovalue - value < 0.0);
        }
    }

    /// The vertex of a crossing edge: of the end that is stored first, or else of the other.
    ///
    /// # Panics
    /// If neither end has one: the edge does not cross.
    pub(super) fn vertex(&self, from: usize, direction: u8, to: usize, back: u8) -> u32 {
        let of = |point: usize, direction: u8| {
            let record = self.records[self.record_of[point].checked_sub(1)? as usize];
            let before = record.near & ((1 << direction) - 1);
            (record.near >> direction & 1 != 0).then(|| record.first.wrapping_add(before.count_ones()))
        };
        of(from, direction).or_else(|| of(to, back)).expect("a crossing edge has a vertex at one of its ends")
    }

    /// Places a vertex on every crossing, point by point.
    pub(super) fn place(
        &mut self,
        samples: &[f32],
        coordinates: &Coordinates,
        settings: &ExtractSettings,
        level: Option<Level>,
        most_vertices: u32,
        mut keys: Option<&mut Vec<VertexKey>>,
    ) -> Result<Vertices, ExtractError> {
        let mut vertices = Vertices::default();
        let placer = Placer::new(self.lattice, self.cut, settings, level);
        let (ties, border) = (Ties::of(settings.topology), Border::of(settings));
        let first = self.lattice.first_stored().map(|i| i as usize);
        let strides = [1, self.grid[0] as isize, (self.grid[0] * self.grid[1]) as isize];
        let hops: Vec<isize> = self
            .cut
            .steps
            .iter()
            .map(|step| (0..3).map(|axis| isize::from(step[axis]) * strides[axis]).sum())
            .collect();
        let mut crossing_ends = 0;
        let mut mixed = filled(self.grid[0], 0)?;
        for (z, y) in (0..self.grid[2]).flat_map(|z| (0..self.grid[1]).map(move |y| (z, y))) {
            self.mark_mixed(y, z, &mut mixed);
            for x in (0..self.grid[0]).filter(|&x| mixed[x] != 0) {
                let (place, point) = ([x, y, z], self.index([x, y, z]));
                let inside = self.is_inside(point);
                let here = settings.isovalue - samples[point];
                let edges =
                    self.cut.edges_of[self.cut.class([0, 1, 2].map(|axis| place[axis] + first[axis]))];
                let is_regular = border == Border::BeyondBox
                    || (0..3).all(|axis| {
                        let (low, end) = self.lattice.regular_points(axis);
                        (low..end).contains(&((place[axis] + first[axis]) / self.cut.steps_a_cell))
                    });
                let record = Record { first: vertices.positions.len() as u32, near: 0 };
                let mut near = 0;
                let mut ends = 0;
                for direction in (0..hops.len()).filter(|d| edges >> d & 1 != 0) {
                    if !self.has_neighbour(place, self.cut.steps[direction]) {
                        continue;
                    }
                    let neighbour = point.strict_add_signed(hops[direction]);
                    if self.is_inside(neighbour) == inside {
                        continue;
                    }
                    ends += 1;
                    let there = settings.isovalue - samples[neighbour];
                    if !ties.is_near(inside, here, there) {
                        continue;
                    }
                    near |= 1 << direction;
                    let values = [samples[point], samples[neighbour]];
                    let from = coordinates.at(place);
                    let way = match is_regular {
                        true => placer.edges[direction],
                        false => coordinates.at(self.neighbour(place, self.cut.steps[direction])) - from,
                    };
                    placer.place(from, (direction, way), values, &mut vertices)?;
                    if let Some(keys) = keys.as_deref_mut() {
                        keys.try_reserve(1)?;
                        keys.push(VertexKey::new(self.lattice.point_number(place), direction));
                    }
                }
                if ends > 0 {
                    crossing_ends += ends;
                    self.records.try_reserve(1)?;
                    self.records.push(Record { near, ..record });
                    self.record_of[point] = self.records.len() as u32;
                }
                if vertices.positions.len() > most_vertices as usize {
                    return Err(ExtractError::TooManyVertices { limit: most_vertices });
                }
            }
        }
        // Each crossing was seen from both ends.
        vertices.crossings = crossing_ends / 2;
        Ok(vertices)
    }

    /// Marks the points of a row that are not on the side of every point that an edge could lead to.
    fn mark_mixed(&self, y: usize, z: usize, mixed: &mut [u8]) {
        let nx = self.grid[0];
        let here = &self.sides[self.index([0, y, z])..][..nx];
        mixed.fill(0);
        for &step in &self.cut.steps {
            let [dx, dy, dz] = step.map(isize::from);
            let (ny, nz) = (y.wrapping_add_signed(dy), z.wrapping_add_signed(dz));
            if ny >= self.grid[1] || nz >= self.grid[2] {
                continue;
            }
            let there = &self.sides[self.index([0, ny, nz])..][..nx];
            let skip = dx.unsigned_abs().min(nx);
            let (mine, theirs) = if dx < 0 { (skip, 0) } else { (0, skip) };
            let pairs = here[mine..].iter().zip(&there[theirs..]);
            for (mark, (a, b)) in mixed[mine..].iter_mut().zip(pairs) {
                *mark |= a ^ b;
            }
        }
    }

    fn neighbour(&self, place: [usize; 3], step: Step) -> [usize; 3] {
        [0, 1, 2].map(|axis| place[axis].strict_add_signed(isize::from(step[axis])))
    }

    fn has_neighbour(&self, place: [usize; 3], step: Step) -> bool {
        (0..3).all(|axis| place[axis].wrapping_add_signed(isize::from(step[axis])) < self.grid[axis])
    }
}

/// Where on its edge a crossing is.
struct Placer<'a> {
    lattice: &'a Lattice,
    isovalue: f32,
    apart: Apart,
    edges: Vec<Vec3>,
    /// Whether the settings want vertices elsewhere, and to find roots with.
    refines: bool,
    level: Option<Level<'a>>,
}

impl<'a> Placer<'a> {
    fn new(lattice: &'a Lattice, cut: &Cut, settings: &ExtractSettings, level: Option<Level<'a>>) -> Self {
        let step = lattice.spacing() / cut.steps_a_cell as f32;
        let edges = cut.steps.iter().map(|step| Vec3::from_array(step.map(f32::from)));
        Self {
            lattice,
            isovalue: settings.isovalue,
            apart: Apart::new(lattice, settings.topology),
            edges: edges.map(|edge| edge * step).collect(),
            // The weighted mean of one crossing is that crossing.
            refines: settings.refine_crossings || settings.placement == Placement::CurvatureWeighted,
            level: level.filter(|_| settings.refine_crossings),
        }
    }

    fn place(
        &self,
        from: Vec3,
        (direction, way): (usize, Vec3),
        [here, there]: [f32; 2],
        vertices: &mut Vertices,
    ) -> Result<(), TryReserveError> {
        let bounds = self.lattice.bounds();
        let isovalue = self.isovalue;
        // Of the edge alone: a chunk need not know whether the point has other vertices.
        let ratio = self.apart.ratio(Company::Singles, direction, linear_ratio(isovalue - here, here, there));
        let position = (way * ratio + from).min(bounds.max).max(bounds.min);
        vertices.positions.try_reserve(1)?;
        vertices.positions.push(position);
        if self.refines {
            let edge = way.as_dvec3();
            let ratio = crossing_ratio(self.level, from, edge, [here - isovalue, there - isovalue]);
            let target: DVec3 = from.as_dvec3() + edge * ratio;
            vertices.targets.try_reserve(1)?;
            vertices.targets.push(target.as_vec3().clamp(bounds.min, bounds.max));
        }
        Ok(())
    }
}
