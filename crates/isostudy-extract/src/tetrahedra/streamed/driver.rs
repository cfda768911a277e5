//! The driver: a lattice's plan, its slabs and their buffers, kept from one surface to the next.

use std::collections::TryReserveError;

use super::faces::FaceTables;
use super::grid::UniformGrid;
use super::rule::{ClusterRule, Guarded, Published, Unclustered};
use super::slab::{Points, Workspace};
use crate::clock::Moment;
use crate::clustering::warp::warp;
use crate::extraction::ExtractError;
use crate::lattice::{Border, Lattice};
use crate::placement::CrossingPlacer;
use crate::placement::move_vertices;
use crate::placement::spot::Apart;
use crate::settings::{Clustering, ExtractSettings, Placement, Topology};
use crate::slabs::{Piece, Run, in_slabs, out_of_memory};
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
    pub(crate) fn extract(&mut self, run: Run) -> Result<(), ExtractError> {
        let Request { lattice, settings, control, .. } = *run.request;
        if settings.clustering != Clustering::Warp {
            return self.extract_by_points(run);
        }
        // The trace says which lattice edge a vertex is on; vertices move once all is warped.
        let mut own = Trace::default();
        let Run { request, progress, trace, extraction } = run;
        let trace = trace.unwrap_or(&mut own);
        let unmoved = ExtractSettings { placement: Placement::MeanOfCrossings, ..*settings };
        self.extract_by_points(Run {
            request: &Request { settings: &unmoved, ..*request },
            progress,
            trace: Some(&mut *trace),
            extraction: &mut *extraction,
        })?;
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
    fn extract_by_points(&mut self, run: Run) -> Result<(), ExtractError> {
        let Request { lattice, settings, .. } = *run.request;
        let plan = Plan::new(lattice, Border::of(settings), self.plan.take())
            .map_err(|_| out_of_memory(run.request, 1))?;
        let arrangement = lattice.arrangement();
        let merges = match settings.clustering {
            Clustering::None | Clustering::EdgeCollapse | Clustering::Warp => false,
            Clustering::Integrated | Clustering::IntegratedCollapse => true,
        };
        let result = match (merges, settings.topology) {
            (false, Topology::Guarded) => self.extract_by(&Unclustered::<false>, &plan, run),
            (false, Topology::Published) => self.extract_by(&Unclustered::<true>, &plan, run),
            (true, Topology::Guarded) => self.extract_by(&Guarded::new(arrangement), &plan, run),
            (true, Topology::Published) => self.extract_by(&Published::new(arrangement), &plan, run),
        };
        self.plan = Some(plan);
        result
    }

    fn extract_by<R: ClusterRule>(&mut self, rule: &R, plan: &Plan, run: Run) -> Result<(), ExtractError> {
        let Plan { grid, tables } = plan;
        let request = run.request;
        let Request { settings, .. } = *request;
        let placer = CrossingPlacer::new(&grid.lattice, settings, request.level());
        let apart = Apart::new(&grid.lattice, settings.topology).clamped(settings.edge_clamp);
        let (has_trace, layers) = (run.trace.is_some(), grid.size[2]);
        let points = Points { grid, tables, rule, request, apart, placer, has_trace };
        in_slabs(&points, layers, 1, &mut self.workspaces, &mut self.pieces, run)
    }
}
