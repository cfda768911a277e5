//! Cells as half-open intervals of the isovalues that they are active at.

use std::collections::TryReserveError;

use isostudy_extract::active::GridSamples;

use super::OfCells;
use super::memory::push;

/// The least and the greatest of some samples.
pub(super) type Span = [f32; 2];

/// That of none.
pub(super) const NONE: Span = [f32::INFINITY, f32::NEG_INFINITY];

/// A cell, or a part of what it is active at.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Spanned {
    pub(super) span: Span,
    pub(super) cell: u32,
}

/// Whether a part with these samples may have some on either side; of a cell, whether it is active.
#[inline(always)]
pub(super) fn holds([least, greatest]: Span, isovalue: f32) -> bool {
    least <= isovalue && isovalue < greatest
}

/// A sample as spans have it: what is no number is never above an isovalue, and there is one zero, so that numbers can be sorted by
/// their bits.
#[inline(always)]
pub(super) fn ranked(value: f32) -> f32 {
    if value.is_nan() { f32::NEG_INFINITY } else { value + 0.0 }
}

/// With another sample.
#[inline(always)]
pub(super) fn with([least, greatest]: Span, value: f32) -> Span {
    let value = ranked(value);
    [if value < least { value } else { least }, if value > greatest { value } else { greatest }]
}

/// Of both.
#[inline(always)]
pub(super) fn union(one: Span, other: Span) -> Span {
    [if other[0] < one[0] { other[0] } else { one[0] }, if other[1] > one[1] { other[1] } else { one[1] }]
}

/// All cells that are active at some isovalue, in storage order.
pub(super) fn spanned_cells(samples: GridSamples) -> Result<Vec<Spanned>, TryReserveError> {
    let [nx, ny, nz] = samples.cells();
    let mut cells = Vec::new();
    for z in 0..nz {
        for y in 0..ny {
            let rows = samples.rows_of_cells(y, z);
            let across = |x: usize| rows.iter().fold(NONE, |span, row| with(span, row[x]));
            let (mut before, first) = (across(0), samples.cell([0, y, z]));
            for x in 0..nx {
                let after = across(x + 1);
                let span = union(before, after);
                if span[0] < span[1] {
                    push(&mut cells, Spanned { span, cell: first + x as u32 })?;
                }
                before = after;
            }
        }
    }
    Ok(cells)
}
