//! SnapMC: marching cubes whose crossings near a point of the lattice are drawn to it, so that triangles have bounded angles.
//!
//! Each point on whose edges there is a crossing at most `gamma` of the edge away is put on the surface; it stands for the nearest of
//! them. The cells' patches are those of the hull rule with such corners ([`table`]). Points stay where their crossing was (Raman
//! & Wenger 2008).
//!
//! It streams as [`super`] does, with more layers in sight: sides; a layer behind, samples; another behind, labels; two more, which
//! patches the cells have, and vertices; and another, triangles.

mod cells_pass;
mod labels;
mod table;
mod vertices;

use std::collections::TryReserveError;
use std::ops::Range;

use self::cells_pass::Chosen;
use self::labels::{Labels, Snap};
use self::table::Table;
use self::vertices::{Record, VertexPass};
use super::grid::CubeGrid;
use super::records::Records;
use super::sampling::{Samples, Sampling};
use super::vertices::Placer;
use super::{Flat, Kept};
use crate::extraction::ExtractError;
use crate::slabs::{LayerDone, Pass, Piece, Run, Stage, Streamed, Vertices, stream};
use crate::source::Request;

/// Layers of sides and samples in sight.
const SLOTS: usize = 6;
/// Workspaces hold so many times what others do.
const TIMES: u64 = 3;

/// The stages in order, timed and counted. The lattice is simple cubic.
pub(crate) fn extract(
    (kept, workspaces): (&mut Kept, &mut Vec<Workspace>),
    gamma: f32,
    flat: Flat,
    run: Run,
) -> Result<(), ExtractError> {
    let request = run.request;
    let placer = Placer::new(request.lattice, request.settings, None);
    let snap = Snap { isovalue: request.settings.isovalue, gamma };
    let table = Table::get();
    let grid = kept.grid(request, TIMES)?;
    kept.stream(&Snapped { grid: &grid, request, snap, flat, table, placer }, TIMES, workspaces, run)?;
    kept.keep(grid);
    Ok(())
}

/// What all slabs of an extraction share.
struct Snapped<'a> {
    grid: &'a CubeGrid<'a>,
    request: &'a Request<'a>,
    snap: Snap,
    flat: Flat,
    table: &'a Table,
    placer: Placer<'a>,
}

/// Buffers of one thread.
#[derive(Default)]
pub(crate) struct Workspace {
    samples: Samples,
    labels: Labels,
    chosen: Chosen,
    records: Records<Record>,
}

impl Streamed for Snapped<'_> {
    type Workspace = Workspace;

    fn workspace(&self) -> Workspace {
        Workspace::default()
    }

    fn fit(&self, workspace: &mut Workspace) -> Result<(), TryReserveError> {
        workspace.samples.fit(self.grid, self.request.source, SLOTS)?;
        workspace.labels.fit(self.grid)?;
        workspace.chosen.fit(self.grid)?;
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
        let numbered = lowest..highest + 1;
        // Whether a point is used is for the cells on both sides of its layer to say; which patch those have, for the next.
        let chosen = lowest.saturating_sub(1)..(layers - 1).min(highest + 1);
        let labelled = lowest.saturating_sub(2)..layers.min(highest + 3);
        let filled = lowest.saturating_sub(3)..layers.min(highest + 4);
        let sided = lowest.saturating_sub(4)..layers.min(highest + 5);
        workspace.chosen.clear_used(chosen.start);
        let passes = [
            Pass { stage: Stage::Sampling, behind: 0, layers: sided, run: Slab::find_sides },
            Pass { stage: Stage::Sampling, behind: 1, layers: filled, run: Slab::fill },
            Pass { stage: Stage::Vertex, behind: 2, layers: labelled, run: Slab::label },
            Pass { stage: Stage::Vertex, behind: 4, layers: chosen, run: Slab::choose },
            Pass { stage: Stage::Vertex, behind: 4, layers: numbered, run: Slab::place },
            Pass { stage: Stage::Geometry, behind: 5, layers: own, run: Slab::triangulate },
        ];
        let vertices = Vertices::within(piece);
        let Request { source, control, .. } = *self.request;
        let sampling = Sampling { grid: self.grid, source, isovalue: self.snap.isovalue, all_corners: true };
        let mut slab = Slab { of: self, layer_done, sampling, workspace, vertices, highest };
        stream(&mut slab, passes, control, piece)?;
        slab.vertices.give_to(piece);
        Ok(())
    }
}

/// A slab on its way.
struct Slab<'a> {
    of: &'a Snapped<'a>,
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

    fn label(&mut self, layer: usize, _: &mut Piece) -> Result<(), ExtractError> {
        let Snapped { grid, request, snap, .. } = self.of;
        let Workspace { samples, labels, .. } = &mut *self.workspace;
        labels.find(grid, samples, samples.values(*grid, request.source), *snap, layer);
        Ok(())
    }

    fn choose(&mut self, layer: usize, _: &mut Piece) -> Result<(), ExtractError> {
        let Snapped { grid, table, flat, .. } = self.of;
        let Workspace { labels, chosen, .. } = &mut *self.workspace;
        chosen.layer(grid, labels, table, *flat, layer);
        Ok(())
    }

    fn place(&mut self, layer: usize, _: &mut Piece) -> Result<(), ExtractError> {
        let Snapped { grid, request, placer, .. } = self.of;
        let Workspace { samples, labels, chosen, records } = &mut *self.workspace;
        let values = samples.values(*grid, request.source);
        let pass = VertexPass { grid, labels, used: &chosen.used, values, placer };
        let is_own = layer < self.highest || layer + 1 == grid.size[2];
        pass.layer(layer, is_own, records, &mut self.vertices)?;
        self.vertices.check(request.most_vertices)
    }

    fn triangulate(&mut self, layer: usize, piece: &mut Piece) -> Result<(), ExtractError> {
        let Snapped { grid, table, .. } = self.of;
        if layer + 1 == self.highest {
            // Only the highest cells have vertices of the slab above.
            piece.tail = piece.surface.triangles.len();
        }
        let Workspace { chosen, records, .. } = &*self.workspace;
        chosen.triangulate(grid, table, records, layer, &mut piece.surface)?;
        (self.layer_done)();
        Ok(())
    }
}
