//! Grids of tetrahedra and other cells with values on their points: the files they come in, and their isosurfaces.
//!
//! | ending | format | cells | numbers |
//! |---|---|---|---|
//! | `.vtu` | VTK XML, unstructured | tetrahedra, voxels, hexahedra, wedges, pyramids | text, base64, appended; raw or zlib |
//! | `.vts` | VTK XML, curvilinear | hexahedra | the same |
//! | `.vtk` | VTK legacy, versions 1 to 5, unstructured or curvilinear | as of these | text, big-endian bytes |
//! | `.node`, `.ele` | TetGen, each with the other beside it | tetrahedra | text |
//!
//! ```
//! use isostudy_grid::Grid;
//!
//! // A tetrahedron with the value 1 on one of its points.
//! let points = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
//! let grid = Grid::try_new(points, vec![1.0, 0.0, 0.0, 0.0], vec![[0, 1, 2, 3]])?;
//! let surface = grid.extract(0.5);
//! assert_eq!(surface.mesh.triangles, [[0, 1, 2]]);
//! assert_eq!(surface.crossings[0].ends, [0, 1]);
//! assert_eq!(surface.crossings[0].share, 0.5);
//! # Ok::<(), isostudy_grid::Problem>(())
//! ```
//!
//! # Guaranteed
//!
//! - The surface is that of the linear interpolant in each tetrahedron, to rounding: a vertex per crossed edge, whose place is
//!   computed from the end with the smaller number. Inside is above the isovalue; a value equal to it is outside.
//! - It is closed except on the boundary of the grid, of which tetrahedra without a value are no part. Its Euler characteristic is the
//!   number of crossed edges, less that of crossed triangles, plus that of crossed tetrahedra.
//! - Triangles face the lower values, however the points of a cell are ordered in the file: its volume says which way it is wound. Cells
//!   without volume go with their neighbours.
//! - Cells that share a face cut it alike, whatever kinds they are.
//! - Bad input is a [`GridError`] that names the file and the line, the array, the cell or the point. Nothing panics. Memory grows
//!   with the data that are there, not with what is claimed, and not beyond the limit for each of the arrays.
//!
//! # Not guaranteed
//!
//! - Triangles may have no area: where a value is the isovalue, vertices of several edges are at one place.
//! - Points at one place are not joined, and cells on different ones do not hang together there. [`Grid::oddities`] counts them.
//! - Where cells fold over each other, or a cell is not convex, the surface folds too.
//! - Vertices are rounded to single precision.
//! - Ghost cells of VTK are cells. Time series, blocks of several files and polyhedra are refused.

mod arrays;
mod cells;
mod contour;
mod error;
mod field;
mod grid;
mod legacy;
mod numbers;
mod tetgen;
mod winding;
mod xml;

use std::path::{Path, PathBuf};

pub use cells::CellKind;
pub use contour::{Crossing, Surface};
pub use error::{GridError, Problem};
pub use field::GridField;
pub use grid::{Census, Grid, Oddities};

/// Reads a grid with one of its arrays of values on points; the ending of the file's name tells the format (see the front page). `array`
/// is the name of the array. It may be `None` where the file has only one with a number per point.
///
/// No file and no array may be larger than `limit_bytes`, and neither may the grid.
///
/// # Errors
/// [`GridError`], with the file, and the place where one is to blame.
pub fn read(path: &Path, array: Option<&str>, limit_bytes: u64) -> Result<Grid, GridError> {
    let bytes = |path: &Path| {
        isostudy_foreign::bytes(path, limit_bytes).map_err(|error| Problem::from(error.problem).in_file(path))
    };
    let ending = ending(path);
    let here = |problem: Problem| problem.in_file(path);
    match ending.as_str() {
        "vtu" | "vts" => xml::read(&bytes(path)?, array, limit_bytes).map_err(here),
        "vtk" => legacy::read(&bytes(path)?, array, limit_bytes).map_err(here),
        "node" | "ele" => {
            // The one that is named may have its ending in capitals.
            let beside =
                |other: &str| if ending == other { path.to_owned() } else { path.with_extension(other) };
            let [of_points, of_cells] = ["node", "ele"].map(beside);
            let nodes = tetgen::nodes(&bytes(&of_points)?, array);
            let nodes = nodes.map_err(|problem| problem.in_file(&of_points))?;
            let elements = tetgen::elements(&bytes(&of_cells)?, nodes, limit_bytes);
            elements.map_err(|problem| problem.in_file(&of_cells))
        }
        _ => Err(here(Problem::Ending)),
    }
}

/// The files that a grid is in: the one that is named, and with TetGen the one beside it.
pub fn files(path: &Path) -> Vec<PathBuf> {
    let ending = ending(path);
    match ending.as_str() {
        "node" | "ele" => tetgen_files(path, &ending).to_vec(),
        _ => vec![path.to_owned()],
    }
}

fn ending(path: &Path) -> String {
    path.extension().unwrap_or_default().to_string_lossy().to_lowercase()
}

/// TetGen's points and cells. The one that is named may have its ending in capitals.
fn tetgen_files(path: &Path, ending: &str) -> [PathBuf; 2] {
    ["node", "ele"].map(|other| if ending == other { path.to_owned() } else { path.with_extension(other) })
}
