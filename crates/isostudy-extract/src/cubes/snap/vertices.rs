//! Vertex pass: a vertex at every point on the surface that triangles use, and on every crossing that was not snapped.

use std::collections::TryReserveError;

use glam::Vec3;

use super::super::grid::CubeGrid;
use super::super::records::Records;
use super::super::vertices::{Placer, RANK};
use super::labels::Labels;
use crate::memory::push;
use crate::sampling::bits::between;
use crate::sampling::in_sight::Values;
use crate::sampling::rows::{Rows, next};
use crate::slabs::Vertices;

/// The number in a key of a vertex that stands for a point. Those on edges have the edge's axis.
const AT_POINT: usize = 3;

/// What is known of a point: its vertices are numbered from `first` on, by axis. A point on the surface has one, and no edges.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Record {
    first: u32,
    /// The axes along which an edge with a vertex begins here, one bit each.
    crossed: u8,
}

impl Record {
    /// The vertex of an edge that begins here, or with axis 0 that of a point on the surface.
    #[inline]
    pub(super) fn vertex(self, axis: u8) -> u32 {
        self.first.wrapping_add(u32::from(RANK[usize::from(self.crossed & ((1 << axis) - 1))]))
    }
}

/// What the pass reads.
pub(super) struct VertexPass<'a> {
    pub(super) grid: &'a CubeGrid<'a>,
    pub(super) labels: &'a Labels,
    pub(super) used: &'a Rows,
    pub(super) values: Values<'a>,
    pub(super) placer: &'a Placer<'a>,
}

impl VertexPass<'_> {
    /// Visits a layer. Of a slab's own, vertices are placed; of others, numbered.
    pub(super) fn layer(
        &self,
        layer: usize,
        is_own: bool,
        records: &mut Records<Record>,
        vertices: &mut Vertices,
    ) -> Result<(), TryReserveError> {
        let Self { grid, labels, .. } = *self;
        let [nx, ny, nz] = grid.size;
        for row in 0..ny {
            // Where there is no next row or layer, this one: no edge leads there.
            let (y, z) = ((row + 1).min(ny - 1), (layer + 1).min(nz - 1));
            let rows = [[row, layer], [y, layer], [row, z]];
            if labels.is_uniform(&rows) {
                continue;
            }
            let inside = rows.map(|[y, z]| labels.inside.row(y, z));
            let on = rows.map(|[y, z]| labels.on.row(y, z));
            let used = self.used.row(row, layer);
            let start = records.start(row, layer);
            for word in 0..grid.words {
                let columns = between(word, 0, nx);
                let [here, is_on] = [inside[0][word], on[0][word]];
                let crossed = |there: u64, is_on_there: u64| (here ^ there) & !is_on & !is_on_there;
                let crossed = [
                    crossed(next(inside[0], word), next(on[0], word)) & grid.with_next(word),
                    crossed(inside[1][word], on[1][word]) & columns,
                    crossed(inside[2][word], on[2][word]) & columns,
                ];
                let points = is_on & used[word];
                let mut left = points | crossed[0] | crossed[1] | crossed[2];
                while left != 0 {
                    let bit = left.trailing_zeros();
                    left &= left - 1;
                    let place = [64 * word + bit as usize, row, layer];
                    let of = |bits: u64| (bits >> bit & 1) as u8;
                    let crossed = of(crossed[0]) | of(crossed[1]) << 1 | of(crossed[2]) << 2;
                    records.set(start + place[0], Record { first: vertices.numbered as u32, crossed });
                    vertices.numbered += u64::from(crossed.count_ones()) + u64::from(of(points));
                    if is_own {
                        self.place(place, crossed, of(points) != 0, vertices)?;
                    }
                }
            }
        }
        Ok(())
    }

    fn place(
        &self,
        place: [usize; 3],
        crossed: u8,
        is_on: bool,
        vertices: &mut Vertices,
    ) -> Result<(), TryReserveError> {
        if is_on {
            let snapped = self.labels.edge(place).map(|(from, axis)| self.crossing(from, axis));
            push(&mut vertices.positions, snapped.unwrap_or_else(|| self.grid.position(place)))?;
            vertices.name(self.grid.lattice, place, AT_POINT)?;
        }
        for axis in (0..3).filter(|axis| crossed >> axis & 1 != 0) {
            push(&mut vertices.positions, self.crossing(place, axis))?;
            vertices.name(self.grid.lattice, place, axis)?;
        }
        vertices.crossing_ends += 2 * u64::from(crossed.count_ones());
        Ok(())
    }

    fn crossing(&self, from: [usize; 3], axis: usize) -> Vec3 {
        let mut to = from;
        to[axis] += 1;
        let values = [self.values.at(from), self.values.at(to)];
        self.placer.position(self.grid, from, axis, values)
    }
}
