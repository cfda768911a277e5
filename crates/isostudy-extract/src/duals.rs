//! Surface nets: a vertex in each cell that the surface crosses, and a quadrilateral round each lattice edge that it crosses.
//!
//! The surface is the dual of [`super`]'s: what is a polygon there is a vertex here. A vertex is the mean of the crossings of its cell
//! (Gibson 1998 and its followers; "naive" without relaxation), or with patches of each loop of surface round it (Nielson 2004).
//! Where two cells share a face on which each of them has one loop through all four crossings, an edge would have four
//! quadrilaterals: there both cells join the inside corners of that face instead (Wenger 2013), which cuts each loop in two.
//!
//! With vertices in the middle of their cells the surface is that of blocks round the samples.
//!
//! With tangent planes a vertex is where those of the field at the crossings meet (dual contouring; Ju, Losasso, Schaefer & Warren 2002).
//!
//! It streams: sides; a layer behind, samples; another behind, the vertices of a layer of cells; then the quadrilaterals of the edges
//! that begin at the points below it.

#[cfg(feature = "dual-contouring-clean")]
mod clean;
mod labels;
mod octree;
mod plan;
mod quads;
mod rectangles;
mod region;
mod relaxed;
mod sharp;
mod tangents;
mod vertices;

#[cfg(feature = "dual-contouring-clean")]
pub(crate) use clean::Buffers as CleanBuffers;
pub(crate) use labels::Placed;
pub use labels::{LabelCount, LabelError, LabelSettings, LabelSurface, LabelVolume};
pub(crate) use plan::{Pattern, VertexPer};
pub(crate) use quads::{ROUND, is_other_better};
pub(crate) use relaxed::MOST_SMOOTHING;
pub(crate) use sharp::Sharp;
pub(crate) use tangents::{Tangent, tangent};

use std::collections::TryReserveError;
use std::ops::Range;

use self::plan::{Plans, Table};
use self::quads::QuadPass;
use self::tangents::{Known, Layer, Tangents};
use self::vertices::{Record, VertexPass};
use crate::cubes::Kept;
use crate::cubes::grid::SLOTS;
use crate::cubes::records::Records;
use crate::cubes::sampling::{Samples, Sampling};
use crate::cubes::vertices::Placer;
use crate::extraction::ExtractError;
use crate::lattice::Part;
use crate::sampling::level::Level;
use crate::slabs::{Pass, Run, Slab, Stage, Streamed};
use crate::source::{NormalsOf, Request};
use crate::surface::trace::Trace;

/// What decides a net.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Nets {
    /// What a cell has one vertex for. With [`VertexPer::Loop`] nothing of the net passes through anything else of it; then there must be
    /// tangent planes, and vertices stay in their cells.
    pub(crate) vertex_per: VertexPer,
    /// Where tangent planes meet, rather than at the mean of crossings. Then there must be a field.
    pub(crate) sharp: Option<Sharp>,
    /// So many steps towards the linked vertices.
    pub(crate) smoothing: u32,
    /// How far vertices may be from tangent planes, in spacings, when cells become larger ones; 0 if they do not.
    pub(crate) tolerance: f32,
    /// Vertices in the middle of their cells, whatever the samples are.
    pub(crate) blocks: Option<Blocks>,
}

/// What becomes of the squares between blocks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Blocks {
    /// Each stays.
    Single,
    /// Those of one plane become rectangles.
    Merged,
}

