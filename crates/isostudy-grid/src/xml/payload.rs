//! The numbers of an XML file: where they stand, and how they are packed.

use std::borrow::Cow;
use std::io::Read;

use flate2::read::ZlibDecoder;
use quick_xml::events::BytesStart;

use super::attribute;
use crate::error::{Problem, shortened};
use crate::numbers::{NumberKind, Numbers, words};

/// Where the numbers of an array stand.
#[derive(Clone)]
pub(super) enum Payload<'a> {
    /// As text.
    Words(&'a [u8]),
    /// As base64.
    Base64(&'a [u8]),
    /// From this byte on in the appended block.
    Appended(u64),
}

/// How a file packs its numbers.
#[derive(Default)]
pub(super) struct Layout<'a> {
    is_big_endian: bool,
    /// Whether counts of bytes have 64 bits, not 32.
    has_long_counts: bool,
    is_compressed: bool,
    appended: Option<&'a [u8]>,
    is_appended_base64: bool,
}

/// The text up to the appended block, with the tag that opens it, and the block.
///
/// # Errors
/// If the text is none.
pub(super) fn split(bytes: &[u8]) -> Result<(&str, Option<&[u8]>), Problem> {
    const TAG: &[u8] = b"<AppendedData";
    let mut brackets = bytes.iter().enumerate().filter(|(_, byte)| **byte == b'<');
    let opens = brackets.find(|(at, _)| bytes[*at..].starts_with(TAG)).map(|(at, _)| at);
    let end = |from: usize| bytes[from..].iter().position(|&byte| byte == b'>').map(|more| from + more + 1);
    let (head, appended) = match opens.and_then(end) {
        Some(end) => {
            let block = bytes[end..].iter().position(|&byte| byte == b'_').map(|at| &bytes[end + at + 1..]);
            (&bytes[..end], block)
        }
        None => (bytes, None),
    };
    let head = std::str::from_utf8(head).map_err(|error| {
        let line = 1 + head[..error.valid_up_to()].iter().filter(|&&byte| byte == b'\n').count();
        Problem::line(line, "this is no text: it is not UTF-8")
    })?;
    Ok((head, appended))
}

impl<'a> Layout<'a> {
    /// Reads what the root says, and whether the grid is curvilinear.
    pub(super) fn of_root(&mut self, tag: &BytesStart<'_>, line: usize) -> Result<bool, Problem> {
        let refused = |what: &str, value: &str, known: &str| {
            Problem::line(line, format!("{what}=\"{}\" is not supported; {known}", shortened(value)))
        };
        let is_structured = match attribute(tag, "type").as_deref() {
            Some("UnstructuredGrid") => false,
            Some("StructuredGrid") => true,
            other => {
                return Err(refused(
                    "type",
                    other.unwrap_or_default(),
                    "UnstructuredGrid and StructuredGrid are",
                ));
            }
        };
        self.is_big_endian = match attribute(tag, "byte_order").as_deref() {
            None | Some("LittleEndian") => false,
            Some("BigEndian") => true,
            Some(other) => return Err(refused("byte_order", other, "LittleEndian and BigEndian are")),
        };
        self.has_long_counts = match attribute(tag, "header_type").as_deref() {
            None | Some("UInt32") => false,
            Some("UInt64") => true,
            Some(other) => return Err(refused("header_type", other, "UInt32 and UInt64 are")),
        };
        self.is_compressed = match attribute(tag, "compressor").as_deref() {
            None | Some("") => false,
            Some("vtkZLibDataCompressor") => true,
            Some(other) => {
                return Err(refused(
                    "compressor",
                    other,
                    "vtkZLibDataCompressor is. ParaView saves with it, or with none",
                ));
            }
        };
        Ok(is_structured)
    }

