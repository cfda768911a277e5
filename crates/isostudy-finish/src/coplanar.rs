//! Flat regions triangulated anew by their outlines alone.
//!
//! The paper calls it coplanarisation. Each region of triangles in one plane becomes the fewest triangles that its outline allows:
//! `n - 2 + 2 h` for `n` vertices and `h` holes (de Berg, Cheong, van Kreveld and Overmars 2008, section 3). Vertices on straight parts of
//! an outline are left out on both sides of it.

mod outline;
mod polygon;
mod regions;

use crate::surface::{Surface, VertexKind, compact};
use isostudy_mesh::TriangleMesh;
use isostudy_mesh::glam::DVec3;
use outline::Outlines;
use regions::Regions;
use std::collections::HashMap;

/// What single precision cannot tell from flat: so many units in the last place of the largest coordinate.
const FLAT: f64 = 4.0 / (1 << 24) as f64;

/// The mesh with its flat regions triangulated anew. Vertices that are left stay where they are, and so does each outline, to the
/// tolerance. Topology stays. A region that cannot be drawn by its outline keeps its triangles: one that has a fault, is no disk with
/// holes, or would use an edge that others use.
pub(crate) fn coplanar(mesh: &TriangleMesh, tolerance: f64) -> TriangleMesh {
    let surface = Surface::of(mesh);
    let largest = surface
        .triangles
        .iter()
        .flatten()
        .map(|&v| f64::from(surface.positions[v as usize].abs().max_element()))
        .fold(0.0, f64::max);
    let slack = FLAT * largest;
    let tolerance = tolerance.max(slack);
    let regions = Regions::of(&surface, tolerance);
    let kinds = surface.kinds();
    let mut is_kept: Vec<bool> =
        (0..regions.count()).map(|r| is_left_alone(r, &surface, &regions, &kinds)).collect();
    // Each round keeps more regions as they are. A region that is kept keeps its vertices, so its neighbours try again.
    loop {
        let outlines = Outlines::of(&surface, &regions, &kinds, &is_kept, tolerance);
        let mut failed = Vec::new();
        let mut drawn: Vec<Vec<[u32; 3]>> = Vec::with_capacity(regions.count());
        for (r, &is_kept) in is_kept.iter().enumerate() {
            let own = || regions.triangles(r).iter().map(|&t| surface.triangles[t as usize]).collect();
            let triangles = if is_kept { None } else { draw(r, &surface, &regions, &outlines, slack) };
            if triangles.is_none() && !is_kept {
                failed.push(r);
            }
            drawn.push(triangles.unwrap_or_else(own));
        }
        if failed.is_empty() {
            failed = crowded(&drawn, &is_kept);
        }
        if failed.is_empty() {
            return compact(&surface.positions, &drawn.concat());
        }
        failed.into_iter().for_each(|r| is_kept[r] = true);
    }
}

/// A region with a vertex at a fault is left alone, and so is one of a single triangle.
fn is_left_alone(r: usize, surface: &Surface, regions: &Regions, kinds: &[VertexKind]) -> bool {
    let triangles = regions.triangles(r);
    let is_singular = |&v: &u32| kinds[v as usize] == VertexKind::Singular;
    triangles.len() == 1 || triangles.iter().any(|&t| surface.triangles[t as usize].iter().any(is_singular))
}

/// The new triangles of a region; `None` if its outline cannot be drawn.
fn draw(
    r: usize,
    surface: &Surface,
    regions: &Regions,
    outlines: &Outlines,
    slack: f64,
) -> Option<Vec<[u32; 3]>> {
    let normal = regions.normal(r);
    let (along, across) = axes(normal);
    let flat = |v: u32| {
        let p = surface.position(v);
        [p.dot(along), p.dot(across)]
    };
    let loops = outlines.loops(r)?;
    if !is_disk_with_holes(r, surface, regions, loops.len()) {
        return None;
    }
    let area: f64 = regions.triangles(r).iter().map(|&t| 0.5 * surface.area_vector(t).dot(normal)).sum();
    polygon::triangulate(&loops, flat, area, slack)
}

/// Whether vertices, edges and triangles count up to a disk with so many outlines.
fn is_disk_with_holes(r: usize, surface: &Surface, regions: &Regions, loops: usize) -> bool {
    let triangles = regions.triangles(r);
    let mut vertices = Vec::with_capacity(3 * triangles.len());
    let mut edges = Vec::with_capacity(3 * triangles.len());
    for &t in triangles {
        let corners = surface.triangles[t as usize];
        vertices.extend(corners);
        edges.extend([0, 1, 2].map(|k| {
            let (u, v) = (corners[k], corners[(k + 1) % 3]);
            [u.min(v), u.max(v)]
        }));
    }
    vertices.sort_unstable();
    vertices.dedup();
    edges.sort_unstable();
    edges.dedup();
    vertices.len() as i64 - edges.len() as i64 + triangles.len() as i64 == 2 - loops as i64
}

/// Two directions that make a right-handed frame with a normal.
fn axes(normal: DVec3) -> (DVec3, DVec3) {
    let least = if normal.x.abs() <= normal.y.abs().min(normal.z.abs()) {
        DVec3::X
    } else if normal.y.abs() <= normal.z.abs() {
        DVec3::Y
    } else {
        DVec3::Z
    };
    let along = least.cross(normal).normalize();
    (along, normal.cross(along))
}

/// Regions drawn anew that have an edge with more than two triangles.
fn crowded(drawn: &[Vec<[u32; 3]>], is_kept: &[bool]) -> Vec<usize> {
    let mut used: HashMap<[u32; 2], u32> = HashMap::new();
    let edges = |corners: &[u32; 3]| {
        let [a, b, c] = *corners;
        [[a, b], [b, c], [c, a]].map(|[u, v]| [u.min(v), u.max(v)])
    };
    for corners in drawn.iter().flatten() {
        for edge in edges(corners) {
            *used.entry(edge).or_default() += 1;
        }
    }
    let is_crowded = |corners: &[u32; 3]| edges(corners).iter().any(|edge| used[edge] > 2);
    (0..drawn.len()).filter(|&r| !is_kept[r] && drawn[r].iter().any(is_crowded)).collect()
}

#[cfg(test)]
mod tests;
