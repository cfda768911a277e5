//! Points of an isosurface's sharp edges: where its normal jumps.

use std::collections::HashMap;

use glam::{DVec3, Vec3};
use isostudy_mesh::{Bounds, TriangleMesh};

use crate::sampling::level::Level;

/// The cosine of 30 degrees: where normals on both sides differ by more, an edge is sharp.
const SHARP: f64 = 0.866_025_403_784_438_6;
/// The cosine of 8 degrees. An extraction rounds an edge over its own cells; its normals at the ends of one of its edges still differ
/// by a good part of what the isosurface's do.
const SUSPECT: f32 = 0.990_268_1;
/// So close to each other, in spacings, normals are compared: farther apart than differences are wide.
const NEAR: f64 = 1.0 / 16.0;
/// Halvings; six suffice where an edge is straight.
const MOST_STEPS: usize = 24;

/// A point of the isosurface, and its unit normal.
#[derive(Clone, Copy)]
struct Place {
    position: DVec3,
    normal: DVec3,
}

/// Edges of an extraction at whose ends its own normals differ: a sharp edge of the isosurface may pass between them.
pub(crate) fn suspects(found: &TriangleMesh) -> Vec<[Vec3; 2]> {
    let edges = found.triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
    // Its two triangles run along an edge in opposite directions.
    let once = edges.filter(|[a, b]| a < b).map(|edge| edge.map(|v| v as usize));
    let bends = |&[a, b]: &[usize; 2]| found.normals[a].dot(found.normals[b]) < SUSPECT;
    once.filter(bends).map(|edge| edge.map(|v| found.positions[v])).collect()
}

/// The point of a sharp edge that passes between two points near the isosurface; `reach` is how far it is looked for from each.
///
/// The two are moved to the isosurface, and the way between them is halved where the normal changes more, until they are a
/// sixteenth of a spacing apart. If their normals still differ by 30 degrees, the edge is where their tangent planes meet: exactly,
/// if both faces are flat. In a thin wedge that is farther away, by a spacing at most, and the isosurface must be there. Two sides
/// of a sheet have no edge between them.
pub(crate) fn between(level: &Level, [a, b]: [Vec3; 2], reach: f32) -> Option<DVec3> {
    let place = |p: Vec3| {
        let position = level.foot(p, reach)?.position;
        Some(Place { position: position.as_dvec3(), normal: level.normal(position)?.as_dvec3() })
    };
    let spacing = f64::from(level.spacing);
    let near = NEAR * spacing;
    let [mut a, mut b] = [place(a)?, place(b)?];
    for _ in 0..MOST_STEPS {
        if a.normal.dot(b.normal) > SHARP {
            return None;
        }
        let middle = 0.5 * (a.position + b.position);
        if a.position.distance(b.position) <= near {
            let edge = meeting(&a, &b)?;
            let is_there = || {
                let foot = level.foot(edge.as_vec3(), level.spacing);
                edge.distance(middle) <= spacing && foot.is_some_and(|foot| foot.distance <= near)
            };
            return (edge.distance(middle) <= near || is_there()).then_some(edge);
        }
        let middle = place(middle.as_vec3())?;
        if a.normal.dot(middle.normal) < middle.normal.dot(b.normal) {
            b = middle;
        } else {
            a = middle;
        }
    }
    None
}

/// The point that lies in both tangent planes, and nearest to the middle of both points.
fn meeting(a: &Place, b: &Place) -> Option<DVec3> {
    let middle = 0.5 * (a.position + b.position);
    let [to_a, to_b] = [a, b].map(|of| of.normal.dot(of.position - middle));
    let cosine = a.normal.dot(b.normal);
    let way = a.normal * (to_a - cosine * to_b) + b.normal * (to_b - cosine * to_a);
    let meeting = middle + way / (1.0 - cosine * cosine);
    meeting.is_finite().then_some(meeting)
}

/// Points of the sharp edges between triangles within a box, a `step` of their length apart. An edge of two triangles is found, next
/// to one without an area it is not.
pub(crate) fn of_triangles(triangles: &[[Vec3; 3]], bounds: &Bounds, step: f64) -> Vec<DVec3> {
    let mut points = Vec::new();
    // How far it is to the next point.
    let mut next = 0.5 * step;
    let mut normals: HashMap<[[u32; 3]; 2], DVec3> = HashMap::new();
    for corners in triangles {
        let [a, b, c] = corners.map(Vec3::as_dvec3);
        let Some(normal) = (b - a).cross(c - a).try_normalize() else { continue };
        for (from, to) in [(0, 1), (1, 2), (2, 0)] {
            let mut ends = [corners[from], corners[to]];
            // The sum is 0 for -0 as well.
            let bits = |p: Vec3| (p + Vec3::ZERO).to_array().map(f32::to_bits);
            if bits(ends[0]) > bits(ends[1]) {
                ends.reverse();
            }
            let Some(other) = normals.remove(&ends.map(bits)) else {
                normals.insert(ends.map(bits), normal);
                continue;
            };
            let Some([from, to]) = (normal.dot(other) <= SHARP).then(|| clipped(ends, bounds)).flatten()
            else {
                continue;
            };
            let length = from.distance(to);
            while next < length {
                points.push(from.lerp(to, next / length));
                next += step;
            }
            next -= length;
        }
    }
    points
}

/// The part of a straight line that is in a box; `None` if it has no length.
fn clipped(ends: [Vec3; 2], bounds: &Bounds) -> Option<[DVec3; 2]> {
    let [from, to] = ends.map(Vec3::as_dvec3);
    let way = to - from;
    let [to_min, to_max] = [bounds.min, bounds.max].map(|side| side.as_dvec3() - from);
    let (mut enters, mut leaves) = (0f64, 1f64);
    for axis in 0..3 {
        let sides = [to_min[axis], to_max[axis]];
        if way[axis] == 0.0 {
            if sides[0] > 0.0 || sides[1] < 0.0 {
                return None;
            }
            continue;
        }
        let [first, second] = sides.map(|side| side / way[axis]);
        (enters, leaves) = (enters.max(first.min(second)), leaves.min(first.max(second)));
    }
    (enters < leaves).then(|| [enters, leaves].map(|share| from + share * way))
}
