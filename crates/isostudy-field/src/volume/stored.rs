//! Samples that are not in memory, such as those of a file: boxes of them are read.

use std::error::Error;
use std::fmt;

/// Samples on a regular grid, of which any box can be read at any time, by any thread.
///
/// The same box has the same samples every time. Samples that are not there any more are [`UnreadSamples`], from then on for all boxes:
/// a surface would be made of what does not belong together.
pub trait StoredSamples: Send + Sync {
    /// How many there are along each axis; the first is the fastest.
    fn counts(&self) -> [usize; 3];

    /// Reads `size` samples along each axis, from the sample `first` on, into as many `values`, the first axis fastest.
    ///
    /// # Errors
    /// [`UnreadSamples`]. Then `values` has anything in it.
    fn read_box(&self, first: [usize; 3], size: [usize; 3], values: &mut [f32]) -> Result<(), UnreadSamples>;
}

/// Why samples cannot be read, in words: with the file and the place, if they have such.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct UnreadSamples(pub String);

impl fmt::Display for UnreadSamples {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl Error for UnreadSamples {}
