//! Vertex pass: the cells that the surface crosses, what their edges lead to, and where that is.

use std::collections::TryReserveError;

use glam::{DVec3, Vec3, Vec4};

use super::plan::{EDGE_STARTS, EDGES, Mean, Pattern, Plans};
use super::region::{Region, margin};
use super::sharp::Sharp;
use super::tangents::{Tangent, Tangents};
use crate::cubes::grid::CubeGrid;
use crate::cubes::records::Records;
use crate::cubes::sampling::Samples;
use crate::cubes::vertices::{Placer, corner_of, outward};
use crate::lattice::Part;
use crate::memory::push;
use crate::sampling::bits::between;
use crate::sampling::in_sight::Values;
use crate::sampling::rows::next;
use crate::slabs::Vertices;
use crate::surface::trace::VertexKey;

/// How far from the ends of their edges crossings count whose mean is certain to be in the region.
const ANCHOR: f64 = 1.0 / 16.0;

/// What is known of a crossed cell: its vertices are numbered from `first` on.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Record {
    pub(super) first: u32,
    pub(super) plan: u32,
}

/// What the pass reads.
pub(super) struct VertexPass<'a> {
    pub(super) grid: &'a CubeGrid<'a>,
    pub(super) samples: &'a Samples,
    pub(super) values: Values<'a>,
    pub(super) placer: &'a Placer<'a>,
    /// Whether each vertex is in the middle of its cell.
    pub(super) in_middle: bool,
    /// The points whose edges have quadrilaterals. Vertices are those of the cells that begin there, and those that the quadrilaterals
    /// have beside them.
    pub(super) part: Part,
    /// Whether vertices have normals by samples.
    pub(super) has_normals: bool,
}

