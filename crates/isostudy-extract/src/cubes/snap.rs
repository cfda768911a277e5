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
use super::records::Records;
use super::sampling::{Samples, Sampling};
use super::vertices::Placer;
use super::{Flat, Kept};
use crate::extraction::ExtractError;
use crate::slabs::{Pass, Run, Slab, Stage, Streamed};

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
    let sampling =
        Sampling { grid: &grid, source: request.source, isovalue: snap.isovalue, all_corners: true };
    kept.stream(&Snapped { sampling, snap, flat, table, placer }, TIMES, workspaces, run)?;
    kept.keep(grid);
    Ok(())
}

/// What all slabs of an extraction share.
struct Snapped<'a> {
    sampling: Sampling<'a>,
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

    fn fit(&self, workspace: &mut Workspace) -> Result<(), TryReserveError> {
        let Sampling { grid, source, .. } = self.sampling;
        workspace.samples.fit(grid, source, SLOTS)?;
        workspace.labels.fit(grid)?;
        workspace.chosen.fit(grid)?;
        workspace.records.fit(grid)
    }

    fn passes(&self, own: Range<usize>) -> impl AsRef<[Pass<Self>]> {
        let layers = self.sampling.grid.size[2];
        let (lowest, highest) = (own.start, own.end);
        let numbered = lowest..highest + 1;
        // Whether a point is used is for the cells on both sides of its layer to say; which patch those have, for the next.
        let chosen = lowest_chosen(&own)..(layers - 1).min(highest + 1);
        let labelled = lowest.saturating_sub(2)..layers.min(highest + 3);
        let filled = lowest.saturating_sub(3)..layers.min(highest + 4);
        let sided = lowest.saturating_sub(4)..layers.min(highest + 5);
        [
            Pass { stage: Stage::Sampling, behind: 0, layers: sided, run: Self::find_sides },
            Pass { stage: Stage::Sampling, behind: 1, layers: filled, run: Self::fill },
            Pass { stage: Stage::Vertex, behind: 2, layers: labelled, run: Self::label },
            Pass { stage: Stage::Vertex, behind: 4, layers: chosen, run: Self::choose },
            Pass { stage: Stage::Vertex, behind: 4, layers: numbered, run: Self::place },
            Pass { stage: Stage::Geometry, behind: 5, layers: own, run: Self::triangulate },
        ]
    }
}

/// The lowest layer of cells whose patches a slab chooses.
fn lowest_chosen(own: &Range<usize>) -> usize {
    own.start.saturating_sub(1)
}

impl Snapped<'_> {
    fn find_sides(&self, slab: &mut Slab<Workspace>, layer: usize) -> Result<(), ExtractError> {
        self.sampling.find_sides(&mut slab.workspace.samples, layer)
    }

    fn fill(&self, slab: &mut Slab<Workspace>, layer: usize) -> Result<(), ExtractError> {
        self.sampling.fill(&mut slab.workspace.samples, layer);
        Ok(())
    }

    fn label(&self, slab: &mut Slab<Workspace>, layer: usize) -> Result<(), ExtractError> {
        let Self { sampling: Sampling { grid, source, .. }, snap, .. } = *self;
        let Workspace { samples, labels, .. } = &mut *slab.workspace;
        labels.find(grid, samples, samples.values(grid, source), snap, layer);
        Ok(())
    }

    fn choose(&self, slab: &mut Slab<Workspace>, layer: usize) -> Result<(), ExtractError> {
        let Workspace { labels, chosen, .. } = &mut *slab.workspace;
        if layer == lowest_chosen(&slab.own) {
            chosen.clear_used(layer);
        }
        chosen.layer(self.sampling.grid, labels, self.table, self.flat, layer);
        Ok(())
    }

    fn place(&self, slab: &mut Slab<Workspace>, layer: usize) -> Result<(), ExtractError> {
        let Self { sampling: Sampling { grid, source, .. }, ref placer, .. } = *self;
        let Workspace { samples, labels, chosen, records } = &mut *slab.workspace;
        let values = samples.values(grid, source);
        let pass = VertexPass { grid, labels, used: &chosen.used, values, placer };
        // Vertices of the layer above the slab's cells are the next slab's.
        let is_own = layer < slab.own.end || layer + 1 == grid.size[2];
        Ok(pass.layer(layer, is_own, records, &mut slab.vertices)?)
    }

    fn triangulate(&self, slab: &mut Slab<Workspace>, layer: usize) -> Result<(), ExtractError> {
        if layer + 1 == slab.own.end {
            // Only the highest cells have vertices of the slab above.
            slab.piece.tail = slab.piece.surface.triangles.len();
        }
        let Workspace { chosen, records, .. } = &*slab.workspace;
        chosen.triangulate(self.sampling.grid, self.table, records, layer, &mut slab.piece.surface)?;
        (slab.layer_done)();
        Ok(())
    }
}
