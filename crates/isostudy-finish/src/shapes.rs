//! Meshes that tests are held against.

use isostudy_mesh::glam::Vec3;
use isostudy_mesh::{TriangleMesh, weld};

/// A unit sphere: an octahedron whose triangles are cut in four, so many times.
pub(crate) fn icosphere(cuts: u32) -> TriangleMesh {
    let n = 1 << cuts;
    let mut mesh = TriangleMesh::default();
    for signs in 0..8 {
        let sign = |axis: i32| if signs >> axis & 1 == 1 { -1.0 } else { 1.0 };
        let is_mirrored = sign(0) * sign(1) * sign(2) < 0.0;
        let at = |i: i32, j: i32| {
            let corner = Vec3::new(i as f32, j as f32, (n - i - j) as f32);
            corner.normalize() * Vec3::new(sign(0), sign(1), sign(2))
        };
        let mut add = |corners: [Vec3; 3]| {
            let first = mesh.positions.len() as u32;
            mesh.positions.extend(corners);
            mesh.triangles.push(if is_mirrored {
                [first, first + 2, first + 1]
            } else {
                [first, first + 1, first + 2]
            });
        };
        for i in 0..n {
            for j in 0..n - i {
                add([at(i, j), at(i + 1, j), at(i, j + 1)]);
                if i + j < n - 1 {
                    add([at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]);
                }
            }
        }
    }
    weld(&mesh)
}

/// The surface of the cube from 0 to 1, each face of `n * n` squares of two triangles.
pub(crate) fn cube(n: u32) -> TriangleMesh {
    let mut mesh = TriangleMesh::default();
    for axis in 0..3 {
        for side in 0..2 {
            let at = |i: u32, j: u32| {
                let mut p = [0.0; 3];
                p[axis] = side as f32;
                p[(axis + 1) % 3] = i as f32 / n as f32;
                p[(axis + 2) % 3] = j as f32 / n as f32;
                Vec3::from(p)
            };
            for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
                let first = mesh.positions.len() as u32;
                mesh.positions.extend([at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]);
                let order = if side == 1 { [[0, 1, 2], [0, 2, 3]] } else { [[0, 2, 1], [0, 3, 2]] };
                mesh.triangles.extend(order.map(|t| t.map(|k: u32| first + k)));
            }
        }
    }
    weld(&mesh)
}

/// The square from 0 to 1 in the plane z = 0, of `n * n` squares.
pub(crate) fn sheet(n: u32) -> TriangleMesh {
    let positions = (0..=n)
        .flat_map(|j| (0..=n).map(move |i| Vec3::new(i as f32 / n as f32, j as f32 / n as f32, 0.0)))
        .collect();
    let at = |i: u32, j: u32| j * (n + 1) + i;
    let triangles = (0..n)
        .flat_map(|j| (0..n).map(move |i| (i, j)))
        .flat_map(|(i, j)| {
            [[at(i, j), at(i + 1, j), at(i + 1, j + 1)], [at(i, j), at(i + 1, j + 1), at(i, j + 1)]]
        })
        .collect();
    TriangleMesh { positions, normals: Vec::new(), triangles }
}

/// A torus round the z axis of radii 1 and `tube`, of `n` rings of `m` quadrilaterals.
pub(crate) fn torus(tube: f32, n: u32, m: u32) -> TriangleMesh {
    let turn = |k: u32, of: u32| std::f32::consts::TAU * k as f32 / of as f32;
    let positions = (0..n)
        .flat_map(|i| {
            (0..m).map(move |j| {
                let (round, across) = (turn(i, n), turn(j, m));
                let r = 1.0 + tube * across.cos();
                Vec3::new(r * round.cos(), r * round.sin(), tube * across.sin())
            })
        })
        .collect();
    let at = |i: u32, j: u32| i % n * m + j % m;
    let triangles = (0..n)
        .flat_map(|i| (0..m).map(move |j| (i, j)))
        .flat_map(|(i, j)| {
            [[at(i, j), at(i + 1, j), at(i + 1, j + 1)], [at(i, j), at(i + 1, j + 1), at(i, j + 1)]]
        })
        .collect();
    TriangleMesh { positions, normals: Vec::new(), triangles }
}
