//! Vertex pass: a vertex on every crossing, and what is remembered of the points for the cells.

use std::collections::TryReserveError;

use glam::{Vec3, Vec4};

use super::Rule;
use super::grid::CubeGrid;
use super::patches::{Patch, Patches};
use super::records::Records;
use super::sampling::Samples;
use crate::lattice::Lattice;
use crate::memory::push;
use crate::placement::spot::{Apart, Company, linear_ratio};
use crate::placement::{clamped, crossing_ratio};
use crate::sampling::bits::between;
use crate::sampling::in_sight::Values;
use crate::sampling::level::Level;
use crate::sampling::rows::next;
use crate::settings::{ExtractSettings, Placement, Topology};
use crate::slabs::Vertices;

/// What is known of a point: its vertices are numbered from `first` on, those of its crossed edges by axis, then those in the cell
/// that begins there.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Record {
    first: u32,
    /// Of the cell that begins here, where its corners are on both sides.
    pub(crate) patch: u16,
    /// The axes along which an edge that begins here is crossed, one bit each.
    crossed: u8,
}

impl Record {
    /// The vertex of an edge that begins here.
    #[inline]
    pub(crate) fn vertex(self, axis: u8) -> u32 {
        self.first.wrapping_add(u32::from(RANK[usize::from(self.crossed & ((1 << axis) - 1))]))
    }

    /// A vertex in the cell that begins here.
    #[inline]
    pub(crate) fn inner(self, vertex: u8) -> u32 {
        let before = RANK[usize::from(self.crossed)] + vertex;
        self.first.wrapping_add(u32::from(before))
    }
}

/// Bits of a number below eight.
pub(crate) static RANK: [u8; 8] = [0, 1, 1, 2, 1, 2, 2, 3];

/// What the pass reads.
pub(crate) struct VertexPass<'a> {
    pub(crate) grid: &'a CubeGrid<'a>,
    pub(crate) samples: &'a Samples,
    pub(crate) values: Values<'a>,
    pub(crate) isovalue: f32,
    pub(crate) rule: Rule,
    pub(super) patches: &'a Patches,
    pub(crate) placer: &'a Placer<'a>,
}

