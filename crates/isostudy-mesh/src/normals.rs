//! Vertex normals from the triangles around a vertex.

use glam::Vec3;

/// The area-weighted normal of every vertex: the sum of the cross products of the first two edges of all its
/// triangles, brought to unit length. Outward when the triangles are counter-clockwise seen from outside.
///
/// Summed in single precision in triangle order, as Costen (2026) does. A vertex whose sum is zero or not finite
/// (no triangle, triangles without area, a folded pair) gets [`Vec3::ZERO`]: it has no direction, and says so.
///
/// # Panics
/// If an index is out of range.
pub fn area_weighted_normals(positions: &[Vec3], triangles: &[[u32; 3]]) -> Vec<Vec3> {
    let mut normals = vec![Vec3::ZERO; positions.len()];
    for triangle in triangles {
        let [a, b, c] = triangle.map(|v| positions[v as usize]);
        let doubled_area = (b - a).cross(c - a);
        for &v in triangle {
            normals[v as usize] += doubled_area;
        }
    }
    for normal in &mut normals {
        // Normalised in double precision: the square of a small triangle's area underflows in single.
        *normal = normal.as_dvec3().normalize_or_zero().as_vec3();
    }
    normals
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_large_triangle_outweighs_a_small_one() {
        // Vertex 0: area 2 facing +z, area 1/2 facing +x.
        let positions =
            [[0., 0., 0.], [2., 0., 0.], [0., 2., 0.], [0., 0., 1.], [9., 9., 9.]].map(Vec3::from);
        let normals = area_weighted_normals(&positions, &[[0, 1, 2], [0, 2, 3]]);
        let want = Vec3::new(2.0, 0.0, 4.0).normalize();
        assert!(normals[0].distance(want) < 1e-6, "{}", normals[0]);
        assert_eq!(normals[1], Vec3::Z);
        assert_eq!(normals[3], Vec3::X);
        assert_eq!(normals[4], Vec3::ZERO, "no triangle, no direction");
    }

    #[test]
    fn tiny_triangles_keep_their_direction_and_folded_ones_have_none() {
        let positions = [[0., 0., 0.], [1e-12, 0., 0.], [0., 1e-12, 0.]].map(Vec3::from);
        assert_eq!(area_weighted_normals(&positions, &[[0, 1, 2]]), [Vec3::Z; 3]);
        assert_eq!(area_weighted_normals(&positions, &[[0, 1, 2], [0, 2, 1]]), [Vec3::ZERO; 3]);
    }
}
