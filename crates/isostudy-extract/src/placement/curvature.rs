//! How sharply the surface bends at a crossing, from the samples round it.

use std::sync::OnceLock;

use glam::{DMat3, DVec3};

use super::surroundings::Surroundings;
use crate::lattice::{Arrangement, DIRECTIONS, Directions};

/// A plane through a lattice edge: the parallelogram of the edge, which is its diagonal, and two neighbours of it.
#[derive(Debug, Clone, Copy)]
struct Plane {
    /// Directions to the two corners beside the edge; their offsets add up to the edge's.
    sides: [usize; 2],
    /// Across the edge, in the plane, towards the first corner.
    across: DVec3,
    /// The first corner, along and across the edge, and the edge's length.
    along_to_side: f64,
    across_to_side: f64,
    length: f64,
}

/// The planes through each lattice edge: two or three.
#[derive(Debug)]
pub(crate) struct Planes {
    edges: [Edge; DIRECTIONS],
}

#[derive(Debug, Default)]
struct Edge {
    unit: DVec3,
    planes: Vec<Plane>,
    /// From the sum of what the planes see of a vector to the vector.
    inverse: DMat3,
}

impl Planes {
    pub(crate) fn get(arrangement: Arrangement) -> &'static Self {
        static PLANES: [OnceLock<Planes>; 2] = [OnceLock::new(), OnceLock::new()];
        PLANES[arrangement as usize].get_or_init(|| Self::new(arrangement.directions()))
    }

    fn new(directions: &Directions) -> Self {
        let offsets = directions.offsets.map(|offset| DVec3::from_array(offset.map(f64::from)));
        Self { edges: std::array::from_fn(|d| Edge::new(d, &offsets)) }
    }

    /// The weight of the crossing in `direction`: how sharply the surface bends there, 0 where it is flat.
    ///
    /// In each plane the two triangles beside the edge have a linearly interpolated gradient of their own. Where the
    /// gradients differ by an angle `d`, the surface's section has a corner of `180 - d` degrees: `a`. Its sharpness is
    /// `cot(a / 2) = tan(d / 2)`. A plane that the surface does not meet at right angles shows too sharp a corner, by
    /// Meusnier's theorem by `1 / cos f`, where `f` is the angle between the plane and the surface's normal. The weight
    /// is `max tan(d / 2) cos f` over the planes.
    ///
    /// After Treece, Prager & Gee (1999), section 3.4, whose equations (1) to (4) take the same steps; the third, which
    /// corrects for the plane, is Meusnier's theorem here. Not a number where a neighbour is missing.
    pub(super) fn weight(&self, around: &Surroundings, direction: usize) -> f64 {
        let edge = &self.edges[direction];
        let change = |d: usize| f64::from(around.neighbours[d]) - f64::from(around.difference);
        // The gradient along the edge, and across it on both sides of each plane.
        let along = change(direction) / edge.planes[0].length;
        let across = |plane: &Plane| {
            let [first, second] = plane.sides.map(change);
            let left = (first - along * plane.along_to_side) / plane.across_to_side;
            let right = (second - along * (plane.length - plane.along_to_side)) / -plane.across_to_side;
            [left, right]
        };
        let seen = |plane: &Plane| {
            let [left, right] = across(plane);
            0.5 * (left + right)
        };
        let sum: DVec3 = edge.planes.iter().map(|plane| plane.across * seen(plane)).sum();
        let gradient = edge.inverse * (sum + edge.unit * along);
        let sharpness = edge.planes.iter().map(|plane| {
            let [left, right] = across(plane).map(|across| (along, across));
            let in_plane = (along * along + gradient.dot(plane.across).powi(2)).sqrt();
            tan_half_angle(left, right) * in_plane / gradient.length()
        });
        // The first, so that not a number wins.
        sharpness.fold(0.0, |most, one| if one <= most { most } else { one })
    }
}

