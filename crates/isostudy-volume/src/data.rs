//! Samples from bytes: types, byte orders, encodings.

use std::collections::TryReserveError;
use std::fs::File;
use std::io::{self, BufRead, BufReader, Read, Seek, SeekFrom};
use std::path::Path;

use flate2::bufread::{MultiGzDecoder, ZlibDecoder};
use isostudy_foreign::FileProblem;
use serde::Deserialize;

use crate::error::{Problem, shortened};

/// The type of a sample in a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum SampleKind {
    /// Signed, one byte.
    I8,
    /// Unsigned, one byte.
    U8,
    /// Signed, two bytes.
    I16,
    /// Unsigned, two bytes.
    U16,
    /// Signed, four bytes.
    I32,
    /// Unsigned, four bytes.
    U32,
    /// Single precision.
    F32,
    /// Double precision.
    F64,
}

impl SampleKind {
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::I8 => "i8",
            Self::U8 => "u8",
            Self::I16 => "i16",
            Self::U16 => "u16",
            Self::I32 => "i32",
            Self::U32 => "u32",
            Self::F32 => "f32",
            Self::F64 => "f64",
        }
    }

    pub(crate) fn bytes(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }

    fn parse(self, token: &str) -> Option<f32> {
        match self {
            Self::I8 => token.parse::<i8>().ok().map(f32::from),
            Self::U8 => token.parse::<u8>().ok().map(f32::from),
            Self::I16 => token.parse::<i16>().ok().map(f32::from),
            Self::U16 => token.parse::<u16>().ok().map(f32::from),
            Self::I32 => token.parse::<i32>().ok().map(|v| v as f32),
            Self::U32 => token.parse::<u32>().ok().map(|v| v as f32),
            Self::F32 | Self::F64 => token.parse::<f32>().ok(),
        }
    }
}

/// How samples are written down.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Encoding {
    Raw,
    Gzip,
    Zlib,
    Text,
    Hex,
}

impl Encoding {
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Raw => "raw",
            Self::Gzip => "gzip",
            Self::Zlib => "zlib",
            Self::Text => "text",
            Self::Hex => "hex",
        }
    }
}

/// What stands before the samples.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(crate) struct Skip {
    /// Lines, before anything is decoded.
    pub(crate) lines: u64,
    /// Bytes after that and after decompression; `None`: all but the samples.
    pub(crate) bytes: Option<u64>,
}

#[derive(Debug, Clone, Copy)]
pub(crate) struct Layout {
    pub(crate) kind: SampleKind,
    pub(crate) big_endian: bool,
    pub(crate) encoding: Encoding,
    pub(crate) skip: Skip,
    pub(crate) samples: u64,
}

/// Opens a regular file. A pipe could be waited for, and a device read, for ever.
pub(crate) fn open(path: &Path) -> Result<BufReader<File>, Problem> {
    let file = isostudy_foreign::open(path).map_err(|error| match error.problem {
        FileProblem::NotAFile(_) => Problem::NotAFile,
        _ => Problem::Io(error.into()),
    })?;
    Ok(BufReader::with_capacity(1 << 16, file))
}

/// Reads the samples, from the data's first byte.
pub(crate) fn read(mut input: impl BufRead + Seek, layout: &Layout) -> Result<Vec<f32>, Problem> {
    skip_lines(&mut input, layout)?;
    match layout.encoding {
        Encoding::Raw => {
            if layout.skip.bytes.is_none() {
                skip_to_last(&mut input, layout)?;
            }
            binary(input, layout)
        }
        Encoding::Gzip => binary(MultiGzDecoder::new(input), layout),
        Encoding::Zlib => binary(ZlibDecoder::new(input), layout),
        Encoding::Hex => binary(HexDecoder(input), layout),
        Encoding::Text => text(input, layout),
    }
}

/// Leaves the input after the lines that stand before the data.
pub(crate) fn skip_lines(input: &mut impl BufRead, layout: &Layout) -> Result<(), Problem> {
    for _ in 0..layout.skip.lines {
        if input.skip_until(b'\n')? == 0 {
            return Err(Problem::Truncated { got: 0, wanted: layout.samples });
        }
    }
    Ok(())
}

/// Makes values of the bytes of as many samples. Returns how many are finite in the file, and beyond single precision.
pub(crate) fn decode(layout: &Layout, bytes: &[u8], values: &mut [f32]) -> u64 {
    let big = layout.big_endian;
    let mut too_large = 0;
    match layout.kind {
        SampleKind::I8 => each(big, bytes, values, |b| f32::from(i8::from_le_bytes(b))),
        SampleKind::U8 => each(big, bytes, values, |b| f32::from(u8::from_le_bytes(b))),
        SampleKind::I16 => each(big, bytes, values, |b| f32::from(i16::from_le_bytes(b))),
        SampleKind::U16 => each(big, bytes, values, |b| f32::from(u16::from_le_bytes(b))),
        SampleKind::I32 => each(big, bytes, values, |b| i32::from_le_bytes(b) as f32),
        SampleKind::U32 => each(big, bytes, values, |b| u32::from_le_bytes(b) as f32),
        SampleKind::F32 => each(big, bytes, values, f32::from_le_bytes),
        SampleKind::F64 => each(big, bytes, values, |b| {
            let sample = f64::from_le_bytes(b);
            let value = sample as f32;
            too_large += u64::from(sample.is_finite() && value.is_infinite());
            value
        }),
    }
    too_large
}

/// `value` of each sample's bytes, the lowest first.
fn each<const WIDTH: usize>(
    big_endian: bool,
    bytes: &[u8],
    values: &mut [f32],
    mut value: impl FnMut([u8; WIDTH]) -> f32,
) {
    for (to, &sample) in values.iter_mut().zip(bytes.as_chunks().0) {
        let mut sample: [u8; WIDTH] = sample;
        if big_endian {
            sample.reverse();
        }
        *to = value(sample);
    }
}

