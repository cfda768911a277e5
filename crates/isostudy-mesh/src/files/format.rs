//! Which file format a mesh is in.

use std::fmt;
use std::io::{self, Read, Write};

use super::glb::write_glb;
use super::obj::{ObjError, read_obj, write_obj};
use super::ply::{PlyError, read_ply, write_ply};
use super::stl::{StlError, read_stl, write_stl};
use crate::TriangleMesh;

/// A mesh file format.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum MeshFormat {
    /// Wavefront OBJ, see [`read_obj`].
    Obj,
    /// The polygon file format, see [`read_ply`].
    Ply,
    /// Stereolithography, see [`read_stl`].
    Stl,
    /// Binary glTF, see [`write_glb`]; not read.
    Glb,
}

/// Why a mesh cannot be read.
#[derive(Debug)]
#[non_exhaustive]
pub enum ReadError {
    /// See [`ObjError`].
    Obj(ObjError),
    /// See [`PlyError`].
    Ply(PlyError),
    /// See [`StlError`].
    Stl(StlError),
    /// Binary glTF, which is written and not read.
    GlbIsWritten,
}

impl fmt::Display for ReadError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Obj(error) => error.fmt(f),
            Self::Ply(error) => error.fmt(f),
            Self::Stl(error) => error.fmt(f),
            Self::GlbIsWritten => f.write_str("glTF is written, not read; .obj, .ply and .stl are"),
        }
    }
}

error_of!(ReadError { Obj(ObjError), Ply(PlyError), Stl(StlError) });

impl MeshFormat {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Obj, Self::Ply, Self::Stl, Self::Glb];

    /// The ending of file names, without the dot.
    pub fn extension(self) -> &'static str {
        match self {
            Self::Obj => "obj",
            Self::Ply => "ply",
            Self::Stl => "stl",
            Self::Glb => "glb",
        }
    }

    /// The format that file names with this ending are in, in any case.
    pub fn from_extension(extension: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|format| extension.eq_ignore_ascii_case(format.extension()))
    }

    /// Reads a mesh in this format.
    ///
    /// # Errors
    /// [`ReadError`], with the place in the file.
    pub fn read(self, input: impl Read) -> Result<TriangleMesh, ReadError> {
        Ok(match self {
            Self::Obj => read_obj(input)?,
            Self::Ply => read_ply(input)?,
            Self::Stl => read_stl(input)?,
            Self::Glb => return Err(ReadError::GlbIsWritten),
        })
    }

    /// Writes a mesh in this format.
    ///
    /// # Errors
    /// What the output reports, or the format cannot say.
    pub fn write(self, mesh: &TriangleMesh, output: impl Write) -> io::Result<()> {
        match self {
            Self::Obj => write_obj(mesh, output),
            Self::Ply => write_ply(mesh, output),
            Self::Stl => write_stl(mesh, output),
            Self::Glb => write_glb(mesh, output),
        }
    }
}
