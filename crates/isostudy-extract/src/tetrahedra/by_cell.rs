//! The extractor for cubes that are cut into tetrahedra each by itself, where points differ in their lattice edges.
//!
//! Like [`crate::tetrahedra::streamed`] it streams: a few layers in memory, samples only where the field does not rule the surface out,
//! slabs of cells on several threads. Every crossing is a vertex: numbered in storage order of the points that they are
//! nearest to, then by direction; triangles go cell by cell. The same with all samples stored is what the tests compare
//! it with.

mod cells;
mod cut;
#[cfg(test)]
mod dense;
mod grid;
mod points;
mod sampling;
#[cfg(test)]
mod tests;

use std::collections::TryReserveError;
use std::ops::Range;

use self::cells::triangulate_layer;
use self::grid::CutGrid;
use self::points::{Placer, PointPass, Records};
use self::sampling::{Samples, Sampling};
use super::ties::Ties;
use crate::extraction::ExtractError;
use crate::lattice::Border;
use crate::slabs::{Pass, Piece, Run, Slab, Stage, Streamed, in_slabs, out_of_memory};
use crate::source::Request;

/// The extractor's plan and buffers, kept from one surface to the next.
#[derive(Debug, Default)]
pub(crate) struct CellStreamer {
    grid: Option<CutGrid>,
    workspaces: Vec<Workspace>,
    pieces: Vec<Piece>,
}

impl CellStreamer {
    /// The stages in order, timed and counted. The trace, if there is one, is that before edges are collapsed.
    pub(crate) fn extract(&mut self, run: Run) -> Result<(), ExtractError> {
        let Request { lattice, settings, .. } = *run.request;
        let request = run.request;
        let Self { grid, workspaces, pieces } = self;
        let border = Border::of(settings);
        match grid {
            Some(grid) if grid.lattice.arrangement() == lattice.arrangement() => {
                grid.refit(lattice, border).map_err(|_| out_of_memory(request, 1))?;
            }
            _ => *grid = Some(CutGrid::new(lattice, border).map_err(|_| out_of_memory(request, 1))?),
        }
        let grid = grid.as_ref().expect("it was just made");
        let placer = Placer::new(lattice, grid.cut, settings, request.level());
        in_slabs(&ByCell { grid, request, placer }, lattice.cells()[2] as usize, 1, workspaces, pieces, run)
    }
}

/// What all slabs of an extraction share.
struct ByCell<'a> {
    grid: &'a CutGrid,
    request: &'a Request<'a>,
    placer: Placer<'a>,
}

/// Buffers of one thread.
#[derive(Debug, Default)]
struct Workspace {
    samples: Samples,
    records: Records,
}

impl Streamed for ByCell<'_> {
    type Workspace = Workspace;

    fn fit(&self, workspace: &mut Workspace) -> Result<(), TryReserveError> {
        workspace.samples.fit(self.grid, self.request.source)?;
        workspace.records.fit(self.grid)
    }

    /// Each pass is as many layers behind the one before as a lattice edge can reach.
    fn passes(&self, own: Range<usize>) -> impl AsRef<[Pass<Self>]> {
        let [lowest, highest] = self.points(&own);
        let (steps, reach, layers) = (self.grid.cut.steps_a_cell, self.grid.reach(), self.grid.size[2]);
        let around = |n: usize| lowest.saturating_sub(n)..layers.min(highest + n + 1);
        let behind = 2 * reach;
        let above = lowest + steps..highest + 1;
        [
            Pass { stage: Stage::Sampling, behind: 0, layers: around(2 * reach), run: Self::find_sides },
            Pass { stage: Stage::Sampling, behind: reach, layers: around(reach), run: Self::find_crossings },
            Pass { stage: Stage::Vertex, behind, layers: around(0), run: Self::place },
            Pass { stage: Stage::Geometry, behind, layers: above, run: Self::triangulate },
        ]
    }
}

impl ByCell<'_> {
    /// The lowest and the highest layer of points of some layers of cells. The vertices of the highest are the next slab's.
    fn points(&self, own: &Range<usize>) -> [usize; 2] {
        [own.start, own.end].map(|layer| layer * self.grid.cut.steps_a_cell)
    }

    fn sampling(&self) -> Sampling<'_> {
        let Request { source, settings, .. } = *self.request;
        Sampling { grid: self.grid, source, isovalue: settings.isovalue }
    }

    fn find_sides(&self, slab: &mut Slab<Workspace>, layer: usize) -> Result<(), ExtractError> {
        slab.workspace.samples.find_sides(self.sampling(), layer)
    }

    fn find_crossings(&self, slab: &mut Slab<Workspace>, layer: usize) -> Result<(), ExtractError> {
        slab.workspace.samples.find_crossings(self.sampling(), layer);
        Ok(())
    }

    fn place(&self, slab: &mut Slab<Workspace>, layer: usize) -> Result<(), ExtractError> {
        let Self { grid, request, ref placer } = *self;
        let Workspace { samples, records } = &mut *slab.workspace;
        let (values, isovalue) = (samples.values(grid, request.source), request.settings.isovalue);
        let (sides, active, ties) = (samples.sides(), &samples.active, Ties::of(request.settings.topology));
        let pass = PointPass { grid, values, sides, active, isovalue, ties, placer };
        let is_own = layer < self.points(&slab.own)[1] || layer + 1 == grid.size[2];
        Ok(pass.layer(layer, is_own, records, &mut slab.vertices)?)
    }

    /// The cells below a layer of points, where it is not in the middle of cells.
    fn triangulate(&self, slab: &mut Slab<Workspace>, layer: usize) -> Result<(), ExtractError> {
        let steps = self.grid.cut.steps_a_cell;
        if !layer.is_multiple_of(steps) {
            return Ok(());
        }
        if layer == self.points(&slab.own)[1] {
            // Only the highest cells have vertices of the slab above.
            slab.piece.tail = slab.piece.surface.triangles.len();
        }
        let Workspace { samples, records } = &*slab.workspace;
        let (sides, active, result) = (samples.sides(), &samples.active, &mut slab.piece.surface);
        triangulate_layer(self.grid, sides, active, records, layer / steps - 1, result)?;
        (slab.layer_done)();
        Ok(())
    }
}