/// The stages in order, timed and counted. The lattice is simple cubic.
pub(crate) fn extract(
    buffers: (&mut Kept, &mut Vec<Workspace>),
    #[cfg(feature = "dual-contouring-clean")] room: &mut CleanBuffers,
    nets: Nets,
    run: Run,
) -> Result<(), ExtractError> {
    let Nets { sharp, smoothing, tolerance, .. } = nets;
    let sharp_and_merged = sharp.filter(|_| tolerance > 0.0);
    let are_squares_merged = nets.blocks == Some(Blocks::Merged);
    let is_clean = nets.vertex_per == VertexPer::Loop;
    if smoothing == 0 && sharp_and_merged.is_none() && !are_squares_merged && !is_clean {
        return extract_unmoved(buffers, nets, run);
    }
    let mut own = Trace::default();
    let Run { request, progress, trace, extraction } = run;
    #[cfg(feature = "dual-contouring-clean")]
    if is_clean {
        let trace = trace.unwrap_or(&mut own);
        let unmoved = &Request { normals: NormalsOf::Nothing, ..*request };
        let run = Run { request: unmoved, progress, trace: Some(&mut *trace), extraction: &mut *extraction };
        let (kept, workspaces) = buffers;
        extract_unmoved((&mut *kept, workspaces), nets, run)?;
        let sharp = sharp.expect("a clean net is of tangent planes");
        let grid = kept.grid(request, 1)?;
        let result = clean::clean(request, &grid, (sharp, tolerance), room, trace, extraction);
        kept.keep(grid);
        return result;
    }
    // The trace says which cell a vertex is of. What is done afterwards needs all triangles.
    let request = &Request { part: None, normals: NormalsOf::Triangles, ..*request };
    let trace = trace.unwrap_or(&mut own);
    let run = Run { request, progress, trace: Some(&mut *trace), extraction: &mut *extraction };
    extract_unmoved(buffers, nets, run)?;
    match sharp_and_merged {
        #[cfg(feature = "dual-contouring")]
        Some(sharp) => octree::simplify(request, sharp, tolerance, trace, extraction),
        #[cfg(feature = "blocky")]
        None if are_squares_merged => rectangles::merge(trace, extraction),
        #[cfg(feature = "surface-nets")]
        None => relaxed::relax(request, smoothing, trace, extraction),
        #[cfg(not(all(feature = "dual-contouring", feature = "surface-nets")))]
        _ => unreachable!("its family is not built"),
    }
}

fn extract_unmoved(
    (kept, workspaces): (&mut Kept, &mut Vec<Workspace>),
    Nets { vertex_per, sharp, blocks, .. }: Nets,
    run: Run,
) -> Result<(), ExtractError> {
    let (request, table) = (run.request, Table::get(vertex_per));
    let placer = Placer::new(request.lattice, request.settings, None);
    let grid = kept.grid(request, 1)?;
    // By tangent planes, if there is a field to have them.
    let by_planes = if cfg!(feature = "dual-contouring") { sharp.zip(request.level()) } else { None };
    let (source, isovalue) = (request.source, request.settings.isovalue);
    let sampling = Sampling { grid: &grid, source, isovalue, all_corners: false };
    kept.stream(
        &Net {
            sampling,
            table,
            by_planes,
            placer,
            in_middle: blocks.is_some(),
            part: request.part,
            has_normals: request.normals == NormalsOf::Samples,
        },
        1,
        workspaces,
        run,
    )?;
    kept.keep(grid);
    Ok(())
}

/// What all slabs of an extraction share.
struct Net<'a> {
    sampling: Sampling<'a>,
    table: &'static Table,
    by_planes: Option<(Sharp, Level<'a>)>,
    placer: Placer<'a>,
    /// Whether vertices are in the middle of their cells.
    in_middle: bool,
    /// The points whose edges have quadrilaterals, where not all have.
    part: Option<Part>,
    /// Whether vertices have normals by samples.
    has_normals: bool,
}

/// Buffers of one thread.
#[derive(Default)]
pub(crate) struct Workspace {
    samples: Samples,
    records: Records<Record>,
    /// Those of a table, once there is one.
    plans: Option<Plans>,
    tangents: Known,
}

