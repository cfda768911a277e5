//! Normals stage: one normal a vertex from the triangles round it.

use std::collections::TryReserveError;

use glam::Vec3;

use crate::memory::filled;

/// Area-weighted mean normals: the sum of the cross products of the triangles at a vertex, made unit length.
/// Outward, as the triangles are. Zero for a vertex that no triangle with an area uses.
pub(crate) fn vertex_normals(
    positions: &[Vec3],
    triangles: &[[u32; 3]],
) -> Result<Vec<Vec3>, TryReserveError> {
    let mut normals = filled(positions.len(), Vec3::ZERO)?;
    accumulate(positions, triangles, &mut normals);
    Ok(normals)
}

/// The same into `normals`, which are zero.
pub(crate) fn accumulate(positions: &[Vec3], triangles: &[[u32; 3]], normals: &mut [Vec3]) {
    for &triangle in triangles {
        let doubled_area = doubled_area(positions, triangle);
        for vertex in triangle {
            normals[vertex as usize] += doubled_area;
        }
    }
    normalise(normals);
}

/// The same for the vertices from `first` on only, of which `normals` has as many as there are to do.
pub(crate) fn accumulate_some(positions: &[Vec3], triangles: &[[u32; 3]], first: u32, normals: &mut [Vec3]) {
    for &triangle in triangles {
        let doubled_area = doubled_area(positions, triangle);
        for vertex in triangle {
            if let Some(normal) = normals.get_mut(vertex.wrapping_sub(first) as usize) {
                *normal += doubled_area;
            }
        }
    }
    normalise(normals);
}

#[inline]
fn doubled_area(positions: &[Vec3], triangle: [u32; 3]) -> Vec3 {
    let [a, b, c] = triangle.map(|vertex| positions[vertex as usize]);
    (b - a).cross(c - a)
}

/// Makes all of unit length; zero where they have no direction.
pub(crate) fn normalise(normals: &mut [Vec3]) {
    for normal in normals {
        *normal = normal.normalize_or_zero();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn larger_triangles_weigh_more() {
        let positions = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::new(0.0, 0.0, 3.0)];
        // One in the xy plane of area 1/2, one in the yz plane of area 3/2, sharing the y side.
        let normals = vertex_normals(&positions, &[[0, 1, 2], [0, 2, 3]]).unwrap();
        assert!((normals[0] - Vec3::new(3.0, 0.0, 1.0).normalize()).length() < 1e-6);
        assert_eq!(normals[1], Vec3::Z);
        assert_eq!(normals[3], Vec3::X);
    }

    #[test]
    fn unused_vertex_has_no_normal() {
        assert_eq!(vertex_normals(&[Vec3::ONE], &[]).unwrap(), [Vec3::ZERO]);
    }
}
