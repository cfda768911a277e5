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
use crate::slabs::{LayerDone, Pass, Piece, Run, Stage, Streamed, Vertices, in_slabs, out_of_memory, stream};
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

    fn workspace(&self) -> Workspace {
        Workspace::default()
    }

    fn fit(&self, workspace: &mut Workspace) -> Result<(), TryReserveError> {
        workspace.samples.fit(self.grid, self.request.source)?;
        workspace.records.fit(self.grid)
    }

    /// Each pass is as many layers behind the one before as a lattice edge can reach.
    fn slab(
        &self,
        own: Range<usize>,
        layer_done: &LayerDone,
        workspace: &mut Workspace,
        piece: &mut Piece,
    ) -> Result<(), ExtractError> {
        let grid = self.grid;
        let (steps, reach, layers) = (grid.cut.steps_a_cell, grid.reach(), grid.size[2]);
        let (lowest, highest) = (own.start * steps, own.end * steps);
        let around = |n: usize| lowest.saturating_sub(n)..layers.min(highest + n + 1);
        let behind = 2 * reach;
        let passes = [
            Pass { stage: Stage::Sampling, behind: 0, layers: around(2 * reach), run: Slab::find_sides },
            Pass { stage: Stage::Sampling, behind: reach, layers: around(reach), run: Slab::find_crossings },
            Pass { stage: Stage::Vertex, behind, layers: around(0), run: Slab::place },
            Pass {
                stage: Stage::Geometry,
                behind,
                layers: lowest + steps..highest + 1,
                run: Slab::triangulate,
            },
        ];
        let Request { source, settings, control, .. } = *self.request;
        let sampling = Sampling { grid, source, isovalue: settings.isovalue };
        let mut slab =
            Slab { of: self, layer_done, sampling, workspace, vertices: Vertices::within(piece), highest };
        stream(&mut slab, passes, control, piece)?;
        slab.vertices.give_to(piece);
        Ok(())
    }
}

/// A slab on its way.
struct Slab<'a> {
    of: &'a ByCell<'a>,
    layer_done: &'a LayerDone<'a>,
    sampling: Sampling<'a>,
    workspace: &'a mut Workspace,
    vertices: Vertices,
    /// The layer of points above the slab's cells, whose vertices are the next slab's.
    highest: usize,
}

impl Slab<'_> {
    fn find_sides(&mut self, layer: usize, _: &mut Piece) -> Result<(), ExtractError> {
        self.workspace.samples.find_sides(self.sampling, layer);
        Ok(())
    }

    fn find_crossings(&mut self, layer: usize, _: &mut Piece) -> Result<(), ExtractError> {
        self.workspace.samples.find_crossings(self.sampling, layer);
        Ok(())
    }

    fn place(&mut self, layer: usize, _: &mut Piece) -> Result<(), ExtractError> {
        let ByCell { grid, request, placer } = self.of;
        let Workspace { samples, records } = &mut *self.workspace;
        let (values, isovalue) = (samples.values(grid, request.source), request.settings.isovalue);
        let (sides, active, ties) = (samples.sides(), &samples.active, Ties::of(request.settings.topology));
        let pass = PointPass { grid, values, sides, active, isovalue, ties, placer };
        let is_own = layer < self.highest || layer + 1 == grid.size[2];
        pass.layer(layer, is_own, records, &mut self.vertices)?;
        self.vertices.check(request.most_vertices)
    }

    /// The cells below a layer of points, where it is not in the middle of cells.
    fn triangulate(&mut self, layer: usize, piece: &mut Piece) -> Result<(), ExtractError> {
        let grid = self.of.grid;
        let steps = grid.cut.steps_a_cell;
        if !layer.is_multiple_of(steps) {
            return Ok(());
        }
        if layer == self.highest {
            // Only the highest cells have vertices of the slab above.
            piece.tail = piece.surface.triangles.len();
        }
        let Workspace { samples, records } = &*self.workspace;
        triangulate_layer(
            grid,
            samples.sides(),
            &samples.active,
            records,
            layer / steps - 1,
            &mut piece.surface,
        )?;
        (self.layer_done)();
        Ok(())
    }
}
