//! The header: the format, and what every element's properties are.

use super::PlyError;

/// How the body is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Encoding {
    Ascii,
    LittleEndian,
    BigEndian,
}

/// The eight scalar types.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Scalar {
    fn named(name: &str) -> Option<Self> {
        Some(match name {
            "char" | "int8" => Self::I8,
            "uchar" | "uint8" => Self::U8,
            "short" | "int16" => Self::I16,
            "ushort" | "uint16" => Self::U16,
            "int" | "int32" => Self::I32,
            "uint" | "uint32" => Self::U32,
            "float" | "float32" => Self::F32,
            "double" | "float64" => Self::F64,
            _ => return None,
        })
    }

    pub(super) fn name(self) -> &'static str {
        match self {
            Self::I8 => "char",
            Self::U8 => "uchar",
            Self::I16 => "short",
            Self::U16 => "ushort",
            Self::I32 => "int",
            Self::U32 => "uint",
            Self::F32 => "float",
            Self::F64 => "double",
        }
    }

    pub(super) fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }

    pub(super) fn is_integer(self) -> bool {
        !matches!(self, Self::F32 | Self::F64)
    }
}

/// One property of an element.
#[derive(Debug)]
pub(super) struct Property {
    pub(super) name: String,
    /// The type of a list's length; `None` for a scalar.
    pub(super) length: Option<Scalar>,
    pub(super) value: Scalar,
}

/// One element: a table with `count` rows.
#[derive(Debug)]
pub(super) struct Element {
    pub(super) name: String,
    pub(super) count: u64,
    pub(super) properties: Vec<Property>,
}

#[derive(Debug)]
pub(super) struct Header {
    pub(super) encoding: Encoding,
    pub(super) elements: Vec<Element>,
}

/// Far longer than any header; keeps a binary file without line ends from being searched to its end.
const LINE_LIMIT: usize = 4096;

/// Parses the header and says where the body starts.
pub(super) fn parse(bytes: &[u8]) -> Result<(Header, usize), PlyError> {
    let mut encoding = None;
    let mut elements: Vec<Element> = Vec::new();
    let mut start = 0;
    for line in 1.. {
        let wrong = |reason: String| PlyError::Header { line, reason };
        let (text, next) = header_line(bytes, start).ok_or_else(|| {
            wrong(format!("no line end within {LINE_LIMIT} bytes, `end_header` is missing"))
        })?;
        start = next;
        let words: Vec<&str> = text.split_ascii_whitespace().collect();
        if line == 1 && words != ["ply"] {
            return Err(wrong("the file does not start with `ply`".into()));
        }
        match words[..] {
            ["ply"] if line == 1 => {}
            [] | ["comment" | "obj_info", ..] => {}
            ["format", name, "1.0"] if encoding.is_none() => {
                encoding = Some(match name {
                    "ascii" => Encoding::Ascii,
                    "binary_little_endian" => Encoding::LittleEndian,
                    "binary_big_endian" => Encoding::BigEndian,
                    _ => return Err(wrong(format!("unknown format `{}`", shortened(name)))),
                });
            }
            ["element", name, count] => {
                let count =
                    count.parse().map_err(|_| wrong(format!("`{}` is not a count", shortened(count))))?;
                if elements.iter().any(|element| element.name == name) {
                    return Err(wrong(format!("a second element `{}`", shortened(name))));
                }
                elements.push(Element { name: name.to_owned(), count, properties: Vec::new() });
            }
            ["property", ref spec @ ..] => {
                let property = property(spec).map_err(wrong)?;
                let element =
                    elements.last_mut().ok_or_else(|| wrong("a property before any element".into()))?;
                if element.properties.iter().any(|other| other.name == property.name) {
                    return Err(wrong(format!("a second property `{}`", shortened(&property.name))));
                }
                element.properties.push(property);
            }
            ["end_header"] => {
                let encoding = encoding.ok_or_else(|| wrong("no format line".into()))?;
                return Ok((Header { encoding, elements }, start));
            }
            _ => return Err(wrong(format!("cannot read `{}`", shortened(text.trim())))),
        }
    }
    unreachable!("the loop ends at `end_header` or at the end of the input")
}

/// The line at `start` and where the next one starts. A lone CR ends a line as well, but CR LF is one end: a body
/// may begin with the byte of a LF.
fn header_line(bytes: &[u8], start: usize) -> Option<(String, usize)> {
    let rest = bytes.get(start..)?;
    let window = &rest[..rest.len().min(LINE_LIMIT)];
    let end = window.iter().position(|b| matches!(b, b'\n' | b'\r'))?;
    let width = if rest[end..].starts_with(b"\r\n") { 2 } else { 1 };
    Some((String::from_utf8_lossy(&window[..end]).into_owned(), start + end + width))
}

fn property(spec: &[&str]) -> Result<Property, String> {
    let scalar =
        |name: &str| Scalar::named(name).ok_or_else(|| format!("unknown type `{}`", shortened(name)));
    match *spec {
        ["list", length, value, name] => {
            let (length, value) = (scalar(length)?, scalar(value)?);
            if !length.is_integer() {
                return Err(format!("list `{}` counts in {}s", shortened(name), length.name()));
            }
            Ok(Property { name: name.to_owned(), length: Some(length), value })
        }
        [value, name] => Ok(Property { name: name.to_owned(), length: None, value: scalar(value)? }),
        _ => Err("a property is `property TYPE NAME` or `property list TYPE TYPE NAME`".into()),
    }
}

/// A line may hold anything, and be long.
fn shortened(token: &str) -> String {
    token.chars().take(40).collect()
}
