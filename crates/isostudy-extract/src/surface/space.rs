//! From a grid in steps to the space its steps are in.

use glam::{DMat3, DVec3};
use isostudy_mesh::TriangleMesh;

/// Where the steps of a grid lead.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Space {
    start: DVec3,
    matrix: DMat3,
}

impl Space {
    /// `None` if the steps span no space, or are not finite.
    pub(crate) fn try_new(origin: [f64; 3], steps: [[f64; 3]; 3]) -> Option<Self> {
        let (matrix, start) = (DMat3::from_cols_array_2d(&steps), DVec3::from_array(origin));
        let lengths = matrix.x_axis.length() * matrix.y_axis.length() * matrix.z_axis.length();
        let is_space =
            start.is_finite() && lengths.is_finite() && matrix.determinant().abs() > 1e-6 * lengths;
        is_space.then_some(Self { start, matrix })
    }

    /// Takes a mesh in steps of the grid to space. Triangles face the same way there as here, mirrored or not.
    pub(crate) fn place(self, mesh: &mut TriangleMesh) {
        for position in &mut mesh.positions {
            *position = (self.start + self.matrix * position.as_dvec3()).as_vec3();
        }
        if self.matrix.determinant() < 0.0 {
            mesh.triangles.iter_mut().for_each(|triangle| triangle.swap(1, 2));
        }
    }
}
