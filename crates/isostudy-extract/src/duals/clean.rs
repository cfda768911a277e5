//! Nets that do not pass through themselves: each quadrilateral stays in the envelope of its edge (Ju & Udeshi 2006).
//!
//! **Envelopes.** Take a vertex strictly within the region of its loop ([`Region`](super::region::Region)), and a point strictly within
//! each face that the loop crosses, in the region's part of it. Of a cell, an edge of a face, the point in that face and the vertex are the
//! corners of a tetrahedron. All such tetrahedra have nothing but faces, edges and corners in common: those of one loop are
//! cones over triangles in the rim of a convex region, from a point within; regions of a cell are apart; and so are cells. The *envelope* of a
//! crossed edge is what has that edge: two tetrahedra in each of the four cells round it. Envelopes of different edges have no more in
//! common than their rims, and each polygon round an edge, from vertex to point in a face to vertex, lies in the rim of its own envelope
//! alone. So surfaces that are spanned within envelopes never pass through each other.
//!
//! **Faces.** Where the segment between two vertices passes through the inside of their face, in both regions' parts of it, that point serves,
//! and needs no vertex. Elsewhere the face gets a vertex.
//!
//! **Edges.** Let `a` and `b` be the ends of the edge. The envelope is the union of the tetrahedra `a b p q` for each side `p q` of the polygon.
//! Some triangles with the polygon as their rim lie in it if each of them has `a` strictly on one side and `b` strictly on the other, as the
//! surface should: the tetrahedra from `a` to the triangles, and from `b`, then are all of positive volume and have together the
//! envelope's rim as theirs, so they cover each point as often as that rim winds round it, which is once within and never beyond. The two
//! diagonals of a quadrilateral are tried, and where there are vertices in faces, fans from these. If none passes, a vertex on
//! the edge has a fan of triangles to the polygon: each of these is in one of the tetrahedra.
//!
//! All of it is decided by signs of determinants that are exact (`robust`), from the four vertices round an edge and their loops. So it does not
//! matter what is decided first, threads and chunks give the same, and it ends.
//!
//! **At the box** edges have no quadrilateral, and a loop can be cut into runs of quadrilaterals that have nothing but its vertex in common.
//! There the fan is filled up: triangles from the vertex to the open edges in between, in the tetrahedra of these edges.

mod added;
mod face;
mod net;

use std::collections::{HashMap, TryReserveError};

use glam::Vec3;
use isostudy_mesh::TriangleMesh;

use self::added::Added;
use self::net::{Cut, Judged, Net};
use super::octree;
use super::plan::{Loop, Plans, Table, VertexPer};
use super::region::margin;
use super::sharp::Sharp;
use crate::clock::Moment;
use crate::cubes::grid::CubeGrid;
use crate::execution::threads::for_each_on_threads;
use crate::extraction::{ExtractError, Extraction};
use crate::lattice::Part;
use crate::memory::{collected, push, refill, refilled, reset};
use crate::source::{NormalsOf, Request};
use crate::surface::normals::accumulate;
use crate::surface::trace::{Trace, VertexKey};

/// Buffers, kept from one extraction to the next.
#[derive(Default)]
pub(crate) struct Buffers {
    plans: Option<Plans>,
    /// Of each vertex its plan, and its number in it.
    numbers: Vec<(u32, usize)>,
    judged: Vec<Judged>,
    triangles: Vec<[u32; 3]>,
    of_cells: Vec<u32>,
    known: HashMap<VertexKey, u32>,
    added: Vec<(VertexKey, Vec3)>,
    order: Vec<(u128, u32)>,
    ranks: Vec<u32>,
    keys: Vec<VertexKey>,
    positions: Vec<Vec3>,
}

