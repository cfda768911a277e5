//! Which file format a mesh is in.

use std::io::{self, Read, Write};

use thiserror::Error;

use crate::{
    ObjError, PlyError, StlError, TriangleMesh, read_obj, read_ply, read_stl, write_glb, write_obj,
    write_ply, write_stl,
};

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
#[derive(Debug, Error)]
pub enum ReadError {
    /// See [`ObjError`].
    #[error(transparent)]
    Obj(#[from] ObjError),
    /// See [`PlyError`].
    #[error(transparent)]
    Ply(#[from] PlyError),
    /// See [`StlError`].
    #[error(transparent)]
    Stl(#[from] StlError),
    /// Binary glTF, which is written and not read.
    #[error("glTF is written, not read; .obj, .ply and .stl are")]
    GlbIsWritten,
}

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