    /// Reads what the tag of the appended block says.
    pub(super) fn of_appended(
        &mut self,
        tag: &BytesStart<'_>,
        line: usize,
        appended: Option<&'a [u8]>,
    ) -> Result<(), Problem> {
        self.is_appended_base64 = match attribute(tag, "encoding").as_deref() {
            Some("raw") => false,
            None | Some("base64") => true,
            Some(other) => {
                let other = shortened(other);
                return Err(Problem::line(
                    line,
                    format!("encoding=\"{other}\" is not supported; raw and base64 are"),
                ));
            }
        };
        self.appended = appended;
        match appended {
            Some(_) => Ok(()),
            None => Err(Problem::line(line, "the appended data do not begin with an underscore")),
        }
    }

    /// The numbers of a type, exactly `count`.
    ///
    /// # Errors
    /// What is wrong with them.
    pub(super) fn numbers(
        &self,
        payload: &Payload<'a>,
        kind: NumberKind,
        count: u64,
        limit: u64,
    ) -> Result<Numbers, String> {
        let wanted = |got: usize| format!("it has {got} numbers, and must have {count}");
        if let Payload::Words(text) = payload {
            let numbers = kind.of_words(words(text), count.saturating_add(1));
            let numbers = numbers.map_err(|(place, word)| {
                format!("number {place} is `{}`", shortened(&String::from_utf8_lossy(word)))
            })?;
            return match numbers.len() as u64 == count {
                true => Ok(numbers),
                false if numbers.len() as u64 > count => Err(format!("it has more than {count} numbers")),
                false => Err(wanted(numbers.len())),
            };
        }
        let bytes = count.checked_mul(kind.bytes() as u64).filter(|&bytes| bytes <= limit);
        let bytes = bytes.ok_or_else(|| {
            format!("its {count} numbers take more than the {limit} bytes of memory that there may be")
        })?;
        let mut stream = self.stream(payload)?;
        let data = match self.is_compressed {
            true => self.inflated(&mut stream, bytes)?,
            false => {
                let claimed = self.count(&mut stream)?;
                if claimed != bytes {
                    return Err(format!("it has {claimed} bytes, and must have {bytes}"));
                }
                stream.take(bytes)?.into_owned()
            }
        };
        Ok(kind.of_bytes(&data, self.is_big_endian))
    }

    fn stream(&self, payload: &Payload<'a>) -> Result<Stream<'a>, String> {
        match payload {
            Payload::Words(_) => Err("it is text".to_owned()),
            Payload::Base64(text) => Ok(Stream::base64(text)),
            Payload::Appended(offset) => {
                let all = self.appended.ok_or("the file has no appended data")?;
                let from = usize::try_from(*offset).ok().and_then(|offset| all.get(offset..));
                let from = from.ok_or_else(|| {
                    format!("it begins at byte {offset} of the appended data, which end at {}", all.len())
                })?;
                Ok(if self.is_appended_base64 { Stream::base64(from) } else { Stream::Raw(from) })
            }
        }
    }

    /// A count of bytes or blocks.
    fn count(&self, stream: &mut Stream<'_>) -> Result<u64, String> {
        let size = if self.has_long_counts { 8 } else { 4 };
        let mut bytes = stream.take(size)?.into_owned();
        if self.is_big_endian {
            bytes.reverse();
        }
        bytes.resize(8, 0);
        Ok(u64::from_le_bytes(bytes.try_into().expect("eight bytes")))
    }

    /// The bytes of blocks that are compressed each by itself; exactly so many.
    fn inflated(&self, stream: &mut Stream<'_>, bytes: u64) -> Result<Vec<u8>, String> {
        let [blocks, size, last] = [self.count(stream)?, self.count(stream)?, self.count(stream)?];
        let claimed = match last {
            0 => blocks.checked_mul(size),
            _ => blocks.saturating_sub(1).checked_mul(size).and_then(|whole| whole.checked_add(last)),
        };
        let claimed = if blocks == 0 { Some(0) } else { claimed };
        if claimed != Some(bytes) {
            let claimed = claimed.map_or_else(|| "more".to_owned(), |claimed| claimed.to_string());
            return Err(format!("its {blocks} blocks have {claimed} bytes, and must have {bytes}"));
        }
        // No more are read than there are: each has its own count in the file.
        let mut packed = Vec::new();
        for _ in 0..blocks {
            packed.push(self.count(stream)?);
        }
        let mut data = Vec::new();
        for (block, packed) in (1..).zip(packed) {
            let whole = if block == blocks && last > 0 { last } else { size };
            let from = stream.take(packed)?;
            let before = data.len() as u64;
            let read = ZlibDecoder::new(&*from).take(whole + 1).read_to_end(&mut data);
            read.map_err(|error| format!("block {block} of {blocks} is damaged: {error}"))?;
            let got = data.len() as u64 - before;
            if got != whole {
                return Err(format!(
                    "block {block} of {blocks} has {got} bytes or more, and must have {whole}"
                ));
            }
        }
        Ok(data)
    }
}

/// Bytes that are taken one after another.
enum Stream<'a> {
    Raw(&'a [u8]),
    /// Groups of four letters, and the bytes of the last group that are not taken yet. What is packed in two parts begins anew after
    /// padding, which one decoder for the whole would refuse.
    Base64 {
        letters: &'a [u8],
        left: Vec<u8>,
    },
}

impl<'a> Stream<'a> {
    fn base64(letters: &'a [u8]) -> Self {
        Self::Base64 { letters, left: Vec::new() }
    }

