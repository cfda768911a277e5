//! What headers have in common: lines, numbers, sizes, and where the data is.

use std::fs::File;
use std::io::{BufRead, BufReader, Read};
use std::path::{Path, PathBuf};

use crate::Volume;
use crate::data::{self, Encoding, Layout};
use crate::error::{Problem, VolumeError, shortened};

/// Far longer than any header; keeps a file of something else from being read to its end.
const HEADER_LIMIT: usize = 1 << 20;

/// The lines of a header, numbered from 1, until the reader is left to the data.
pub(crate) struct Lines<R> {
    input: R,
    line: usize,
    bytes: usize,
}

impl<R: BufRead> Lines<R> {
    pub(crate) fn new(input: R) -> Self {
        Self { input, line: 0, bytes: 0 }
    }

    /// The next line without its end, and its number; `None` at the end of the file.
    pub(crate) fn next(&mut self) -> Result<Option<(usize, String)>, Problem> {
        let mut text = Vec::new();
        let left = HEADER_LIMIT - self.bytes;
        let got = (&mut self.input).take(left as u64).read_until(b'\n', &mut text)?;
        if got == 0 && left > 0 {
            return Ok(None);
        }
        self.bytes += got;
        if self.bytes >= HEADER_LIMIT {
            return Err(Problem::HeaderTooLong { limit: HEADER_LIMIT });
        }
        self.line += 1;
        let text = String::from_utf8_lossy(&text);
        Ok(Some((self.line, text.trim_end_matches(['\n', '\r']).to_owned())))
    }

    /// The reader, at the first byte after the line that was read last.
    pub(crate) fn into_data(self) -> R {
        self.input
    }
}

/// Numbers separated by white space.
pub(crate) fn numbers<T: std::str::FromStr>(line: usize, text: &str) -> Result<Vec<T>, Problem> {
    let number = |word: &str| {
        word.parse().map_err(|_| Problem::line(line, format!("`{}` is not a number here", shortened(word))))
    };
    text.split_ascii_whitespace().map(number).collect()
}

/// As many numbers as there are axes.
pub(crate) fn three(line: usize, text: &str) -> Result<[f64; 3], Problem> {
    let values: Vec<f64> = numbers(line, text)?;
    let count = values.len();
    values.try_into().map_err(|_| Problem::line(line, format!("{count} numbers where 3 belong")))
}

/// The most samples whose bytes can be counted: eight bytes each in the file, four in memory.
const COUNTABLE: u64 = isize::MAX as u64 / 8;

/// The number of samples, if none is missing and they can be counted.
pub(crate) fn sample_count(sizes: &[u64]) -> Result<u64, Problem> {
    if sizes.contains(&0) {
        return Err(Problem::NoSamples { sizes: sizes.to_vec() });
    }
    let product = sizes.iter().try_fold(1u64, |product, &size| product.checked_mul(size));
    product.filter(|&samples| samples <= COUNTABLE).ok_or_else(|| Problem::TooManySamples {
        sizes: sizes.to_vec(),
        needed: None,
        limit: COUNTABLE,
    })
}

/// Where samples lie.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Frame {
    /// How many samples there are along each axis of the grid; none is zero.
    pub counts: [usize; 3],
    /// Where the first sample lies.
    pub origin: [f64; 3],
    /// From one sample to the next, along each axis of the grid. Finite, and no two in one plane with the third.
    pub steps: [[f64; 3]; 3],
}

/// A volume of which the header was read, and no sample.
#[derive(Debug)]
pub struct Unread {
    frame: Frame,
    layout: Layout,
    header: PathBuf,
    data: Data,
}

/// Where the samples are.
#[derive(Debug)]
pub(crate) enum Data {
    /// In the header's own file, from here on.
    Here(BufReader<File>),
    /// In a file of their own, named from the header's folder.
    In(PathBuf),
}

impl Unread {
    pub(crate) fn new(frame: Frame, layout: Layout, header: &Path, data: Data) -> Self {
        Self { frame, layout, header: header.to_owned(), data }
    }

    /// The header's file.
    pub fn path(&self) -> &Path {
        &self.header
    }

    /// Where its samples lie.
    pub fn frame(&self) -> Frame {
        self.frame
    }

    /// What the samples will take in memory.
    pub fn memory_bytes(&self) -> u64 {
        // No overflow: countable.
        self.layout.samples * crate::SAMPLE_BYTES
    }

    /// The data's file, where the data may begin, and its name; and what the header says.
    pub(crate) fn opened(self) -> Result<(BufReader<File>, PathBuf, Frame, Layout), VolumeError> {
        let Self { frame, layout, header, data } = self;
        let (input, path) = opened(data, &header)?;
        Ok((input, path, frame, layout))
    }

    /// Whether the samples stand in the file one after the other, so that parts of them can be read ([`stored`](Self::stored)): neither
    /// compressed nor written as text.
    pub fn is_raw(&self) -> bool {
        self.layout.encoding == Encoding::Raw
    }

    /// Reads the samples, as [`read`](crate::read).
    ///
    /// # Errors
    /// [`VolumeError`]; [`Problem::TooManySamples`] before anything is read.
    pub fn read(self, limit_bytes: u64) -> Result<Volume, VolumeError> {
        let Self { frame, layout, header, data } = self;
        let needed = layout.samples * crate::SAMPLE_BYTES;
        if needed > limit_bytes {
            let sizes = frame.counts.map(|n| n as u64).to_vec();
            let limit = limit_bytes / crate::SAMPLE_BYTES;
            return Err(Problem::TooManySamples { sizes, needed: Some(needed), limit }.in_file(&header));
        }
        let (input, path) = opened(data, &header)?;
        let values = data::read(input, &layout).map_err(|problem| problem.in_file(&path))?;
        let Frame { counts, origin, steps } = frame;
        Ok(Volume { counts, origin, steps, values })
    }
}

/// The data's file, where the data may begin, and its name.
fn opened(data: Data, header: &Path) -> Result<(BufReader<File>, PathBuf), VolumeError> {
    match data {
        Data::Here(input) => Ok((input, header.to_owned())),
        Data::In(name) => {
            let path = header.parent().unwrap_or(Path::new("")).join(name);
            let input = data::open(&path).map_err(|problem| problem.in_file(&path))?;
            Ok((input, path))
        }
    }
}

impl Frame {
    /// Along x, y and z.
    pub(crate) fn diagonal(counts: [usize; 3], origin: [f64; 3], spacing: [f64; 3]) -> Self {
        let mut steps = [[0.0; 3]; 3];
        for (k, step) in steps.iter_mut().enumerate() {
            step[k] = spacing[k];
        }
        Self { counts, origin, steps }
    }

    /// Finite, and not flat beside the lengths of the steps.
    pub(crate) fn check(&self) -> Result<(), Problem> {
        let [a, b, c] = self.steps;
        let cross = [b[1] * c[2] - b[2] * c[1], b[2] * c[0] - b[0] * c[2], b[0] * c[1] - b[1] * c[0]];
        let volume = (a[0] * cross[0] + a[1] * cross[1] + a[2] * cross[2]).abs();
        let lengths: f64 = self.steps.iter().map(|s| s.iter().map(|v| v * v).sum::<f64>().sqrt()).product();
        let is_finite = self.origin.iter().all(|v| v.is_finite()) && lengths.is_finite();
        if is_finite && lengths > 0.0 && volume > 1e-6 * lengths {
            Ok(())
        } else {
            Err(Problem::Steps { steps: self.steps, origin: self.origin })
        }
    }
}
