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
mod tiles;

use std::sync::Mutex;
use std::time::Instant;

use mesh::TriangleMesh;
use rayon::prelude::*;

use self::grid::Grid;
use self::points::Placer;
use self::slab::{Job, Workspace, sweep};
use crate::extraction::{Counts, ExtractError, Extraction};
use crate::lattice::{Border, Lattice};
use crate::level::Level;
use crate::placement;
use crate::sampling::on_threads;
use crate::settings::{Execution, ExtractSettings};
use crate::sweep::{Piece, Source, join, make_normals, shares, threads_and_slabs};
use crate::trace::Trace;
use crate::vertices::Ties;

/// The stages in order, timed and counted. At most `most_vertices` may come of it. The trace, if there is one, is that
/// before edges are collapsed.
pub(crate) fn extract(
    source: Source,
    lattice: &Lattice,
    settings: &ExtractSettings,
    execution: &Execution,
    most_vertices: u32,
    trace: Option<&mut Trace>,
    extraction: &mut Extraction,
) -> Result<(), ExtractError> {
    let start = Instant::now();
    let (threads, slabs) = threads_and_slabs(execution, lattice.stored_grid()[2] as usize);
    let out_of_memory = |_| ExtractError::OutOfMemory { bytes: lattice.sweep_bytes(threads as u64) };
    let grid = &Grid::new(lattice, Border::of(settings)).map_err(out_of_memory)?;
    let workspaces: Result<Vec<Workspace>, _> = (0..threads).map(|_| Workspace::new(grid, source)).collect();
    let mut workspaces = workspaces.map_err(out_of_memory)?;
    let mut pieces: Vec<Piece> = (0..slabs).map(|_| Piece::default()).collect();
    let allocation = start.elapsed();

    let sweeping = Instant::now();
    let isovalue = settings.isovalue;
    let level = match source {
        Source::Field(field) => Some(Level { field, isovalue, spacing: lattice.spacing() }),
        Source::Samples(_) => None,
    };
    let (ties, placer) = (Ties::of(settings.topology), &Placer::new(lattice, &grid.cut, settings, level));
    let job = Job { grid, source, isovalue, ties, placer, most_vertices, traced: trace.is_some() };
    sweep_all(&job, &mut workspaces, &mut pieces)?;
    drop(workspaces);
    let mut times = shares(&pieces, sweeping.elapsed());
    times.allocation = allocation;

    let joining = Instant::now();
    let seams = join(&mut pieces, most_vertices)?;
    let crossing_ends: u64 = pieces.iter().map(|piece| piece.crossing_ends).sum();
    let whole = pieces.into_iter().next().expect("there is a slab");
    let (mut positions, targets, mut surface) = (whole.positions, whole.targets, whole.surface);
    if let (Some(trace), Some(found)) = (trace, surface.trace.take()) {
        *trace = found;
    }
    let collapsing =
        placement::finish(level, lattice, settings, execution, &targets, &mut positions, &mut surface)?;
    times.clustering = collapsing.unwrap_or_default();
    times.geometry += joining.elapsed() - times.clustering;

    let making_normals = Instant::now();
    let mut mesh = TriangleMesh { positions, triangles: surface.triangles, ..TriangleMesh::default() };
    surface.triangles = Vec::new();
    let seams = if collapsing.is_some() { None } else { Some(&seams) };
    make_normals(&mut mesh, seams, threads)?;
    times.normals = making_normals.elapsed();

    // Each crossing was seen from both ends.
    extraction.counts = Counts::of(lattice, &mesh, &surface, crossing_ends / 2);
    (extraction.mesh, extraction.times) = (mesh, times);
    Ok(())
}

/// Sweeps all slabs, each by the thread that comes first. Which one that is does not show.
fn sweep_all(job: &Job, workspaces: &mut [Workspace], pieces: &mut [Piece]) -> Result<(), ExtractError> {
    let (cells, slabs) = (job.grid.lattice.cells()[2] as usize, pieces.len());
    let slab = |i: usize| i * cells / slabs..(i + 1) * cells / slabs;
    if let ([workspace], [piece]) = (&mut *workspaces, &mut *pieces) {
        return sweep(job, slab(0), workspace, piece);
    }
    let threads = workspaces.len();
    let queue = Mutex::new(pieces.iter_mut().enumerate());
    on_threads(&Execution { threads }, threads, || {
        workspaces.par_iter_mut().with_max_len(1).try_for_each(|workspace| {
            loop {
                let next = queue.lock().expect("no thread panics").next();
                let Some((i, piece)) = next else { return Ok(()) };
                sweep(job, slab(i), workspace, piece)?;
            }
        })
    })?
}
