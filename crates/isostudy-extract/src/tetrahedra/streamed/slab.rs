//! A slab of layers, streamed from the bottom up: sampled, then searched for vertices, then for triangles, each pass
//! as many layers behind the one before as a lattice edge can reach.

use std::ops::Range;

use super::faces::{FaceTables, triangulate_layer};
use super::grid::UniformGrid;
use super::points::{Placed, PointPass, Samples};
use super::records::Records;
use super::rule::ClusterRule;
use super::sampling::{FieldPass, FieldSamples, signs_of};
use super::signs::Signs;
use crate::clock::Laps;
use crate::execution::control::Control;
use crate::extraction::ExtractError;
use crate::placement::CrossingPlacer;
use crate::placement::spot::Apart;
use crate::slabs::Piece;
use crate::source::Sampler;

/// What all slabs of an extraction share.
pub(super) struct Job<'a, R> {
    pub(super) grid: &'a UniformGrid,
    pub(super) tables: &'a FaceTables,
    pub(super) rule: &'a R,
    pub(super) source: Sampler<'a>,
    pub(super) isovalue: f32,
    pub(super) apart: Apart,
    pub(super) most_vertices: u32,
    pub(super) placer: Option<&'a CrossingPlacer<'a>>,
    /// Whether vertices get keys and triangles the numbers of their cells.
    pub(super) traced: bool,
    pub(super) control: Control<'a>,
    /// Called with the number of layers sampled since the last call.
    pub(super) progress: &'a (dyn Fn(usize) + Sync),
}

/// Buffers of one thread, a few layers each, kept between slabs and between extractions.
#[derive(Debug, Default)]
pub(super) struct Workspace {
    samples: FieldSamples,
    signs: Signs,
    records: Records,
}

impl Workspace {
    /// Makes room; keeps what is large enough.
    pub(super) fn fit(
        &mut self,
        grid: &UniformGrid,
        source: Sampler,
    ) -> Result<(), std::collections::TryReserveError> {
        let slots = grid.slots() + lead(grid, source);
        if matches!(source, Sampler::Field(_)) {
            self.samples.fit(grid, slots)?;
        }
        self.signs.fit(grid, slots)?;
        self.records.fit(grid)
    }
}

/// How many layers signs are ahead of the samples at crossings. A crossing is known when the signs of all neighbours
/// are; given samples are there before that.
fn lead(grid: &UniformGrid, source: Sampler) -> usize {
    match source {
        Sampler::Field(_) => grid.reach,
        Sampler::Given { .. } => 0,
    }
}

/// Extracts the layers `own`, vertices and triangles.
pub(super) fn stream_slab<R: ClusterRule>(
    job: &Job<R>,
    own: Range<usize>,
    workspace: &mut Workspace,
    piece: &mut Piece,
) -> Result<(), ExtractError> {
    let Job { grid, isovalue, .. } = *job;
    let (reach, layers) = (grid.reach, grid.size[2]);
    let recorded = own.start.saturating_sub(reach)..layers.min(own.end + reach);
    let sampled = own.start.saturating_sub(2 * reach)..layers.min(own.end + 2 * reach);
    let lead = lead(grid, job.source);
    let signed = sampled.start.saturating_sub(lead)..layers.min(sampled.end + lead);
    let out_of_memory = |_| ExtractError::NoMemoryForMesh;
    let everywhere = job.placer.is_some_and(CrossingPlacer::reads_neighbours);
    let field_pass = |field| FieldPass { field, grid, isovalue, everywhere };

    piece.clear(job.traced);
    let mut placed = Placed {
        targets: std::mem::take(&mut piece.targets),
        keys: piece.surface.trace.as_mut().map(|trace| std::mem::take(&mut trace.keys)),
        ..Placed::default()
    };
    let mut laps = Laps::new();
    for step in signed.start..own.end + 2 * reach + lead {
        if signed.contains(&step) {
            job.control.check()?;
            match job.source {
                Sampler::Given { values, .. } => signs_of(grid, values, isovalue, step, &mut workspace.signs),
                Sampler::Field(field) => {
                    workspace.samples.find_signs(field_pass(field), step, &mut workspace.signs);
                }
            }
            if own.contains(&step) {
                (job.progress)(1);
            }
        }
        let Some(step) = step.checked_sub(lead) else { continue };
        if let Sampler::Field(field) = job.source
            && sampled.contains(&step)
        {
            workspace.samples.fill(field_pass(field), step, &workspace.signs);
        }
        piece.times.sampling += laps.lap();

        if let Some(layer) = step.checked_sub(reach).filter(|layer| recorded.contains(layer)) {
            let samples = match job.source {
                Sampler::Given { values, .. } => Samples { values, slots: layers },
                Sampler::Field(_) => workspace.samples.samples(),
            };
            let (signs, placer) = (&workspace.signs, job.placer);
            let has_more = placer.is_some() || job.traced;
            let (rule, apart) = (job.rule, job.apart);
            let pass = PointPass { grid, rule, samples, signs, isovalue, apart, placer, has_more };
            if layer == own.start {
                piece.below = placed.numbered;
            }
            if own.contains(&layer) {
                let seen = placed.crossing_ends;
                pass.layer(layer, &mut workspace.records, &mut placed, Some(&mut piece.positions))
                    .map_err(out_of_memory)?;
                piece.crossing_ends += placed.crossing_ends - seen;
            } else {
                pass.layer(layer, &mut workspace.records, &mut placed, None).map_err(out_of_memory)?;
            }
            if placed.numbered > u64::from(job.most_vertices) {
                return Err(ExtractError::TooManyVertices { limit: job.most_vertices });
            }
        }
        piece.times.vertex += laps.lap();

        if let Some(layer) = step.checked_sub(2 * reach).filter(|layer| own.contains(layer)) {
            if layer + 2 * reach <= own.end {
                piece.tail = piece.surface.triangles.len();
            }
            triangulate_layer(grid, job.tables, R::TIES, &workspace.records, layer, &mut piece.surface)
                .map_err(out_of_memory)?;
            if layer < own.start + 2 * reach {
                piece.head = piece.surface.triangles.len();
            }
        }
        piece.times.geometry += laps.lap();
    }
    piece.targets = placed.targets;
    if let (Some(trace), Some(keys)) = (&mut piece.surface.trace, placed.keys) {
        trace.keys = keys;
    }
    Ok(())
}
