//! Points of an isosurface's sharp edges: where its normal jumps.

use std::collections::HashMap;

use glam::{DVec3, Vec3};
use mesh::TriangleMesh;

use crate::level::Level;

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
/// if both faces are flat.
pub(crate) fn between(level: &Level, [a, b]: [Vec3; 2], reach: f32) -> Option<DVec3> {
    let place = |p: Vec3| {
        let position = level.foot(p, reach)?.position;
        Some(Place { position: position.as_dvec3(), normal: level.normal(position)?.as_dvec3() })
    };
    let near = NEAR * f64::from(level.spacing);
    let [mut a, mut b] = [place(a)?, place(b)?];
    for _ in 0..MOST_STEPS {
        if a.normal.dot(b.normal) > SHARP {
            return None;
        }
        let middle = 0.5 * (a.position + b.position);
        if a.position.distance(b.position) <= near {
            return Some(meeting(&a, &b).filter(|p| p.distance(middle) <= near).unwrap_or(middle));
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

/// Points of the sharp edges between triangles, a `step` of their length apart.
pub(crate) fn of_triangles(triangles: &[[Vec3; 3]], step: f64) -> Vec<DVec3> {
    let mut points = Vec::new();
    // How far it is to the next point.
    let mut next = 0.5 * step;
    let mut normals: HashMap<[[u32; 3]; 2], DVec3> = HashMap::new();
    for corners in triangles {
        let [a, b, c] = corners.map(Vec3::as_dvec3);
        let Some(normal) = (b - a).cross(c - a).try_normalize() else { continue };
        for (from, to) in [(0, 1), (1, 2), (2, 0)] {
            let mut ends = [corners[from], corners[to]];
            let bits = |p: Vec3| p.to_array().map(|x| (x + 0.0).to_bits());
            if bits(ends[0]) > bits(ends[1]) {
                ends.reverse();
            }
            let Some(other) = normals.insert(ends.map(bits), normal) else { continue };
            if normal.dot(other) > SHARP {
                continue;
            }
            let [from, to] = ends.map(Vec3::as_dvec3);
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
