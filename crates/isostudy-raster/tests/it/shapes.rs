//! Shapes with known geometry, and exact normals.

use isostudy_mesh::TriangleMesh;
use isostudy_mesh::glam::Vec3;
use std::f32::consts::{PI, TAU};

/// A UV sphere round the origin with `2 * rings * (rings - 1) * 2` triangles.
pub(crate) fn sphere(radius: f32, rings: u32) -> TriangleMesh {
    let around = 2 * rings;
    let mut normals = vec![Vec3::Z];
    for ring in 1..rings {
        let (sin, cos) = (PI * ring as f32 / rings as f32).sin_cos();
        normals.extend((0..around).map(|i| {
            let (y, x) = (TAU * i as f32 / around as f32).sin_cos();
            Vec3::new(sin * x, sin * y, cos)
        }));
    }
    normals.push(-Vec3::Z);
    let south = normals.len() as u32 - 1;
    let at = |ring: u32, i: u32| match ring {
        0 => 0,
        r if r == rings => south,
        r => 1 + (r - 1) * around + i % around,
    };
    let mut triangles = Vec::new();
    for ring in 0..rings {
        for i in 0..around {
            if ring + 1 < rings {
                triangles.push([at(ring, i), at(ring + 1, i), at(ring + 1, i + 1)]);
            }
            if ring > 0 {
                triangles.push([at(ring, i), at(ring + 1, i + 1), at(ring, i + 1)]);
            }
        }
    }
    TriangleMesh { positions: normals.iter().map(|&n| n * radius).collect(), normals, triangles }
}

/// A torus round the z axis with `2 * major_steps * minor_steps` triangles.
pub(crate) fn torus(major: f32, minor: f32, major_steps: u32, minor_steps: u32) -> TriangleMesh {
    let mut mesh = TriangleMesh::default();
    for i in 0..major_steps {
        let (sin_u, cos_u) = (TAU * i as f32 / major_steps as f32).sin_cos();
        for j in 0..minor_steps {
            let (sin_v, cos_v) = (TAU * j as f32 / minor_steps as f32).sin_cos();
            let normal = Vec3::new(cos_u * cos_v, sin_u * cos_v, sin_v);
            mesh.positions.push(Vec3::new(cos_u, sin_u, 0.0) * major + normal * minor);
            mesh.normals.push(normal);
        }
    }
    let at = |i: u32, j: u32| (i % major_steps) * minor_steps + j % minor_steps;
    for i in 0..major_steps {
        for j in 0..minor_steps {
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            mesh.triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    mesh
}
