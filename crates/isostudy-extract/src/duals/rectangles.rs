//! Greedy meshing: squares of one plane that face one way become rectangles (Lysenko 2012).
//!
//! In each plane, row by row, a rectangle begins at the first square that is in none yet. It goes as far along the row as squares
//! do, and then over as many rows as have all of its squares. A corner of one rectangle may lie within the side of another, so the
//! mesh has cracks of width 0 there: edges with one triangle.

use super::quads::Quadrilateral;
use crate::clock::Moment;
use crate::extraction::{ExtractError, Extraction};
use crate::memory::{collected, filled};
use crate::surface::trace::Trace;

/// One of a net whose vertices are in the middle of their cells.
struct Square {
    /// Its plane: the axis across it, the way it faces, and the cells that its corners are of along the axis.
    plane: (usize, bool, i32),
    /// The row, and the place in it: the cell of its lowest corner along the other axes.
    place: [i32; 2],
    of: Quadrilateral,
    /// The cell that its triangles are counted for.
    cell: u32,
}

/// Merges the squares of a net of blocks, whose trace is given.
///
/// # Errors
/// [`ExtractError::NoMemoryForMesh`].
pub(super) fn merge(trace: &mut Trace, extraction: &mut Extraction) -> Result<(), ExtractError> {
    let start = Moment::now();
    let mesh = &mut extraction.mesh;
    let pairs = mesh.triangles.as_chunks::<2>().0.iter().zip(trace.cells.iter().step_by(2));
    let mut squares = collected(pairs.map(|(&pair, &cell)| square(trace, Quadrilateral::of(pair), cell)))?;
    squares.sort_unstable_by_key(|square| (square.plane, square.place));
    let triangles_before = mesh.triangles.len();
    mesh.triangles.clear();
    trace.cells.clear();
    for plane in squares.chunk_by(|a, b| a.plane == b.plane) {
        for (of, cell) in rectangles(plane)? {
            mesh.triangles.extend(of.cut(false));
            trace.cells.resize(mesh.triangles.len(), cell);
        }
    }
    drop_unused(trace, extraction)?;
    extraction.renew()?;
    extraction.counts.discarded_triangles = triangles_before as u64 - extraction.counts.triangles;
    extraction.times.geometry += start.elapsed();
    Ok(())
}

fn square(trace: &Trace, of: Quadrilateral, cell: u32) -> Square {
    let [low, .., last] = of.corners.map(|corner| trace.keys[corner as usize].cell());
    let opposite = trace.keys[of.corners[2] as usize].cell();
    let axis =
        (0..3).find(|&axis| low[axis] == opposite[axis]).expect("a square lies in a plane of the lattice");
    debug_assert_ne!(low, last);
    let place = [low[(axis + 2) % 3], low[(axis + 1) % 3]];
    Square { plane: (axis, of.leads_out, low[axis]), place, of, cell }
}

/// The rectangles of squares of one plane, which are sorted by place; each with the cell of its first square.
fn rectangles(squares: &[Square]) -> Result<Vec<(Quadrilateral, u32)>, ExtractError> {
    let mut is_used = filled(squares.len(), false)?;
    let mut found = Vec::new();
    for first in 0..squares.len() {
        if is_used[first] {
            continue;
        }
        let [row, begin] = squares[first].place;
        let goes_on = |i: &usize| !is_used[*i] && squares[*i].place == [row, begin + (*i - first) as i32];
        let length = (first..squares.len()).take_while(goes_on).count();
        let mut rows = vec![first];
        while let Some(start) = row_above(squares, &is_used, [row + rows.len() as i32, begin], length) {
            rows.push(start);
        }
        rows.iter().for_each(|&start| is_used[start..start + length].fill(true));
        let top = rows[rows.len() - 1];
        let corner = |i: usize, corner: usize| squares[i].of.corners[corner];
        let corners =
            [corner(first, 0), corner(first + length - 1, 1), corner(top + length - 1, 2), corner(top, 3)];
        let leads_out = squares[first].of.leads_out;
        found.push((Quadrilateral { corners, leads_out }, squares[first].cell));
    }
    Ok(found)
}

/// Where as many squares begin at a place, all of them in no rectangle yet.
fn row_above(squares: &[Square], is_used: &[bool], place: [i32; 2], length: usize) -> Option<usize> {
    let start = squares.binary_search_by_key(&place, |square| square.place).ok()?;
    let row = squares.get(start..start + length)?;
    let [y, x] = place;
    let is_whole = row.last().is_some_and(|last| last.place == [y, x + length as i32 - 1]);
    (is_whole && !is_used[start..start + length].contains(&true)).then_some(start)
}

/// Drops the vertices that no triangle has any more.
fn drop_unused(trace: &mut Trace, extraction: &mut Extraction) -> Result<(), ExtractError> {
    let mesh = &mut extraction.mesh;
    let mut numbers = filled(mesh.positions.len(), u32::MAX)?;
    mesh.triangles.iter().flatten().for_each(|&v| numbers[v as usize] = 0);
    let mut count = 0;
    for (v, number) in numbers.iter_mut().enumerate() {
        if *number == 0 {
            *number = count as u32;
            mesh.positions[count] = mesh.positions[v];
            trace.keys[count] = trace.keys[v];
            count += 1;
        }
    }
    mesh.positions.truncate(count);
    trace.keys.truncate(count);
    mesh.triangles.iter_mut().flatten().for_each(|v| *v = numbers[*v as usize]);
    Ok(())
}