impl VertexPass<'_> {
    /// Visits a layer. Of a slab's own, vertices are placed; of others, numbered.
    pub(crate) fn layer(
        &self,
        layer: usize,
        is_own: bool,
        records: &mut Records<Record>,
        vertices: &mut Vertices,
    ) -> Result<(), TryReserveError> {
        let grid = self.grid;
        let [nx, ny, nz] = grid.size;
        let above = layer + 1 < nz;
        for row in 0..ny {
            let beside = row + 1 < ny;
            // The four rows of the cells that begin here; those beyond the lattice are this one.
            let (y, z) = (row + usize::from(beside), layer + usize::from(above));
            let rows = [[row, layer], [y, layer], [row, z], [y, z]];
            if self.samples.is_uniform(&rows) {
                continue;
            }
            let lines = rows.map(|[y, z]| self.samples.sides.row(y, z));
            let start = records.start(row, layer);
            for word in 0..grid.words {
                let here = lines.map(|line| line[word]);
                let after = lines.map(|line| next(line, word));
                let used = between(word, 0, nx);
                let crossed = [
                    (here[0] ^ after[0]) & grid.with_next(word),
                    (here[0] ^ here[1]) & used,
                    (here[0] ^ here[2]) & used,
                ];
                let any = here.iter().chain(&after).fold(0, |any, bits| any | bits);
                let all = here.iter().chain(&after).fold(!0, |all, bits| all & bits);
                let cells = if beside && above { any & !all & grid.with_next(word) } else { 0 };
                let mut left = crossed[0] | crossed[1] | crossed[2] | cells;
                while left != 0 {
                    let bit = left.trailing_zeros();
                    left &= left - 1;
                    let place = [64 * word + bit as usize, row, layer];
                    let of = |bits: u64| (bits >> bit & 1) as u8;
                    let mut record = Record {
                        first: vertices.numbered as u32,
                        patch: 0,
                        crossed: of(crossed[0]) | of(crossed[1]) << 1 | of(crossed[2]) << 2,
                    };
                    let mut inner = 0;
                    if of(cells) != 0 {
                        let inside = (0..4)
                            .fold(0, |set, i| set | of(here[i]) << (2 * i) | of(after[i]) << (2 * i + 1));
                        let values = || self.values.corners(place);
                        record.patch = self.patches.choose(self.rule.faces, inside, self.isovalue, values);
                        inner = self.patches.inner(record.patch);
                    }
                    let crossings = record.crossed.count_ones();
                    vertices.numbered += u64::from(crossings) + u64::from(inner);
                    records.set(start + place[0], record);
                    if is_own {
                        vertices.crossing_ends += 2 * u64::from(crossings);
                        self.place(place, record.crossed, vertices)?;
                        if inner != 0 {
                            self.place_inner(place, self.patches.at(record.patch), vertices)?;
                        }
                    }
                }
            }
        }
        Ok(())
    }

    /// Places the vertices on the edges that begin at a point.
    #[inline]
    fn place(&self, place: [usize; 3], crossed: u8, vertices: &mut Vertices) -> Result<(), TryReserveError> {
        let value = self.values.at(place);
        for axis in (0..3).filter(|axis| crossed >> axis & 1 != 0) {
            let mut there = place;
            there[axis] += 1;
            let values = [value, self.values.at(there)];
            push(&mut vertices.positions, self.placer.position(self.grid, place, axis, values))?;
            if let Some(target) = self.placer.target(self.grid, place, axis, values) {
                push(&mut vertices.targets, target)?;
            }
            vertices.name(self.grid.lattice, place, axis)?;
        }
        Ok(())
    }

    /// Places the vertices in the cell that begins at a point.
    #[inline(never)]
    fn place_inner(
        &self,
        place: [usize; 3],
        patch: &Patch,
        vertices: &mut Vertices,
    ) -> Result<(), TryReserveError> {
        for (v, edges) in patch.inner.iter().enumerate() {
            let mut sum = Vec3::ZERO;
            let mut target = Vec3::ZERO;
            for &edge in edges {
                let (corner, axis) = self.patches.edge(edge);
                let (from, axis) = (corner_of(place, corner), usize::from(axis));
                let mut to = from;
                to[axis] += 1;
                let values = [self.values.at(from), self.values.at(to)];
                let position = self.placer.position(self.grid, from, axis, values);
                sum += position;
                target += self.placer.target(self.grid, from, axis, values).unwrap_or(position);
            }
            let count = edges.len() as f32;
            push(&mut vertices.positions, sum / count)?;
            if self.placer.refines {
                push(&mut vertices.targets, target / count)?;
            }
            vertices.name(self.grid.lattice, place, 3 + v)?;
        }
        Ok(())
    }
}

pub(crate) fn corner_of([x, y, z]: [usize; 3], corner: u8) -> [usize; 3] {
    let corner = usize::from(corner);
    [x + (corner & 1), y + (corner >> 1 & 1), z + (corner >> 2)]
}

/// The share of the way between two coordinates, and beside both ends: where a sample equals the isovalue, vertices on different edges
/// would lie in its place. As far off as the end's last place, or that of the edge's length if it is larger. Points of three edges of a
/// cube that are no corners never lie in a line, so no triangle is without area.
#[inline(always)]
pub(super) fn within(from: f32, to: f32, ratio: f64) -> f32 {
    let way = to - from;
    let off = |end: f32| (f32::EPSILON * end.abs().max(way)).min(MOST_OFF * way);
    let at = (f64::from(from) + (f64::from(to) - f64::from(from)) * ratio) as f32;
    at.max(from + off(from)).min(to - off(to))
}

/// The same as a share of the edge is never more than this, however coarse `f32` is there.
const MOST_OFF: f32 = 0.125;

/// Where on its edge a crossing is.
pub(crate) struct Placer<'a> {
    isovalue: f32,
    /// How near to either end it may lie, but for vertices on edges along an axis.
    apart: Apart,
    /// The same where it is a root.
    clamp: f32,
    /// How far a vertex is drawn from its crossing to the middle of its edge: 0 to 1.
    pull: f32,
    /// Whether the settings want vertices elsewhere, and to find roots with.
    refines: bool,
    level: Option<Level<'a>>,
}

