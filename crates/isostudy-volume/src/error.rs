//! What can be wrong with a volume's files.

use std::io;
use std::path::{Path, PathBuf};

use isostudy_foreign::FileProblem;
use thiserror::Error;

/// What is wrong, and with which file.
#[derive(Debug, Error)]
#[error("{}: {problem}", .file.display())]
pub struct VolumeError {
    /// The header or the data file.
    pub file: PathBuf,
    /// What is wrong with it. It is in the message, hence not a source of its own.
    pub problem: Box<Problem>,
}

/// What is wrong. Lines count from 1.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum Problem {
    /// The file cannot be opened or read. Compressed data that is damaged ends up here as well.
    #[error(transparent)]
    Io(#[from] io::Error),
    /// Not a regular file: a folder, a pipe, a device.
    #[error("not a file")]
    NotAFile,
    /// The name's ending tells no format.
    #[error("known endings are .nrrd, .nhdr, .mha, .mhd, .toml and .raw (with a .toml beside it)")]
    Ending,
    /// The header breaks its format.
    #[error("line {line}: {reason}")]
    Line {
        /// Where.
        line: usize,
        /// What is wrong there.
        reason: String,
    },
    /// The header lacks something that it must have.
    #[error("the header has no `{key}`")]
    Lacks {
        /// What it lacks.
        key: &'static str,
    },
    /// The header asks for something that is not supported.
    #[error("{key} `{value}` is not supported; {supported}")]
    Unsupported {
        /// The key.
        key: &'static str,
        /// Its value, cut after 40 characters.
        value: String,
        /// What is.
        supported: &'static str,
    },
    /// The header has no end.
    #[error("the header does not end within {limit} bytes")]
    HeaderTooLong {
        /// How much was searched.
        limit: usize,
    },
    /// An axis without samples.
    #[error("sizes {sizes:?}: every axis needs at least one sample")]
    NoSamples {
        /// The sizes as written.
        sizes: Vec<u64>,
    },
    /// More samples than the limit, or than can be counted.
    #[error(
        "sizes {sizes:?} need {}, four bytes a sample, and the limit is {}",
        needed.map_or_else(|| "more memory than can be counted".to_owned(), |bytes| amount(bytes, f64::ceil) + " of memory"),
        amount(4 * limit, f64::floor)
    )]
    TooManySamples {
        /// Samples along the axes.
        sizes: Vec<u64>,
        /// The bytes that their samples need, if they can be counted.
        needed: Option<u64>,
        /// The most samples there may be.
        limit: u64,
    },
    /// The steps from sample to sample span no space, or are not finite numbers.
    #[error("the steps {steps:?} from sample to sample, from {origin:?}, span no space")]
    Steps {
        /// Along each axis.
        steps: [[f64; 3]; 3],
        /// Where the first sample lies.
        origin: [f64; 3],
    },
    /// The data ends early.
    #[error("the data ends after {got} of {wanted} samples")]
    Truncated {
        /// Whole samples that are there.
        got: u64,
        /// What the header claims.
        wanted: u64,
    },
    /// There is data beyond the last sample.
    #[error("there is more data than the {wanted} samples that the header claims")]
    Excess {
        /// What the header claims.
        wanted: u64,
    },
    /// Text that is not a number.
    #[error("sample {sample}: `{token}` is not a number of the type {kind}")]
    NotANumber {
        /// Which sample, from 0.
        sample: u64,
        /// What stands there, cut after 40 characters.
        token: String,
        /// The type.
        kind: &'static str,
    },
    /// Finite numbers that are infinite in single precision.
    #[error("{count} of {samples} samples are beyond {:e}, the largest number of single precision", f32::MAX)]
    TooLarge {
        /// How many.
        count: u64,
        /// Of how many.
        samples: u64,
    },
    /// The same in a part that was read by itself.
    #[error(
        "{count} of the samples from {place:?} on are beyond {:e}, the largest number of single precision",
        f32::MAX
    )]
    TooLargeHere {
        /// How many.
        count: u64,
        /// Where the part begins, along the axes of the grid.
        place: [usize; 3],
    },
    /// A part that cannot be read, or no longer belongs to the others.
    #[error("the samples from {place:?} on: {problem}")]
    Part {
        /// Where it begins, along the axes of the grid.
        place: [usize; 3],
        /// Why not. It is in the message, hence not a source of its own.
        problem: FileProblem,
    },
    /// Memory that is not to be had.
    #[error("no memory for {samples} samples")]
    OutOfMemory {
        /// How many there were to be.
        samples: u64,
    },
    /// A TOML header that is none.
    #[error(transparent)]
    Toml(#[from] toml::de::Error),
}

impl Problem {
    pub(crate) fn in_file(self, file: &Path) -> VolumeError {
        VolumeError { file: file.to_owned(), problem: Box::new(self) }
    }

    pub(crate) fn line(line: usize, reason: impl Into<String>) -> Self {
        Self::Line { line, reason: reason.into() }
    }

    pub(crate) fn unsupported(key: &'static str, value: &str, supported: &'static str) -> Self {
        Self::Unsupported { key, value: shortened(value), supported }
    }
}

/// `1.0 GiB`. What is needed is rounded up and what there is down, lest they look the same.
fn amount(bytes: u64, rounded: fn(f64) -> f64) -> String {
    let units = [(1 << 40, "TiB"), (1 << 30, "GiB"), (1 << 20, "MiB"), (1 << 10, "KiB")];
    let Some((unit, name)) = units.into_iter().find(|(unit, _)| bytes >= *unit) else {
        return format!("{bytes} bytes");
    };
    format!("{:.1} {name}", rounded(bytes as f64 / unit as f64 * 10.0) / 10.0)
}

/// A value may be anything, and long.
pub(crate) fn shortened(text: &str) -> String {
    text.chars().take(40).collect()
}
