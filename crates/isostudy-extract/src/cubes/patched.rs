//! Patches of crossings, streamed: sides; a layer behind, the samples that cells need; another behind, vertices; and another,
//! triangles.

use std::collections::TryReserveError;
use std::ops::Range;

use super::cells_pass::{BestTriangles, TrianglePass};
use super::grid::SLOTS;
use super::patches::Patches;
use super::records::Records;
use super::sampling::{Samples, Sampling};
use super::vertices::{Placer, Record, VertexPass};
use super::{Kept, Rule};
use crate::extraction::ExtractError;
use crate::lattice::Part;
use crate::slabs::{Pass, Run, Slab, Stage, Streamed};
use crate::source::{NormalsOf, Request};

/// The stages in order, timed and counted. The lattice is simple cubic: its points are the corners of the cubes. Vertices are
/// drawn to the middles of their edges by a `pull`.
pub(crate) fn extract(
    (kept, workspaces): (&mut Kept, &mut Vec<Workspace>),
    rule: Rule,
    pull: f32,
    run: Run,
) -> Result<(), ExtractError> {
    let request = run.request;
    let Request { source, lattice, settings, .. } = *request;
    let placer = Placer::new(lattice, settings, request.level()).pulled(pull);
    let patches = Patches::get(rule);
    let grid = kept.grid(request, 1)?;
    let (isovalue, all_corners) = (settings.isovalue, rule.faces.reads_all_corners());
    let sampling = Sampling { grid: &grid, source, isovalue, all_corners };
    let (part, has_normals) = (request.part, request.normals == NormalsOf::Samples);
    kept.stream(&Patched { sampling, rule, patches, placer, part, has_normals }, 1, workspaces, run)?;
    kept.keep(grid);
    Ok(())
}

/// What all slabs of an extraction share.
struct Patched<'a> {
    sampling: Sampling<'a>,
    rule: Rule,
    patches: &'a Patches,
    placer: Placer<'a>,
    /// The cells that have triangles, where not all have.
    part: Option<Part>,
    /// Whether vertices have normals by samples.
    has_normals: bool,
}

/// Buffers of one thread.
#[derive(Default)]
pub(crate) struct Workspace {
    samples: Samples,
    records: Records<Record>,
    best: BestTriangles,
}

impl Streamed for Patched<'_> {
    type Workspace = Workspace;

    fn fit(&self, workspace: &mut Workspace) -> Result<(), TryReserveError> {
        let Sampling { grid, source, .. } = self.sampling;
        workspace.samples.fit(grid, source, SLOTS)?;
        workspace.records.fit(grid)
    }

    fn part(&self) -> Option<Part> {
        self.part
    }

    fn passes(&self, own: Range<usize>) -> impl AsRef<[Pass<Self>]> {
        let layers = self.sampling.grid.size[2];
        let (lowest, highest) = (own.start, own.end);
        // The highest layer's own edges lead one layer farther, and those of the samples there one more.
        let numbered = lowest..layers.min(highest + 1);
        let filled = lowest..layers.min(highest + 2);
        let sided = lowest.saturating_sub(1)..layers.min(highest + 3);
        [
            Pass { stage: Stage::Sampling, behind: 0, layers: sided, run: Self::find_sides },
            Pass { stage: Stage::Sampling, behind: 1, layers: filled, run: Self::fill },
            Pass { stage: Stage::Vertex, behind: 2, layers: numbered, run: Self::place },
            Pass { stage: Stage::Geometry, behind: 3, layers: own, run: Self::triangulate },
        ]
    }
}

impl Patched<'_> {
    /// Those that have triangles.
    fn cells(&self) -> Part {
        self.part.unwrap_or_else(|| Part::whole(self.sampling.grid.lattice))
    }

    fn find_sides(&self, slab: &mut Slab<Workspace>, layer: usize) -> Result<(), ExtractError> {
        self.sampling.find_sides(&mut slab.workspace.samples, layer)
    }

    fn fill(&self, slab: &mut Slab<Workspace>, layer: usize) -> Result<(), ExtractError> {
        self.sampling.fill(&mut slab.workspace.samples, layer);
        Ok(())
    }

    fn place(&self, slab: &mut Slab<Workspace>, layer: usize) -> Result<(), ExtractError> {
        let Self { sampling, rule, patches, ref placer, has_normals, .. } = *self;
        let Workspace { samples, records, .. } = &mut *slab.workspace;
        let Sampling { grid, source, isovalue, .. } = sampling;
        let pass = VertexPass {
            grid,
            samples,
            values: samples.values(grid, source),
            isovalue,
            rule,
            patches,
            placer,
            part: self.cells(),
            has_normals,
        };
        // Vertices of the layer above the slab's cells are the next slab's.
        let is_own = layer < slab.own.end || layer + 1 == grid.size[2];
        Ok(pass.layer(layer, is_own, records, &mut slab.vertices)?)
    }

    fn triangulate(&self, slab: &mut Slab<Workspace>, layer: usize) -> Result<(), ExtractError> {
        let Self { sampling: Sampling { grid, source, .. }, patches, ref placer, .. } = *self;
        if layer + 1 == slab.own.end {
            // Only the highest cells have vertices of the slab above.
            slab.piece.tail = slab.piece.surface.triangles.len();
        }
        let Workspace { samples, records, best } = &mut *slab.workspace;
        let (values, part) = (samples.values(grid, source), self.cells());
        let pass = TrianglePass { grid, samples, values, patches, placer, part };
        pass.layer(layer, records, best, &mut slab.piece.surface)?;
        (slab.layer_done)();
        Ok(())
    }
}
