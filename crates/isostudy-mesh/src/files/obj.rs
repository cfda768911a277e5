//! Wavefront OBJ: vertices, vertex normals and faces.

use std::fmt;
use std::io::{self, BufWriter, Read, Write};
use std::str::SplitAsciiWhitespace;

use glam::Vec3;

use crate::TriangleMesh;

/// What is wrong with an OBJ file; lines count from 1.
#[derive(Debug)]
#[non_exhaustive]
pub enum ObjError {
    /// The input cannot be read.
    Io(io::Error),
    /// A statement has too few values.
    TooFewValues {
        /// Where.
        line: usize,
        /// `v`, `vn` or `f`.
        keyword: &'static str,
        /// How many there are.
        got: usize,
        /// How many there have to be.
        need: usize,
    },
    /// Something that is not a finite number stands where a coordinate belongs.
    NotANumber {
        /// Where.
        line: usize,
        /// What stands there, cut after 40 characters.
        token: String,
    },
    /// A face corner is not `v`, `v/vt`, `v//vn` or `v/vt/vn` in whole numbers.
    NotACorner {
        /// Where.
        line: usize,
        /// What stands there, cut after 40 characters.
        token: String,
    },
    /// An index is 0 or points before the first or after the last element.
    IndexOutOfRange {
        /// Where.
        line: usize,
        /// The index as written.
        index: i64,
        /// How many elements there are (for a negative index: so far).
        count: usize,
        /// `vertices` or `normals`.
        element: &'static str,
    },
}

impl fmt::Display for ObjError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Io(error) => error.fmt(f),
            Self::TooFewValues { line, keyword, got, need } => {
                write!(f, "line {line}: `{keyword}` has {got} values, needs at least {need}")
            }
            Self::NotANumber { line, token } => {
                write!(f, "line {line}: `{token}` is not a finite single-precision number")
            }
            Self::NotACorner { line, token } => write!(f, "line {line}: `{token}` is not a face corner"),
            Self::IndexOutOfRange { line, index, count, element } => {
                write!(f, "line {line}: index {index} is out of range, there are {count} {element}")
            }
        }
    }
}

error_of!(ObjError { Io(io::Error) });

/// Reads the `v`, `vn` and `f` statements of an OBJ file; everything else is skipped.
///
/// Lines end in LF, CR LF or CR. Polygons become fans round their first corner. Indices may be negative, and may
/// run ahead of the vertices they mean. Colours or a weight after a vertex are ignored. Normals are kept, as
/// written, when every vertex that a face uses has exactly one; otherwise the mesh has none, because a vertex with
/// two normals would have to be two vertices.
///
/// # Errors
/// [`ObjError`], with the line. Never panics, and allocates in proportion to the input only.
pub fn read_obj(mut input: impl Read) -> Result<TriangleMesh, ObjError> {
    let mut bytes = Vec::new();
    input.read_to_end(&mut bytes)?;
    let mut reader = Reader::default();
    for (i, line) in lines(&bytes).enumerate() {
        reader.statement(i + 1, &String::from_utf8_lossy(line))?;
    }
    reader.finish()
}

/// Splits at LF, CR LF and CR alike, so that line numbers are those an editor shows.
fn lines(bytes: &[u8]) -> impl Iterator<Item = &[u8]> {
    let mut rest = Some(bytes);
    std::iter::from_fn(move || {
        let text = rest?;
        let Some(end) = text.iter().position(|b| matches!(b, b'\n' | b'\r')) else {
            rest = None;
            return Some(text);
        };
        let width = if text[end..].starts_with(b"\r\n") { 2 } else { 1 };
        rest = Some(&text[end + width..]);
        Some(&text[..end])
    })
}

/// A face corner as read: 0-based vertex and perhaps normal, not checked against the counts yet.
#[derive(Clone, Copy)]
struct Corner {
    vertex: u32,
    normal: Option<u32>,
}

#[derive(Default)]
struct Reader {
    positions: Vec<Vec3>,
    normals: Vec<Vec3>,
    triangles: Vec<[Corner; 3]>,
    /// The largest positive vertex and normal index so far, with its line: checked when the counts are known.
    furthest: [(i64, usize); 2],
}

impl Reader {
    fn statement(&mut self, line: usize, text: &str) -> Result<(), ObjError> {
        let text = text.split('#').next().unwrap_or_default();
        let mut words = text.split_ascii_whitespace();
        match words.next() {
            Some("v") => self.positions.push(vector(line, "v", words)?),
            Some("vn") => self.normals.push(vector(line, "vn", words)?),
            Some("f") => self.face(line, words)?,
            _ => {}
        }
        Ok(())
    }

