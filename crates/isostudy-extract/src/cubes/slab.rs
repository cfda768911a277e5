//! A slab of cells, streamed from the bottom up: sides; a layer behind, the samples that cells need; another behind, vertices; and
//! another, triangles.

use std::collections::TryReserveError;
use std::ops::Range;

use super::Rule;
use super::cells_pass::{BestTriangles, triangulate_layer};
use super::grid::{CubeGrid, SLOTS};
use super::patches::Patches;
use super::records::Records;
use super::sampling::{Samples, Sampling};
use super::vertices::{Placer, Record, VertexPass, Vertices};
use crate::clock::Laps;
use crate::execution::control::Control;
use crate::extraction::ExtractError;
use crate::slabs::Piece;
use crate::source::Sampler;

/// What all slabs of an extraction share.
pub(super) struct Job<'a> {
    pub(super) grid: &'a CubeGrid<'a>,
    pub(super) source: Sampler<'a>,
    pub(super) isovalue: f32,
    pub(super) rule: Rule,
    pub(super) patches: &'a Patches,
    pub(super) placer: &'a Placer<'a>,
    pub(super) most_vertices: u32,
    /// Whether vertices get keys and triangles the numbers of their cells.
    pub(super) traced: bool,
    pub(super) control: Control<'a>,
    /// Called when a layer of cells is done.
    pub(super) layer_done: &'a (dyn Fn() + Sync),
}

/// Buffers of one thread, a few layers each, kept between slabs and between extractions.
#[derive(Default)]
pub(crate) struct Workspace {
    samples: Samples,
    records: Records<Record>,
    best: BestTriangles,
}

impl Workspace {
    /// Makes room.
    pub(super) fn fit(&mut self, grid: &CubeGrid, source: Sampler) -> Result<(), TryReserveError> {
        self.samples.fit(grid, source, SLOTS)?;
        self.records.fit(grid)
    }
}

/// Extracts the layers `own` of cells: their triangles, and the vertices of their points but for those of the highest layer,
/// which are the next slab's. Vertices are numbered from the slab's first on, so that the numbers of the whole surface are these
/// plus a constant.
pub(super) fn stream_slab(
    job: &Job,
    own: Range<usize>,
    Workspace { samples, records, best }: &mut Workspace,
    piece: &mut Piece,
) -> Result<(), ExtractError> {
    let Job { grid, source, isovalue, rule, patches, placer, .. } = *job;
    let layers = grid.size[2];
    let (lowest, highest) = (own.start, own.end);
    // The highest layer's own edges lead one layer farther, and those of the samples there one more.
    let numbered = lowest..layers.min(highest + 1);
    let filled = lowest..layers.min(highest + 2);
    let sided = lowest.saturating_sub(1)..layers.min(highest + 3);
    let sampling = Sampling { grid, source, isovalue, all_corners: rule.faces.reads_all_corners() };
    piece.clear(job.traced);
    let mut vertices = Vertices::within(piece);
    let mut laps = Laps::new();
    for step in sided.start..=highest + 2 {
        if sided.contains(&step) {
            job.control.check()?;
            samples.find_sides(sampling, step);
        }
        if let Some(layer) = step.checked_sub(1).filter(|layer| filled.contains(layer)) {
            samples.fill(sampling, layer);
        }
        piece.times.sampling += laps.lap();

        let Some(layer) = step.checked_sub(2).filter(|layer| numbered.contains(layer)) else { continue };
        let samples = &*samples;
        let values = samples.values(grid, source);
        let pass = VertexPass { grid, samples, values, isovalue, rule, patches, placer };
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
        triangulate_layer(job, samples, values, records, z, best, &mut piece.surface)?;
        piece.times.geometry += laps.lap();
        (job.layer_done)();
    }
    vertices.give_to(piece);
    Ok(())
}
