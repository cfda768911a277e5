//! A slab of cells, streamed from the bottom up: sides, then crossings and their samples, then vertices, each pass as
//! many layers behind the one before as a lattice edge can reach; then the triangles of the cells below.

use std::collections::TryReserveError;
use std::ops::Range;

use super::cells::triangulate_layer;
use super::grid::CutGrid;
use super::points::{Placer, PointPass, Records, Vertices};
use super::sampling::{Samples, Sampling};
use crate::clock::Laps;
use crate::execution::control::Control;
use crate::extraction::ExtractError;
use crate::slabs::Piece;
use crate::source::Sampler;
use crate::tetrahedra::ties::Ties;

/// What all slabs of an extraction share.
pub(super) struct Job<'a> {
    pub(super) grid: &'a CutGrid,
    pub(super) source: Sampler<'a>,
    pub(super) isovalue: f32,
    pub(super) ties: Ties,
    pub(super) placer: &'a Placer<'a>,
    pub(super) most_vertices: u32,
    /// Whether vertices get keys and triangles the numbers of their cells.
    pub(super) traced: bool,
    pub(super) control: Control<'a>,
    /// Called when a layer of cells is done.
    pub(super) progress: &'a (dyn Fn() + Sync),
}

/// Buffers of one thread, a few layers each.
#[derive(Debug, Default)]
pub(super) struct Workspace {
    samples: Samples,
    records: Records,
}

impl Workspace {
    /// Makes room; keeps what is large enough.
    pub(super) fn fit(&mut self, grid: &CutGrid, source: Sampler) -> Result<(), TryReserveError> {
        self.samples.fit(grid, source)?;
        self.records.fit(grid)
    }
}

/// Extracts the layers `own` of cells: their triangles, and the vertices of their points but for those of the highest
/// layer, which are the next slab's. Vertices are numbered from the slab's first on, so that the numbers of the whole
/// surface are these plus a constant.
pub(super) fn stream_slab(
    job: &Job,
    own: Range<usize>,
    Workspace { samples, records }: &mut Workspace,
    piece: &mut Piece,
) -> Result<(), ExtractError> {
    let Job { grid, source, isovalue, ties, placer, .. } = *job;
    let (steps, reach, layers) = (grid.cut.steps_a_cell, grid.reach(), grid.size[2]);
    let (lowest, highest) = (own.start * steps, own.end * steps);
    let around = |n: usize| lowest.saturating_sub(n)..layers.min(highest + n + 1);
    let (placed, sampled, sided) = (around(0), around(reach), around(2 * reach));
    let sampling = Sampling { grid, source, isovalue };
    piece.clear(job.traced);
    let mut vertices = Vertices {
        positions: std::mem::take(&mut piece.positions),
        targets: std::mem::take(&mut piece.targets),
        keys: piece.surface.trace.as_mut().map(|trace| std::mem::take(&mut trace.keys)),
        ..Vertices::default()
    };
    let mut laps = Laps::new();
    for step in sided.start..=highest + 2 * reach {
        if sided.contains(&step) {
            job.control.check()?;
            samples.find_sides(sampling, step);
        }
        if let Some(layer) = step.checked_sub(reach).filter(|layer| sampled.contains(layer)) {
            samples.find_crossings(sampling, layer);
        }
        piece.times.sampling += laps.lap();

        let Some(layer) = step.checked_sub(2 * reach).filter(|layer| placed.contains(layer)) else {
            continue;
        };
        let (sides, active) = (&samples.sides, &samples.active);
        let values = samples.values(grid, source);
        let pass = PointPass { grid, values, sides, active, isovalue, ties, placer };
        pass.layer(layer, layer < highest || layer + 1 == layers, records, &mut vertices)?;
        if vertices.numbered > u64::from(job.most_vertices) {
            return Err(ExtractError::TooManyVertices { limit: job.most_vertices });
        }
        piece.times.vertex += laps.lap();

        let Some(cells) = (layer / steps).checked_sub(1).filter(|&z| layer % steps == 0 && own.contains(&z))
        else {
            continue;
        };
        if cells + 1 == own.end {
            // Only the highest cells have vertices of the slab above.
            piece.tail = piece.surface.triangles.len();
        }
        triangulate_layer(grid, sides, active, records, cells, &mut piece.surface)?;
        (job.progress)();
        piece.times.geometry += laps.lap();
    }
    (piece.positions, piece.targets) = (vertices.positions, vertices.targets);
    piece.crossing_ends = vertices.crossing_ends;
    if let (Some(trace), Some(keys)) = (&mut piece.surface.trace, vertices.keys) {
        trace.keys = keys;
    }
    Ok(())
}