impl Streamed for Net<'_> {
    type Workspace = Workspace;

    fn fit(&self, workspace: &mut Workspace) -> Result<(), TryReserveError> {
        if workspace.plans.as_ref().is_none_or(|plans| !std::ptr::eq(plans.table, self.table)) {
            workspace.plans = Some(Plans::new(self.table));
        }
        let Sampling { grid, source, .. } = self.sampling;
        workspace.samples.fit(grid, source, SLOTS)?;
        workspace.records.fit(grid)
    }

    fn part(&self) -> Option<Part> {
        self.part
    }

    /// The quadrilaterals are those of the edges that begin at the lower points of the layers. Those lead to cells one layer down,
    /// which are the slab's below.
    fn passes(&self, own: Range<usize>) -> impl AsRef<[Pass<Self>]> {
        let layers = self.sampling.grid.size[2];
        let numbered = lowest_numbered(&own)..own.end;
        let filled = numbered.start..own.end + 1;
        let sided = numbered.start.saturating_sub(1)..layers.min(own.end + 2);
        [
            Pass { stage: Stage::Sampling, behind: 0, layers: sided, run: Self::find_sides },
            Pass { stage: Stage::Sampling, behind: 1, layers: filled, run: Self::fill },
            Pass { stage: Stage::Vertex, behind: 2, layers: numbered, run: Self::place },
            Pass { stage: Stage::Geometry, behind: 2, layers: own, run: Self::join },
        ]
    }

    fn end(&self, slab: &mut Slab<Workspace>) {
        slab.piece.tail = slab.piece.surface.triangles.len();
        // Those of the slab below were needed for diagonals alone.
        let below = slab.piece.below as usize;
        slab.vertices.positions.drain(..below);
        if self.has_normals {
            slab.vertices.normals.drain(..below);
        }
        if let Some(keys) = &mut slab.vertices.keys {
            keys.drain(..below);
        }
        if self.table.has_loops() && !slab.vertices.patterns.is_empty() {
            slab.vertices.patterns.drain(..below);
        }
    }
}

/// The lowest layer of cells whose vertices a slab places.
fn lowest_numbered(own: &Range<usize>) -> usize {
    own.start.saturating_sub(1)
}

impl Net<'_> {
    fn find_sides(&self, slab: &mut Slab<Workspace>, layer: usize) -> Result<(), ExtractError> {
        self.sampling.find_sides(&mut slab.workspace.samples, layer)
    }

    fn fill(&self, slab: &mut Slab<Workspace>, layer: usize) -> Result<(), ExtractError> {
        self.sampling.fill(&mut slab.workspace.samples, layer);
        Ok(())
    }

    fn place(&self, slab: &mut Slab<Workspace>, layer: usize) -> Result<(), ExtractError> {
        let Self { sampling: Sampling { grid, source, .. }, by_planes, ref placer, in_middle, .. } = *self;
        let Workspace { samples, records, plans, tangents } = &mut *slab.workspace;
        let plans = plans.as_mut().expect("there is room for it");
        let part = self.part.unwrap_or_else(|| Part::whole(grid.lattice));
        let values = samples.values(grid, source);
        let pass =
            VertexPass { grid, samples, values, placer, in_middle, part, has_normals: self.has_normals };
        if layer == lowest_numbered(&slab.own) {
            tangents.iter_mut().for_each(Layer::clear);
        }
        let mut tangents = by_planes.map(|(sharp, level)| (sharp, Tangents::new(level, tangents, layer)));
        let by_planes = tangents.as_mut().map(|(sharp, tangents)| (*sharp, tangents));
        let cells = pass.layer(layer, by_planes, plans, records, &mut slab.vertices)?;
        match slab.own.contains(&layer) {
            true => slab.piece.surface.cells_visited += cells,
            false => slab.piece.below = slab.vertices.numbered,
        }
        Ok(())
    }

    fn join(&self, slab: &mut Slab<Workspace>, layer: usize) -> Result<(), ExtractError> {
        let (grid, level) = (self.sampling.grid, self.by_planes.map(|(_, level)| level));
        let Workspace { samples, records, plans, .. } = &*slab.workspace;
        let plans = plans.as_ref().expect("there is room for it");
        let part = self.part.unwrap_or_else(|| Part::whole(grid.lattice));
        let pass =
            QuadPass { grid, samples, plans, records, positions: &slab.vertices.positions, level, part };
        let mut crossings = pass.layer(layer, &mut slab.piece.surface)?;
        if layer == slab.own.start {
            // Only the lowest points have quadrilaterals with vertices of the slab below.
            slab.piece.head = slab.piece.surface.triangles.len();
        }
        if layer + 2 == grid.size[2] {
            crossings += pass.crossings(layer + 1);
        }
        slab.vertices.crossing_ends += 2 * crossings;
        (slab.layer_done)();
        Ok(())
    }
}
