//! The mesh that a program wrote: read, and checked against what it told and where its samples lie.

use std::fs;
use std::io::Read;
use std::path::Path;

use isostudy_mesh::{MeshFormat, TriangleMesh};

use crate::answer::Done;
use crate::error::Problem;
use crate::request::Request;

/// Makes room for the answer's mesh, so that none of an earlier request is taken for it.
pub(crate) fn clear(path: &Path) -> Result<(), Problem> {
    match fs::remove_file(path) {
        Err(error) if error.kind() != std::io::ErrorKind::NotFound => Err(Problem::io(path)(error)),
        _ => Ok(()),
    }
}

/// Reads and checks it. No file is larger than `limit_bytes`: reading is done in this process.
pub(crate) fn read(
    path: &Path,
    request: &Request<'_>,
    done: &Done,
    limit_bytes: Option<u64>,
) -> Result<TriangleMesh, Problem> {
    let wrong = |reason: String| Problem::Mesh { path: path.to_owned(), reason };
    // What it wrote is in its folder, and not where a link leads.
    let limit = limit_bytes.unwrap_or(u64::MAX);
    let size = match fs::symlink_metadata(path) {
        Ok(found) if found.is_file() => found.len(),
        Ok(_) => return Err(wrong("not a file".to_owned())),
        Err(error) => {
            return Err(wrong(format!("it told {} triangles and wrote none: {error}", done.triangles)));
        }
    };
    if size > limit {
        return Err(wrong(format!("{size} bytes, more than its memory limit of {limit}")));
    }
    let format = path.extension().and_then(|ending| ending.to_str()).and_then(MeshFormat::from_extension);
    // It may grow while it is read.
    let file = isostudy_foreign::open(path).map_err(|error| wrong(error.problem.to_string()))?.take(limit);
    let mesh = format.unwrap_or(MeshFormat::Ply).read(file).map_err(|error| wrong(error.to_string()))?;
    check(&mesh, request, done)?;
    Ok(mesh)
}

/// The readers let no index out of range through, and no coordinate that is not finite.
fn check(mesh: &TriangleMesh, request: &Request<'_>, done: &Done) -> Result<(), Problem> {
    let counts = [
        ("vertices", done.vertices, mesh.positions.len() as u64),
        ("triangles", done.triangles, mesh.triangles.len() as u64),
    ];
    for (what, told, found) in counts {
        if told != found {
            return Err(Problem::Counts { what, told, found });
        }
    }
    let (min, max) = (request.origin, request.far_corner());
    for (vertex, position) in mesh.positions.iter().map(|p| p.to_array()).enumerate() {
        let is_near = |a: usize| {
            let beyond = request.spacing[a] * (1.0 + 1e-6);
            (min[a] - beyond..=max[a] + beyond).contains(&f64::from(position[a]))
        };
        if !(0..3).all(is_near) {
            return Err(Problem::Outside { vertex, position, min, max });
        }
    }
    Ok(())
}
