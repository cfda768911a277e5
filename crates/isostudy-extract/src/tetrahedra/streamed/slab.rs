//! The passes over a slab: sampled, then searched for vertices, then for triangles, each pass as many layers behind the one before as
//! a lattice edge can reach.

use std::collections::TryReserveError;
use std::ops::Range;

use super::faces::{FaceTables, triangulate_layer};
use super::grid::UniformGrid;
use super::points::{Placed, PointPass, Samples};
use super::records::Records;
use super::rule::ClusterRule;
use super::sampling::{FieldPass, FieldSamples, signs_of};
use super::signs::Signs;
use crate::extraction::ExtractError;
use crate::placement::CrossingPlacer;
use crate::placement::spot::Apart;
use crate::slabs::{LayerDone, Pass, Piece, Stage, Streamed, stream};
use crate::source::{Request, Sampler};

/// What all slabs of an extraction share.
pub(super) struct Points<'a, R> {
    pub(super) grid: &'a UniformGrid,
    pub(super) tables: &'a FaceTables,
    pub(super) rule: &'a R,
    pub(super) request: &'a Request<'a>,
    pub(super) apart: Apart,
    pub(super) placer: Option<CrossingPlacer<'a>>,
    pub(super) has_trace: bool,
}

/// Buffers of one thread.
#[derive(Debug, Default)]
pub(super) struct Workspace {
    samples: FieldSamples,
    signs: Signs,
    records: Records,
}

impl<R: ClusterRule> Points<'_, R> {
    /// How many layers signs are ahead of the samples at crossings. A crossing is known when the signs of all neighbours
    /// are; given samples are there before that.
    fn lead(&self) -> usize {
        match self.request.source {
            Sampler::Field(_) => self.grid.reach,
            Sampler::Given { .. } => 0,
        }
    }

    fn field_pass(&self) -> Option<FieldPass<'_>> {
        let Sampler::Field(field) = self.request.source else { return None };
        let everywhere = self.placer.as_ref().is_some_and(CrossingPlacer::reads_neighbours);
        Some(FieldPass { field, grid: self.grid, isovalue: self.request.settings.isovalue, everywhere })
    }
}

impl<R: ClusterRule> Streamed for Points<'_, R> {
    type Workspace = Workspace;

    fn workspace(&self) -> Workspace {
        Workspace::default()
    }

    fn fit(&self, workspace: &mut Workspace) -> Result<(), TryReserveError> {
        let slots = self.grid.slots() + self.lead();
        if matches!(self.request.source, Sampler::Field(_)) {
            workspace.samples.fit(self.grid, slots)?;
        }
        workspace.signs.fit(self.grid, slots)?;
        workspace.records.fit(self.grid)
    }

    fn slab(
        &self,
        own: Range<usize>,
        layer_done: &LayerDone,
        workspace: &mut Workspace,
        piece: &mut Piece,
    ) -> Result<(), ExtractError> {
        let (reach, layers, lead) = (self.grid.reach, self.grid.size[2], self.lead());
        let around = |n: usize| own.start.saturating_sub(n)..layers.min(own.end + n);
        let [signed, sampled, recorded] = [2 * reach + lead, 2 * reach, reach].map(around);
        let passes = [
            Pass { stage: Stage::Sampling, behind: 0, layers: signed, run: Slab::find_signs },
            Pass { stage: Stage::Sampling, behind: lead, layers: sampled, run: Slab::fill },
            Pass { stage: Stage::Vertex, behind: lead + reach, layers: recorded, run: Slab::place },
            Pass {
                stage: Stage::Geometry,
                behind: lead + 2 * reach,
                layers: own.clone(),
                run: Slab::triangulate,
            },
        ];
        let placed = Placed {
            targets: std::mem::take(&mut piece.targets),
            keys: piece.surface.trace.as_mut().map(|trace| std::mem::take(&mut trace.keys)),
            ..Placed::default()
        };
        let field = self.field_pass();
        let mut slab = Slab { of: self, layer_done, field, workspace, placed, own };
        stream(&mut slab, passes, self.request.control, piece)?;
        let Placed { targets, keys, .. } = slab.placed;
        piece.targets = targets;
        if let (Some(trace), Some(keys)) = (&mut piece.surface.trace, keys) {
            trace.keys = keys;
        }
        Ok(())
    }
}

/// A slab on its way.
struct Slab<'a, R> {
    of: &'a Points<'a, R>,
    layer_done: &'a LayerDone<'a>,
    /// What is called, if it is a field.
    field: Option<FieldPass<'a>>,
    workspace: &'a mut Workspace,
    placed: Placed,
    own: Range<usize>,
}

impl<R: ClusterRule> Slab<'_, R> {
    fn find_signs(&mut self, layer: usize, _: &mut Piece) -> Result<(), ExtractError> {
        let Points { grid, request, .. } = self.of;
        let Workspace { samples, signs, .. } = &mut *self.workspace;
        match (request.source, self.field) {
            (Sampler::Given { values, .. }, _) => {
                signs_of(grid, values, request.settings.isovalue, layer, signs);
            }
            (Sampler::Field(_), Some(pass)) => samples.find_signs(pass, layer, signs),
            (Sampler::Field(_), None) => unreachable!("made for a field"),
        }
        Ok(())
    }

    fn fill(&mut self, layer: usize, _: &mut Piece) -> Result<(), ExtractError> {
        if let Some(pass) = self.field {
            self.workspace.samples.fill(pass, layer, &self.workspace.signs);
        }
        Ok(())
    }

    fn place(&mut self, layer: usize, piece: &mut Piece) -> Result<(), ExtractError> {
        let &Points { grid, rule, request, apart, ref placer, has_trace, .. } = self.of;
        let Workspace { samples, signs, records } = &mut *self.workspace;
        let samples = match request.source {
            Sampler::Given { values, .. } => Samples { values, slots: grid.size[2] },
            Sampler::Field(_) => samples.samples(),
        };
        let (placer, isovalue) = (placer.as_ref(), request.settings.isovalue);
        let has_more = placer.is_some() || has_trace;
        let pass = PointPass { grid, rule, samples, signs, isovalue, apart, placer, has_more };
        let placed = &mut self.placed;
        if layer == self.own.start {
            piece.below = placed.numbered;
        }
        if self.own.contains(&layer) {
            let seen = placed.crossing_ends;
            pass.layer(layer, records, placed, Some(&mut piece.positions))?;
            piece.crossing_ends += placed.crossing_ends - seen;
        } else {
            pass.layer(layer, records, placed, None)?;
        }
        let limit = request.most_vertices;
        if placed.numbered > u64::from(limit) {
            return Err(ExtractError::TooManyVertices { limit });
        }
        Ok(())
    }

    fn triangulate(&mut self, layer: usize, piece: &mut Piece) -> Result<(), ExtractError> {
        let Points { grid, tables, .. } = self.of;
        let farthest = 2 * grid.reach;
        if layer + farthest <= self.own.end {
            piece.tail = piece.surface.triangles.len();
        }
        triangulate_layer(grid, tables, R::TIES, &self.workspace.records, layer, &mut piece.surface)?;
        if layer < self.own.start + farthest {
            piece.head = piece.surface.triangles.len();
        }
        (self.layer_done)();
        Ok(())
    }
}
