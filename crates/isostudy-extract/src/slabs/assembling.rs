//! One mesh of what slabs give, finished as the settings say.

use std::time::Duration;

use glam::Vec3;
use isostudy_mesh::TriangleMesh;

use super::finish::finish;
use super::piece::{Piece, SlabTimes};
use crate::clock::Moment;
use crate::execution::control::Threads;
use crate::execution::threads::{ARE_THERE, on_each};
use crate::extraction::{Counts, ExtractError, Extraction, StageTimes};
use crate::memory::{refill, with_room};
use crate::source::{NormalsOf, Request};
use crate::surface::trace::Trace;

/// Makes the mesh of the whole out of its pieces, and finishes it as the settings say. `allocating` and `streaming` are what
/// came before.
///
/// The buffers of the first piece become those of the mesh; its trace is exchanged for `trace`.
///
/// # Errors
/// [`ExtractError::TooManyVertices`], [`ExtractError::NoMemoryForMesh`], [`ExtractError::Threads`].
pub(super) fn assemble(
    request: &Request,
    pieces: &mut [Piece],
    threads: usize,
    [allocating, streaming]: [Duration; 2],
    trace: Option<&mut Trace>,
    extraction: &mut Extraction,
) -> Result<(), ExtractError> {
    let mut times = shares(pieces, streaming);
    times.allocation = allocating;

    let joining = Moment::now();
    let seams = join(pieces, request.most_vertices, request.control.threads)?;
    let crossing_ends: u64 = pieces.iter().map(|piece| piece.crossing_ends).sum();
    let first = pieces.first_mut().expect("there is a slab");
    let surface = &mut first.surface;
    if let (Some(trace), Some(found)) = (trace, &mut surface.trace) {
        std::mem::swap(trace, found);
    }
    let mesh = &mut extraction.mesh;
    mesh.positions = std::mem::take(&mut first.positions);
    let targets = std::mem::take(&mut first.targets);
    let Request { lattice, settings, control, .. } = *request;
    let collapsing =
        finish(request.level(), lattice, settings, control.threads, &targets, &mut mesh.positions, surface)?;
    mesh.triangles = std::mem::take(&mut surface.triangles);
    times.clustering = collapsing.unwrap_or_default();
    times.geometry += joining.elapsed() - times.clustering;

    let making_normals = Moment::now();
    let seams = if collapsing.is_some() { None } else { Some(&*seams) };
    mesh.normals = std::mem::take(&mut first.normals);
    match request.normals {
        NormalsOf::Triangles => make_normals(mesh, seams, control.threads, threads)?,
        NormalsOf::Samples => crate::surface::normals::normalise(&mut mesh.normals),
        NormalsOf::Nothing => mesh.normals.clear(),
    }
    times.normals = making_normals.elapsed();

    extraction.times = times;
    // Each crossing was seen from both ends.
    extraction.counts = Counts::of(lattice, mesh, surface, crossing_ends / 2);
    Ok(())
}

/// Wall-clock time, divided as the threads spent theirs.
fn shares(pieces: &[Piece], elapsed: Duration) -> StageTimes {
    let sum = |of: fn(&SlabTimes) -> Duration| pieces.iter().map(|piece| of(&piece.times)).sum::<Duration>();
    let [sampling, vertex, geometry] = [sum(|t| t.sampling), sum(|t| t.vertex), sum(|t| t.geometry)];
    let all = (sampling + vertex + geometry).as_secs_f64().max(f64::MIN_POSITIVE);
    let share = |part: Duration| elapsed.mul_f64((part.as_secs_f64() / all).min(1.0));
    let (sampling, vertex) = (share(sampling), share(vertex));
    // The rest, so that nothing is lost to rounding.
    let geometry = elapsed.saturating_sub(sampling + vertex);
    StageTimes { sampling, vertex, geometry, ..StageTimes::default() }
}

/// A slab's part of the whole mesh.
#[derive(Debug, Clone, Copy)]
struct Seam {
    /// Vertices before the slab's own.
    vertices: usize,
    /// Triangles before `head` may touch vertices of the slab below; those from `tail` on, of the slab above.
    head: usize,
    tail: usize,
}

