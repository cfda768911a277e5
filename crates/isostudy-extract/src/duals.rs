//! Surface nets: a vertex in each cell that the surface crosses, and a quadrilateral round each lattice edge that it crosses.
//!
//! The surface is the dual of [`super`]'s: what is a polygon there is a vertex here. A vertex is the mean of the crossings of its cell
//! (Gibson 1998 and its followers; "naive" without relaxation), or with patches of each loop of surface round it (Nielson 2004).
//! Where two cells share a face on which each of them has one loop through all four crossings, an edge would have four
//! quadrilaterals: there both cells join the inside corners of that face instead (Wenger 2013), which cuts each loop in two.
//!
//! With tangent planes a vertex is where those of the field at the crossings meet (dual contouring; Ju, Losasso, Schaefer & Warren 2002).
//!
//! It streams: sides; a layer behind, samples; another behind, the vertices of a layer of cells; then the quadrilaterals of the edges
//! that begin at the points below it.

mod labels;
mod octree;
mod plan;
mod quads;
mod relaxed;
mod sharp;
mod tangents;
mod vertices;

pub use labels::{LabelCount, LabelError, LabelSettings, LabelSurface, LabelVolume};
pub(crate) use quads::{ROUND, is_other_better};
pub(crate) use relaxed::MOST_SMOOTHING;
pub(crate) use sharp::Sharp;

use std::collections::TryReserveError;
use std::ops::Range;

use self::plan::{Plans, Table};
use self::quads::QuadPass;
use self::tangents::{Known, Tangents};
use self::vertices::{Record, VertexPass};
use crate::cubes::Kept;
use crate::cubes::grid::{CubeGrid, SLOTS};
use crate::cubes::records::Records;
use crate::cubes::sampling::{Samples, Sampling};
use crate::cubes::vertices::Placer;
use crate::extraction::ExtractError;
use crate::sampling::level::Level;
use crate::slabs::{LayerDone, Pass, Piece, Run, Stage, Streamed, Vertices, stream};
use crate::source::Request;
use crate::surface::trace::Trace;

/// What decides a net.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Nets {
    /// A vertex for each patch of a cell, rather than one in all.
    pub(crate) patches: bool,
    /// Where tangent planes meet, rather than at the mean of crossings. Then there must be a field.
    pub(crate) sharp: Option<Sharp>,
    /// So many steps towards the linked vertices.
    pub(crate) smoothing: u32,
    /// How far vertices may be from tangent planes, in spacings, when cells become larger ones; 0 if they do not.
    pub(crate) tolerance: f32,
}

/// The stages in order, timed and counted. The lattice is simple cubic.
pub(crate) fn extract(
    buffers: (&mut Kept, &mut Vec<Workspace>),
    nets: Nets,
    run: Run,
) -> Result<(), ExtractError> {
    let Nets { sharp, smoothing, tolerance, .. } = nets;
    let sharp_and_merged = sharp.filter(|_| tolerance > 0.0);
    if smoothing == 0 && sharp_and_merged.is_none() {
        return extract_unmoved(buffers, nets, run);
    }
    // The trace says which cell a vertex is of.
    let mut own = Trace::default();
    let Run { request, progress, trace, extraction } = run;
    let trace = trace.unwrap_or(&mut own);
    let run = Run { request, progress, trace: Some(&mut *trace), extraction: &mut *extraction };
    extract_unmoved(buffers, nets, run)?;
    match sharp_and_merged {
        Some(sharp) => octree::simplify(request, sharp, tolerance, trace, extraction),
        None => relaxed::relax(request, smoothing, trace, extraction),
    }
}

fn extract_unmoved(
    (kept, workspaces): (&mut Kept, &mut Vec<Workspace>),
    Nets { patches, sharp, .. }: Nets,
    run: Run,
) -> Result<(), ExtractError> {
    let (request, table) = (run.request, Table::get(patches));
    let placer = Placer::new(request.lattice, request.settings, None);
    let grid = kept.grid(request, 1)?;
    // By tangent planes, if there is a field to have them.
    let level = sharp.and(request.level());
    kept.stream(&Net { grid: &grid, request, table, sharp, level, placer }, 1, workspaces, run)?;
    kept.keep(grid);
    Ok(())
}

/// What all slabs of an extraction share.
struct Net<'a> {
    grid: &'a CubeGrid<'a>,
    request: &'a Request<'a>,
    table: &'static Table,
    sharp: Option<Sharp>,
    level: Option<Level<'a>>,
    placer: Placer<'a>,
}

/// Buffers of one thread.
pub(crate) struct Workspace {
    samples: Samples,
    records: Records<Record>,
    plans: Plans,
    tangents: Known,
}

