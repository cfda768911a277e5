//! Samples without a header, and a TOML file that says what they are.

use std::io::Read;
use std::path::{Path, PathBuf};

use serde::Deserialize;

use crate::data::{self, Encoding, Layout, SampleKind, Skip};
use crate::error::{Problem, VolumeError};
use crate::header::{Data, Frame, Unread, sample_count};

/// Longer than any header of this kind.
const HEADER_LIMIT: u64 = 1 << 20;

/// The keys of the TOML file, all but `size` and `type` optional:
///
/// ```toml
/// file = "head.raw"        # the data, from this file's folder; by default its name with .raw
/// size = [256, 256, 113]   # samples along each axis, the fastest first
/// type = "u16"             # i8, u8, i16, u16, i32, u32, f32, f64
/// endian = "big"           # or "little", the default
/// encoding = "gzip"        # or "raw", the default
/// skip_bytes = 0           # before the samples, after decompression
/// spacing = [1.0, 1.0, 1.5]
/// origin = [0.0, 0.0, 0.0] # where the first sample lies
/// ```
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RawHeader {
    /// The data file.
    pub file: Option<PathBuf>,
    /// Samples along each axis.
    pub size: [u64; 3],
    /// The type of a sample.
    #[serde(rename = "type")]
    pub kind: SampleKind,
    /// The byte order.
    #[serde(default)]
    pub endian: RawEndian,
    /// Whether the data is compressed.
    #[serde(default)]
    pub encoding: RawEncoding,
    /// Bytes before the samples, after decompression.
    #[serde(default)]
    pub skip_bytes: u64,
    /// From sample to sample; negative where an axis runs backwards.
    pub spacing: Option<[f64; 3]>,
    /// Where the first sample lies.
    pub origin: Option<[f64; 3]>,
}

/// The byte order of samples.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum RawEndian {
    /// The lowest byte first.
    #[default]
    Little,
    /// The highest byte first.
    Big,
}

/// How samples are written down.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum RawEncoding {
    /// One after the other.
    #[default]
    Raw,
    /// The same, compressed.
    Gzip,
}

pub(crate) fn open(path: &Path) -> Result<Unread, VolumeError> {
    let here = |problem: Problem| problem.in_file(path);
    let (header, frame, layout) = meaning(path).map_err(here)?;
    let file = header
        .file
        .unwrap_or_else(|| PathBuf::from(path.with_extension("raw").file_name().unwrap_or_default()));
    Ok(Unread::new(frame, layout, path, Data::In(file)))
}

fn meaning(path: &Path) -> Result<(RawHeader, Frame, Layout), Problem> {
    let mut text = String::new();
    data::open(path)?.take(HEADER_LIMIT).read_to_string(&mut text)?;
    if text.len() as u64 == HEADER_LIMIT {
        return Err(Problem::HeaderTooLong { limit: HEADER_LIMIT as usize });
    }
    let header: RawHeader = toml::from_str(&text)?;
    let samples = sample_count(&header.size)?;
    let counts = header.size.map(|n| n as usize);
    let (origin, spacing) = (header.origin.unwrap_or_default(), header.spacing.unwrap_or([1.0; 3]));
    let frame = Frame::diagonal(counts, origin, spacing);
    frame.check()?;
    let encoding = match header.encoding {
        RawEncoding::Raw => Encoding::Raw,
        RawEncoding::Gzip => Encoding::Gzip,
    };
    let skip = Skip { lines: 0, bytes: Some(header.skip_bytes) };
    let (kind, big_endian) = (header.kind, header.endian == RawEndian::Big);
    Ok((header, frame, Layout { kind, big_endian, encoding, skip, samples }))
}
