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
use super::Flat;
use super::grid::CubeGrid;
use super::records::Records;
use super::sampling::{Samples, Sampling};
use super::vertices::{Placer, Vertices};
use super::{Kept, LayerDone, in_slabs};
use crate::clock::Laps;
use crate::execution::control::Control;
use crate::extraction::{ExtractError, Extraction};
use crate::slabs::Piece;
use crate::slabs::Progress;
use crate::source::{Request, Sampler};
use crate::surface::trace::Trace;

/// Layers of sides and samples in sight.
const SLOTS: usize = 6;

/// The stages in order, timed and counted. The lattice is simple cubic.
pub(crate) fn extract(
    (kept, workspaces): (&mut Kept, &mut Vec<Workspace>),
    request: &Request,
    gamma: f32,
    flat: Flat,
    progress: Option<&Progress>,
    trace: Option<&mut Trace>,
    extraction: &mut Extraction,
) -> Result<(), ExtractError> {
    let Request { source, settings, control, most_vertices, .. } = *request;
    let table = Table::get();
    let placer = &Placer::new(request.lattice, settings, None);
    let snap = Snap { isovalue: settings.isovalue, gamma };
    let traced = trace.is_some();
    let fit = |workspace: &mut Workspace, grid: &CubeGrid| workspace.fit(grid, source);
    let work =
        |grid: &CubeGrid, layer_done: &LayerDone, own, workspace: &mut Workspace, piece: &mut Piece| {
            let job =
                Job { grid, source, snap, flat, table, placer, most_vertices, traced, control, layer_done };
            stream_slab(&job, own, workspace, piece)
        };
    let buffers = (kept, workspaces, Workspace::default);
    in_slabs(buffers, request, progress, trace, extraction, 3, fit, work)
}

/// What all slabs of an extraction share.
struct Job<'a> {
    grid: &'a CubeGrid<'a>,
    source: Sampler<'a>,
    snap: Snap,
    flat: Flat,
    table: &'a Table,
    placer: &'a Placer<'a>,
    most_vertices: u32,
    /// Whether vertices get keys and triangles the numbers of their cells.
    traced: bool,
    control: Control<'a>,
    layer_done: &'a (dyn Fn() + Sync),
}

/// Buffers of one thread, a few layers each, kept between slabs and between extractions.
#[derive(Default)]
pub(crate) struct Workspace {
    samples: Samples,
    labels: Labels,
    chosen: Chosen,
    records: Records<Record>,
}

impl Workspace {
    fn fit(&mut self, grid: &CubeGrid, source: Sampler) -> Result<(), TryReserveError> {
        self.samples.fit(grid, source, SLOTS)?;
        self.labels.fit(grid)?;
        self.chosen.fit(grid)?;
        self.records.fit(grid)
    }
}

/// Extracts the layers `own` of cells: their triangles, and the vertices of their points but for those of the highest layer,
/// which are the next slab's.
fn stream_slab(
    job: &Job,
    own: Range<usize>,
    Workspace { samples, labels, chosen, records }: &mut Workspace,
    piece: &mut Piece,
) -> Result<(), ExtractError> {
    let Job { grid, source, snap, flat, table, placer, .. } = *job;
    let layers = grid.size[2];
    let (lowest, highest) = (own.start, own.end);
    let numbered = lowest..highest + 1;
    // Whether a point is used is for the cells on both sides of its layer to say; which patch those have, for the next.
    let chosen_cells = lowest.saturating_sub(1)..(layers - 1).min(highest + 1);
    let labelled = lowest.saturating_sub(2)..layers.min(highest + 3);
    let filled = lowest.saturating_sub(3)..layers.min(highest + 4);
    let sided = lowest.saturating_sub(4)..layers.min(highest + 5);
    let sampling = Sampling { grid, source, isovalue: snap.isovalue, all_corners: true };
    piece.clear(job.traced);
    let mut vertices = Vertices::within(piece);
    chosen.clear_used(chosen_cells.start);
    let mut laps = Laps::new();
    for step in sided.start..=highest + 4 {
        if sided.contains(&step) {
            job.control.check()?;
            samples.find_sides(sampling, step);
        }
        if let Some(layer) = step.checked_sub(1).filter(|layer| filled.contains(layer)) {
            samples.fill(sampling, layer);
        }
        piece.times.sampling += laps.lap();

        let values = samples.values(grid, source);
        if let Some(layer) = step.checked_sub(2).filter(|layer| labelled.contains(layer)) {
            labels.find(grid, samples, values, snap, layer);
        }
        let Some(layer) = step.checked_sub(4) else { continue };
        if chosen_cells.contains(&layer) {
            chosen.layer(grid, labels, table, flat, layer);
        }
        if !numbered.contains(&layer) {
            continue;
        }
        let pass = VertexPass { grid, labels, used: &chosen.used, values, placer };
        pass.layer(layer, layer < highest || layer + 1 == layers, records, &mut vertices)?;
        if vertices.numbered > u64::from(job.most_vertices) {
            return Err(ExtractError::TooManyVertices { limit: job.most_vertices });
        }
        piece.times.vertex += laps.lap();

        let Some(z) = layer.checked_sub(1).filter(|z| own.contains(z)) else { continue };
        if z + 1 == own.end {
            // Only the highest cells have vertices of the slab above.
            piece.tail = piece.surface.triangles.len();
        }
        chosen.triangulate(grid, table, records, z, &mut piece.surface)?;
        piece.times.geometry += laps.lap();
        (job.layer_done)();
    }
    vertices.give_to(piece);
    Ok(())
}
