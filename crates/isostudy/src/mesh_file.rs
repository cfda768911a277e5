//! Meshes in files: the format is what the name ends with.

use crate::input;
use anyhow::{Context, Result};
use isostudy_mesh::{MeshFormat, TriangleMesh};
use std::path::Path;

const READ: [MeshFormat; 3] = [MeshFormat::Obj, MeshFormat::Ply, MeshFormat::Stl];

/// The format to read a file in.
///
/// # Errors
/// If none that is read ends so.
pub(crate) fn format_to_read(path: &Path) -> Result<MeshFormat> {
    format_among(path, &READ)
}

/// The format to write a file in.
///
/// # Errors
/// If none that is written ends so.
pub(crate) fn format_to_write(path: &Path) -> Result<MeshFormat> {
    format_among(path, &MeshFormat::ALL)
}

fn format_among(path: &Path, known: &[MeshFormat]) -> Result<MeshFormat> {
    let extension = path.extension().unwrap_or_default().to_string_lossy();
    let endings = || known.iter().map(|f| format!(".{}", f.extension())).collect::<Vec<_>>().join(", ");
    MeshFormat::from_extension(&extension)
        .filter(|format| known.contains(format))
        .with_context(|| format!("known endings are {}", endings()))
}

/// The mesh in a file.
///
/// # Errors
/// If there is none that can be read. The path is named.
pub(crate) fn read(path: &Path) -> Result<TriangleMesh> {
    let named = || path.display().to_string();
    let format = format_to_read(path).with_context(named)?;
    format.read(input::open(path)?).with_context(named)
}
