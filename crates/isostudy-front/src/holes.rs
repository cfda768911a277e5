//! Leftover loops of the front, closed with triangles of the least area.

use glam::DVec3;

use crate::patch::Patch;
use crate::step::faces;

/// The most edges of a loop that is closed.
const MOST_EDGES: usize = 16;

/// Closes the loops that can be. How many triangles it took. Of a loop that is `forced`, triangles may face any way: they are slivers
/// in creases, whose normal says nothing.
pub(crate) fn close(patch: &mut Patch, forced: impl Fn(&[u32]) -> bool) -> u64 {
    let mut triangles = 0;
    for corners in loops(patch) {
        let Some(ears) = ears(patch, &corners, forced(&corners)) else { continue };
        for ear in ears {
            // An earlier loop or ear may have taken the edge.
            if patch.is_free(ear) {
                patch.add_triangle(ear);
                triangles += 1;
            }
        }
    }
    triangles
}

/// The loops of the front, each as its vertices, by sectors.
pub(crate) fn loops(patch: &Patch) -> Vec<Vec<u32>> {
    let mut left = patch.front();
    let mut loops = Vec::new();
    while let Some(&[a, b]) = left.first() {
        let mut corners = Vec::new();
        let mut at = [a, b];
        while let Some(i) = left.iter().position(|edge| *edge == at) {
            left.remove(i);
            corners.push(at[0]);
            let Some((d, _)) = patch.sector_before(at[1], at[0]) else { break };
            at = [at[1], d];
        }
        if at == [a, b] {
            loops.push(corners);
        }
    }
    loops
}

/// The triangulation of a loop with the least area, of triangles that face the way of their corners.
fn ears(patch: &Patch, corners: &[u32], forced: bool) -> Option<Vec<[u32; 3]>> {
    let n = corners.len();
    if !(3..=MOST_EDGES).contains(&n) {
        return None;
    }
    let price = |i: usize, k: usize, j: usize| {
        let ear = [corners[i], corners[k], corners[j]];
        if ear[0] == ear[1] || ear[1] == ear[2] || ear[2] == ear[0] {
            return f64::INFINITY;
        }
        let [a, b, c] = ear.map(|v| patch.place(v));
        let is_inner = |p: usize, q: usize| (q + n - p) % n != 1 && (p + n - q) % n != 1;
        let is_taken = |p: usize, q: usize| {
            let (from, to) = (corners[p], corners[q]);
            is_inner(p, q) && (patch.is_used(from, to) || patch.is_used(to, from))
        };
        if is_taken(i, k)
            || is_taken(k, j)
            || is_taken(j, i)
            || !(forced || faces(ear.map(|v| patch.foot(v)), -0.3))
        {
            return f64::INFINITY;
        }
        DVec3::length((b - a).cross(c - a))
    };
    // best[i][j]: of the polygon from i to j.
    let mut best = vec![vec![(0.0, usize::MAX); n]; n];
    for span in 2..n {
        for i in 0..n - span {
            let j = i + span;
            best[i][j] = (i + 1..j)
                .map(|k| (best[i][k].0 + best[k][j].0 + price(i, k, j), k))
                .min_by(|a, b| a.0.total_cmp(&b.0))?;
        }
    }
    if !best[0][n - 1].0.is_finite() {
        return None;
    }
    let (mut ears, mut left) = (Vec::new(), vec![(0, n - 1)]);
    while let Some((i, j)) = left.pop() {
        if j - i > 1 {
            let k = best[i][j].1;
            ears.push([corners[i], corners[k], corners[j]]);
            left.extend([(i, k), (k, j)]);
        }
    }
    Some(ears)
}
