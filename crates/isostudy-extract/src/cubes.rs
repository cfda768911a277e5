//! Marching cubes: the extractor for cubes that are not cut any further.
//!
//! Like [`crate::tetrahedra::streamed`] it streams: a few layers in memory, samples only where the field does not rule the surface out, slabs of
//! cells on several threads. A vertex is a crossing, numbered by the lower end of its lattice edge, then by axis; after them come
//! the few vertices in the cell whose lowest corner that point is. Triangles go cell by cell. Which triangles a cell has is a
//! [`patches::Patch`], made by rule from [`cells`] at first use.

mod cells_pass;
pub(crate) mod continuation;
mod exact;
pub(crate) mod grid;
mod moved;
mod patches;
pub(crate) mod records;
pub(crate) mod rows;
mod rule;
pub(crate) mod sampling;
mod slab;
pub(crate) mod snap;
mod tubes;
mod tunnel;
pub(crate) mod vertices;

pub(crate) use continuation::Continued;
pub use continuation::{ContinuedCells, Seeds, SeedsError};
pub(crate) use moved::EdgeMoves;
pub use rule::{Diagonals, Faces, Flat};

use isostudy_cells::{Cell, Table};

use std::collections::TryReserveError;
use std::ops::Range;
use std::sync::atomic::{AtomicUsize, Ordering};

use self::grid::CubeGrid;
use self::patches::Patches;
pub(crate) use self::slab::Workspace;
use self::slab::{Job, stream_slab};
use self::vertices::Placer;
use crate::clock::Moment;
use crate::extraction::{ExtractError, Extraction};
use crate::slabs::Progress;
use crate::slabs::{Piece, assemble, on_slabs, threads_and_slabs};
use crate::source::Request;
use crate::surface::trace::Trace;

/// What decides the triangles of a cell.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Rule {
    pub(crate) faces: Faces,
    pub(crate) diagonals: Diagonals,
}

/// Whether a face's inside corners are one region of it, where they alternate with outside ones. `round` has the samples at its
/// corners in order, from an inside one on.
pub(crate) fn joins(faces: Faces, isovalue: f32, round: impl FnOnce() -> [f32; 4]) -> bool {
    match faces {
        Faces::SeparateInside => false,
        Faces::JoinInside => true,
        Faces::Decider | Faces::Trilinear => exact::is_joined(round(), isovalue),
    }
}

/// The table of a rule, where it is one of signs alone.
pub(crate) fn table(rule: Rule) -> Option<Table> {
    let entries = Patches::get(rule).by_signs(rule.faces)?;
    Some(Table::try_new(Cell::cube(), entries).expect("patches fit together"))
}

/// How many cells of a grid of samples have another patch by a rule's faces than the trilinear interpolant has.
pub(crate) fn cells_otherwise(rule: Rule, [nx, ny, nz]: [usize; 3], values: &[f32], isovalue: f32) -> u64 {
    let patches = Patches::get(rule);
    let mut count = 0;
    for z in 0..nz - 1 {
        for y in 0..ny - 1 {
            for x in 0..nx - 1 {
                let at = |c: usize| values[((z + (c >> 2)) * ny + y + (c >> 1 & 1)) * nx + x + (c & 1)];
                let inside = (0..8).fold(0, |set, c| set | u8::from(at(c) > isovalue) << c);
                if matches!(inside, 0 | 255) {
                    continue;
                }
                let by = |faces| patches.choose(faces, inside, isovalue, || std::array::from_fn(at));
                count += u64::from(by(rule.faces) != by(Faces::Trilinear));
            }
        }
    }
    count
}

/// What every way has.
#[derive(Default)]
pub(crate) struct Kept {
    /// The coordinates of the grid's points along each axis.
    at: [Vec<f32>; 3],
    pieces: Vec<Piece>,
}