    fn face(&mut self, line: usize, words: SplitAsciiWhitespace) -> Result<(), ObjError> {
        let corners = words.map(|word| self.corner(line, word)).collect::<Result<Vec<_>, _>>()?;
        if corners.len() < 3 {
            return Err(ObjError::TooFewValues { line, keyword: "f", got: corners.len(), need: 3 });
        }
        for pair in corners[1..].windows(2) {
            self.triangles.push([corners[0], pair[0], pair[1]]);
        }
        Ok(())
    }

    fn corner(&mut self, line: usize, word: &str) -> Result<Corner, ObjError> {
        let whole = |text: &str| {
            text.parse::<i64>().map_err(|_| ObjError::NotACorner { line, token: shortened(word) })
        };
        let mut parts = word.split('/');
        let vertex = whole(parts.next().unwrap_or_default())?;
        let texture = parts.next();
        if let Some(index) = texture.filter(|text| !text.is_empty()) {
            whole(index)?;
        }
        let normal = parts.next().filter(|text| !text.is_empty()).map(whole).transpose()?;
        if parts.next().is_some() {
            return Err(ObjError::NotACorner { line, token: shortened(word) });
        }
        Ok(Corner {
            vertex: self.resolve(line, vertex, 0)?,
            normal: normal.map(|index| self.resolve(line, index, 1)).transpose()?,
        })
    }

    /// From a 1-based or negative index to a 0-based one; `kind` 0 is vertices, 1 normals.
    fn resolve(&mut self, line: usize, index: i64, kind: usize) -> Result<u32, ObjError> {
        let count = [self.positions.len(), self.normals.len()][kind];
        let zero_based = if index > 0 { index - 1 } else { count as i64 + index };
        let resolved = u32::try_from(zero_based).ok().filter(|_| index != 0);
        let resolved = resolved.ok_or_else(|| out_of_range(line, index, count, kind))?;
        if index > self.furthest[kind].0 {
            self.furthest[kind] = (index, line);
        }
        Ok(resolved)
    }

    fn finish(self) -> Result<TriangleMesh, ObjError> {
        for (kind, count) in [self.positions.len(), self.normals.len()].into_iter().enumerate() {
            let (index, line) = self.furthest[kind];
            if index > count as i64 {
                return Err(out_of_range(line, index, count, kind));
            }
        }
        Ok(TriangleMesh {
            normals: self.one_normal_a_vertex().unwrap_or_default(),
            triangles: self.triangles.iter().map(|t| t.map(|corner| corner.vertex)).collect(),
            positions: self.positions,
        })
    }

    fn one_normal_a_vertex(&self) -> Option<Vec<Vec3>> {
        let mut chosen = vec![None; self.positions.len()];
        for corner in self.triangles.iter().flatten() {
            let normal = self.normals[corner.normal? as usize];
            let slot = &mut chosen[corner.vertex as usize];
            if slot.is_some_and(|other| other != normal) {
                return None;
            }
            *slot = Some(normal);
        }
        // A vertex that no face uses may have none.
        Some(chosen.into_iter().map(|normal| normal.unwrap_or(Vec3::ZERO)).collect())
            .filter(|_| !self.triangles.is_empty())
    }
}

fn vector(line: usize, keyword: &'static str, words: SplitAsciiWhitespace) -> Result<Vec3, ObjError> {
    let mut values = [0.0; 3];
    let mut got = 0;
    for (value, word) in values.iter_mut().zip(words) {
        *value = word
            .parse::<f32>()
            .ok()
            .filter(|v| v.is_finite())
            .ok_or_else(|| ObjError::NotANumber { line, token: shortened(word) })?;
        got += 1;
    }
    if got < 3 {
        return Err(ObjError::TooFewValues { line, keyword, got, need: 3 });
    }
    Ok(Vec3::from(values))
}

fn out_of_range(line: usize, index: i64, count: usize, kind: usize) -> ObjError {
    ObjError::IndexOutOfRange { line, index, count, element: ["vertices", "normals"][kind] }
}

fn shortened(token: &str) -> String {
    token.chars().take(40).collect()
}

/// Writes vertices, normals when there is one a vertex, and faces. Numbers are the shortest that read back to the
/// same bits.
///
/// # Errors
/// What the output reports.
pub fn write_obj(mesh: &TriangleMesh, output: impl Write) -> io::Result<()> {
    let mut out = BufWriter::new(output);
    for p in &mesh.positions {
        writeln!(out, "v {} {} {}", p.x, p.y, p.z)?;
    }
    let with_normals = !mesh.normals.is_empty() && mesh.normals.len() == mesh.positions.len();
    if with_normals {
        for n in &mesh.normals {
            writeln!(out, "vn {} {} {}", n.x, n.y, n.z)?;
        }
    }
    for t in &mesh.triangles {
        let [a, b, c] = t.map(|v| u64::from(v) + 1);
        if with_normals {
            writeln!(out, "f {a}//{a} {b}//{b} {c}//{c}")?;
        } else {
            writeln!(out, "f {a} {b} {c}")?;
        }
    }
    out.flush()
}
