//! The driver: a lattice's plan, its slabs and their buffers, kept from one surface to the next.

use std::collections::TryReserveError;
use std::sync::atomic::{AtomicUsize, Ordering};

use super::faces::FaceTables;
use super::grid::UniformGrid;
use super::rule::{ClusterRule, Guarded, Published, Unclustered};
use super::slab::{Job, Workspace, stream_slab};
use crate::clock::Moment;
use crate::clustering::warp::warp;
use crate::extraction::{ExtractError, Extraction};
use crate::lattice::{Border, Lattice};
use crate::placement::CrossingPlacer;
use crate::placement::move_vertices;
use crate::placement::spot::Apart;
use crate::settings::{Clustering, ExtractSettings, Placement, Topology};
use crate::slabs::{Piece, Progress, assemble, on_slabs, threads_and_slabs};
use crate::source::Request;
use crate::surface::normals::vertex_normals;
use crate::surface::trace::Trace;
use isostudy_mesh::TriangleMesh;

/// A streaming extractor's plan and buffers.
#[derive(Default)]
pub(crate) struct Streamer {
    plan: Option<Plan>,
    workspaces: Vec<Workspace>,
    pieces: Vec<Piece>,
}

/// What depends on the lattice and its border alone; the tables on its arrangement only.
struct Plan {
    grid: UniformGrid,
    tables: FaceTables,
}

impl Plan {
    /// The one there is, if it fits.
    fn new(lattice: &Lattice, border: Border, before: Option<Self>) -> Result<Self, TryReserveError> {
        match before {
            Some(plan) if plan.grid.lattice == *lattice && plan.grid.border == border => Ok(plan),
            Some(mut plan) if plan.grid.lattice.arrangement() == lattice.arrangement() => {
                plan.grid.refit(lattice, border)?;
                Ok(plan)
            }
            _ => {
                let grid = UniformGrid::new(lattice, border)?;
                let tables = FaceTables::new(&grid);
                Ok(Self { grid, tables })
            }
        }
    }
}

impl Streamer {
    /// The stages in order, timed and counted. The trace, if there is one, is that before edges are collapsed.
    pub(crate) fn extract(
        &mut self,
        request: &Request,
        progress: Option<&Progress>,
        trace: Option<&mut Trace>,
        extraction: &mut Extraction,
    ) -> Result<(), ExtractError> {
        let Request { lattice, settings, control, .. } = *request;
        if settings.clustering != Clustering::Warp {
            return self.extract_by_points(request, progress, trace, extraction);
        }
        // The trace says which lattice edge a vertex is on; vertices move once all is warped.
        let mut own = Trace::default();
        let trace = trace.unwrap_or(&mut own);
        let unmoved = ExtractSettings { placement: Placement::MeanOfCrossings, ..*settings };
        let request = Request { settings: &unmoved, ..*request };
        self.extract_by_points(&request, progress, Some(trace), extraction)?;
        let start = Moment::now();
        warp(lattice, trace, extraction)?;
        extraction.times.clustering += start.elapsed();
        let Some(level) = request.level().filter(|_| settings.placement.calls_the_field()) else {
            return Ok(());
        };
        let start = Moment::now();
        let TriangleMesh { positions, normals, triangles } = &mut extraction.mesh;
        move_vertices(&level, lattice, settings.placement, control.threads, positions, triangles)?;
        *normals = vertex_normals(positions, triangles)?;
        extraction.times.geometry += start.elapsed();
        Ok(())
    }

    /// The same where each point merges its own crossings.
    fn extract_by_points(
        &mut self,
        request: &Request,
        progress: Option<&Progress>,
        trace: Option<&mut Trace>,
        extraction: &mut Extraction,
    ) -> Result<(), ExtractError> {
        let Request { lattice, settings, control, .. } = *request;
        let plan = Plan::new(lattice, Border::of(settings), self.plan.take()).map_err(|_| {
            ExtractError::OutOfMemory { bytes: lattice.memory_bytes_on(settings, control.threads.count()) }
        })?;
        let arrangement = lattice.arrangement();
        let merges = match settings.clustering {
            Clustering::None | Clustering::EdgeCollapse | Clustering::Warp => false,
            Clustering::Integrated | Clustering::IntegratedCollapse => true,
        };
        let mut run = Run { plan: &plan, request, progress, trace, streamer: self };
        let result = match (merges, settings.topology) {
            (false, Topology::Guarded) => run.by(&Unclustered::<false>, extraction),
            (false, Topology::Published) => run.by(&Unclustered::<true>, extraction),
            (true, Topology::Guarded) => run.by(&Guarded::new(arrangement), extraction),
            (true, Topology::Published) => run.by(&Published::new(arrangement), extraction),
        };
        self.plan = Some(plan);
        result
    }
}

/// One extraction, but for the rule.
struct Run<'a> {
    plan: &'a Plan,
    request: &'a Request<'a>,
    progress: Option<&'a Progress>,
    trace: Option<&'a mut Trace>,
    streamer: &'a mut Streamer,
}

impl Run<'_> {
    fn by<R: ClusterRule>(&mut self, rule: &R, extraction: &mut Extraction) -> Result<(), ExtractError> {
        let Request { source, settings, control, most_vertices, start, .. } = *self.request;
        let Streamer { workspaces, pieces, .. } = &mut *self.streamer;
        let grid = &self.plan.grid;
        let layers = grid.size[2];
        let (threads, slabs) = threads_and_slabs(control.threads.count(), layers);
        let bytes = grid.lattice.streaming_bytes(threads as u64);
        workspaces.resize_with(threads, Workspace::default);
        pieces.resize_with(slabs, Piece::default);
        for workspace in &mut *workspaces {
            workspace.fit(grid, source).map_err(|_| ExtractError::OutOfMemory { bytes })?;
        }
        // The first piece is written where the whole mesh will be.
        pieces[0].positions = std::mem::take(&mut extraction.mesh.positions);
        pieces[0].surface.triangles = std::mem::take(&mut extraction.mesh.triangles);
        pieces[0].surface.trace = self.trace.as_deref_mut().map(std::mem::take);
        let allocation = start.elapsed();

        let streaming = Moment::now();
        let done = AtomicUsize::new(0);
        let progress = |more: usize| {
            let done = done.fetch_add(more, Ordering::Relaxed) + more;
            if let Some(progress) = self.progress {
                progress(done, layers);
            }
            if let Some(progress) = control.progress {
                progress(done, layers);
            }
        };
        let placer = CrossingPlacer::new(&grid.lattice, settings, self.request.level());
        let job = Job {
            grid,
            tables: &self.plan.tables,
            rule,
            source,
            isovalue: settings.isovalue,
            apart: Apart::new(&grid.lattice, settings.topology).clamped(settings.edge_clamp),
            most_vertices,
            placer: placer.as_ref(),
            traced: self.trace.is_some(),
            control,
            progress: &progress,
        };
        on_slabs(layers, control.threads, workspaces, pieces, |own, workspace, piece| {
            stream_slab(&job, own, workspace, piece)
        })?;
        let times = [allocation, streaming.elapsed()];
        assemble(self.request, pieces, threads, times, self.trace.as_deref_mut(), extraction)
    }
}