/// The stages in order, timed and counted. The lattice is simple cubic: its points are the corners of the cubes.
pub(crate) fn extract_patches(
    (kept, workspaces): (&mut Kept, &mut Vec<Workspace>),
    request: &Request,
    rule: Rule,
    pull: f32,
    progress: Option<&Progress>,
    trace: Option<&mut Trace>,
    extraction: &mut Extraction,
) -> Result<(), ExtractError> {
    let Request { source, settings, control, most_vertices, .. } = *request;
    let patches = Patches::get(rule);
    let placer = &Placer::new(request.lattice, settings, request.level()).pulled(pull);
    let (isovalue, traced) = (settings.isovalue, trace.is_some());
    let fit = |workspace: &mut Workspace, grid: &CubeGrid| workspace.fit(grid, source);
    let work = |grid: &CubeGrid,
                layer_done: &LayerDone,
                own,
                workspace: &mut Workspace,
                piece: &mut Piece| {
        let job =
            Job { grid, source, isovalue, rule, patches, placer, most_vertices, traced, control, layer_done };
        stream_slab(&job, own, workspace, piece)
    };
    let buffers = (kept, workspaces, Workspace::default);
    in_slabs(buffers, request, progress, trace, extraction, 1, fit, work)
}

/// Told when a layer of cells is done.
pub(crate) type LayerDone<'a> = dyn Fn() + Sync + 'a;

/// Streams the slabs of a simple cubic lattice, and makes one mesh of them, timed and counted. `work` does the layers of cells it is
/// given, with a workspace that `fit` made room in, and says when it has done one. Workspaces hold so many `times` what a lattice's
/// layers do; the function among the buffers makes one without room.
pub(crate) fn in_slabs<W: Send>(
    (kept, workspaces, new): (&mut Kept, &mut Vec<W>, impl Fn() -> W),
    request: &Request,
    progress: Option<&Progress>,
    mut trace: Option<&mut Trace>,
    extraction: &mut Extraction,
    times: u64,
    fit: impl Fn(&mut W, &CubeGrid) -> Result<(), TryReserveError>,
    work: impl Fn(&CubeGrid, &LayerDone, Range<usize>, &mut W, &mut Piece) -> Result<(), ExtractError> + Sync,
) -> Result<(), ExtractError> {
    let Request { lattice, control, start, .. } = *request;
    let (threads, slabs) = threads_and_slabs(control.threads.count(), lattice.stored_grid()[2] as usize);
    let out_of_memory =
        |_| ExtractError::OutOfMemory { bytes: times * lattice.streaming_bytes(threads as u64) };
    let Kept { at, pieces } = kept;
    let grid = CubeGrid::within(lattice, std::mem::take(at)).map_err(out_of_memory)?;
    workspaces.resize_with(threads, new);
    pieces.resize_with(slabs, Piece::default);
    for workspace in &mut *workspaces {
        fit(workspace, &grid).map_err(out_of_memory)?;
    }
    // The first piece is written where the whole mesh will be.
    pieces[0].positions = std::mem::take(&mut extraction.mesh.positions);
    pieces[0].surface.triangles = std::mem::take(&mut extraction.mesh.triangles);
    pieces[0].surface.trace = trace.as_deref_mut().map(std::mem::take);
    let allocation = start.elapsed();

    let streaming = Moment::now();
    let cells = lattice.cells()[2] as usize;
    let done = AtomicUsize::new(0);
    let layer_done = || {
        let done = 1 + done.fetch_add(1, Ordering::Relaxed);
        if let Some(progress) = progress {
            progress(done, cells);
        }
        if let Some(progress) = control.progress {
            progress(done, cells);
        }
    };
    on_slabs(cells, control.threads, workspaces, pieces, |own, workspace, piece| {
        work(&grid, &layer_done, own, workspace, piece)
    })?;
    *at = grid.at;
    let times = [allocation, streaming.elapsed()];
    assemble(request, pieces, threads, times, trace, extraction)?;
    extraction.counts.tetrahedra = None;
    Ok(())
}
