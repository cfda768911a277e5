//! Points with normals, and their files.

mod obj;
mod xyz;

use std::fmt;
use std::io::{self, Read};

use glam::Vec3;
use isostudy_mesh::{ObjError, PlyError, read_ply};
use thiserror::Error;

/// Points of a surface, and which way it faces at each.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct PointCloud {
    /// Where they are.
    pub positions: Vec<Vec3>,
    /// Of any length; empty, or one a point.
    pub normals: Vec<Vec3>,
    /// Of a text, the line of each point, from 1; empty for other files.
    pub lines: Vec<u32>,
}

impl PointCloud {
    /// Where a point stands in its file: `line 7`, or `vertex 6`, which counts from 0 as errors of PLY do.
    pub fn place(&self, point: usize) -> Place {
        match self.lines.get(point) {
            Some(&line) => Place::Line(line),
            None => Place::Vertex(point),
        }
    }
}

/// Where a point stands in its file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Place {
    /// A line of a text, from 1.
    Line(u32),
    /// A vertex, from 0.
    Vertex(usize),
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Line(line) => write!(f, "line {line}"),
            Self::Vertex(vertex) => write!(f, "vertex {vertex}"),
        }
    }
}

/// A format of files that hold points.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum PointFormat {
    /// The vertices of a polygon file, with `nx`, `ny` and `nz`.
    Ply,
    /// A line of text for each point: `x y z nx ny nz`.
    Xyz,
    /// The `v` and `vn` lines of Wavefront OBJ.
    Obj,
}

impl PointFormat {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Ply, Self::Xyz, Self::Obj];

    /// The ending of file names, without the dot.
    pub fn extension(self) -> &'static str {
        match self {
            Self::Ply => "ply",
            Self::Xyz => "xyz",
            Self::Obj => "obj",
        }
    }

    /// The format that file names with this ending are in, in any case.
    pub fn from_extension(extension: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|format| extension.eq_ignore_ascii_case(format.extension()))
    }
}

/// Why points cannot be read. Lines count from 1.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum PointsError {
    /// The input cannot be read.
    #[error("{0}")]
    Io(#[from] io::Error),
    /// See [`PlyError`].
    #[error("{0}")]
    Ply(#[from] PlyError),
    /// See [`ObjError`].
    #[error("{0}")]
    Obj(#[from] ObjError),
    /// A value is no finite number in single precision.
    #[error("line {line}: `{token}` is not a finite single-precision number")]
    NotANumber {
        /// Where.
        line: usize,
        /// What stands there, cut after 40 characters.
        token: String,
    },
    /// A line has neither a point nor a point with its normal.
    #[error("line {line}: {got} values; x y z or x y z nx ny nz are wanted")]
    Values {
        /// Where.
        line: usize,
        /// How many values it has.
        got: usize,
    },
    /// Some points have normals and others none.
    #[error("line {line}: {got} values, where the points before have {before}")]
    Uneven {
        /// Where.
        line: usize,
        /// How many values it has.
        got: usize,
        /// How many those before have.
        before: usize,
    },
    /// There is not one normal for each point.
    #[error("{normals} normals for {points} points; without faces, line by line they belong together")]
    Normals {
        /// How many there are.
        normals: usize,
        /// How many points there are.
        points: usize,
    },
}

/// Reads points, and their normals where the file has them, in single precision.
///
/// - PLY: the element `vertex`. Faces are checked and left out.
/// - XYZ: three or six numbers a line, with white space, commas or semicolons between them. What follows the sixth is left out. Empty
///   lines are passed over, and so are lines that begin with `#` or `//`.
/// - OBJ: with faces, normals are those of a mesh. Without, the first `vn` belongs to the first `v`, and so on.
///
/// # Errors
/// [`PointsError`], with the place. Never panics, and allocates in proportion to the input only.
pub fn read_points(format: PointFormat, mut input: impl Read) -> Result<PointCloud, PointsError> {
    if format == PointFormat::Ply {
        let mesh = read_ply(input)?;
        return Ok(PointCloud { positions: mesh.positions, normals: mesh.normals, lines: Vec::new() });
    }
    let mut bytes = Vec::new();
    input.read_to_end(&mut bytes)?;
    match format {
        PointFormat::Obj => obj::read(&bytes),
        _ => xyz::read(&bytes),
    }
}

/// The text of a file with one end for all its lines: LF, CR LF and CR are ends, as editors count them.
fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).replace("\r\n", "\n").replace('\r', "\n")
}

/// A finite number in single precision.
fn number(line: usize, word: &str) -> Result<f32, PointsError> {
    let value = word.parse::<f32>().ok().filter(|value| value.is_finite());
    value.ok_or_else(|| PointsError::NotANumber { line, token: word.chars().take(40).collect() })
}