impl Edge {
    fn new(direction: usize, offsets: &[DVec3; DIRECTIONS]) -> Self {
        let (diagonal, unit) = (offsets[direction], offsets[direction].normalize());
        let mut planes = Vec::new();
        for first in 0..DIRECTIONS {
            let second = offsets.iter().position(|&offset| offset == diagonal - offsets[first]);
            let Some(second) = second.filter(|&second| first < second) else { continue };
            let along_to_side = offsets[first].dot(unit);
            let rejection = offsets[first] - unit * along_to_side;
            planes.push(Plane {
                sides: [first, second],
                across: rejection.normalize(),
                along_to_side,
                across_to_side: rejection.length(),
                length: diagonal.length(),
            });
        }
        let product = |v: DVec3| DMat3::from_cols(v * v.x, v * v.y, v * v.z);
        let sum = planes.iter().fold(product(unit), |sum, plane| sum + product(plane.across));
        Self { unit, planes, inverse: sum.inverse() }
    }
}

/// The tangent of half the angle between two vectors: `|u - v| / |u + v|` of their unit vectors.
fn tan_half_angle(a: (f64, f64), b: (f64, f64)) -> f64 {
    let unit = |(x, y): (f64, f64)| {
        let length = (x * x + y * y).sqrt();
        (x / length, y / length)
    };
    let (a, b) = (unit(a), unit(b));
    let length = |x: f64, y: f64| (x * x + y * y).sqrt();
    length(a.0 - b.0, a.1 - b.1) / length(a.0 + b.0, a.1 + b.1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    const BOTH: [Arrangement; 2] = [Arrangement::BodyCentred, Arrangement::SimpleCubic];

    fn surroundings(arrangement: Arrangement, f: impl Fn(DVec3) -> f64) -> Surroundings {
        let offsets = arrangement.directions().offsets;
        let at = |offset: [i8; 3]| f(DVec3::from_array(offset.map(f64::from)) * 0.01) as f32;
        Surroundings { position: Vec3::ZERO, difference: at([0; 3]), neighbours: offsets.map(at), ways: None }
    }

    #[test]
    fn each_edge_has_two_or_three_planes_with_equal_halves() {
        for arrangement in BOTH {
            let directions = arrangement.directions();
            for (d, edge) in Planes::get(arrangement).edges.iter().enumerate() {
                assert_eq!(2 * edge.planes.len() as u32, directions.links[d].count_ones());
                for plane in &edge.planes {
                    assert!(plane.sides.iter().all(|&side| directions.links[d] >> side & 1 != 0));
                }
            }
        }
    }

    #[test]
    fn a_plane_does_not_bend() {
        for arrangement in BOTH {
            let flat = surroundings(arrangement, |p| p.dot(DVec3::new(1.0, 0.7, -0.4)) + 0.003);
            for d in 0..DIRECTIONS {
                assert!(Planes::get(arrangement).weight(&flat, d) < 1e-4);
            }
        }
    }

    #[test]
    fn a_crease_bends_by_its_angle_whichever_plane_sees_it() {
        // A roof along y with a ridge through the z axis: each side falls by the slope. The angle between the normals
        // is 2 atan(slope), so that the weight is the slope, in the plane x = 0 of which the ridge is seen end on.
        let slope = 0.5;
        let roof = surroundings(Arrangement::BodyCentred, |p| 0.005 - p.z - slope * p.x.abs());
        let up = Arrangement::BodyCentred.directions().offsets.iter().position(|&o| o == [0, 0, 2]).unwrap();
        let weight = Planes::get(Arrangement::BodyCentred).weight(&roof, up);
        // Both planes through the edge stand at 45 degrees to the ridge: each sees a slope of slope / sqrt 2.
        assert!((weight - slope / 2f64.sqrt()).abs() < 1e-4, "{weight}");
    }

    #[test]
    fn a_missing_neighbour_is_not_flat() {
        let mut around = surroundings(Arrangement::SimpleCubic, |p| p.z + 0.003);
        around.neighbours[6] = f32::NAN;
        let planes = Planes::get(Arrangement::SimpleCubic);
        assert!(planes.weight(&around, 0).is_nan() && !planes.weight(&around, 4).is_nan());
    }
}
