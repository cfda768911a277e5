//! Vertices at one point made one.

use std::collections::HashMap;

use glam::Vec3;

use crate::TriangleMesh;

/// The mesh with all vertices at the same coordinates made one, which keeps the number order of the first of each;
/// 0 and -0 are the same. Normals are dropped. Triangles keep their order; one whose corners have met is kept.
///
/// # Panics
/// If a triangle's index is out of range.
pub fn weld(mesh: &TriangleMesh) -> TriangleMesh {
    let mut numbers: HashMap<[u32; 3], u32> = HashMap::with_capacity(mesh.positions.len() / 2);
    let mut positions = Vec::new();
    let moved_to: Vec<u32> = mesh
        .positions
        .iter()
        .map(|&p| {
            // The sum is 0 for -0 as well.
            *numbers.entry((p + Vec3::ZERO).to_array().map(f32::to_bits)).or_insert_with(|| {
                positions.push(p);
                positions.len() as u32 - 1
            })
        })
        .collect();
    let triangles = mesh.triangles.iter().map(|t| t.map(|v| moved_to[v as usize])).collect();
    TriangleMesh { positions, normals: Vec::new(), triangles }
}
