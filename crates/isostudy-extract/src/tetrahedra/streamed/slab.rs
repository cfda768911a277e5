//! The passes over a slab: sampled, then searched for vertices, then for triangles, each pass as many layers behind the one before as
//! a lattice edge can reach.

use std::collections::TryReserveError;
use std::ops::Range;

use super::faces::{FaceTables, triangulate_layer};
use super::grid::UniformGrid;
use super::points::{PointPass, Samples};
use super::records::Records;
use super::rule::ClusterRule;
use super::sampling::{FieldPass, FieldSamples, signs_of};
use super::signs::Signs;
use crate::extraction::ExtractError;
use crate::placement::CrossingPlacer;
use crate::placement::spot::Apart;
use crate::slabs::{Pass, Slab, Stage, Streamed};
use crate::source::{Request, Sampler, read_layer};

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
    /// are; given samples are there before that, and so are those that are read.
    fn lead(&self) -> usize {
        match self.request.source {
            Sampler::Field(_) => self.grid.reach,
            Sampler::Given { .. } | Sampler::Stored(_) => 0,
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

    fn fit(&self, workspace: &mut Workspace) -> Result<(), TryReserveError> {
        let slots = self.grid.slots() + self.lead();
        match self.request.source {
            Sampler::Given { .. } => {}
            Sampler::Field(_) => workspace.samples.fit(self.grid, slots)?,
            Sampler::Stored(_) => workspace.samples.fit_values(self.grid, slots)?,
        }
        workspace.signs.fit(self.grid, slots)?;
        workspace.records.fit(self.grid)
    }

    fn passes(&self, own: Range<usize>) -> impl AsRef<[Pass<Self>]> {
        let (reach, layers, lead) = (self.grid.reach, self.grid.size[2], self.lead());
        let around = |n: usize| own.start.saturating_sub(n)..layers.min(own.end + n);
        let [signed, sampled, recorded] = [2 * reach + lead, 2 * reach, reach].map(around);
        let behind = lead + 2 * reach;
        [
            Pass { stage: Stage::Sampling, behind: 0, layers: signed, run: Self::find_signs },
            Pass { stage: Stage::Sampling, behind: lead, layers: sampled, run: Self::fill },
            Pass { stage: Stage::Vertex, behind: lead + reach, layers: recorded, run: Self::place },
            Pass { stage: Stage::Geometry, behind, layers: own, run: Self::triangulate },
        ]
    }
}

impl<R: ClusterRule> Points<'_, R> {
    fn find_signs(&self, slab: &mut Slab<Workspace>, layer: usize) -> Result<(), ExtractError> {
        let Workspace { samples, signs, .. } = &mut *slab.workspace;
        let isovalue = self.request.settings.isovalue;
        match (self.request.source, self.field_pass()) {
            (Sampler::Given { values, .. }, _) => {
                let all = Samples { values, slots: self.grid.size[2] };
                signs_of(self.grid, all, isovalue, layer, signs);
            }
            (Sampler::Stored(stored), _) => {
                read_layer(stored, layer, samples.layer_mut(self.grid, layer))?;
                signs_of(self.grid, samples.samples(), isovalue, layer, signs);
            }
            (Sampler::Field(_), Some(pass)) => samples.find_signs(pass, layer, signs),
            (Sampler::Field(_), None) => unreachable!("made for a field"),
        }
        Ok(())
    }

    fn fill(&self, slab: &mut Slab<Workspace>, layer: usize) -> Result<(), ExtractError> {
        if let Some(pass) = self.field_pass() {
            slab.workspace.samples.fill(pass, layer, &slab.workspace.signs);
        }
        Ok(())
    }

    fn place(&self, slab: &mut Slab<Workspace>, layer: usize) -> Result<(), ExtractError> {
        let &Self { grid, rule, request, apart, ref placer, has_trace, .. } = self;
        let Slab { own, workspace: Workspace { samples, signs, records }, vertices, piece, .. } = slab;
        let samples = match request.source {
            Sampler::Given { values, .. } => Samples { values, slots: grid.size[2] },
            Sampler::Field(_) | Sampler::Stored(_) => samples.samples(),
        };
        let (placer, isovalue) = (placer.as_ref(), request.settings.isovalue);
        let has_more = placer.is_some() || has_trace;
        let pass = PointPass { grid, rule, samples, signs, isovalue, apart, placer, has_more };
        if layer == own.start {
            piece.below = vertices.numbered;
        }
        // Of other layers, vertices are numbered and no more.
        let (is_own, seen) = (own.contains(&layer), vertices.crossing_ends);
        let mut positions = std::mem::take(&mut vertices.positions);
        let placed = pass.layer(layer, records, vertices, is_own.then_some(&mut positions));
        vertices.positions = positions;
        if !is_own {
            vertices.crossing_ends = seen;
        }
        Ok(placed?)
    }

    fn triangulate(&self, slab: &mut Slab<Workspace>, layer: usize) -> Result<(), ExtractError> {
        let Slab { own, workspace, piece, layer_done, .. } = slab;
        let farthest = 2 * self.grid.reach;
        if layer + farthest <= own.end {
            piece.tail = piece.surface.triangles.len();
        }
        let result = &mut piece.surface;
        triangulate_layer(self.grid, self.tables, R::TIES, &workspace.records, layer, result)?;
        if layer < own.start + farthest {
            piece.head = piece.surface.triangles.len();
        }
        layer_done();
        Ok(())
    }
}
