//! Vectors that ask for their memory, so that its end is an error and not an abort.

use std::collections::TryReserveError;
use std::sync::OnceLock;

/// Whoever counts what the process holds.
static WATCH: OnceLock<fn() -> bool> = OnceLock::new();

/// Has extractions end where `is_short` says that memory is short, for a program that counts what it holds: with
/// [`ExtractError::NoMemoryForMesh`](crate::ExtractError), as where memory is not to be had. It is asked where
/// [`Control::cancel`](crate::Control) is looked at, before each layer of samples, on any thread. The first watch stays, for all
/// extractions of the process.
pub fn watch_memory(is_short: fn() -> bool) {
    let _ = WATCH.set(is_short);
}

/// What the watch says.
pub(crate) fn is_short() -> bool {
    WATCH.get().is_some_and(|is_short| is_short())
}

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

/// Makes a vector hold the items of an iterator that knows how many there are, in the room that it has if that is enough.
pub(crate) fn refilled<T>(
    vector: &mut Vec<T>,
    items: impl ExactSizeIterator<Item = T>,
) -> Result<(), TryReserveError> {
    vector.clear();
    vector.try_reserve_exact(items.len())?;
    vector.extend(items);
    Ok(())
}

/// Makes a vector hold as many of `value` as `len` says and nothing else, in the room that it has if that is enough.
pub(crate) fn reset<T: Clone>(vector: &mut Vec<T>, len: usize, value: T) -> Result<(), TryReserveError> {
    vector.clear();
    vector.try_reserve_exact(len)?;
    vector.resize(len, value);
    Ok(())
}

/// Makes a vector `len` long. What it held stays if it is long enough; new room is asked for, not taken.
pub(crate) fn refill<T: Copy>(vector: &mut Vec<T>, len: usize, value: T) -> Result<(), TryReserveError> {
    vector.try_reserve_exact(len.saturating_sub(vector.len()))?;
    vector.resize(len, value);
    Ok(())
}