/// Appends all pieces to the first one, with vertex numbers of the whole.
fn join(pieces: &mut [Piece], most_vertices: u32, on: Threads) -> Result<Vec<Seam>, ExtractError> {
    let (first, rest) = pieces.split_first_mut().expect("there is a slab");
    let mut seams = Vec::new();
    if !ARE_THERE || rest.is_empty() {
        return Ok(seams);
    }
    let total: usize = first.positions.len() + rest.iter().map(|piece| piece.positions.len()).sum::<usize>();
    if total as u64 > u64::from(most_vertices) {
        return Err(ExtractError::TooManyVertices { limit: most_vertices });
    }
    let triangles: usize = rest.iter().map(|piece| piece.surface.triangles.len()).sum();
    first.positions.try_reserve(total - first.positions.len()).map_err(|_| ExtractError::NoMemoryForMesh)?;
    first.surface.triangles.try_reserve(triangles).map_err(|_| ExtractError::NoMemoryForMesh)?;
    let targets: usize = rest.iter().map(|piece| piece.targets.len()).sum();
    first.targets.try_reserve(targets).map_err(|_| ExtractError::NoMemoryForMesh)?;
    let normals: usize = rest.iter().map(|piece| piece.normals.len()).sum();
    first.normals.try_reserve(normals).map_err(|_| ExtractError::NoMemoryForMesh)?;
    seams.push(Seam { vertices: 0, head: first.head, tail: first.tail });
    let (mut vertices, mut base) = (first.positions.len(), first.surface.triangles.len());
    for piece in &mut *rest {
        seams.push(Seam { vertices, head: base + piece.head, tail: base + piece.tail });
        vertices += piece.positions.len();
        base += piece.surface.triangles.len();
        first.targets.append(&mut piece.targets);
        first.normals.append(&mut piece.normals);
        if let (Some(whole), Some(trace)) = (&mut first.surface.trace, &mut piece.surface.trace) {
            whole.append(trace)?;
        }
        first.surface.cells_visited += piece.surface.cells_visited;
        first.surface.tetrahedra_evaluated += piece.surface.tetrahedra_evaluated;
        first.surface.discarded += piece.surface.discarded;
        first.surface.discarded_as_published += piece.surface.discarded_as_published;
    }
    // One thread each: much of it is waiting for new pages.
    let mut parts = [Part::Triangles(&mut first.surface.triangles), Part::Positions(&mut first.positions)];
    let (rest, after_first) = (&*rest, &seams[1..]);
    on_each(on, &mut parts, |_, part| {
        match part {
            Part::Positions(whole) => rest.iter().for_each(|piece| whole.extend_from_slice(&piece.positions)),
            Part::Triangles(whole) => {
                for (piece, seam) in rest.iter().zip(after_first) {
                    let shift = (seam.vertices as u32).wrapping_sub(piece.below as u32);
                    let global = |triangle: &[u32; 3]| triangle.map(|vertex| vertex.wrapping_add(shift));
                    whole.extend(piece.surface.triangles.iter().map(global));
                }
            }
        }
        Ok(())
    })?;
    Ok(seams)
}

/// What of a mesh is appended to.
enum Part<'a> {
    Positions(&'a mut Vec<Vec3>),
    Triangles(&'a mut Vec<[u32; 3]>),
}

/// Area-weighted mean normals, as [`vertex_normals`](crate::surface::normals::vertex_normals), to the bit: each vertex adds up
/// its triangles in their order. With seams, each thread does the vertices of a run of slabs.
fn make_normals(
    mesh: &mut TriangleMesh,
    seams: Option<&[Seam]>,
    on: Threads,
    threads: usize,
) -> Result<(), ExtractError> {
    let TriangleMesh { positions, normals, triangles } = mesh;
    normals.clear();
    refill(normals, positions.len(), Vec3::ZERO).map_err(|_| ExtractError::NoMemoryForMesh)?;
    let seams = seams.filter(|seams| ARE_THERE && threads > 1 && seams.len() > 1);
    let Some(seams) = seams else {
        crate::surface::normals::accumulate(positions, triangles, normals);
        return Ok(());
    };
    let mut rest: &mut [Vec3] = normals;
    let mut runs = with_room(threads).map_err(|_| ExtractError::NoMemoryForMesh)?;
    for thread in 0..threads {
        let [first, end] = [thread, thread + 1].map(|t| t * seams.len() / threads);
        let low = seams[first].vertices;
        let high = seams.get(end).map_or(positions.len(), |seam| seam.vertices);
        let from = if first == 0 { 0 } else { seams[first - 1].tail };
        let to = seams.get(end).map_or(triangles.len(), |seam| seam.head);
        let (mine, others) = rest.split_at_mut(high - low);
        rest = others;
        runs.push((low, &triangles[from..to], mine));
    }
    on_each(on, &mut runs, |_, (low, triangles, mine)| {
        crate::surface::normals::accumulate_some(positions, triangles, *low as u32, mine);
        Ok(())
    })
}
