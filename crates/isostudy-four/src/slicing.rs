//! Tetrahedra of space-time cut at one time.
//!
//! Tetrahedra come with the normal first: `det(n, b - a, c - a, d - a) > 0`. The two triangles that follow each other at a cut, and then
//! a way to later times, are such a system too.

use std::ops::Range;

use glam::DVec4;
use isostudy_mesh::TriangleMesh;

use crate::surface::sort;

/// The triangles of tetrahedra in a frame, whose vertices are a range: of tetrahedra before it, or after.
pub(crate) fn in_frame(
    positions: &[DVec4],
    tetrahedra: &[[u32; 4]],
    frame: Range<u32>,
    are_before: bool,
) -> TriangleMesh {
    let mut triangles = Vec::new();
    for tetrahedron in tetrahedra {
        let outside = |v: &u32| !frame.contains(v);
        if tetrahedron.iter().filter(|v| outside(v)).count() != 1 {
            continue;
        }
        let apex = tetrahedron.iter().position(outside).expect("there is one");
        let (_, [b, c, d]) = first(tetrahedron, apex);
        let [b, c, d] = [b, c, d].map(|v| v - frame.start);
        // The way to later times is towards the apex, or away from it.
        triangles.push(if are_before { [b, c, d] } else { [b, d, c] });
    }
    sort(&mut triangles);
    let [start, end] = [frame.start, frame.end].map(|v| v as usize);
    let positions = positions[start..end].iter().map(|p| p.truncate().as_vec3()).collect();
    TriangleMesh { positions, triangles, normals: Vec::new() }
}

/// The cut between frames.
pub(crate) fn between_frames(positions: &[DVec4], tetrahedra: &[[u32; 4]], time: f64) -> TriangleMesh {
    let is_later = |v: u32| positions[v as usize].w > time;
    let mut corners: Vec<[u64; 3]> = Vec::new();
    for tetrahedron in tetrahedra {
        let later = tetrahedron.map(is_later);
        match later.iter().filter(|later| **later).count() {
            0 | 4 => {}
            2 => {
                let ([a, b], [c, d]) = halves(tetrahedron, later);
                let quad = [[a, c], [a, d], [b, d], [b, c]].map(side);
                let at = quad.map(|side| crossing(positions, side, time));
                // The shorter diagonal makes the rounder triangles.
                let [p, q, r, s] = quad;
                if at[0].distance_squared(at[2]) <= at[1].distance_squared(at[3]) {
                    corners.extend([[p, q, r], [p, r, s]]);
                } else {
                    corners.extend([[p, q, s], [q, r, s]]);
                }
            }
            count => {
                let alone = later.iter().position(|&later| later == (count == 1)).expect("there is one");
                let (a, [b, c, d]) = first(tetrahedron, alone);
                let [b, c, d] = [b, c, d].map(|v| side([a, v]));
                corners.push(if count == 1 { [b, d, c] } else { [b, c, d] });
            }
        }
    }
    let mut sides: Vec<u64> = corners.as_flattened().to_vec();
    sides.sort_unstable();
    sides.dedup();
    let number = |side: u64| sides.binary_search(&side).expect("it is a corner") as u32;
    let mut triangles: Vec<[u32; 3]> = corners.iter().map(|corners| corners.map(number)).collect();
    sort(&mut triangles);
    let positions = sides.iter().map(|&side| crossing(positions, side, time).truncate().as_vec3()).collect();
    TriangleMesh { positions, triangles, normals: Vec::new() }
}

/// A vertex, and the others so that all four in this order face the same way.
fn first(tetrahedron: &[u32; 4], which: usize) -> (u32, [u32; 3]) {
    let [a, b, c, d] = *tetrahedron;
    match which {
        0 => (a, [b, c, d]),
        1 => (b, [a, d, c]),
        2 => (c, [a, b, d]),
        _ => (d, [a, c, b]),
    }
}

/// The two vertices that are earlier and the two that are later, so that all four in this order face the same way.
fn halves(tetrahedron: &[u32; 4], later: [bool; 4]) -> ([u32; 2], [u32; 2]) {
    let [a, b, c, d] = *tetrahedron;
    match later {
        [false, false, true, true] => ([a, b], [c, d]),
        [true, true, false, false] => ([c, d], [a, b]),
        [false, true, false, true] => ([a, c], [d, b]),
        [true, false, true, false] => ([b, d], [c, a]),
        [false, true, true, false] => ([a, d], [b, c]),
        _ => ([b, c], [a, d]),
    }
}

/// Two vertices as one number, the lower first.
fn side([a, b]: [u32; 2]) -> u64 {
    u64::from(a.min(b)) << 32 | u64::from(a.max(b))
}

fn crossing(positions: &[DVec4], side: u64, time: f64) -> DVec4 {
    let [a, b] = [(side >> 32) as u32, side as u32].map(|v| positions[v as usize]);
    // One is later and the other is not.
    a + (b - a) * ((time - a.w) / (b.w - a.w))
}
