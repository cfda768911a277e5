//! Relaxation: vertices are drawn towards those that they are linked to, and stay in their cells (Gibson 1998).
//!
//! Two vertices are linked where a quadrilateral has a side from one to the other. All vertices take a step at a time, each from where
//! all were before, so that the order does not matter. A step is half the way: nets are chequered, and with whole steps the two halves
//! of a chequered net only change places.

use std::collections::TryReserveError;

use glam::Vec3;
use isostudy_mesh::TriangleMesh;

use super::quads::Quadrilateral;
use crate::clock::Moment;
use crate::cubes::grid::CubeGrid;
use crate::execution::control::Control;
use crate::execution::threads::for_each_on_threads;
use crate::extraction::{ExtractError, Extraction};
use crate::memory::{copied, filled};
use crate::source::Request;
use crate::surface::normals::vertex_normals;
use crate::surface::trace::Trace;

/// The most steps: each needs one more cell round a chunk.
pub(crate) const MOST_SMOOTHING: u32 = 64;

/// The share of the way to the mean of the linked vertices that a step takes.
const STEP: f32 = 0.5;

/// Takes so many steps, and cuts each quadrilateral along the diagonal that is shorter then. The trace is that of the extraction.
///
/// # Errors
/// [`ExtractError::NoMemoryForMesh`], [`ExtractError::Threads`], [`ExtractError::OutOfMemory`].
pub(super) fn relax(
    request: &Request,
    steps: u32,
    trace: &Trace,
    extraction: &mut Extraction,
) -> Result<(), ExtractError> {
    let start = Moment::now();
    let grid = &CubeGrid::new(request.lattice)?;
    let origin = request.lattice.origin();
    let mesh = &mut extraction.mesh;
    relax_positions(&request.control, steps, mesh, |v| {
        let cell = trace.keys[v].cell();
        let low = [0, 1, 2].map(|axis| cell[axis].wrapping_sub(origin[axis]) as usize);
        [low, low.map(|i| i + 1)].map(|corner| grid.position(corner))
    })?;
    mesh.normals =
        vertex_normals(&mesh.positions, &mesh.triangles).map_err(|_| ExtractError::NoMemoryForMesh)?;
    extraction.times.vertex += start.elapsed();
    Ok(())
}

/// The same of a net whose triangles are two for each quadrilateral. `cell` says between which corners a vertex stays. Normals are left.
///
/// # Errors
/// As [`relax`].
pub(super) fn relax_positions(
    control: &Control,
    steps: u32,
    mesh: &mut TriangleMesh,
    cell: impl Fn(usize) -> [Vec3; 2] + Sync,
) -> Result<(), ExtractError> {
    let TriangleMesh { positions, triangles, .. } = mesh;
    let links = &Links::of(positions.len(), triangles)?;
    let mut before = copied(positions)?;
    for _ in 0..steps {
        control.check()?;
        before.copy_from_slice(positions);
        let before = &before;
        for_each_on_threads(control.threads, positions, |v, position| {
            let ways = links.at(v).iter().map(|&other| before[other as usize] - *position);
            let step = ways.sum::<Vec3>() * (STEP / links.at(v).len().max(1) as f32);
            let [low, high] = cell(v);
            *position = (*position + step).clamp(low, high);
        })?;
    }
    for pair in triangles.as_chunks_mut::<2>().0 {
        *pair = Quadrilateral::of(*pair).by_shorter_diagonal(positions);
    }
    Ok(())
}

/// Sorts a few numbers. What sorts many is 4 kB in a module for a page.
fn in_order(numbers: &mut [u32]) {
    for end in 1..numbers.len() {
        let mut at = end;
        while at > 0 && numbers[at - 1] > numbers[at] {
            numbers.swap(at - 1, at);
            at -= 1;
        }
    }
}

/// The vertices that each vertex is linked to, by ascending number, once each.
struct Links {
    /// Where those of a vertex begin and end.
    ranges: Vec<[u32; 2]>,
    others: Vec<u32>,
}

impl Links {
    /// Of triangles in pairs.
    fn of(vertices: usize, triangles: &[[u32; 3]]) -> Result<Self, TryReserveError> {
        let mut ranges = filled(vertices, [0; 2])?;
        let sides = || {
            let quadrilaterals = triangles.as_chunks::<2>().0.iter().map(|&pair| Quadrilateral::of(pair));
            quadrilaterals.flat_map(|of| (0..4).map(move |i| [of.corners[i], of.corners[(i + 1) % 4]]))
        };
        for v in sides().flatten() {
            ranges[v as usize][1] += 1;
        }
        let mut start = 0;
        for range in &mut ranges {
            let length = range[1];
            *range = [start; 2];
            start += length;
        }
        let mut others = filled(start as usize, 0)?;
        for [a, b] in sides() {
            for (from, to) in [(a, b), (b, a)] {
                let end = &mut ranges[from as usize][1];
                others[*end as usize] = to;
                *end += 1;
            }
        }
        for [start, end] in &mut ranges {
            let own = &mut others[*start as usize..*end as usize];
            in_order(own);
            // Most sides are two quadrilaterals'.
            let mut count = 0;
            for i in 0..own.len() {
                if i == 0 || own[i] != own[i - 1] {
                    own[count] = own[i];
                    count += 1;
                }
            }
            *end = *start + count as u32;
        }
        Ok(Self { ranges, others })
    }

    fn at(&self, v: usize) -> &[u32] {
        let [start, end] = self.ranges[v];
        &self.others[start as usize..end as usize]
    }
}
