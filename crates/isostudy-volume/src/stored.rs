//! Volumes of which parts are read: their samples stand in the file one after the other.

use std::fs::File;
use std::io::{BufReader, Seek};
use std::path::Path;

use isostudy_foreign::Parts;

use crate::data::{Encoding, Layout, decode, skip_lines};
use crate::error::{Problem, VolumeError};
use crate::header::{Frame, Unread};

/// Bytes that are read at a time, a multiple of every sample's size. They are on the stack: reading asks for no memory.
const BLOCK: usize = 1 << 15;
/// Bytes between two rows of a box that are read with them: a call of the system takes as long as so many more bytes.
const GAP: usize = 1 << 11;

/// A volume whose samples are in a file, raw. Any box of them is read by itself, from any thread, and has the values that
/// [`read`](crate::read) gives, to the bit.
#[derive(Debug)]
pub struct Stored {
    frame: Frame,
    layout: Layout,
    parts: Parts,
    /// The byte that the first sample begins at.
    start: u64,
}

impl Unread {
    /// Opens the data, of which parts are to be read. It must be as long as the header says.
    ///
    /// # Errors
    /// [`VolumeError`]; [`Problem::Unsupported`] if it is not [raw](Self::is_raw).
    pub fn stored(self) -> Result<Stored, VolumeError> {
        let (input, path, frame, layout) = self.opened()?;
        Stored::of(input, &path, frame, layout).map_err(|problem| problem.in_file(&path))
    }
}

impl Stored {
    /// Of the data's file, which is read to where the data begins.
    fn of(mut input: BufReader<File>, path: &Path, frame: Frame, layout: Layout) -> Result<Self, Problem> {
        if layout.encoding != Encoding::Raw {
            return Err(Problem::unsupported("encoding", layout.encoding.name(), "raw is, to read parts"));
        }
        skip_lines(&mut input, &layout)?;
        let here = input.stream_position()?;
        let parts = Parts::of(input.into_inner(), path).map_err(|error| Problem::Io(error.into()))?;
        // Countable: no overflow.
        let wanted = layout.samples * layout.kind.bytes() as u64;
        let start = match layout.skip.bytes {
            Some(bytes) => here.saturating_add(bytes),
            None => here.max(parts.bytes().saturating_sub(wanted)),
        };
        let there = parts.bytes().saturating_sub(start);
        if there < wanted {
            let got = there / layout.kind.bytes() as u64;
            return Err(Problem::Truncated { got, wanted: layout.samples });
        }
        if there > wanted {
            return Err(Problem::Excess { wanted: layout.samples });
        }
        Ok(Self { frame, layout, parts, start })
    }

    /// Where the samples lie.
    pub fn frame(&self) -> Frame {
        self.frame
    }

    /// Reads the samples of a box: `size` of them along each axis, from the sample `first` on, into `values`, the first axis fastest.
    ///
    /// # Errors
    /// [`Problem::Part`] if the file changed since it was opened, or cannot be read; [`Problem::TooLargeHere`]. Then `values` has anything
    /// in it.
    ///
    /// # Panics
    /// If the box is not in the volume, or there are not as many values.
    pub fn read_box(
        &self,
        first: [usize; 3],
        size: [usize; 3],
        values: &mut [f32],
    ) -> Result<(), VolumeError> {
        let counts = self.frame.counts;
        let is_there = (0..3).all(|k| first[k].checked_add(size[k]).is_some_and(|end| end <= counts[k]));
        assert!(is_there, "{size:?} samples from {first:?} on, of {counts:?}");
        assert_eq!(Some(values.len()), checked_product(size), "values for {size:?} samples");
        if values.is_empty() {
            return Ok(());
        }
        self.read_rows(first, size, values).map_err(|problem| problem.in_file(self.parts.path()))
    }

    fn read_rows(&self, first: [usize; 3], size: [usize; 3], values: &mut [f32]) -> Result<(), Problem> {
        let (width, counts) = (self.layout.kind.bytes(), self.frame.counts);
        let [length, rows, _] = size;
        // Rows that follow each other are read in one piece, with what is between them if that is little.
        let together = if (counts[0] - length).saturating_mul(width) <= GAP {
            (BLOCK / counts[0].saturating_mul(width)).clamp(1, rows)
        } else {
            1
        };
        let mut block = [0; BLOCK];
        for (z, layer) in values.chunks_exact_mut(length * rows).enumerate() {
            for (group, values) in layer.chunks_mut(length * together).enumerate() {
                let place = [first[0], first[1] + group * together, first[2] + z];
                if together > 1 {
                    let span = length + (values.len() / length - 1) * counts[0];
                    let bytes = &mut block[..span * width];
                    self.read_bytes(place, bytes)?;
                    for (row, values) in values.chunks_exact_mut(length).enumerate() {
                        let (place, start) = ([place[0], place[1] + row, place[2]], row * counts[0] * width);
                        self.decode(place, &bytes[start..start + length * width], values)?;
                    }
                    continue;
                }
                // A row may be longer than what is read at a time.
                for (piece, values) in values.chunks_mut(BLOCK / width).enumerate() {
                    let place = [place[0] + piece * (BLOCK / width), place[1], place[2]];
                    let bytes = &mut block[..values.len() * width];
                    self.read_bytes(place, bytes)?;
                    self.decode(place, bytes, values)?;
                }
            }
        }
        Ok(())
    }

    /// Reads bytes from those of a sample on.
    fn read_bytes(&self, place @ [x, y, z]: [usize; 3], bytes: &mut [u8]) -> Result<(), Problem> {
        let [nx, ny, _] = self.frame.counts.map(|n| n as u64);
        // In the file, since the box is in the volume: no overflow.
        let sample = (z as u64 * ny + y as u64) * nx + x as u64;
        let at = self.start + sample * self.layout.kind.bytes() as u64;
        self.parts.read(at, bytes).map_err(|error| Problem::Part { place, problem: error.problem })
    }

    fn decode(&self, place: [usize; 3], bytes: &[u8], values: &mut [f32]) -> Result<(), Problem> {
        match decode(&self.layout, bytes, values) {
            0 => Ok(()),
            count => Err(Problem::TooLargeHere { count, place }),
        }
    }
}

fn checked_product(size: [usize; 3]) -> Option<usize> {
    size.iter().try_fold(1usize, |product, &n| product.checked_mul(n))
}
