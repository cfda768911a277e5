//! Rows of points as words of bits, the first column in the lowest bit.

use glam::Vec4;

/// The bits of a word whose points lie in columns from `first` up to `end`.
#[inline]
pub(crate) fn between(word: usize, first: usize, end: usize) -> u64 {
    below(end, word) & !below(first, word)
}

/// The bits of a word in columns before `end`.
#[inline]
fn below(end: usize, word: usize) -> u64 {
    match end.saturating_sub(64 * word) {
        n if n < 64 => !(!0 << n),
        _ => !0,
    }
}

/// Sets the bits of columns from `first` up to `end`.
pub(crate) fn set_range(bits: &mut [u64], first: usize, end: usize) {
    let words = first / 64..end.div_ceil(64);
    for (word, bits) in words.clone().zip(&mut bits[words]) {
        *bits |= between(word, first, end);
    }
}

/// Of a row of values, which are above the isovalue. Equal is not, and `NaN` is not. Words beyond the row stay as they are.
#[inline]
pub(crate) fn set_above(values: &[f32], isovalue: f32, words: &mut [u64]) {
    let limit = Vec4::splat(isovalue);
    // By fours, since whole words one by one take four times as long.
    let above = |fours: &[[f32; 4]]| {
        let set = |four: &[f32; 4]| u64::from(Vec4::from_array(*four).cmpgt(limit).bitmask());
        fours.iter().enumerate().fold(0, |word, (i, four)| word | set(four) << (4 * i))
    };
    let (wholes, rest) = values.as_chunks::<64>();
    for (word, values) in words.iter_mut().zip(wholes) {
        *word = above(values.as_chunks::<4>().0);
    }
    if let Some(last) = words.get_mut(wholes.len()).filter(|_| !rest.is_empty()) {
        let (fours, few) = rest.as_chunks::<4>();
        let done = 4 * fours.len();
        let bits = few.iter().enumerate();
        *last = bits.fold(above(fours), |word, (i, &value)| word | u64::from(value > isovalue) << (done + i));
    }
}

/// A set bit near another bit.
pub(crate) fn set_near(bits: u64, bit: u32) -> Option<u32> {
    let (below, above) = (bits & !(!0 << bit), bits & (!0 << bit));
    below.checked_ilog2().or((above != 0).then(|| above.trailing_zeros()))
}
