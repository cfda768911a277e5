//! Ranges of samples, as half-open intervals of the isovalues that cells are active at.

/// The least and the greatest of some samples.
pub(super) type Span = [f32; 2];

/// That of none.
pub(super) const NONE: Span = [f32::INFINITY, f32::NEG_INFINITY];

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
