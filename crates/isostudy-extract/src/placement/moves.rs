//! Taking vertices to their targets without turning a triangle over.

use std::collections::TryReserveError;

use glam::{DVec3, Vec3};
use isostudy_mesh::Bounds;

use crate::memory::copied;

/// The least that may be left of a triangle's area, seen along its normal before any move.
const LEAST_AREA: f64 = 0.1;
/// Refusals spread to neighbours, pass by pass; three passes have been enough for noise, too. Beyond this many, all stay.
pub(crate) const MOST_PASSES: usize = 64;

/// The moves of a mesh's vertices. Triangles stay the same throughout.
pub(crate) struct Moves {
    /// Where vertices were at the start.
    reference: Vec<Vec3>,
    stays: Vec<bool>,
}

impl Moves {
    pub(crate) fn start(positions: &[Vec3]) -> Result<Self, TryReserveError> {
        Ok(Self { reference: copied(positions)?, stays: Vec::new() })
    }

    /// Moves every vertex to its target, or leaves it where it is:
    /// - vertices on the box stay, so that a surface stays flush with it;
    /// - when a triangle would keep less than a tenth of its area, seen along the normal that it had at the start, its
    ///   three vertices stay. So no triangle turns over or loses its area, however many moves follow each other, and
    ///   triangles without area stay as they are.
    ///
    /// Triangles are looked at in their order until none is refused: the result depends on nothing else.
    pub(crate) fn advance(
        &mut self,
        positions: &mut [Vec3],
        targets: &[Vec3],
        triangles: &[[u32; 3]],
        bounds: &Bounds,
    ) -> Result<(), TryReserveError> {
        let stays = &mut self.stays;
        stays.clear();
        stays.try_reserve_exact(positions.len())?;
        stays.extend(
            positions.iter().zip(targets).map(|(p, target)| on_box(p, bounds) || !target.is_finite()),
        );
        for pass in 0.. {
            let mut refused = false;
            for triangle in triangles {
                let corners = triangle.map(|v| v as usize);
                let reference = corners.map(|v| self.reference[v]);
                let [at, to] = [corners.map(|v| positions[v]), corners.map(|v| targets[v])];
                if Self::is_refused(reference, at, to, corners.map(|v| stays[v])) {
                    corners.iter().for_each(|&v| stays[v] = true);
                    refused = true;
                }
            }
            if !refused {
                break;
            }
            if pass == MOST_PASSES {
                return Ok(());
            }
        }
        for ((p, target), stays) in positions.iter_mut().zip(targets).zip(stays) {
            if !*stays {
                *p = *target;
            }
        }
        Ok(())
    }

    /// Whether a triangle that was at `reference` may not have the corners `at` that stay and the corners `to` that go.
    #[inline]
    pub(crate) fn is_refused(reference: [Vec3; 3], at: [Vec3; 3], to: [Vec3; 3], stays: [bool; 3]) -> bool {
        if stays == [true; 3] {
            return false;
        }
        let before = doubled_area(reference);
        let after = doubled_area([0, 1, 2].map(|k| if stays[k] { at[k] } else { to[k] }));
        before == DVec3::ZERO || after.dot(before) < LEAST_AREA * before.length_squared()
    }
}

/// Whether a point lies on a side of a box.
pub(crate) fn on_box(p: &Vec3, bounds: &Bounds) -> bool {
    (p.cmpeq(bounds.min) | p.cmpeq(bounds.max)).any()
}

fn doubled_area([a, b, c]: [Vec3; 3]) -> DVec3 {
    let [a, b, c] = [a, b, c].map(|p| p.as_dvec3());
    (b - a).cross(c - a)
}

#[cfg(test)]
mod tests {
    use super::*;

    const BOX: Bounds = Bounds { min: Vec3::splat(-9.0), max: Vec3::splat(9.0) };
    /// Two triangles on the edge from 1 to 2.
    const SQUARE: [[u32; 3]; 2] = [[0, 1, 2], [2, 1, 3]];

    fn square() -> Vec<Vec3> {
        [[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [1., 1., 0.]].map(Vec3::from).to_vec()
    }

    fn after(moved: &[(usize, Vec3)]) -> Vec<Vec3> {
        let (mut positions, mut targets) = (square(), square());
        moved.iter().for_each(|&(v, target)| targets[v] = target);
        Moves::start(&positions).unwrap().advance(&mut positions, &targets, &SQUARE, &BOX).unwrap();
        positions
    }

    #[test]
    fn free_vertices_arrive() {
        let up = Vec3::new(0.1, 0.1, 0.5);
        assert_eq!(after(&[(0, up)])[0], up);
    }

    #[test]
    fn a_triangle_that_would_turn_over_keeps_its_corners() {
        let (beyond, up) = (Vec3::new(0.9, 0.9, 0.0), Vec3::new(1.0, 1.0, 0.3));
        let result = after(&[(0, beyond), (3, up), (1, Vec3::new(1.1, 0.0, 0.0))]);
        assert_eq!(result[..3], square()[..3]);
        assert_eq!(result[3], up, "not a corner of it");
        // Nor may it shrink to nothing.
        assert_eq!(after(&[(0, Vec3::new(0.48, 0.48, 0.0))]), square());
    }

    #[test]
    fn many_small_moves_are_held_against_the_start() {
        let mut positions = square();
        let mut moves = Moves::start(&positions).unwrap();
        for step in 1..40 {
            let mut targets = positions.clone();
            let angle = step as f32 * 0.1;
            targets[0] = Vec3::new(0.5 - 0.5 * angle.cos(), 0.5 - 0.5 * angle.cos(), angle.sin());
            moves.advance(&mut positions, &targets, &SQUARE, &BOX).unwrap();
        }
        let area = doubled_area([positions[0], positions[1], positions[2]]);
        assert!(area.z >= LEAST_AREA && area.z < 0.2, "turned until a tenth was left: {area}");
    }

    #[test]
    fn vertices_on_the_box_stay() {
        let bounds = Bounds { min: Vec3::ZERO, max: Vec3::splat(9.0) };
        let (mut positions, mut targets) = (square(), square());
        positions[3].z = 0.1;
        targets.iter_mut().for_each(|p| *p += Vec3::splat(0.05));
        Moves::start(&positions).unwrap().advance(&mut positions, &targets, &SQUARE, &bounds).unwrap();
        assert_eq!(positions[..3], square()[..3]);
        assert_eq!(positions[3], targets[3]);
    }
}