/// Has the quadrilaterals of an extraction stay in the envelopes of their edges, after cells were merged if there is a tolerance. The trace
/// says which loops its vertices stand for.
///
/// # Errors
/// [`ExtractError::NoMemoryForMesh`], [`ExtractError::Threads`], [`ExtractError::Cancelled`], [`ExtractError::TooManyVertices`].
pub(super) fn clean(
    request: &Request,
    grid: &CubeGrid,
    (sharp, tolerance): (Sharp, f32),
    room: &mut Buffers,
    trace: &mut Trace,
    extraction: &mut Extraction,
) -> Result<(), ExtractError> {
    let Some(level) = request.level() else { return Ok(()) };
    let start = Moment::now();
    let mesh = &mut extraction.mesh;
    let triangles_before = mesh.triangles.len();
    let (mut stands_for, mut cells) = (Vec::new(), Vec::new());
    if tolerance > 0.0 {
        let standing = octree::merged(request, level, grid, (sharp, tolerance), trace, mesh)?;
        (stands_for, mesh.positions, cells) = (standing.stands_for, standing.positions, standing.cells);
        for (position, &(low, size)) in
            mesh.positions.iter_mut().zip(&cells).filter(|(_, (_, size))| *size > 1)
        {
            let [low, high] = [low, low.map(|i| i + size)].map(|corner| grid.position(corner).as_dvec3());
            let margin = (high - low) * margin(low, high, size);
            *position = position.as_dvec3().clamp(low + margin, high - margin).as_vec3();
        }
    }
    let TriangleMesh { positions, normals, triangles } = mesh;
    // What is small and cannot be refused comes where it was asked whether memory is short.
    request.control.check()?;
    let plans = room.plans.get_or_insert_with(|| Plans::new(Table::get(VertexPer::Loop)));
    let numbers = trace.patterns.iter().map(|pattern| {
        let (inside, joined, at_box) = pattern.cell();
        (plans.number(inside, joined, at_box), pattern.vertex())
    });
    refilled(&mut room.numbers, numbers)?;
    let net = &Net {
        level,
        grid,
        stands_for: &stands_for,
        positions,
        cells: &cells,
        keys: &trace.keys,
        origin: request.lattice.origin(),
        plans,
        numbers: &room.numbers,
        merged: &Loop::whole(),
    };

    request.control.check()?;
    // What is made is exchanged for what was there: from the second chunk on, both have room.
    let most = triangles.len() + triangles.len() / 8;
    if request.part.is_some() {
        triangles.try_reserve(most - triangles.len())?;
        trace.cells.try_reserve(most - trace.cells.len())?;
    }
    let pairs = triangles.as_chunks::<2>().0;
    reset(&mut room.judged, pairs.len(), Judged::default())?;
    for_each_on_threads(request.control.threads, &mut room.judged, |q, judged| {
        *judged = net.judge(pairs[q])
    })?;

    request.control.check()?;
    let of_pairs = trace.cells.as_chunks::<2>().0;
    let (made, of_cells) = (&mut room.triangles, &mut room.of_cells);
    made.clear();
    of_cells.clear();
    made.try_reserve(most)?;
    of_cells.try_reserve(most)?;
    let mut added = Added::new(net, &mut room.known, &mut room.added);
    for (judged, [cell, _]) in room.judged.iter().zip(of_pairs) {
        match judged.cut {
            Cut::Nothing => {}
            Cut::Triangle(of) => push(made, of)?,
            Cut::Two(of) => of.into_iter().try_for_each(|of| push(made, of))?,
            Cut::Polygon => added.polygon(judged, made)?,
        }
        // Mostly two.
        while of_cells.len() < made.len() {
            push(of_cells, *cell)?;
        }
    }
    request.control.check()?;
    let part = request.part.unwrap_or_else(|| Part::whole(request.lattice));
    if added.fill(part, made, of_cells)? {
        // What fills a cell comes after its quadrilaterals.
        let order = &mut room.order;
        refilled(order, of_cells.iter().enumerate().map(|(t, &cell)| (u128::from(cell), t as u32)))?;
        order.sort_unstable();
        *made = collected(order.iter().map(|&(_, t)| made[t as usize]))?;
        *of_cells = collected(order.iter().map(|&(cell, _)| cell as u32))?;
    }
    if (positions.len() + room.added.len()) as u64 > u64::from(request.most_vertices) {
        return Err(ExtractError::TooManyVertices { limit: request.most_vertices });
    }
    std::mem::swap(triangles, &mut room.triangles);
    std::mem::swap(&mut trace.cells, &mut room.of_cells);
    if !room.added.is_empty() || !stands_for.is_empty() {
        room.put_in_order(&stands_for, &mut trace.keys, positions, triangles)?;
    }
    trace.patterns.clear();
    normals.clear();
    if request.normals != NormalsOf::Nothing {
        refill(normals, positions.len(), Vec3::ZERO)?;
        accumulate(positions, triangles, normals);
    }
    extraction.count();
    if tolerance > 0.0 {
        extraction.counts.discarded_triangles =
            (triangles_before as u64).saturating_sub(extraction.counts.triangles);
    }
    extraction.times.geometry += start.elapsed();
    Ok(())
}

impl Buffers {
    /// Numbers what was added, whose numbers follow those that there are, so that all vertices are in the order of their keys. Those for
    /// which others stand go.
    fn put_in_order(
        &mut self,
        stands_for: &[u32],
        keys: &mut Vec<VertexKey>,
        positions: &mut Vec<Vec3>,
        triangles: &mut [[u32; 3]],
    ) -> Result<(), TryReserveError> {
        let Self { added, order, ranks, keys: all_keys, positions: all_positions, .. } = self;
        let old = keys.len();
        refilled(order, added.iter().enumerate().map(|(v, (key, _))| (key.number(), v as u32)))?;
        order.sort_unstable();
        reset(ranks, old + added.len(), 0)?;
        all_keys.clear();
        all_keys.try_reserve(ranks.len())?;
        all_positions.clear();
        all_positions.try_reserve(ranks.len())?;
        let mut next = order.iter().map(|&(_, v)| v).peekable();
        for v in 0..=old {
            while let Some(new) = next.next_if(|&new| v == old || added[new as usize].0 < keys[v]) {
                let (key, position) = added[new as usize];
                ranks[old + new as usize] = all_keys.len() as u32;
                all_keys.push(key);
                all_positions.push(position);
            }
            if v < old && stands_for.get(v).is_none_or(|&standing| standing as usize == v) {
                ranks[v] = all_keys.len() as u32;
                all_keys.push(keys[v]);
                all_positions.push(positions[v]);
            }
        }
        std::mem::swap(keys, all_keys);
        std::mem::swap(positions, all_positions);
        triangles.iter_mut().for_each(|triangle| *triangle = triangle.map(|v| ranks[v as usize]));
        Ok(())
    }
}
