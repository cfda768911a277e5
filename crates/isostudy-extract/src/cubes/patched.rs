//! Patches of crossings, streamed: sides; a layer behind, the samples that cells need; another behind, vertices; and another,
//! triangles.

use std::collections::TryReserveError;
use std::ops::Range;

use super::cells_pass::{BestTriangles, TrianglePass};
use super::grid::{CubeGrid, SLOTS};
use super::patches::Patches;
use super::records::Records;
use super::sampling::{Samples, Sampling};
use super::vertices::{Placer, Record, VertexPass};
use super::{Kept, Rule};
use crate::extraction::ExtractError;
use crate::slabs::{LayerDone, Pass, Piece, Run, Stage, Streamed, Vertices, stream};
use crate::source::Request;

/// The stages in order, timed and counted. The lattice is simple cubic: its points are the corners of the cubes. Vertices are
/// drawn to the middles of their edges by a `pull`.
pub(crate) fn extract(
    (kept, workspaces): (&mut Kept, &mut Vec<Workspace>),
    rule: Rule,
    pull: f32,
    run: Run,
) -> Result<(), ExtractError> {
    let Request { lattice, settings, .. } = *run.request;
    let request = run.request;
    let placer = Placer::new(lattice, settings, request.level()).pulled(pull);
    let patches = Patches::get(rule);
    let grid = kept.grid(request, 1)?;
    kept.stream(&Patched { grid: &grid, request, rule, patches, placer }, 1, workspaces, run)?;
    kept.keep(grid);
    Ok(())
}

/// What all slabs of an extraction share.
struct Patched<'a> {
    grid: &'a CubeGrid<'a>,
    request: &'a Request<'a>,
    rule: Rule,
    patches: &'a Patches,
    placer: Placer<'a>,
}

/// Buffers of one thread.
#[derive(Default)]
pub(crate) struct Workspace {
    samples: Samples,
    records: Records<Record>,
    best: BestTriangles,
}

impl<'a> Streamed for Patched<'a> {
    type Workspace = Workspace;

    fn workspace(&self) -> Workspace {
        Workspace::default()
    }

    fn fit(&self, workspace: &mut Workspace) -> Result<(), TryReserveError> {
        workspace.samples.fit(self.grid, self.request.source, SLOTS)?;
        workspace.records.fit(self.grid)
    }

    fn slab(
        &self,
        own: Range<usize>,
        layer_done: &LayerDone,
        workspace: &mut Workspace,
        piece: &mut Piece,
    ) -> Result<(), ExtractError> {
        let layers = self.grid.size[2];
        let (lowest, highest) = (own.start, own.end);
        // The highest layer's own edges lead one layer farther, and those of the samples there one more.
        let numbered = lowest..layers.min(highest + 1);
        let filled = lowest..layers.min(highest + 2);
        let sided = lowest.saturating_sub(1)..layers.min(highest + 3);
        let passes = [
            Pass { stage: Stage::Sampling, behind: 0, layers: sided, run: Slab::find_sides },
            Pass { stage: Stage::Sampling, behind: 1, layers: filled, run: Slab::fill },
            Pass { stage: Stage::Vertex, behind: 2, layers: numbered, run: Slab::place },
            Pass { stage: Stage::Geometry, behind: 3, layers: own, run: Slab::triangulate },
        ];
        let vertices = Vertices::within(piece);
        let Request { source, settings, control, .. } = *self.request;
        let all_corners = self.rule.faces.reads_all_corners();
        let sampling = Sampling { grid: self.grid, source, isovalue: settings.isovalue, all_corners };
        let mut slab = Slab { of: self, layer_done, sampling, workspace, vertices, highest };
        stream(&mut slab, passes, control, piece)?;
        slab.vertices.give_to(piece);
        Ok(())
    }
}

/// A slab on its way.
struct Slab<'a> {
    of: &'a Patched<'a>,
    layer_done: &'a LayerDone<'a>,
    sampling: Sampling<'a>,
    workspace: &'a mut Workspace,
    vertices: Vertices,
    /// The layer above the slab's cells, whose vertices are the next slab's.
    highest: usize,
}

impl Slab<'_> {
    fn find_sides(&mut self, layer: usize, _: &mut Piece) -> Result<(), ExtractError> {
        self.sampling.find_sides(&mut self.workspace.samples, layer);
        Ok(())
    }

    fn fill(&mut self, layer: usize, _: &mut Piece) -> Result<(), ExtractError> {
        self.sampling.fill(&mut self.workspace.samples, layer);
        Ok(())
    }

    fn place(&mut self, layer: usize, _: &mut Piece) -> Result<(), ExtractError> {
        let Patched { grid, request, rule, patches, placer } = self.of;
        let Workspace { samples, records, .. } = &mut *self.workspace;
        let (values, isovalue) = (samples.values(*grid, request.source), request.settings.isovalue);
        let pass = VertexPass { grid, samples, values, isovalue, rule: *rule, patches, placer };
        let is_own = layer < self.highest || layer + 1 == grid.size[2];
        pass.layer(layer, is_own, records, &mut self.vertices)?;
        self.vertices.check(request.most_vertices)
    }

    fn triangulate(&mut self, layer: usize, piece: &mut Piece) -> Result<(), ExtractError> {
        let Patched { grid, request, patches, placer, .. } = self.of;
        if layer + 1 == self.highest {
            // Only the highest cells have vertices of the slab above.
            piece.tail = piece.surface.triangles.len();
        }
        let Workspace { samples, records, best } = &mut *self.workspace;
        let values = samples.values(*grid, request.source);
        let pass = TrianglePass { grid, samples, values, patches, placer };
        pass.layer(layer, records, best, &mut piece.surface)?;
        (self.layer_done)();
        Ok(())
    }
}
