//! The extractor for cubes that are cut into tetrahedra each by itself, where points differ in their lattice edges.
//!
//! Like [`crate::tetrahedra::streamed`] it streams: a few layers in memory, samples only where the field does not rule the surface out,
//! slabs of cells on several threads. Every crossing is a vertex: numbered in storage order of the points that they are
//! nearest to, then by direction; triangles go cell by cell. The same with all samples stored is what the tests compare
//! it with.

mod cells;
mod cut;
#[cfg(test)]
mod dense;
mod grid;
mod points;
mod rows;
mod sampling;
mod slab;
#[cfg(test)]
mod tests;

use std::sync::atomic::{AtomicUsize, Ordering};

use self::grid::CutGrid;
use self::points::Placer;
use self::slab::{Job, Workspace, stream_slab};
use crate::clock::Moment;
use crate::extraction::{ExtractError, Extraction};
use crate::lattice::Border;
use crate::slabs::Progress;
use crate::slabs::{Piece, assemble, on_slabs, threads_and_slabs};
use crate::source::Request;
use crate::surface::trace::Trace;
use crate::tetrahedra::ties::Ties;

/// The extractor's plan and buffers, kept from one surface to the next.
#[derive(Debug, Default)]
pub(crate) struct CellStreamer {
    grid: Option<CutGrid>,
    workspaces: Vec<Workspace>,
    pieces: Vec<Piece>,
}

impl CellStreamer {
    /// The stages in order, timed and counted. The trace, if there is one, is that before edges are collapsed.
    pub(crate) fn extract(
        &mut self,
        request: &Request,
        progress: Option<&Progress>,
        mut trace: Option<&mut Trace>,
        extraction: &mut Extraction,
    ) -> Result<(), ExtractError> {
        let Request { source, lattice, settings, control, most_vertices, start } = *request;
        let (threads, slabs) = threads_and_slabs(control.threads.count(), lattice.stored_grid()[2] as usize);
        let out_of_memory = |_| ExtractError::OutOfMemory { bytes: lattice.streaming_bytes(threads as u64) };
        let Self { grid, workspaces, pieces } = self;
        match grid {
            Some(grid) if grid.lattice.arrangement() == lattice.arrangement() => {
                grid.refit(lattice, Border::of(settings)).map_err(out_of_memory)?;
            }
            _ => *grid = Some(CutGrid::new(lattice, Border::of(settings)).map_err(out_of_memory)?),
        }
        let grid = grid.as_ref().expect("it was just made");
        workspaces.resize_with(threads, Workspace::default);
        pieces.resize_with(slabs, Piece::default);
        for workspace in &mut *workspaces {
            workspace.fit(grid, source).map_err(out_of_memory)?;
        }
        // The first piece is written where the whole mesh will be.
        pieces[0].positions = std::mem::take(&mut extraction.mesh.positions);
        pieces[0].surface.triangles = std::mem::take(&mut extraction.mesh.triangles);
        pieces[0].surface.trace = trace.as_deref_mut().map(std::mem::take);
        let allocation = start.elapsed();

        let streaming = Moment::now();
        let (isovalue, ties) = (settings.isovalue, Ties::of(settings.topology));
        let placer = &Placer::new(lattice, grid.cut, settings, request.level());
        let cells = lattice.cells()[2] as usize;
        let done = AtomicUsize::new(0);
        let progress = || {
            let done = done.fetch_add(1, Ordering::Relaxed) + 1;
            if let Some(progress) = progress {
                progress(done, cells);
            }
            if let Some(progress) = control.progress {
                progress(done, cells);
            }
        };
        let (traced, progress) = (trace.is_some(), &progress);
        let job = Job { grid, source, isovalue, ties, placer, most_vertices, traced, control, progress };
        on_slabs(cells, control.threads, workspaces, pieces, |own, workspace, piece| {
            stream_slab(&job, own, workspace, piece)
        })?;
        let times = [allocation, streaming.elapsed()];
        assemble(request, pieces, threads, times, trace, extraction)
    }
}