impl<'a> Placer<'a> {
    pub(crate) fn new(lattice: &Lattice, settings: &ExtractSettings, level: Option<Level<'a>>) -> Self {
        Self {
            pull: 0.0,
            isovalue: settings.isovalue,
            apart: Apart::new(lattice, Topology::Guarded).clamped(settings.edge_clamp),
            clamp: settings.edge_clamp,
            // The weighted mean of one crossing is that crossing.
            refines: settings.refine_crossings || settings.placement == Placement::CurvatureWeighted,
            level: level.filter(|_| settings.refine_crossings),
        }
    }

    /// The same with vertices drawn to the middles of their edges, but for edges in the sides of the box.
    pub(crate) fn pulled(self, pull: f32) -> Self {
        Self { pull, ..self }
    }

    /// The crossing by linear interpolation, on the edge that begins at a place. Of the edge alone, so that chunks, slabs and cells
    /// agree. It is within four units in the last place of the exact one, and strictly between the ends: see [`within`].
    #[inline]
    pub(crate) fn position(
        &self,
        grid: &CubeGrid,
        place: [usize; 3],
        axis: usize,
        [here, there]: [f32; 2],
    ) -> Vec3 {
        let mut position = grid.position(place);
        let [from, to] = [0, 1].map(|step| grid.at[axis][place[axis] + step]);
        let [here, there] = [here, there].map(f64::from);
        let ratio = (f64::from(self.isovalue) - here) / (there - here);
        // As `linear_ratio` has it.
        let ratio = if ratio.is_finite() { clamped(ratio, self.clamp) } else { 0.5 };
        let ratio = if self.pull > 0.0 { self.drawn(ratio, grid, place, axis) } else { ratio };
        position[axis] = within(from, to, ratio);
        position
    }

    /// The crossing on an edge that goes along several axes, the same way.
    pub(crate) fn position_between(&self, from: Vec3, to: Vec3, [here, there]: [f32; 2]) -> Vec3 {
        let least = self.apart.at(from).ratio(Company::Singles, 0, 0.0);
        let ratio = linear_ratio(self.isovalue - here, here, there).clamp(least, 1.0 - least);
        (from + (to - from) * ratio).clamp(from.min(to), from.max(to))
    }

    /// The shares of four edges at which their crossings are, by linear interpolation, where no vertex is drawn away. `from` says where
    /// each begins.
    #[inline(always)]
    pub(crate) fn shares(&self, from: impl Fn(usize) -> Vec3, here: Vec4, there: Vec4) -> Vec4 {
        let least = match self.apart.everywhere() {
            Some(apart) => Vec4::splat(apart.ratio(Company::Singles, 0, 0.0)),
            None => Vec4::from_array(std::array::from_fn(|edge| {
                self.apart.at(from(edge)).ratio(Company::Singles, 0, 0.0)
            })),
        };
        let share = (Vec4::splat(self.isovalue) - here) / (there - here);
        // As `linear_ratio` has it.
        let share = Vec4::select(share.is_finite_mask(), share, Vec4::splat(0.5));
        share.max(least).min(1.0 - least)
    }

    #[inline(never)]
    fn drawn(&self, ratio: f64, grid: &CubeGrid, place: [usize; 3], axis: usize) -> f64 {
        let is_on_side = |other: usize| place[other] == 0 || place[other] + 1 == grid.size[other];
        if (0..3).any(|other| other != axis && is_on_side(other)) {
            return ratio;
        }
        ratio + (0.5 - ratio) * f64::from(self.pull)
    }

    /// Where the settings want it, if elsewhere.
    fn target(
        &self,
        grid: &CubeGrid,
        place: [usize; 3],
        axis: usize,
        [here, there]: [f32; 2],
    ) -> Option<Vec3> {
        if !self.refines {
            return None;
        }
        let mut target = grid.position(place);
        let [from, to] = [0, 1].map(|step| grid.at[axis][place[axis] + step]);
        let mut edge = glam::DVec3::ZERO;
        edge[axis] = f64::from(to) - f64::from(from);
        let ends = [here - self.isovalue, there - self.isovalue];
        let ratio = clamped(crossing_ratio(self.level, target, edge, ends), self.clamp);
        target[axis] = ((f64::from(from) + edge[axis] * ratio) as f32).clamp(from, to);
        Some(target)
    }
}
