//! Transition cells along the sides of a chunk of marching cubes that have finer neighbours.

use std::collections::TryReserveError;

use glam::Vec3;
use isostudy_field::StudyField;

use super::layer::{Plane, point};
use super::patterns::{CORNERS, Edge, Patterns, SQUARES};
use crate::chunks::Chunk;
use crate::cubes::{Faces, joins};
use crate::lattice::Arrangement;
use crate::lattice::endless::Grid;
use crate::surface::trace::VertexKey;

/// A corner of a triangle.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Corner {
    /// A vertex of the chunk's own level.
    Own(u32),
    /// A vertex of the extracted layer of the finer level.
    Fine(u32),
}

/// What decides on squares with a choice.
pub(super) struct Decision<'a> {
    pub(super) faces: Faces,
    pub(super) field: &'a dyn StudyField,
    pub(super) isovalue: f32,
    /// The fine one.
    pub(super) grid: &'a Grid,
}

/// Hands out the triangles of the transition cells of a side, with the cells of the chunk that they are at. The first `own` vertices are
/// those of the chunk's level; `plane` is of the fine grid.
pub(super) fn triangulate(
    (chunk, own): (&Chunk, usize),
    (across, is_high): (usize, bool),
    plane: &Plane,
    decision: &Decision,
    mut take: impl FnMut([i32; 3], [Corner; 3]) -> Result<(), TryReserveError>,
) -> Result<(), TryReserveError> {
    let patterns = Patterns::get();
    let axes = [(across + 1) % 3, (across + 2) % 3];
    // Seen along the way into the chunk, x and y of the transition cell are these axes of the plane.
    let turned = usize::from(is_high);
    let place_of = |square: [usize; 2], [x, y]: [u8; 2]| {
        let mut place = square.map(|i| 2 * i);
        place[turned] += usize::from(x);
        place[1 - turned] += usize::from(y);
        place
    };
    let keys = &chunk.keys[..own];
    let own = |square: [usize; 2], from: [u8; 2], along: usize| {
        let place = place_of(square, from);
        let mut corner = [0; 3];
        corner[across] = i64::from(if is_high { chunk.cells.end[across] } else { chunk.cells.start[across] });
        for (i, axis) in axes.into_iter().enumerate() {
            corner[axis] = i64::from(chunk.cells.start[axis]) + place[i] as i64 / 2;
        }
        let key = VertexKey::new(Arrangement::SimpleCubic, corner, axes[along]);
        keys.binary_search(&key).ok().map(|v| v as u32)
    };
    let size = axes.map(|axis| chunk.cells.size()[axis] as usize);
    for square in (0..size[1]).flat_map(|v| (0..size[0]).map(move |u| [u, v])) {
        let at = |c: u8| place_of(square, [c % 3, c / 3]);
        let is_inside = |c: u8| plane.is_inside(at(c));
        let inside = (0..9).fold(0, |set, c| set | u16::from(is_inside(c)) << c);
        if matches!(inside, 0 | 511) {
            continue;
        }
        let ambiguous = patterns.ambiguous(inside);
        let is_joined = |square: usize| {
            let mut round = CORNERS[square];
            if !is_inside(round[0]) {
                round.rotate_left(1);
            }
            let value = |c: u8| decision.field.sample(Vec3::from(point(decision.grid, plane.corner(at(c)))));
            joins(decision.faces, decision.isovalue, || round.map(value))
        };
        let joined = (0..SQUARES)
            .filter(|square| ambiguous >> square & 1 != 0)
            .fold(0, |set, square| set | u8::from(is_joined(square)) << square);
        let mut cell = chunk.cells.start;
        if is_high {
            cell[across] = chunk.cells.end[across] - 1;
        }
        for (i, axis) in axes.into_iter().enumerate() {
            cell[axis] += square[i] as i32;
        }
        let corner = |edge: Edge| match edge {
            Edge::Fine { from, along } => {
                plane.vertex(place_of(square, from), usize::from(along) ^ turned).map(Corner::Fine)
            }
            Edge::Coarse { from, along } => own(square, from, usize::from(along) ^ turned).map(Corner::Own),
            Edge::Between => None,
        };
        for [a, b, c] in patterns.triangles(inside, joined) {
            // A vertex is missing only where a field breaks its promises.
            if let (Some(a), Some(b), Some(c)) = (corner(a), corner(b), corner(c)) {
                take(cell, [a, b, c])?;
            }
        }
    }
    Ok(())
}
