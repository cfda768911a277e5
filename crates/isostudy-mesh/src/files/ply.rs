//! The polygon file format (Turk 1994): ASCII and both binary orders in, little-endian binary out.

mod body;
mod header;

use std::fmt;
use std::io::{self, BufWriter, Read, Write};

use crate::TriangleMesh;

/// What is wrong with a PLY file. Lines count from 1, rows from 0, offsets in bytes from the start of the file.
#[derive(Debug)]
#[non_exhaustive]
pub enum PlyError {
    /// The input cannot be read.
    Io(io::Error),
    /// The header breaks the format, or asks for something that is not supported.
    Header {
        /// Where.
        line: usize,
        /// What is wrong there.
        reason: String,
    },
    /// An element lacks what its name promises.
    Lacks {
        /// `vertex` or `face`.
        element: &'static str,
        /// The property, with its type.
        what: &'static str,
    },
    /// The file ends before the header's counts are met.
    Truncated {
        /// The element that is cut off.
        element: String,
        /// Its row.
        row: u64,
        /// How many rows the header promises.
        count: u64,
        /// The length of the file.
        offset: usize,
    },
    /// An ASCII value is not a number, or not one of its type.
    NotANumber {
        /// The element it belongs to.
        element: String,
        /// Its row.
        row: u64,
        /// Where.
        offset: usize,
        /// What stands there, cut after 40 characters.
        token: String,
        /// The property's type.
        kind: &'static str,
    },
    /// A coordinate is NaN or infinite, or too large for single precision.
    NotFinite {
        /// The vertex.
        row: u64,
        /// Where.
        offset: usize,
        /// `x`, `y`, `z`, `nx`, `ny` or `nz`.
        property: &'static str,
        /// The value.
        value: f64,
    },
    /// A list length is negative.
    ListLength {
        /// The element.
        element: String,
        /// Its row.
        row: u64,
        /// Where.
        offset: usize,
        /// The length.
        length: f64,
    },
    /// A face has fewer than three corners.
    FewCorners {
        /// The face.
        row: u64,
        /// Where.
        offset: usize,
        /// How many corners it has.
        corners: usize,
    },
    /// A face refers to a vertex that does not exist.
    IndexOutOfRange {
        /// The face.
        row: u64,
        /// The index as written.
        index: f64,
        /// How many vertices there are.
        vertices: usize,
    },
}

impl fmt::Display for PlyError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Io(error) => error.fmt(f),
            Self::Header { line, reason } => write!(f, "header line {line}: {reason}"),
            Self::Lacks { element, what } => write!(f, "element `{element}` lacks {what}"),
            Self::Truncated { element, row, count, offset } => {
                write!(f, "{element} {row} of {count}: the file ends at byte {offset}")
            }
            Self::NotANumber { element, row, offset, token, kind } => {
                write!(f, "{element} {row}, byte {offset}: `{token}` is not a {kind}")
            }
            Self::NotFinite { row, offset, property, value } => write!(
                f,
                "vertex {row}, before byte {offset}: `{property}` is {value}, not a finite single-precision number"
            ),
            Self::ListLength { element, row, offset, length } => {
                write!(f, "{element} {row}, before byte {offset}: a list of {length} values")
            }
            Self::FewCorners { row, offset, corners } => {
                write!(f, "face {row}, before byte {offset}: {corners} corners")
            }
            Self::IndexOutOfRange { row, index, vertices } => {
                write!(f, "face {row}: vertex {index} of {vertices}")
            }
        }
    }
}

error_of!(PlyError { Io(io::Error) });

/// Reads the `vertex` and `face` elements of a PLY file; other elements and properties are skipped.
///
/// Scalars may have any type. Lists may have any integer types. Polygons become fans round their first corner.
/// Without a `face` element the mesh has no triangles. Normals are kept, as written, when `nx`, `ny` and `nz` are
/// there. Carriage returns count as white space in the header and in an ASCII body.
///
/// # Errors
/// [`PlyError`], with the place. Never panics, and allocates in proportion to the input only, whatever the
/// header claims.
pub fn read_ply(mut input: impl Read) -> Result<TriangleMesh, PlyError> {
    let mut bytes = Vec::new();
    input.read_to_end(&mut bytes)?;
    let (header, start) = header::parse(&bytes)?;
    body::read(&header, &bytes, start)
}

/// Writes binary little-endian PLY: `float` coordinates, `float` normals when there is one a vertex, and faces as
/// `list uchar uint vertex_indices`.
///
/// # Errors
/// What the output reports.
pub fn write_ply(mesh: &TriangleMesh, output: impl Write) -> io::Result<()> {
    let mut out = BufWriter::new(output);
    let with_normals = !mesh.normals.is_empty() && mesh.normals.len() == mesh.positions.len();
    let normals = if with_normals { "property float nx\nproperty float ny\nproperty float nz\n" } else { "" };
    write!(
        out,
        "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\nproperty float y\n\
         property float z\n{normals}element face {}\nproperty list uchar uint vertex_indices\nend_header\n",
        mesh.positions.len(),
        mesh.triangles.len()
    )?;
    for (v, p) in mesh.positions.iter().enumerate() {
        let normal = mesh.normals.get(v).filter(|_| with_normals);
        for value in p.to_array().into_iter().chain(normal.into_iter().flat_map(|n| n.to_array())) {
            out.write_all(&value.to_le_bytes())?;
        }
    }
    for triangle in &mesh.triangles {
        out.write_all(&[3])?;
        for v in triangle {
            out.write_all(&v.to_le_bytes())?;
        }
    }
    out.flush()
}
