//! What headers have in common: lines, numbers, sizes, and where the data is.

use std::io::{BufRead, Read};
use std::path::{Path, PathBuf};

use crate::Volume;
use crate::data::{self, Layout};
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

/// The number of samples, if none is missing and all fit the limit.
pub(crate) fn sample_count(sizes: &[u64], limit_bytes: u64) -> Result<u64, Problem> {
    if sizes.contains(&0) {
        return Err(Problem::NoSamples { sizes: sizes.to_vec() });
    }
    // Eight bytes a sample in the file, four in memory, must be countable.
    let limit = (limit_bytes / 4).min(isize::MAX as u64 / 8);
    let product = sizes.iter().try_fold(1u64, |product, &size| product.checked_mul(size));
    product.filter(|&samples| samples <= limit).ok_or_else(|| {
        let needed = product.and_then(|samples| samples.checked_mul(4));
        Problem::TooManySamples { sizes: sizes.to_vec(), needed, limit }
    })
}

/// Where samples lie.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Frame {
    pub(crate) counts: [usize; 3],
    pub(crate) origin: [f64; 3],
    pub(crate) steps: [[f64; 3]; 3],
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

    /// The volume with the samples of a data file of its own, named from the header's folder.
    pub(crate) fn with_file(
        &self,
        header: &Path,
        name: impl AsRef<Path>,
        layout: &Layout,
    ) -> Result<Volume, VolumeError> {
        let path: PathBuf = header.parent().unwrap_or(Path::new("")).join(name);
        data::open(&path)
            .and_then(|input| data::read(input, layout))
            .map(|values| self.with(values))
            .map_err(|problem| problem.in_file(&path))
    }

    pub(crate) fn with(&self, values: Vec<f32>) -> Volume {
        Volume { counts: self.counts, origin: self.origin, steps: self.steps, values }
    }
}
