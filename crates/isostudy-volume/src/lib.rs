//! Volumes: samples on a regular grid, and the files they come in.
//!
//! | ending | format | encodings |
//! |---|---|---|
//! | `.nrrd` | [NRRD] 1 to 5, data in the file | raw, gzip, text, hex |
//! | `.nhdr` | NRRD with the data in one file of its own | the same |
//! | `.mha`, `.mhd` | MetaImage, data in the file or in one of its own | raw, zlib, text |
//! | `.toml`, `.raw` | raw data with a [TOML header](RawHeader) | raw, gzip |
//!
//! Samples may be `i8`, `u8`, `i16`, `u16`, `i32`, `u32`, `f32` or `f64`, in either byte order; in memory they are `f32`
//! (32-bit whole numbers beyond 2^24 and doubles are rounded to the nearest; doubles that would be infinite are an error).
//!
//! ```
//! # let folder = tempfile::tempdir()?;
//! # let path = folder.path().join("block.nrrd");
//! let header = "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 3 2 2\nspacings: 1 1 2.5\nencoding: text\n";
//! std::fs::write(&path, format!("{header}\n0 10 20  1 11 21\n2 12 22  3 13 23\n"))?;
//!
//! let volume = isostudy_volume::read(&path, isostudy_volume::NO_LIMIT)?;
//! assert_eq!(volume.counts, [3, 2, 2]);
//! assert_eq!(volume.steps[2], [0.0, 0.0, 2.5]);
//! // The sample (2, 0, 1).
//! assert_eq!(volume.values[2 + 3 * (0 + 2 * 1)], 22.0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! A volume larger than memory stays in its file, and boxes of its samples are read: [`Unread::stored`]. For that it must be raw.
//!
//! # Guaranteed
//!
//! - Sample `(i, j, k)` is `values[i + counts[0] * (j + counts[1] * k)]` and lies at
//!   `origin + i * steps[0] + j * steps[1] + k * steps[2]`, as the file says: rotated, mirrored and sheared grids keep
//!   their steps.
//! - Bad input is a [`VolumeError`] that names the file and the line. Nothing panics. Memory grows with the data that is
//!   there, not with what a header claims, and never beyond the limit that is given.
//! - Data beyond what the header claims is an error, like data that is missing.
//! - A MetaImage key that would change values or places and is not supported is an error: a slope or an offset from
//!   elements to intensities other than 1 and 0, and a centre of rotation away from the origin where the axes are turned.
//!
//! # Not guaranteed
//!
//! - Coordinates are those of the file's own space. Nothing is converted between the conventions of medicine
//!   (left-posterior-superior, right-anterior-superior) or from left-handed spaces.
//! - A time series, which is an NRRD with a fourth axis, is read by [`open_series`] alone.
//! - Colour, vectors, lists of slices, `block` and 64-bit whole numbers, and
//!   bzip2 are refused.
//!
//! [NRRD]: https://teem.sourceforge.net/nrrd/format.html

mod data;
mod error;
mod header;
mod labels;
mod metaimage;
mod nrrd;
mod raw;
mod series;
mod stored;

use std::path::Path;

pub use data::SampleKind;
pub use error::{Problem, VolumeError};
pub use header::{Frame, Unread};
pub use labels::{LABELS_END, NotALabel};
pub use raw::RawHeader;
pub use series::{UnreadSeries, VolumeSeries, open_series};
pub use stored::Stored;

/// For [`read`], where memory need not be watched.
pub const NO_LIMIT: u64 = u64::MAX;

/// Bytes that a sample takes in memory, whatever its type in the file.
pub const SAMPLE_BYTES: u64 = size_of::<f32>() as u64;

/// Samples on a regular grid.
#[derive(Debug, Clone, PartialEq)]
pub struct Volume {
    /// How many samples there are along each axis of the grid; none is zero.
    pub counts: [usize; 3],
    /// Where the first sample lies.
    pub origin: [f64; 3],
    /// From one sample to the next, along each axis of the grid. Finite, and no two in one plane with the third.
    pub steps: [[f64; 3]; 3],
    /// The samples, the first axis fastest. They may be infinite or NaN where the file's are.
    pub values: Vec<f32>,
}

/// Reads a volume; the ending of the file's name tells the format (see the front page). Data files that a header names
/// are looked for from the header's folder.
///
/// `limit_bytes` bounds the memory for samples, four bytes each; a header that claims more is an error before anything
/// is read. While they are read memory grows with the data that is there and never beyond what the header claims, but for
/// a buffer, and data beyond the claim is an error as soon as it is met: compressed data cannot take more.
///
/// # Errors
/// [`VolumeError`], with the file, and the line of the header where one is to blame.
pub fn read(path: &Path, limit_bytes: u64) -> Result<Volume, VolumeError> {
    open(path)?.read(limit_bytes)
}

/// Reads the header of a volume and none of its samples, so that a caller can look at their number and refuse. The data
/// file is not opened, if it is one of its own.
///
/// # Errors
/// [`VolumeError`], with the file, and the line of the header where one is to blame.
pub fn open(path: &Path) -> Result<Unread, VolumeError> {
    let ending = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
    match ending.as_str() {
        "nrrd" | "nhdr" => nrrd::open(path),
        "mha" | "mhd" => metaimage::open(path),
        "toml" => raw::open(path),
        // The header stands beside the data.
        "raw" => raw::open(&path.with_extension("toml")),
        _ => Err(Problem::Ending.in_file(path)),
    }
}
