//! Meshes whose measures are known by hand.

use isostudy_mesh::TriangleMesh;
use isostudy_mesh::glam::Vec3;

pub(crate) fn mesh(positions: &[[f32; 3]], triangles: &[[u32; 3]]) -> TriangleMesh {
    TriangleMesh {
        positions: positions.iter().copied().map(Vec3::from).collect(),
        triangles: triangles.to_vec(),
        ..TriangleMesh::default()
    }
}

/// Regular, edge 2 sqrt 2, volume 8/3.
pub(crate) fn tetrahedron() -> TriangleMesh {
    mesh(
        &[[1., 1., 1.], [1., -1., -1.], [-1., 1., -1.], [-1., -1., 1.]],
        &[[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]],
    )
}

/// The unit cube, every square cut along a diagonal.
pub(crate) fn cube() -> TriangleMesh {
    let corner = |i: u8| [f32::from(i & 1), f32::from(i >> 1 & 1), f32::from(i >> 2)];
    let positions: Vec<_> = (0..8).map(corner).collect();
    let squares = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let halves = squares.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]);
    mesh(&positions, &halves.collect::<Vec<_>>())
}

/// Edge 2.
pub(crate) fn icosahedron() -> TriangleMesh {
    let g = (1.0 + 5f32.sqrt()) / 2.0;
    let mut positions = Vec::new();
    for s in [1.0, -1.0] {
        for t in [g, -g] {
            positions.extend([[0.0, s, t], [s, t, 0.0], [t, 0.0, s]]);
        }
    }
    let p: Vec<Vec3> = positions.iter().copied().map(Vec3::from).collect();
    let touch = |a: usize, b: usize| (p[a].distance(p[b]) - 2.0).abs() < 1e-3;
    let mut triangles = Vec::new();
    for a in 0..12 {
        for b in a + 1..12 {
            for c in b + 1..12 {
                if touch(a, b) && touch(b, c) && touch(c, a) {
                    let outward = (p[b] - p[a]).cross(p[c] - p[a]).dot(p[a]) > 0.0;
                    let (b, c) = if outward { (b, c) } else { (c, b) };
                    triangles.push([a as u32, b as u32, c as u32]);
                }
            }
        }
    }
    mesh(&positions, &triangles)
}

/// A ring of `n` x `m` squares, radii 2 and 1/2.
pub(crate) fn torus(n: u32, m: u32) -> TriangleMesh {
    let turn = std::f32::consts::TAU;
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    for i in 0..n {
        for j in 0..m {
            let (u, v) = (turn * i as f32 / n as f32, turn * j as f32 / m as f32);
            let r = 2.0 + 0.5 * v.cos();
            positions.push([r * u.cos(), r * u.sin(), 0.5 * v.sin()]);
            let at = |i, j| (i % n) * m + j % m;
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    mesh(&positions, &triangles)
}

/// A band of `n` squares with half a twist: no consistent orientation exists.
pub(crate) fn moebius(n: u32) -> TriangleMesh {
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    for i in 0..n {
        let u = std::f32::consts::TAU * i as f32 / n as f32;
        for side in [-0.3, 0.3] {
            let r = 1.0 + side * (u / 2.0).cos();
            positions.push([r * u.cos(), r * u.sin(), side * (u / 2.0).sin()]);
        }
        let [a, b] = [2 * i, 2 * i + 1];
        let [c, d] = if i + 1 < n { [a + 2, b + 2] } else { [1, 0] };
        triangles.extend([[a, c, b], [b, c, d]]);
    }
    mesh(&positions, &triangles)
}

/// Both meshes, side by side in one.
pub(crate) fn joined(a: &TriangleMesh, b: &TriangleMesh) -> TriangleMesh {
    let shift = a.positions.len() as u32;
    let mut both = TriangleMesh { normals: Vec::new(), ..a.clone() };
    both.positions.extend(b.positions.iter().map(|&p| p + Vec3::X * 9.0));
    both.triangles.extend(b.triangles.iter().map(|t| t.map(|v| v + shift)));
    both
}
