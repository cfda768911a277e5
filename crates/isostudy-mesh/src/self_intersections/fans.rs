//! Triangles round a common corner.
//!
//! The boxes of all of them meet there, so that boxes tell nothing. What two of them share beside the corner goes on to the corner, since
//! both are convex: they meet if and only if, seen from it, the arcs that they cover meet. So arcs are put into boxes instead. Round a
//! common side the same is true of the directions in which the third corners lie from it.

use glam::{DVec3, Vec3};

use super::tree::Around;

/// What a unit vector's coordinates may be off by, with all that is computed here.
const ROUNDING: f64 = 1e-12;

/// The box of the arc that a triangle covers, seen from its corner `apex`.
pub(super) fn arc(corners: &[Vec3; 3], apex: Vec3) -> Around {
    let mut ends = corners.iter().filter(|corner| **corner != apex);
    let mut direction = || (ends.next().expect("it has an area").as_dvec3() - apex.as_dvec3()).normalize();
    let [one, other] = [direction(), direction()];
    // No point of an arc is farther from its chord than its middle.
    let sagitta = 1.0 - 0.5 * (one + other).length();
    Around::of([one, other]).wider(sagitta + ROUNDING)
}

/// The box of the direction in which a triangle lies from its side `[from, to]`, across it.
pub(super) fn across(corners: &[Vec3; 3], [from, to]: [Vec3; 2]) -> Around {
    let third = corners.iter().find(|corner| **corner != from && **corner != to);
    let third = third.expect("it has an area").as_dvec3() - from.as_dvec3();
    let along = (to.as_dvec3() - from.as_dvec3()).normalize();
    let aside = third - along * third.dot(along);
    let length = aside.length();
    if length <= ROUNDING * third.length() {
        // Anywhere.
        return Around::of([DVec3::NEG_ONE, DVec3::ONE]).wider(ROUNDING);
    }
    let error = ROUNDING * (1.0 + third.length() / length);
    Around::of([aside / length]).wider(error)
}
