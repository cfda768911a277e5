//! Vectors that ask for their memory, so that its end is an error and not an abort.

use std::collections::TryReserveError;

/// As many of `value` as `len` says.
pub(crate) fn filled<T: Clone>(len: usize, value: T) -> Result<Vec<T>, TryReserveError> {
    let mut vector = with_room(len)?;
    vector.resize(len, value);
    Ok(vector)
}

/// The items of an iterator that knows how many there are.
pub(crate) fn collected<T>(items: impl ExactSizeIterator<Item = T>) -> Result<Vec<T>, TryReserveError> {
    let mut vector = with_room(items.len())?;
    vector.extend(items);
    Ok(vector)
}

/// A copy.
pub(crate) fn copied<T: Copy>(items: &[T]) -> Result<Vec<T>, TryReserveError> {
    collected(items.iter().copied())
}

/// Adds an item; room grows in steps, as with `push`.
#[inline]
pub(crate) fn push<T>(vector: &mut Vec<T>, item: T) -> Result<(), TryReserveError> {
    vector.try_reserve(1)?;
    vector.push(item);
    Ok(())
}

/// Empty, with room for `len` items.
pub(crate) fn with_room<T>(len: usize) -> Result<Vec<T>, TryReserveError> {
    let mut vector = Vec::new();
    vector.try_reserve_exact(len)?;
    Ok(vector)
}
