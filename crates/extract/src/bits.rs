//! Rows of points as words of bits, the first column in the lowest bit.

/// The bits of a word whose points lie in columns from `first` up to `end`.
pub(crate) fn between(word: usize, first: usize, end: usize) -> u64 {
    below(end, word) & !below(first, word)
}

/// The bits of a word in columns before `end`.
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

/// A set bit near another bit.
pub(crate) fn set_near(bits: u64, bit: u32) -> Option<u32> {
    let (below, above) = (bits & !(!0 << bit), bits & (!0 << bit));
    below.checked_ilog2().or((above != 0).then(|| above.trailing_zeros()))
}
