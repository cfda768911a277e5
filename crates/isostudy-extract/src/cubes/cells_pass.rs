//! Triangle pass: the cells of a layer in storage order, but for those whose corners are all on one side.

use std::collections::TryReserveError;

use isostudy_cells::{PolygonTriangles, radius_ratio};

use super::grid::CubeGrid;
use super::patches::{MOST_TRIANGLES, Patch, Patches};
use super::records::Records;
use super::sampling::Samples;
use super::tubes::INNER;
use super::vertices::{Placer, Record, corner_of};
use crate::lattice::Part;
use crate::sampling::bits::between;
use crate::sampling::in_sight::Values;
use crate::sampling::rows::next;
use crate::surface::triangulation::Triangulation;

/// The triangulation of a cell's polygons that was chosen last.
#[derive(Default)]
pub(super) struct BestTriangles {
    of_polygon: PolygonTriangles,
    triangles: Vec<[u8; 3]>,
}

/// What the pass reads.
pub(super) struct TrianglePass<'a> {
    pub(super) grid: &'a CubeGrid<'a>,
    pub(super) samples: &'a Samples,
    pub(super) values: Values<'a>,
    pub(super) patches: &'a Patches,
    pub(super) placer: &'a Placer<'a>,
    /// The cells that have triangles.
    pub(super) part: Part,
}

impl TrianglePass<'_> {
    /// Adds the triangles of layer `z` of the cells. Of the layers of points below and above it, sides and records are known.
    pub(super) fn layer(
        &self,
        z: usize,
        records: &Records<Record>,
        best: &mut BestTriangles,
        result: &mut Triangulation,
    ) -> Result<(), TryReserveError> {
        let Self { grid, samples, patches, part, .. } = *self;
        if !part.has(2, z) {
            return Ok(());
        }
        for y in part.start[1]..part.end[1] {
            let rows = [[y, z], [y + 1, z], [y, z + 1], [y + 1, z + 1]];
            if samples.is_uniform(&rows) {
                continue;
            }
            let lines = rows.map(|[y, z]| samples.sides.row(y, z));
            let starts = rows.map(|[y, z]| records.start(y, z));
            for word in 0..grid.words {
                let here = lines.map(|line| line[word]);
                let after = lines.map(|line| next(line, word));
                let any = here.iter().chain(&after).fold(0, |any, bits| any | bits);
                let all = here.iter().chain(&after).fold(!0, |all, bits| all & bits);
                let mut left = any & !all & between(word, part.start[0], part.end[0]);
                result.cells_visited += u64::from(left.count_ones());
                result.triangles.try_reserve(MOST_TRIANGLES * left.count_ones() as usize)?;
                while left != 0 {
                    let x = 64 * word + left.trailing_zeros() as usize;
                    left &= left - 1;
                    let at = |corner: u8| {
                        let corner = usize::from(corner);
                        records.at(starts[corner >> 1] + x + (corner & 1))
                    };
                    let patch = patches.at(at(0).patch);
                    let mut vertices = [0; 20];
                    for &edge in &patch.crossed {
                        let (corner, axis) = patches.edge(edge);
                        vertices[usize::from(edge)] = at(corner).vertex(axis);
                    }
                    let base: Record = at(0);
                    for v in 0..patch.inner.len() as u8 {
                        vertices[usize::from(INNER + v)] = base.inner(v);
                    }
                    let numbered = |triangle: &[u8; 3]| triangle.map(|corner| vertices[usize::from(corner)]);
                    result.triangles.extend(patch.triangles.iter().map(numbered));
                    if !patch.polygons.is_empty() {
                        best.find(self, patch, [x, y, z]);
                        result.triangles.extend(best.triangles.iter().map(numbered));
                    }
                    if let Some(trace) = &mut result.trace {
                        trace.close_cell(part.number([x, y, z]), result.triangles.len())?;
                    }
                }
            }
        }
        Ok(())
    }
}

impl BestTriangles {
    /// Finds the triangulations of a patch's polygons with the largest sum of radius ratios.
    #[inline(never)]
    fn find(&mut self, pass: &TrianglePass, patch: &Patch, cell: [usize; 3]) {
        let TrianglePass { grid, values, patches, placer, .. } = *pass;
        let mut places = [[0.0; 3]; INNER as usize];
        for &edge in &patch.crossed {
            let (corner, axis) = patches.edge(edge);
            let (from, axis) = (corner_of(cell, corner), usize::from(axis));
            let mut to = from;
            to[axis] += 1;
            let ends = [values.at(from), values.at(to)];
            let position = placer.position(grid, from, axis, ends);
            places[usize::from(edge)] = position.to_array().map(f64::from);
        }
        let cost = |triangle: [u8; 3]| 1.0 - radius_ratio(triangle.map(|edge| places[usize::from(edge)]));
        self.triangles.clear();
        for polygon in &patch.polygons {
            let is_found = patches.triangulator().find_cheapest(polygon, cost, &mut self.of_polygon);
            assert!(is_found, "there is a triangulation");
            self.triangles.extend_from_slice(self.of_polygon.triangles());
        }
    }
}