impl VertexPass<'_> {
    /// Visits a layer of cells, and says how many have corners on both sides. Sides are known from the layer of points below to
    /// the second above them.
    pub(super) fn layer(
        &self,
        z: usize,
        mut by_planes: Option<(Sharp, &mut Tangents)>,
        plans: &mut Plans,
        records: &mut Records<Record>,
        vertices: &mut Vertices,
    ) -> Result<u64, TryReserveError> {
        let (grid, Part { start: first, end }) = (self.grid, self.part);
        let mut visited = 0;
        if z + 1 < first[2] || end[2] <= z {
            return Ok(visited);
        }
        for y in first[1].saturating_sub(1)..end[1] {
            let rows = [[y, z], [y + 1, z], [y, z + 1], [y + 1, z + 1]];
            if self.samples.is_uniform(&rows) {
                continue;
            }
            let lines = rows.map(|[y, z]| self.samples.sides.row(y, z));
            let values = rows.map(|[y, z]| self.values.row(y, z));
            let [ys, zs] = [[grid.at[1][y], grid.at[1][y + 1]], [grid.at[2][z], grid.at[2][z + 1]]];
            let start = records.start(y, z);
            let is_row_beside = y < first[1] || z < first[2];
            let lattice = grid.lattice;
            let row_key = VertexKey::new(lattice.arrangement(), lattice.stored([0, y, z]), 0);
            for word in 0..grid.words {
                let corners: [u64; 8] = std::array::from_fn(|c| {
                    let line = lines[c >> 1];
                    if c & 1 == 0 { line[word] } else { next(line, word) }
                });
                let any = corners.iter().fold(0, |any, bits| any | bits);
                let all = corners.iter().fold(!0, |all, bits| all & bits);
                let of_part = between(word, first[0].saturating_sub(1), end[0]);
                let mut left = any & !all & grid.with_next(word) & of_part;
                visited += u64::from(left.count_ones());
                while left != 0 {
                    let bit = left.trailing_zeros();
                    left &= left - 1;
                    let x = 64 * word + bit as usize;
                    let cell = [x, y, z];
                    let inside = (0..8).fold(0, |set, c| set | ((corners[c] >> bit & 1) as u8) << c);
                    let is_beside = is_row_beside || x < first[0];
                    // Where a cell without patches is beside the part, its vertex is there if a quadrilateral needs it.
                    let at_box = if is_beside && !plans.table.has_patches() { 0 } else { self.at_box(cell) };
                    let joined = self.joined(plans, cell, inside);
                    let plan = plans.number(inside, joined, at_box);
                    let mut numbers = 0..plans.at(plan).means.len();
                    if is_beside {
                        let needed = self.needed(plans, plan, cell, inside);
                        if needed == 0 {
                            continue;
                        }
                        numbers = needed.trailing_zeros() as usize..32 - needed.leading_zeros() as usize;
                        vertices.has_spare |= needed.count_ones() as usize != numbers.len();
                    }
                    let first = (vertices.positions.len() as u32).wrapping_sub(numbers.start as u32);
                    records.set(start + x, Record { first, plan });
                    vertices.reserve(numbers.len(), self.has_normals)?;
                    for number in numbers {
                        let mean = &plans.at(plan).means[number];
                        let position = match &mut by_planes {
                            None if self.in_middle => {
                                let xs = [grid.at[0][x], grid.at[0][x + 1]];
                                let [low, high] = [0, 1].map(|end| Vec3::new(xs[end], ys[end], zs[end]));
                                low.midpoint(high)
                            }
                            None => {
                                let values = std::array::from_fn(|c| values[c >> 1][x + (c & 1)]);
                                let ends = [[grid.at[0][x], grid.at[0][x + 1]], ys, zs];
                                let (position, share) = self.mean(ends, &values, mean);
                                if self.has_normals {
                                    let lengths = (!lattice.is_endless())
                                        .then(|| Vec3::from_array(ends.map(|[low, high]| high - low)));
                                    vertices.normals.push(outward(&values, share, lengths));
                                }
                                position
                            }
                            #[cfg(feature = "dual-contouring")]
                            Some((sharp, tangents)) => {
                                let region = plans.at(plan).loops.get(number).map(|of| of.region);
                                self.meeting(plans, cell, (mean.set, region), *sharp, tangents)
                            }
                            #[cfg(not(feature = "dual-contouring"))]
                            Some(_) => unreachable!("planes are for dual contouring"),
                        };
                        vertices.positions.push(position);
                        if let Some(keys) = &mut vertices.keys {
                            keys.push(row_key.along_x(x).numbered(number));
                            if plans.table.has_loops() {
                                push(&mut vertices.patterns, Pattern::new(inside, joined, at_box, number))?;
                            }
                        }
                    }
                }
            }
        }
        vertices.numbered = vertices.positions.len() as u64;
        Ok(visited)
    }

    /// Which vertices of a cell beside the part are those of its quadrilaterals, one bit each.
    #[inline(never)]
    fn needed(&self, plans: &Plans, plan: u32, cell: [usize; 3], inside: u8) -> u32 {
        let mut needed = 0;
        for edge in 0..EDGES as u8 {
            let (corner, axis) = plans.table.edge(edge);
            let is_crossed = (inside >> corner ^ inside >> (corner | 1 << axis)) & 1 != 0;
            let from = corner_of(cell, corner);
            // Those in a side of the box have no quadrilateral.
            let is_in_side = |other: usize| from[other] == 0 || from[other] + 1 == self.grid.size[other];
            let has_four = (0..3).all(|other| other == usize::from(axis) || !is_in_side(other));
            if is_crossed && has_four && self.part.contains(from) {
                needed |= 1 << plans.vertex(plan, edge);
                if !plans.table.has_patches() {
                    // There is one.
                    return needed;
                }
            }
        }
        needed
    }

    /// The face on which this cell and its neighbour both join their inside corners.
    #[inline]
    fn joined(&self, plans: &Plans, cell: [usize; 3], inside: u8) -> Option<u8> {
        let face = plans.table.joinable(inside)?;
        let (axis, is_high) = (usize::from(face / 2), face % 2 != 0);
        let mut other = cell;
        other[axis] = if is_high { cell[axis] + 1 } else { cell[axis].checked_sub(1)? };
        if other[axis] + 1 >= self.grid.size[axis] {
            return None;
        }
        let is_inside = |corner: u8| {
            let [x, y, z] = corner_of(other, corner);
            self.samples.sides.row(y, z)[x / 64] >> (x % 64) & 1 != 0
        };
        let inside = (0..8).fold(0, |set, corner| set | u8::from(is_inside(corner)) << corner);
        (plans.table.joinable(inside) == Some(face ^ 1)).then_some(face)
    }

    /// The faces of a cell that lie on the box, one bit each: low and high along x, y and z.
    #[inline(always)]
    fn at_box(&self, cell: [usize; 3]) -> u8 {
        let size = self.grid.size;
        (0..3).fold(0, |set, axis| {
            let [low, high] = [cell[axis] == 0, cell[axis] + 2 == size[axis]];
            set | u8::from(low) << (2 * axis) | u8::from(high) << (2 * axis + 1)
        })
    }

    /// The mean of the crossings of some edges of a cell between coordinates, with samples at its corners; and the same in shares of the
    /// cell's edges. It is found in shares, so that far from the origin no digits are lost.
    #[inline(always)]
    fn mean(&self, ends: [[f32; 2]; 3], values: &[f32; 8], of: &Mean) -> (Vec3, Vec3) {
        let [low, high] = [0, 1].map(|end| Vec3::new(ends[0][end], ends[1][end], ends[2][end]));
        let mut shares = of.at_high_ends;
        for axis in 0..3 {
            let corners = EDGE_STARTS[axis];
            let here = Vec4::from_array(corners.map(|c| values[c]));
            let there = Vec4::from_array(corners.map(|c| values[c | 1 << axis]));
            let from = |edge: usize| {
                let c = corners[edge];
                Vec3::new(ends[0][c & 1], ends[1][c >> 1 & 1], ends[2][c >> 2])
            };
            let share = self.placer.shares(from, here, there, of.edges[axis]);
            shares[axis] += share.element_sum();
        }
        let share = shares / of.count;
        ((low + (high - low) * share).max(low).min(high), share)
    }

    /// Where the tangent planes at the crossings of some edges meet; in a region of the cell, if there is one.
    fn meeting(
        &self,
        plans: &Plans,
        cell: [usize; 3],
        (edges, region): (u16, Option<Region>),
        sharp: Sharp,
        tangents: &mut Tangents,
    ) -> Vec3 {
        let mut all: [Tangent; EDGES] = [(DVec3::ZERO, None); EDGES];
        let (mut axes, mut count) = ([0; EDGES], 0);
        for (from, axis, values) in self.crossed(plans, cell, edges) {
            axes[count] = axis;
            all[count] = tangents.at(self.grid, from, axis, values);
            count += 1;
        }
        let [low, high] = [cell, cell.map(|i| i + 1)].map(|corner| self.grid.position(corner).as_dvec3());
        let point = sharp.vertex(&all[..count], low, high);
        let Some(region) = region else { return point.as_vec3() };
        let share = |at: DVec3| (at - low) / (high - low);
        // Crossings at the ends of their edges may be on the planes of the region.
        let inner = |(at, axis): (DVec3, usize)| {
            let mut share = share(at);
            share[axis] = share[axis].clamp(ANCHOR, 1.0 - ANCHOR);
            share
        };
        let anchor = all[..count].iter().zip(axes).map(|(&(at, _), axis)| inner((at, axis))).sum::<DVec3>()
            / count as f64;
        (low + region.nearest(anchor, share(point), margin(low, high, 1)) * (high - low)).as_vec3()
    }

    /// The points that some edges of a cell begin at, their axes, and the samples at their ends.
    fn crossed(
        &self,
        plans: &Plans,
        cell: [usize; 3],
        edges: u16,
    ) -> impl Iterator<Item = ([usize; 3], usize, [f32; 2])> {
        (0..EDGES as u8).filter(move |edge| edges >> edge & 1 != 0).map(move |edge| {
            let (corner, axis) = plans.table.edge(edge);
            let (from, axis) = (corner_of(cell, corner), usize::from(axis));
            let mut to = from;
            to[axis] += 1;
            (from, axis, [self.values.at(from), self.values.at(to)])
        })
    }
}