/// How many bytes are decoded at a time; a multiple of every sample's size.
const BLOCK: usize = 1 << 16;

fn binary(mut input: impl Read, layout: &Layout) -> Result<Vec<f32>, Problem> {
    let width = layout.kind.bytes();
    // Sizes were checked against the limit, hence no overflow.
    let wanted = layout.samples * width as u64;
    if let Some(bytes) = layout.skip.bytes {
        io::copy(&mut (&mut input).take(bytes), &mut io::sink())?;
    }
    let input: &mut dyn Read = &mut input;
    let mut values = Vec::new();
    let mut block = vec![0; BLOCK];
    let mut too_large = 0;
    let mut left = wanted;
    while left > 0 {
        let asked = left.min(BLOCK as u64) as usize;
        let got = fill(input, &mut block[..asked])?;
        let (before, samples) = (values.len(), got / width);
        reserve(&mut values, samples, layout.samples)?;
        values.resize(before + samples, 0.0);
        too_large += decode(layout, &block[..got], &mut values[before..]);
        if got < asked {
            return Err(Problem::Truncated { got: values.len() as u64, wanted: layout.samples });
        }
        left -= got as u64;
    }
    if fill(input, &mut block[..1])? > 0 {
        return Err(Problem::Excess { wanted: layout.samples });
    }
    none_too_large(too_large, values)
}

/// The values, if none was finite in the file only.
fn none_too_large(count: u64, values: Vec<f32>) -> Result<Vec<f32>, Problem> {
    if count == 0 { Ok(values) } else { Err(Problem::TooLarge { count, samples: values.len() as u64 }) }
}

/// Grows with what is there, since what a header claims may be a lie; and no farther than to what it claims, since that
/// was held against the limit.
fn reserve(values: &mut Vec<f32>, more: usize, samples: u64) -> Result<(), Problem> {
    let needed = values.len() + more;
    if needed <= values.capacity() {
        return Ok(());
    }
    let claimed = usize::try_from(samples).unwrap_or(usize::MAX);
    let room = values.capacity().saturating_mul(2).min(claimed).max(needed);
    let more = room - values.len();
    values.try_reserve_exact(more).map_err(|_: TryReserveError| Problem::OutOfMemory { samples })
}

/// Leaves the input where its last samples start, or where it is if it has fewer.
fn skip_to_last(input: &mut (impl Read + Seek), layout: &Layout) -> io::Result<()> {
    let here = input.stream_position()?;
    let end = input.seek(SeekFrom::End(0))?;
    let wanted = layout.samples * layout.kind.bytes() as u64;
    input.seek(SeekFrom::Start(here.max(end.saturating_sub(wanted))))?;
    Ok(())
}

/// Reads until the buffer is full or the input ends.
fn fill(input: &mut dyn Read, buffer: &mut [u8]) -> io::Result<usize> {
    let mut got = 0;
    while got < buffer.len() {
        match input.read(&mut buffer[got..]) {
            Ok(0) => break,
            Ok(n) => got += n,
            Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
            Err(error) => return Err(error),
        }
    }
    Ok(got)
}

/// Bytes as two digits each, with white space anywhere.
struct HexDecoder<R>(R);

impl<R: BufRead> HexDecoder<R> {
    fn digit(&mut self) -> io::Result<Option<u8>> {
        loop {
            let Some(&byte) = self.0.fill_buf()?.first() else { return Ok(None) };
            self.0.consume(1);
            if byte.is_ascii_whitespace() {
                continue;
            }
            let wrong = || io::Error::new(io::ErrorKind::InvalidData, format!("byte {byte} is no hex digit"));
            return Ok(Some(char::from(byte).to_digit(16).ok_or_else(wrong)? as u8));
        }
    }
}

impl<R: BufRead> Read for HexDecoder<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        for (i, byte) in buffer.iter_mut().enumerate() {
            let (Some(high), Some(low)) = (self.digit()?, self.digit()?) else { return Ok(i) };
            *byte = high << 4 | low;
        }
        Ok(buffer.len())
    }
}

/// A number is never longer; what is, is not a number.
const TOKEN_LIMIT: usize = 400;

fn text(mut input: impl BufRead, layout: &Layout) -> Result<Vec<f32>, Problem> {
    let mut values = Vec::new();
    let mut too_large = 0;
    let mut token = Vec::new();
    loop {
        let byte = input.fill_buf()?.first().copied();
        input.consume(usize::from(byte.is_some()));
        let is_separator = byte.is_none_or(|b| b.is_ascii_whitespace() || b == b',');
        if !is_separator && token.len() < TOKEN_LIMIT {
            token.extend(byte);
            continue;
        }
        if !token.is_empty() {
            if values.len() as u64 == layout.samples {
                return Err(Problem::Excess { wanted: layout.samples });
            }
            let word = String::from_utf8_lossy(&token);
            let value = layout.kind.parse(&word).filter(|_| is_separator).ok_or_else(|| {
                let sample = values.len() as u64;
                Problem::NotANumber { sample, token: shortened(&word), kind: layout.kind.name() }
            })?;
            // Infinity is written in letters.
            too_large += u64::from(value.is_infinite() && word.contains(|c: char| c.is_ascii_digit()));
            reserve(&mut values, 1, layout.samples)?;
            values.push(value);
            token.clear();
        }
        if byte.is_none() {
            let got = values.len() as u64;
            let is_whole = got == layout.samples;
            return if is_whole {
                none_too_large(too_large, values)
            } else {
                Err(Problem::Truncated { got, wanted: layout.samples })
            };
        }
    }
}
