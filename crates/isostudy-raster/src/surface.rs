//! A mesh that has been checked, with what its colours follow from.

use crate::colouring::{Colouring, Values};
use crate::{Look, RasterError, Shading};
use glam::Vec3;
use isostudy_mesh::{CornerNormals, TriangleMesh, corner_normals};

/// A drawable mesh.
pub(crate) struct Surface<'a> {
    pub(crate) positions: &'a [Vec3],
    pub(crate) triangles: &'a [[u32; 3]],
    normals: Normals<'a>,
    /// Places on the scale of colours, 0 to 1; `None` for a surface that shows its material.
    places: Option<Values>,
}

enum Normals<'a> {
    Vertices(&'a [Vec3]),
    Triangles(Vec<Vec3>),
    Corners(CornerNormals),
}

/// A surface's exposures under one light, in the order of its normals.
pub(crate) struct Lit(Vec<f32>);

/// What a triangle's corners are drawn with.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Corners {
    pub(crate) exposures: [f32; 3],
    /// 0 for a surface that shows its material.
    pub(crate) places: [f32; 3],
}

impl<'a> Surface<'a> {
    /// # Errors
    /// When an index is out of range, a used position or normal is not finite, a smooth look lacks normals, the
    /// shading is out of range, or the numbers do not fit the mesh.
    pub(crate) fn try_new(
        mesh: &'a TriangleMesh,
        colouring: Option<&Colouring>,
        shading: &Shading,
        look: Look,
    ) -> Result<Self, RasterError> {
        shading.check()?;
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
        let face_normal = |t| {
            let [a, b, c] = mesh.corners(t);
            (b - a).cross(c - a).normalize_or_zero()
        };
        let normals = match look {
            Look::Smooth | Look::Wireframe | Look::SmoothWireframe => Normals::Vertices(&mesh.normals),
            Look::Flat => Normals::Triangles((0..mesh.triangles.len()).map(face_normal).collect()),
            Look::Creased => Normals::Corners(corner_normals(mesh, shading.crease_deg)),
        };
        let places = colouring.map(|colouring| colouring.places(mesh)).transpose()?;
        Ok(Surface { positions: &mesh.positions, triangles: &mesh.triangles, normals, places })
    }

    pub(crate) fn is_coloured(&self) -> bool {
        self.places.is_some()
    }

    /// The exposures under the light of `shading`, which stands as it is.
    pub(crate) fn lit(&self, shading: &Shading) -> Lit {
        let normals = match &self.normals {
            Normals::Vertices(normals) => normals,
            Normals::Triangles(normals) => &normals[..],
            Normals::Corners(of) => &of.normals[..],
        };
        Lit(normals.iter().map(|&n| shading.exposure(n)).collect())
    }

    /// What the three corners of `triangle` are drawn with.
    #[inline]
    pub(crate) fn corners(&self, lit: &Lit, triangle: usize) -> Corners {
        let vertices = || self.triangles[triangle].map(|v| v as usize);
        let exposures = match &self.normals {
            Normals::Vertices(_) => vertices().map(|v| lit.0[v]),
            Normals::Triangles(_) => [lit.0[triangle]; 3],
            Normals::Corners(of) => of.corners[triangle].map(|place| lit.0[place as usize]),
        };
        let places = match &self.places {
            None => [0.0; 3],
            Some(Values::PerVertex(places)) => vertices().map(|v| places[v]),
            Some(Values::PerTriangle(places)) => [places[triangle]; 3],
        };
        Corners { exposures, places }
    }
}
