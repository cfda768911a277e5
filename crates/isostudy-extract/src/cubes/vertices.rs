//! Vertex pass: a vertex on every crossing, and what is remembered of the points for the cells.

use std::collections::TryReserveError;

use glam::{BVec4A, Vec3, Vec3A, Vec3Swizzles, Vec4};

use super::Rule;
use super::grid::CubeGrid;
use super::patches::{Patch, Patches};
use super::records::Records;
use super::sampling::Samples;
use isostudy_mesh::Bounds;

use crate::lattice::{Lattice, Part};
use crate::memory::push;
use crate::placement::spot::{Apart, Company, linear_ratio};
use crate::placement::{clamped, crossing_ratio};
use crate::sampling::bits::between;
use crate::sampling::in_sight::Values;
use crate::sampling::level::Level;
use crate::sampling::rows::next;
use crate::settings::{ExtractSettings, Placement, Topology};
use crate::slabs::Vertices;
use crate::surface::trace::VertexKey;

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
    /// The cells whose corners and edges have vertices.
    pub(crate) part: Part,
    /// Whether vertices have normals by samples, which are all in memory then.
    pub(crate) has_normals: bool,
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
        let (grid, Part { start: first, end }) = (self.grid, self.part);
        let [_, ny, nz] = grid.size;
        if layer < first[2] || end[2] < layer {
            return Ok(());
        }
        let above = layer < end[2];
        for row in first[1]..=end[1] {
            let beside = row < end[1];
            // The four rows of the cells that begin here; those beyond the lattice are this one.
            let (y, z) = ((row + 1).min(ny - 1), (layer + 1).min(nz - 1));
            let rows = [[row, layer], [y, layer], [row, z], [y, z]];
            if self.samples.is_uniform(&rows) {
                continue;
            }
            let lines = rows.map(|[y, z]| self.samples.sides.row(y, z));
            let values = [rows[0], rows[1], rows[2]].map(|[y, z]| self.values.row(y, z));
            let start = records.start(row, layer);
            let row_key = VertexKey::new(grid.lattice.arrangement(), grid.lattice.stored([0, row, layer]), 0);
            for word in 0..grid.words {
                let here = lines.map(|line| line[word]);
                let after = lines.map(|line| next(line, word));
                // Those with an edge along x, and a cell, and all that are corners of cells.
                let begin = between(word, first[0], end[0]);
                let used = between(word, first[0], end[0] + 1);
                let crossed = [
                    (here[0] ^ after[0]) & begin,
                    if beside { (here[0] ^ here[1]) & used } else { 0 },
                    if above { (here[0] ^ here[2]) & used } else { 0 },
                ];
                let any = here.iter().chain(&after).fold(0, |any, bits| any | bits);
                let all = here.iter().chain(&after).fold(!0, |all, bits| all & bits);
                let cells = if beside && above { any & !all & begin } else { 0 };
                let mut left = crossed[0] | crossed[1] | crossed[2] | cells;
                if is_own {
                    let crossings = crossed.iter().map(|bits| bits.count_ones() as usize).sum();
                    vertices.reserve(crossings, self.has_normals)?;
                }
                while left != 0 {
                    let bit = left.trailing_zeros();
                    left &= left - 1;
                    let x = 64 * word + bit as usize;
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
                        let values = || self.values.corners([x, row, layer]);
                        record.patch = self.patches.choose(self.rule.faces, inside, self.isovalue, values);
                        inner = self.patches.inner(record.patch);
                    }
                    let crossings = record.crossed.count_ones();
                    vertices.numbered += u64::from(crossings) + u64::from(inner);
                    records.set(start + x, record);
                    if is_own {
                        vertices.crossing_ends += 2 * u64::from(crossings);
                        self.place([x, row, layer], record.crossed, values, row_key, vertices)?;
                        if inner != 0 {
                            self.place_inner([x, row, layer], self.patches.at(record.patch), vertices)?;
                        }
                    }
                }
            }
        }
        Ok(())
    }

    /// Places the vertices on the edges that begin at a point, for which there is room. `values` are those of its row, of the next one, and of that above.
    #[inline(always)]
    fn place(
        &self,
        place: [usize; 3],
        crossed: u8,
        values: [&[f32]; 3],
        row_key: VertexKey,
        vertices: &mut Vertices,
    ) -> Result<(), TryReserveError> {
        let x = place[0];
        let here = values[0][x];
        for axis in 0..3 {
            if crossed >> axis & 1 == 0 {
                continue;
            }
            let there = if axis == 0 { values[0][x + 1] } else { values[axis][x] };
            let position = self.placer.position(self.grid, place, axis, [here, there]);
            vertices.positions.push(position);
            if self.has_normals {
                vertices.normals.push(self.outward(place, axis, [here, there], position[axis]));
            }
            if let Some(target) = self.placer.target(self.grid, place, axis, [here, there]) {
                push(&mut vertices.targets, target)?;
            }
            if let Some(keys) = &mut vertices.keys {
                keys.push(row_key.along_x(x).numbered(axis));
            }
        }
        Ok(())
    }

    /// The normal by samples at a coordinate on an edge: along it by the difference of its ends, across it by central differences at both,
    /// interpolated; of any length. Of samples round the edge alone, so that all its cells agree.
    #[inline]
    fn outward(&self, place: [usize; 3], axis: usize, [here, there]: [f32; 2], coordinate: f32) -> Vec3 {
        let (grid, values) = (self.grid, self.values.all());
        let strides = [1, grid.size[0], grid.size[0] * grid.size[1]];
        let low = place[0] + place[1] * strides[1] + place[2] * strides[2];
        let high = low + strides[axis];
        let [from, to] = [0, 1].map(|step| grid.at[axis][place[axis] + step]);
        let others = [(axis + 1) % 3, (axis + 2) % 3];
        let mut falls = Vec3::ZERO;
        if grid.lattice.is_endless() {
            // In cells, which are all alike; beyond the chunk there are samples on every side.
            let share = (coordinate - from) * self.placer.cells_per_length;
            falls[axis] = here - there;
            for other in others {
                let stride = strides[other];
                let at_end = |end: usize| values[end - stride] - values[end + stride];
                falls[other] = 0.5 * (at_end(low) + (at_end(high) - at_end(low)) * share);
            }
            return falls;
        }
        let share = (coordinate - from) / (to - from);
        falls[axis] = (here - there) / (to - from);
        for other in others {
            let i = place[other];
            let (back, on) = (usize::from(i > 0), usize::from(i + 1 < grid.size[other]));
            let at_end = |end: usize| values[end - back * strides[other]] - values[end + on * strides[other]];
            let fall = at_end(low) + (at_end(high) - at_end(low)) * share;
            falls[other] = fall / (grid.at[other][i + on] - grid.at[other][i - back]);
        }
        falls
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
            let position = sum / count;
            push(&mut vertices.positions, position)?;
            if self.has_normals {
                let ends = [0, 1, 2].map(|axis| [0, 1].map(|end| self.grid.at[axis][place[axis] + end]));
                let [low, high] = [0, 1].map(|end| Vec3::from_array(ends.map(|of| of[end])));
                let share = (position - low) / (high - low);
                push(&mut vertices.normals, outward(&self.values.corners(place), share, Some(high - low)))?;
            }
            if self.placer.refines {
                push(&mut vertices.targets, target / count)?;
            }
            vertices.name(self.grid.lattice, place, 3 + v)?;
        }
        Ok(())
    }
}

