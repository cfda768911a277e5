//! The driver that all streaming extractors share: a few layers in memory, slabs of layers on several threads, one mesh of them.
//!
//! Memory grows with a layer and with the mesh, not with the volume. Slabs are independent up to a few layers on either side, and
//! vertices are numbered by sums over slabs, so any number of threads gives the same bytes. What is done with a layer is an
//! extractor's own: a [`Streamed`], whose slabs go through its [`Pass`]es.

mod assembling;
pub(crate) mod finish;
mod passes;
mod piece;
pub(crate) mod window;

pub(crate) use passes::{Pass, Slab, Stage};
pub(crate) use piece::{Piece, Vertices};

use std::collections::TryReserveError;
use std::ops::Range;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use self::assembling::assemble;
use crate::clock::Moment;
use crate::execution::control::Threads;
use crate::execution::threads::{ARE_THERE, on_each};
use crate::extraction::{ExtractError, Extraction};
use crate::lattice::Part;
use crate::source::Request;
use crate::surface::trace::Trace;

/// Slabs a thread, so that an uneven surface still keeps all threads busy.
const SLABS_PER_THREAD: usize = 2;
/// A slab has at least this many layers: the halo on either side costs up to four more.
const LEAST_LAYERS: usize = 16;

/// Told how many layers of how many are done.
pub(crate) type Progress = dyn Fn(usize, usize) + Send + Sync;

/// Told when a layer is done.
pub(crate) type LayerDone<'a> = dyn Fn() + Sync + 'a;

/// What is asked for, who is told, and where it goes.
pub(crate) struct Run<'a> {
    pub(crate) request: &'a Request<'a>,
    pub(crate) progress: Option<&'a Progress>,
    /// Where the mesh comes from, before edges are collapsed; where that is asked for.
    pub(crate) trace: Option<&'a mut Trace>,
    pub(crate) extraction: &'a mut Extraction,
}

/// What all slabs of an extraction share.
pub(crate) trait Streamed: Sync + Sized {
    /// Buffers of one thread, a few layers each, kept between slabs and between extractions.
    type Workspace: Send + Default;

    /// Makes room; keeps what is large enough.
    fn fit(&self, workspace: &mut Self::Workspace) -> Result<(), TryReserveError>;

    /// What makes the triangles of the layers `own`, and the vertices of their points but for those of the highest layer, which
    /// may be the next slab's. Vertices are numbered from the slab's first on, so that the numbers of the whole surface are these
    /// plus a constant. The first pass comes first at each step.
    fn passes(&self, own: Range<usize>) -> impl AsRef<[Pass<Self>]>;

    /// The cells that are extracted, where not all are: those of [`Request::part`], if the extractor can leave others out.
    fn part(&self) -> Option<Part> {
        None
    }

    /// What is left to do when the passes are through.
    fn end(&self, _slab: &mut Slab<Self::Workspace>) {}
}

/// How many threads there is work for, and how many slabs they share.
pub(crate) fn threads_and_slabs(threads: usize, layers: usize) -> (usize, usize) {
    if !ARE_THERE {
        return (1, 1);
    }
    let most = (layers / LEAST_LAYERS).max(1);
    let slabs = if threads == 1 { 1 } else { threads.saturating_mul(SLABS_PER_THREAD).min(most) };
    (threads.min(slabs), slabs)
}

/// That workspaces have no room which hold so many `times` what a lattice's layers do.
pub(crate) fn out_of_memory(request: &Request, times: u64) -> ExtractError {
    let layers = request.lattice.stored_grid()[2] as usize;
    let threads = threads_and_slabs(request.control.threads.count(), layers).0;
    ExtractError::OutOfMemory { bytes: times * request.lattice.streaming_bytes(threads as u64) }
}

/// Streams slabs of `layers`, and makes one mesh of them, timed and counted. Workspaces hold so many `times` what a lattice's
/// layers do.
///
/// # Errors
/// [`ExtractError::OutOfMemory`], [`ExtractError::NoMemoryForMesh`], [`ExtractError::Threads`], [`ExtractError::TooManyVertices`],
/// [`ExtractError::Cancelled`].
pub(crate) fn in_slabs<S: Streamed>(
    of: &S,
    layers: usize,
    times: u64,
    workspaces: &mut Vec<S::Workspace>,
    pieces: &mut Vec<Piece>,
    run: Run,
) -> Result<(), ExtractError> {
    let Run { request, progress, mut trace, extraction } = run;
    let Request { lattice, control, start, .. } = *request;
    let (threads, slabs) = threads_and_slabs(control.threads.count(), lattice.stored_grid()[2] as usize);
    workspaces.resize_with(threads, S::Workspace::default);
    pieces.resize_with(slabs, Piece::default);
    for workspace in &mut *workspaces {
        of.fit(workspace).map_err(|_| out_of_memory(request, times))?;
    }
    // The first piece is written where the whole mesh will be.
    pieces[0].positions = std::mem::take(&mut extraction.mesh.positions);
    pieces[0].normals = std::mem::take(&mut extraction.mesh.normals);
    pieces[0].surface.triangles = std::mem::take(&mut extraction.mesh.triangles);
    pieces[0].surface.trace = trace.as_deref_mut().map(std::mem::take);
    let allocation = start.elapsed();

    let streaming = Moment::now();
    let done = AtomicUsize::new(0);
    let layer_done = || {
        let done = 1 + done.fetch_add(1, Ordering::Relaxed);
        if let Some(progress) = progress {
            progress(done, layers);
        }
        if let Some(progress) = control.progress {
            progress(done, layers);
        }
    };
    let traced = trace.is_some();
    on_slabs(layers, control.threads, workspaces, pieces, |own, workspace, piece| {
        piece.clear(traced, of.part());
        let vertices = Vertices::within(piece);
        Slab { own, workspace, vertices, piece, layer_done: &layer_done }.stream(of, request)
    })?;
    let times = [allocation, streaming.elapsed()];
    assemble(request, pieces, threads, times, trace, extraction)
}

/// Has every slab of `layers` done, each by the thread that comes first. Which one that is does not show.
///
/// # Errors
/// [`ExtractError::Threads`], and the first error of `work`.
fn on_slabs<W: Send>(
    layers: usize,
    on: Threads,
    workspaces: &mut [W],
    pieces: &mut [Piece],
    work: impl Fn(Range<usize>, &mut W, &mut Piece) -> Result<(), ExtractError> + Sync,
) -> Result<(), ExtractError> {
    let slabs = pieces.len();
    let slab = |i: usize| i * layers / slabs..(i + 1) * layers / slabs;
    if let ([workspace], [piece]) = (&mut *workspaces, &mut *pieces) {
        return work(slab(0), workspace, piece);
    }
    if !ARE_THERE {
        unreachable!("there is one slab for one thread");
    }
    let queue = Mutex::new(pieces.iter_mut().enumerate());
    let work = |workspace: &mut W| -> Result<(), ExtractError> {
        loop {
            let next = queue.lock().expect("no thread panics").next();
            let Some((i, piece)) = next else { return Ok(()) };
            work(slab(i), workspace, piece)?;
        }
    };
    on_each(on, workspaces, |_, workspace| work(workspace))
}
