//! Whether a mesh can be computed with at all.

use std::error::Error;
use std::fmt;

use glam::Vec3;

use crate::TriangleMesh;

/// Coordinates up to here have finite squares and cubes of differences in the precisions used.
pub const COORDINATE_LIMIT: f32 = 1e18;

/// Why a mesh cannot be computed with.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum MeshError {
    /// There are no triangles.
    Empty,
    /// A triangle refers to a vertex that does not exist.
    IndexOutOfRange {
        /// The triangle.
        triangle: usize,
        /// The index.
        index: u32,
        /// How many vertices there are.
        vertices: usize,
    },
    /// A vertex of a triangle is NaN, infinite or beyond the limit.
    Coordinate {
        /// The vertex.
        vertex: usize,
        /// Where it is.
        position: Vec3,
    },
    /// So many triangles lie so close to each other that looking for intersections was given up.
    Entangled {
        /// Pairs of boxes that were looked at.
        looks: u64,
        /// Pairs of triangles that were found to intersect before.
        found: u64,
    },
}

impl fmt::Display for MeshError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Empty => f.write_str("the mesh has no triangles"),
            Self::IndexOutOfRange { triangle, index, vertices } => {
                write!(f, "triangle {triangle} refers to vertex {index} of {vertices}")
            }
            Self::Coordinate { vertex, position } => write!(
                f,
                "vertex {vertex} is at {position}; coordinates must be numbers up to {COORDINATE_LIMIT:e}"
            ),
            Self::Entangled { looks, found } => write!(
                f,
                "the triangles lie so close to each other that looking for intersections was given up after {looks} looks; {found} \
                 pairs intersect so far"
            ),
        }
    }
}

impl Error for MeshError {}

/// Whether all coordinates are numbers up to [`COORDINATE_LIMIT`].
pub fn is_sound(p: Vec3) -> bool {
    // A comparison with NaN is false, but the largest element of some passes over it.
    !p.is_nan() && p.abs().max_element() <= COORDINATE_LIMIT
}

/// Which vertices triangles use, all of them sound.
///
/// # Errors
/// The first fault, indices before coordinates. A vertex that no triangle uses may be anything.
pub fn used_vertices(mesh: &TriangleMesh) -> Result<Vec<bool>, MeshError> {
    if mesh.triangles.is_empty() {
        return Err(MeshError::Empty);
    }
    let vertices = mesh.positions.len();
    let mut is_used = vec![false; vertices];
    for (triangle, corners) in mesh.triangles.iter().enumerate() {
        for &index in corners {
            let vertex = is_used.get_mut(index as usize);
            *vertex.ok_or(MeshError::IndexOutOfRange { triangle, index, vertices })? = true;
        }
    }
    match (0..vertices).find(|&v| is_used[v] && !is_sound(mesh.positions[v])) {
        Some(vertex) => Err(MeshError::Coordinate { vertex, position: mesh.positions[vertex] }),
        None => Ok(is_used),
    }
}