    /// The next bytes.
    fn take(&mut self, count: u64) -> Result<Cow<'a, [u8]>, String> {
        let short = |got: usize| format!("it ends after {got} of {count} bytes");
        match self {
            Self::Raw(bytes) => {
                let parts = usize::try_from(count).ok().and_then(|count| bytes.split_at_checked(count));
                let (taken, rest) = parts.ok_or_else(|| short(bytes.len()))?;
                *bytes = rest;
                Ok(Cow::Borrowed(taken))
            }
            Self::Base64 { letters, left } => {
                let mut taken = std::mem::take(left);
                while (taken.len() as u64) < count {
                    let Some(group) = group(letters) else { return Err(short(taken.len())) };
                    taken.extend_from_slice(&decoded(group)?);
                }
                *left = taken.split_off(count as usize);
                Ok(Cow::Owned(taken))
            }
        }
    }
}

/// The next four letters, spaces passed over.
fn group(letters: &mut &[u8]) -> Option<[u8; 4]> {
    if let Some((group, rest)) = letters.split_first_chunk::<4>()
        && group.iter().all(|byte| !byte.is_ascii_whitespace())
    {
        *letters = rest;
        return Some(*group);
    }
    let mut group = [0; 4];
    for letter in &mut group {
        let skipped = letters.iter().position(|byte| !byte.is_ascii_whitespace())?;
        *letter = letters[skipped];
        *letters = &letters[skipped + 1..];
    }
    Some(group)
}

/// The bytes of four letters, three but for padding.
fn decoded(group: [u8; 4]) -> Result<Bytes, String> {
    let padding = group.iter().rev().take_while(|&&letter| letter == b'=').count();
    let mut bits = 0u32;
    for &letter in &group[..4 - padding.min(2)] {
        let six = match letter {
            b'A'..=b'Z' => letter - b'A',
            b'a'..=b'z' => letter - b'a' + 26,
            b'0'..=b'9' => letter - b'0' + 52,
            b'+' => 62,
            b'/' => 63,
            _ => return Err(format!("`{}` is no base64", shortened(&String::from_utf8_lossy(&group)))),
        };
        bits = bits << 6 | u32::from(six);
    }
    bits <<= 6 * padding.min(2);
    let [_, a, b, c] = bits.to_be_bytes();
    Ok(Bytes { bytes: [a, b, c], count: 3 - padding.min(2) })
}

/// At most three bytes.
struct Bytes {
    bytes: [u8; 3],
    count: usize,
}

impl std::ops::Deref for Bytes {
    type Target = [u8];

    fn deref(&self) -> &[u8] {
        &self.bytes[..self.count]
    }
}
