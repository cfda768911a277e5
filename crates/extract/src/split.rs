//! The extractor for cubes that are cut into tetrahedra each by itself, where points differ in their lattice edges.
//!
//! Like [`crate::sweep`] it streams: a few layers in memory, samples only where the field does not rule the surface out,
//! slabs of cells on several threads. Every crossing is a vertex: numbered in storage order of the points that they are
//! nearest to, then by direction; triangles go cell by cell. The same with all samples stored is what the tests compare
//! it with.

mod cells;
mod cut;
mod grid;
mod points;
mod rows;
mod sampling;
mod slab;
#[cfg(test)]
mod stored;
#[cfg(test)]
mod tests;

use std::time::Instant;

use self::grid::Grid;
use self::points::Placer;
use self::slab::{Job, Workspace, sweep};
use crate::extraction::{ExtractError, Extraction};
use crate::lattice::Border;
use crate::slabs::{Piece, assemble, on_slabs, threads_and_slabs};
use crate::source::Request;
use crate::trace::Trace;
use crate::vertices::Ties;

/// The stages in order, timed and counted. The trace, if there is one, is that before edges are collapsed.
pub(crate) fn extract(
    request: &Request,
    trace: Option<&mut Trace>,
    extraction: &mut Extraction,
) -> Result<(), ExtractError> {
    let Request { source, lattice, settings, execution, most_vertices, start } = *request;
    let (threads, slabs) = threads_and_slabs(execution, lattice.stored_grid()[2] as usize);
    let out_of_memory = |_| ExtractError::OutOfMemory { bytes: lattice.sweep_bytes(threads as u64) };
    let grid = &Grid::new(lattice, Border::of(settings)).map_err(out_of_memory)?;
    let workspaces: Result<Vec<Workspace>, _> = (0..threads).map(|_| Workspace::new(grid, source)).collect();
    let mut workspaces = workspaces.map_err(out_of_memory)?;
    let mut pieces: Vec<Piece> = (0..slabs).map(|_| Piece::default()).collect();
    let allocation = start.elapsed();

    let sweeping = Instant::now();
    let (isovalue, ties) = (settings.isovalue, Ties::of(settings.topology));
    let placer = &Placer::new(lattice, &grid.cut, settings, request.level());
    let job = Job { grid, source, isovalue, ties, placer, most_vertices, traced: trace.is_some() };
    let cells = lattice.cells()[2] as usize;
    on_slabs(cells, &mut workspaces, &mut pieces, |own, workspace, piece| {
        sweep(&job, own, workspace, piece)
    })?;
    drop(workspaces);
    let times = [allocation, sweeping.elapsed()];
    assemble(request, &mut pieces, threads, times, trace, extraction)
}
