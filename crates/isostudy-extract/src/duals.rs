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
use self::vertices::{Record, VertexPass, Vertices};
use crate::clock::Laps;
use crate::cubes::grid::{CubeGrid, SLOTS};
use crate::cubes::records::Records;
use crate::cubes::sampling::{Samples, Sampling};
use crate::cubes::vertices::Placer;
use crate::cubes::{Kept, LayerDone, in_slabs};
use crate::extraction::{ExtractError, Extraction};
use crate::slabs::Piece;
use crate::slabs::Progress;
use crate::source::{Request, Sampler};
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
    request: &Request,
    Nets { patches, sharp, smoothing, tolerance }: Nets,
    progress: Option<&Progress>,
    trace: Option<&mut Trace>,
    extraction: &mut Extraction,
) -> Result<(), ExtractError> {
    let sharp_and_merged = sharp.filter(|_| tolerance > 0.0);
    if smoothing == 0 && sharp_and_merged.is_none() {
        return extract_unmoved(buffers, request, patches, sharp, progress, trace, extraction);
    }
    // The trace says which cell a vertex is of.
    let mut own = Trace::default();
    let trace = trace.unwrap_or(&mut own);
    extract_unmoved(buffers, request, patches, sharp, progress, Some(trace), extraction)?;
    match sharp_and_merged {
        Some(sharp) => octree::simplify(request, sharp, tolerance, trace, extraction),
        None => relaxed::relax(request, smoothing, trace, extraction),
    }
}

fn extract_unmoved(
    (kept, workspaces): (&mut Kept, &mut Vec<Workspace>),
    request: &Request,
    patches: bool,
    sharp: Option<Sharp>,
    progress: Option<&Progress>,
    trace: Option<&mut Trace>,
    extraction: &mut Extraction,
) -> Result<(), ExtractError> {
    let table = Table::get(patches);
    let placer = &Placer::new(request.lattice, request.settings, None);
    let traced = trace.is_some();
    let fit = |workspace: &mut Workspace, grid: &CubeGrid| workspace.fit(grid, request.source, table);
    let work =
        |grid: &CubeGrid, layer_done: &LayerDone, own, workspace: &mut Workspace, piece: &mut Piece| {
            let job = Job { grid, request, sharp, placer, traced, layer_done };
            stream_slab(&job, own, workspace, piece)
        };
    let buffers = (kept, workspaces, || Workspace::new(table));
    in_slabs(buffers, request, progress, trace, extraction, 1, fit, work)
}

/// What all slabs of an extraction share.
struct Job<'a> {
    grid: &'a CubeGrid<'a>,
    request: &'a Request<'a>,
    /// By tangent planes, if there is a field to have them.
    sharp: Option<Sharp>,
    placer: &'a Placer<'a>,
    /// Whether vertices get keys and triangles the numbers of their cells.
    traced: bool,
    /// Called when a layer of cells is done.
    layer_done: &'a (dyn Fn() + Sync),
}

/// Buffers of one thread, a few layers each, kept between slabs and between extractions.
pub(crate) struct Workspace {
    samples: Samples,
    records: Records<Record>,
    plans: Plans,
    tangents: Known,
}

impl Workspace {
    /// Without room yet.
    fn new(table: &'static Table) -> Self {
        let (samples, records, tangents) = Default::default();
        Self { samples, records, plans: Plans::new(table), tangents }
    }

    fn fit(
        &mut self,
        grid: &CubeGrid,
        source: Sampler,
        table: &'static Table,
    ) -> Result<(), TryReserveError> {
        if !std::ptr::eq(self.plans.table, table) {
            self.plans = Plans::new(table);
        }
        self.samples.fit(grid, source, SLOTS)?;
        self.records.fit(grid)
    }
}

/// Extracts the layers `own` of cells: their vertices, and the quadrilaterals of the edges that begin at their lower points. Those lead
/// to cells one layer down, which are the slab's below.
fn stream_slab(
    job: &Job,
    own: Range<usize>,
    Workspace { samples, records, plans, tangents }: &mut Workspace,
    piece: &mut Piece,
) -> Result<(), ExtractError> {
    let Job { grid, request, sharp, placer, .. } = *job;
    let Request { source, settings, most_vertices, .. } = *request;
    let layers = grid.size[2];
    let numbered = own.start.saturating_sub(1)..own.end;
    let filled = numbered.start..own.end + 1;
    let sided = numbered.start.saturating_sub(1)..layers.min(own.end + 2);
    let sampling = Sampling { grid, source, isovalue: settings.isovalue, all_corners: false };
    let level = sharp.and(request.level());
    let mut tangents = level.map(|level| Tangents::new(level, tangents));
    piece.clear(job.traced);
    let keys = piece.surface.trace.as_mut().map(|trace| std::mem::take(&mut trace.keys));
    let mut vertices = Vertices { positions: std::mem::take(&mut piece.positions), keys };
    let mut laps = Laps::new();
    for step in sided.start..own.end + 2 {
        if sided.contains(&step) {
            request.control.check()?;
            samples.find_sides(sampling, step);
        }
        if let Some(layer) = step.checked_sub(1).filter(|layer| filled.contains(layer)) {
            samples.fill(sampling, layer);
        }
        piece.times.sampling += laps.lap();

        let Some(layer) = step.checked_sub(2).filter(|layer| numbered.contains(layer)) else { continue };
        let samples = &*samples;
        let pass = VertexPass { grid, samples, values: samples.values(grid, source), placer };
        let by_planes = sharp.zip(tangents.as_mut());
        let cells = pass.layer(layer, by_planes, plans, records, &mut vertices)?;
        if vertices.numbered() > u64::from(most_vertices) {
            return Err(ExtractError::TooManyVertices { limit: most_vertices });
        }
        piece.times.vertex += laps.lap();

        if !own.contains(&layer) {
            piece.below = vertices.numbered();
            continue;
        }
        piece.surface.cells_visited += cells;
        let pass = QuadPass { grid, samples, plans, records, positions: &vertices.positions, level };
        let mut crossings = pass.layer(layer, &mut piece.surface)?;
        if layer == own.start {
            // Only the lowest points have quadrilaterals with vertices of the slab below.
            piece.head = piece.surface.triangles.len();
        }
        if layer + 2 == layers {
            crossings += pass.crossings(layer + 1);
        }
        // As if seen from both ends.
        piece.crossing_ends += 2 * crossings;
        piece.times.geometry += laps.lap();
        (job.layer_done)();
    }
    piece.tail = piece.surface.triangles.len();
    // Those of the slab below were needed for diagonals alone.
    vertices.positions.drain(..piece.below as usize);
    piece.positions = vertices.positions;
    if let (Some(trace), Some(mut keys)) = (&mut piece.surface.trace, vertices.keys) {
        keys.drain(..piece.below as usize);
        trace.keys = keys;
    }
    Ok(())
}
