//! Flat shapes, and several as one.

use isostudy_mesh::TriangleMesh;
use isostudy_mesh::glam::Vec3;

/// A parallelogram with corner `corner` and sides `a` and `b`, in `steps * steps * 2` triangles facing `a x b`.
pub(crate) fn sheet(corner: Vec3, a: Vec3, b: Vec3, steps: u32) -> TriangleMesh {
    let mut mesh = TriangleMesh::default();
    for j in 0..=steps {
        for i in 0..=steps {
            mesh.positions.push(corner + a * (i as f32 / steps as f32) + b * (j as f32 / steps as f32));
            mesh.normals.push(a.cross(b).normalize());
        }
    }
    let at = |i: u32, j: u32| j * (steps + 1) + i;
    for j in 0..steps {
        for i in 0..steps {
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            mesh.triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    mesh
}

/// Both meshes as one.
pub(crate) fn together(mut a: TriangleMesh, b: &TriangleMesh) -> TriangleMesh {
    let from = a.positions.len() as u32;
    a.positions.extend(&b.positions);
    a.normals.extend(&b.normals);
    a.triangles.extend(b.triangles.iter().map(|t| t.map(|v| v + from)));
    a
}