/// Against the gradient of what is interpolated between samples at the corners of a cell, of any length: all are made unit afterwards, which
/// takes less time than one by one. `share` is the place in the cell, in shares of its edges, whose lengths are given where they are not all the same.
#[inline(always)]
pub(crate) fn outward(values: &[f32; 8], share: Vec3, lengths: Option<Vec3>) -> Vec3 {
    let [v0, v1, v2, v3, v4, v5, v6, v7] = *values;
    let high = Vec3A::from(share);
    let low = Vec3A::ONE - high;
    // Of the four edges along each axis, by the two other ones in cyclic order.
    let both_low = Vec3A::splat(v0) - Vec3A::new(v1, v2, v4);
    let first_high = Vec3A::new(v2, v4, v1) - Vec3A::new(v3, v6, v5);
    let second_high = Vec3A::new(v4, v1, v2) - Vec3A::new(v5, v3, v6);
    let both_high = Vec3A::new(v6, v5, v3) - Vec3A::splat(v7);
    let falls = (both_low * low.yzx() + first_high * high.yzx()) * low.zxy()
        + (second_high * low.yzx() + both_high * high.yzx()) * high.zxy();
    match lengths {
        None => Vec3::from(falls),
        Some(lengths) => Vec3::from(falls) / lengths,
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
    /// How near to either end all may lie that do not begin farther off than the lattice reaches.
    least_of_all: Vec4,
    /// Of a whole cell.
    cells_per_length: f32,
    /// How near to either end a crossing that is a root may lie.
    clamp: f32,
    /// How far a vertex is drawn from its crossing to the middle of its edge: 0 to 1.
    pull: f32,
    /// Whether the settings want vertices elsewhere, and to find roots with.
    refines: bool,
    level: Option<Level<'a>>,
}

impl<'a> Placer<'a> {
    pub(crate) fn new(lattice: &Lattice, settings: &ExtractSettings, level: Option<Level<'a>>) -> Self {
        let apart = Apart::new(lattice, Topology::Guarded).clamped(settings.edge_clamp);
        // A crossing may lie the nearer to its ends the nearer they are to the origin.
        let Bounds { min, max } = lattice.sampled_bounds();
        let farthest = apart.at(min.abs().max(max.abs()));
        Self {
            pull: 0.0,
            isovalue: settings.isovalue,
            apart,
            cells_per_length: 1.0 / lattice.spacing(),
            least_of_all: Vec4::splat(farthest.ratio(Company::Singles, 0, 0.0)),
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

    /// The shares of four edges at which their crossings are, by linear interpolation, where no vertex is drawn away; 0 for edges that are
    /// not `counted`. `from` says where each begins.
    #[inline(always)]
    pub(crate) fn shares(
        &self,
        from: impl Fn(usize) -> Vec3,
        here: Vec4,
        there: Vec4,
        counted: BVec4A,
    ) -> Vec4 {
        let share = (Vec4::splat(self.isovalue) - here) / (there - here);
        // Nearly all are farther from both ends than any must be. What is no number is not.
        let is_within = share.cmpge(self.least_of_all) & share.cmple(1.0 - self.least_of_all);
        let share = match (is_within | !counted).all() {
            true => share,
            false => self.kept_apart(from, share),
        };
        Vec4::select(counted, share, Vec4::ZERO)
    }

    /// The shares of four edges as far from their ends as they must be.
    #[inline(never)]
    fn kept_apart(&self, from: impl Fn(usize) -> Vec3, share: Vec4) -> Vec4 {
        let least = match self.apart.everywhere() {
            Some(apart) => Vec4::splat(apart.ratio(Company::Singles, 0, 0.0)),
            None => Vec4::from_array(std::array::from_fn(|edge| {
                self.apart.at(from(edge)).ratio(Company::Singles, 0, 0.0)
            })),
        };
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
