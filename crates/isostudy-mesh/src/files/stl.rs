//! Stereolithography (3D Systems 1988): text and binary in, binary out.

mod text;

use std::fmt;
use std::io::{self, BufWriter, Read, Write};

use glam::Vec3;

use crate::{TriangleMesh, weld};

/// What stands before the number of triangles: anything.
const TITLE_BYTES: usize = 80;
/// Where the first triangle of a binary file starts.
const HEADER_BYTES: usize = TITLE_BYTES + 4;
/// A normal, three corners, and two bytes that are nobody's.
const TRIANGLE_BYTES: usize = 50;

/// What is wrong with an STL file. Lines count from 1, triangles from 0.
#[derive(Debug)]
#[non_exhaustive]
pub enum StlError {
    /// The input cannot be read.
    Io(io::Error),
    /// The file is neither text nor as long as its number of triangles says.
    Length {
        /// The length of the file.
        bytes: usize,
        /// What the four bytes after the title say.
        triangles: u32,
        /// The length that a file of so many triangles has.
        wanted: u64,
    },
    /// The file is shorter than the shortest.
    TooShort {
        /// The length of the file.
        bytes: usize,
    },
    /// A binary coordinate is NaN or infinite.
    NotFinite {
        /// The triangle.
        triangle: usize,
        /// 0, 1 or 2.
        corner: usize,
        /// `x`, `y` or `z`.
        axis: char,
        /// The value.
        value: f32,
    },
    /// Text that does not follow the format.
    Unexpected {
        /// Where.
        line: usize,
        /// What stands there, cut after 40 characters; empty at the end of the file.
        token: String,
        /// What belongs there.
        wanted: &'static str,
    },
    /// More corners than a 32-bit index can name.
    TooManyVertices,
}

impl fmt::Display for StlError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Io(error) => error.fmt(f),
            Self::Length { bytes, triangles, wanted } => write!(
                f,
                "{bytes} bytes, but a binary STL file of {triangles} triangles has {wanted}; and as text it lacks `solid` or `facet`"
            ),
            Self::TooShort { bytes } => write!(
                f,
                "{bytes} bytes; the shortest binary STL file has 84, and as text it lacks `solid` or `facet`"
            ),
            Self::NotFinite { triangle, corner, axis, value } => {
                write!(f, "triangle {triangle}, corner {corner}: `{axis}` is {value}, not a finite number")
            }
            Self::Unexpected { line, token, wanted } => {
                write!(f, "line {line}: `{token}` where {wanted} belongs")
            }
            Self::TooManyVertices => write!(f, "more than {} different corners", u32::MAX),
        }
    }
}

error_of!(StlError { Io(io::Error) });

/// Reads an STL file, text or binary.
///
/// A file is binary if it is as long as its number of triangles says, whatever its title; otherwise it is text if it
/// starts with `solid` and has a `facet`. STL has triangles without vertices: corners with the same coordinates become
/// one vertex, numbered as they come ([`weld`]). There is no tolerance, which would join surfaces that pass close to
/// each other. A facet's normal is not read: the order of its corners says where outside is. Triangles with two
/// corners in one place are kept.
///
/// # Errors
/// [`StlError`], with the place. Never panics, and allocates in proportion to the input only, whatever the header
/// claims.
pub fn read_stl(mut input: impl Read) -> Result<TriangleMesh, StlError> {
    let mut bytes = Vec::new();
    input.read_to_end(&mut bytes)?;
    let claimed = bytes.get(TITLE_BYTES..HEADER_BYTES).map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]]));
    let wanted = claimed.map(|n| HEADER_BYTES as u64 + u64::from(n) * TRIANGLE_BYTES as u64);
    let corners = if wanted == Some(bytes.len() as u64) {
        binary(&bytes[HEADER_BYTES..])?
    } else if text::is_text(&bytes) {
        text::read(&bytes)?
    } else {
        return Err(match (claimed, wanted) {
            (Some(triangles), Some(wanted)) => StlError::Length { bytes: bytes.len(), triangles, wanted },
            _ => StlError::TooShort { bytes: bytes.len() },
        });
    };
    let count = u32::try_from(corners.len()).map_err(|_| StlError::TooManyVertices)?;
    let triangles = (0..count / 3).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
    Ok(weld(&TriangleMesh { positions: corners, triangles, ..TriangleMesh::default() }))
}

fn binary(body: &[u8]) -> Result<Vec<Vec3>, StlError> {
    let mut corners = Vec::with_capacity(body.len() / TRIANGLE_BYTES * 3);
    for (triangle, row) in body.chunks_exact(TRIANGLE_BYTES).enumerate() {
        for corner in 0..3 {
            let mut p = [0.0; 3];
            for (k, axis) in ['x', 'y', 'z'].into_iter().enumerate() {
                let at = 12 * (corner + 1) + 4 * k;
                let value = f32::from_le_bytes([row[at], row[at + 1], row[at + 2], row[at + 3]]);
                if !value.is_finite() {
                    return Err(StlError::NotFinite { triangle, corner, axis, value });
                }
                p[k] = value;
            }
            corners.push(Vec3::from(p));
        }
    }
    Ok(corners)
}

/// Writes binary STL: for every triangle its unit normal (zero where it has no area) and its corners. Vertex numbers
/// and normals are lost; corners keep their bits.
///
/// # Errors
/// What the output reports, and [`io::ErrorKind::InvalidInput`] for more than 2^32 - 1 triangles.
///
/// # Panics
/// If a triangle's index is out of range.
pub fn write_stl(mesh: &TriangleMesh, output: impl Write) -> io::Result<()> {
    let too_many = |_| io::Error::new(io::ErrorKind::InvalidInput, "more triangles than STL can count");
    let count = u32::try_from(mesh.triangles.len()).map_err(too_many)?;
    let mut out = BufWriter::new(output);
    // Not `solid`, by which many programs know text.
    let mut title = [b' '; TITLE_BYTES];
    title[..10].copy_from_slice(b"binary STL");
    out.write_all(&title)?;
    out.write_all(&count.to_le_bytes())?;
    for t in 0..mesh.triangles.len() {
        let [a, b, c] = mesh.corners(t);
        let normal = (b - a).as_dvec3().cross((c - a).as_dvec3()).normalize_or_zero().as_vec3();
        for value in [normal, a, b, c].iter().flat_map(|v| v.to_array()) {
            out.write_all(&value.to_le_bytes())?;
        }
        out.write_all(&[0; 2])?;
    }
    out.flush()
}