impl Streamed for Net<'_> {
    type Workspace = Workspace;

    fn workspace(&self) -> Workspace {
        let (samples, records, tangents) = Default::default();
        Workspace { samples, records, plans: Plans::new(self.table), tangents }
    }

    fn fit(&self, workspace: &mut Workspace) -> Result<(), TryReserveError> {
        if !std::ptr::eq(workspace.plans.table, self.table) {
            workspace.plans = Plans::new(self.table);
        }
        workspace.samples.fit(self.grid, self.request.source, SLOTS)?;
        workspace.records.fit(self.grid)
    }

    /// The quadrilaterals are those of the edges that begin at the lower points of the layers. Those lead to cells one layer down,
    /// which are the slab's below.
    fn slab(
        &self,
        own: Range<usize>,
        layer_done: &LayerDone,
        workspace: &mut Workspace,
        piece: &mut Piece,
    ) -> Result<(), ExtractError> {
        let layers = self.grid.size[2];
        let numbered = own.start.saturating_sub(1)..own.end;
        let filled = numbered.start..own.end + 1;
        let sided = numbered.start.saturating_sub(1)..layers.min(own.end + 2);
        let passes = [
            Pass { stage: Stage::Sampling, behind: 0, layers: sided, run: Slab::find_sides },
            Pass { stage: Stage::Sampling, behind: 1, layers: filled, run: Slab::fill },
            Pass { stage: Stage::Vertex, behind: 2, layers: numbered, run: Slab::place },
            Pass { stage: Stage::Geometry, behind: 2, layers: own.clone(), run: Slab::join },
        ];
        let Workspace { samples, records, plans, tangents } = workspace;
        let Request { source, settings, control, .. } = *self.request;
        let grid = self.grid;
        let sampling = Sampling { grid, source, isovalue: settings.isovalue, all_corners: false };
        let tangents = self.level.map(|level| Tangents::new(level, tangents));
        let vertices = Vertices::within(piece);
        let mut slab =
            Slab { of: self, layer_done, sampling, samples, records, plans, tangents, vertices, own };
        stream(&mut slab, passes, control, piece)?;
        let mut vertices = slab.vertices;
        piece.tail = piece.surface.triangles.len();
        // Those of the slab below were needed for diagonals alone.
        let below = piece.below as usize;
        vertices.positions.drain(..below);
        if let Some(keys) = &mut vertices.keys {
            keys.drain(..below);
        }
        vertices.give_to(piece);
        Ok(())
    }
}

/// A slab on its way.
struct Slab<'a> {
    of: &'a Net<'a>,
    layer_done: &'a LayerDone<'a>,
    sampling: Sampling<'a>,
    samples: &'a mut Samples,
    records: &'a mut Records<Record>,
    plans: &'a mut Plans,
    tangents: Option<Tangents<'a>>,
    vertices: Vertices,
    own: Range<usize>,
}

impl Slab<'_> {
    fn find_sides(&mut self, layer: usize, _: &mut Piece) -> Result<(), ExtractError> {
        self.sampling.find_sides(self.samples, layer);
        Ok(())
    }

    fn fill(&mut self, layer: usize, _: &mut Piece) -> Result<(), ExtractError> {
        self.sampling.fill(self.samples, layer);
        Ok(())
    }

    fn place(&mut self, layer: usize, piece: &mut Piece) -> Result<(), ExtractError> {
        let Net { grid, request, sharp, placer, .. } = self.of;
        let samples = &*self.samples;
        let pass = VertexPass { grid, samples, values: samples.values(*grid, request.source), placer };
        let by_planes = sharp.zip(self.tangents.as_mut());
        let cells = pass.layer(layer, by_planes, self.plans, self.records, &mut self.vertices)?;
        self.vertices.check(request.most_vertices)?;
        match self.own.contains(&layer) {
            true => piece.surface.cells_visited += cells,
            false => piece.below = self.vertices.numbered,
        }
        Ok(())
    }

    fn join(&mut self, layer: usize, piece: &mut Piece) -> Result<(), ExtractError> {
        let Net { grid, level, .. } = *self.of;
        let Self { samples, records, plans, vertices, .. } = self;
        let pass = QuadPass { grid, samples, plans, records, positions: &vertices.positions, level };
        let mut crossings = pass.layer(layer, &mut piece.surface)?;
        if layer == self.own.start {
            // Only the lowest points have quadrilaterals with vertices of the slab below.
            piece.head = piece.surface.triangles.len();
        }
        if layer + 2 == grid.size[2] {
            crossings += pass.crossings(layer + 1);
        }
        vertices.crossing_ends += 2 * crossings;
        (self.layer_done)();
        Ok(())
    }
}
