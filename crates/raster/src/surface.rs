//! A mesh that has been checked, with the exposure that its colours follow from.

use crate::{Look, RasterError, Shading};
use glam::Vec3;
use mesh::TriangleMesh;

/// A drawable mesh. Light stands still in the world while the camera turns, so exposures hold for every frame.
pub(crate) struct Surface<'a> {
    pub(crate) positions: &'a [Vec3],
    pub(crate) triangles: &'a [[u32; 3]],
    exposures: Exposures,
}

enum Exposures {
    PerVertex(Vec<f32>),
    PerTriangle(Vec<f32>),
}

impl<'a> Surface<'a> {
    /// # Errors
    /// When an index is out of range, a used position or normal is not finite, or a smooth look lacks normals.
    pub(crate) fn try_new(
        mesh: &'a TriangleMesh,
        shading: &Shading,
        look: Look,
    ) -> Result<Self, RasterError> {
        let (normals, vertices) = (mesh.normals.len(), mesh.positions.len());
        let smooth = look != Look::Flat;
        if smooth && normals != vertices {
            return Err(RasterError::Normals { normals, vertices });
        }
        for (triangle, corners) in mesh.triangles.iter().enumerate() {
            for &vertex in corners {
                let position = mesh.positions.get(vertex as usize).ok_or(RasterError::NoSuchVertex {
                    triangle,
                    vertex,
                    vertices,
                })?;
                let vertex = vertex as usize;
                if !position.is_finite() {
                    return Err(RasterError::NotFinite { vertex, part: "position" });
                }
                if smooth && !mesh.normals[vertex].is_finite() {
                    return Err(RasterError::NotFinite { vertex, part: "normal" });
                }
            }
        }
        let exposures = if smooth {
            Exposures::PerVertex(mesh.normals.iter().map(|&n| shading.exposure(n)).collect())
        } else {
            let face_normal = |t| {
                let [a, b, c] = mesh.corners(t);
                (b - a).cross(c - a).normalize_or_zero()
            };
            Exposures::PerTriangle(
                (0..mesh.triangles.len()).map(|t| shading.exposure(face_normal(t))).collect(),
            )
        };
        Ok(Surface { positions: &mesh.positions, triangles: &mesh.triangles, exposures })
    }

    /// The exposures at the three corners of `triangle`.
    #[inline]
    pub(crate) fn exposures(&self, triangle: usize) -> [f32; 3] {
        match &self.exposures {
            Exposures::PerVertex(d) => self.triangles[triangle].map(|v| d[v as usize]),
            Exposures::PerTriangle(d) => [d[triangle]; 3],
        }
    }
}
