//! Vertices among their neighbours.

use std::collections::TryReserveError;

use glam::Vec3;

use crate::memory::{refilled, reset};

/// How much of the way is gone.
const SHARE: f32 = 0.5;

/// Each vertex half the way to the mean of its neighbours, in the plane through it across its area-weighted normal.
/// Neighbours are the vertices of its triangles, each counted once a triangle. A vertex on the boundary, or without a
/// normal, stays. `around` is room to work in.
pub(crate) fn relax(
    positions: &[Vec3],
    triangles: &[[u32; 3]],
    around: &mut Vec<Around>,
    targets: &mut Vec<Vec3>,
) -> Result<(), TryReserveError> {
    reset(around, positions.len(), Around::default())?;
    for triangle in triangles {
        let [a, b, c] = triangle.map(|v| positions[v as usize]);
        let doubled_area = (b - a).cross(c - a);
        let sum = a + b + c;
        for k in 0..3 {
            let [v, next, last] = [0, 1, 2].map(|i| triangle[(k + i) % 3]);
            let around = &mut around[v as usize];
            around.sum += sum - positions[v as usize];
            around.normal += doubled_area;
            around.neighbours += 2;
            around.open += i64::from(next) - i64::from(last);
        }
    }
    let relax = |(&p, around): (&Vec3, &Around)| match around.normal.try_normalize() {
        Some(normal) if around.open == 0 => {
            let way = (around.sum / around.neighbours as f32 - p) * SHARE;
            p + (way - normal * normal.dot(way))
        }
        _ => p,
    };
    refilled(targets, positions.iter().zip(&*around).map(relax))
}

/// What surrounds a vertex.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Around {
    sum: Vec3,
    normal: Vec3,
    neighbours: u32,
    /// First less last vertex of each triangle, added up: round a closed fan of triangles everything cancels, of an
    /// open one its two ends remain.
    open: i64,
}

#[cfg(test)]
mod tests {
    use super::*;

    fn relaxed(positions: &[Vec3], triangles: &[[u32; 3]]) -> Vec<Vec3> {
        // What was in there does not matter.
        let (mut around, mut targets) =
            (vec![Around { neighbours: 7, ..Around::default() }], vec![Vec3::ONE]);
        relax(positions, triangles, &mut around, &mut targets).unwrap();
        targets
    }

    /// A fan round vertex 0, closed with all six triangles.
    fn fan(triangles: usize) -> (Vec<Vec3>, Vec<[u32; 3]>) {
        let around = |k: usize| Vec3::new((k as f32).cos(), (k as f32).sin(), 0.0);
        let positions = std::iter::once(Vec3::new(0.2, 0.1, 0.3)).chain((0..6).map(around)).collect();
        (positions, (0..triangles as u32).map(|k| [0, k + 1, (k + 1) % 6 + 1]).collect())
    }

    #[test]
    fn the_middle_of_a_fan_goes_half_the_way_within_its_plane() {
        let (positions, triangles) = fan(6);
        let moved = relaxed(&positions, &triangles);
        let normal = isostudy_mesh::normals::area_weighted_normals(&positions, &triangles)[0];
        let mean = positions[1..].iter().sum::<Vec3>() / 6.0;
        let way = (mean - positions[0]) * 0.5;
        assert!(
            (moved[0] - positions[0] - way).cross(normal).length() < 1e-6,
            "along the normal alone it differs"
        );
        assert!((moved[0] - positions[0]).dot(normal).abs() < 1e-6);
        assert_eq!(moved[1..], positions[1..], "the rim is the boundary");
    }

    #[test]
    fn an_open_fan_has_no_middle() {
        let (positions, triangles) = fan(4);
        assert_eq!(relaxed(&positions, &triangles), positions);
    }
}
