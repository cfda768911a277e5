//! Old vertices taken out, and edges flipped.

use crate::decimate::shape;
use crate::surface::{Surface, VertexKind};
use isostudy_mesh::glam::DVec3;

/// What the triangles of a removal must be at least, pass by pass, good ones first: their [`shape`], and the cosine between their normal
/// and the mean of those at their corners.
const PASSES: [Upright; 4] = [
    Upright { shape: 0.3, cosine: 0.3 },
    Upright { shape: 0.1, cosine: 0.3 },
    Upright { shape: 0.01, cosine: 0.1 },
    Upright { shape: 0.0, cosine: 0.0 },
];
/// The least cosine of triangles that a flip makes.
const FLIPPED: f64 = 0.3;
/// Passes over all edges at most.
const MOST_FLIPS: usize = 12;

/// Takes out the vertices below `old` that are inside. Returns those that must stay, or the topology would change or a triangle fold.
pub(crate) fn remove(
    surface: &mut Surface,
    mut kinds: Vec<VertexKind>,
    old: u32,
    normals: &[DVec3],
) -> Vec<u32> {
    let mut left: Vec<u32> = (0..old).filter(|&v| kinds[v as usize] == VertexKind::Inner).collect();
    kinds.resize(surface.positions.len(), VertexKind::Inner);
    let mut removal = Removal { surface, kinds, normals, scratch: [Vec::new(), Vec::new()] };
    loop {
        let before = left.len();
        for least in PASSES {
            left.retain(|&v| !removal.take_out(v, least));
        }
        removal.flip();
        if left.is_empty() || left.len() == before {
            return left;
        }
    }
}

#[derive(Clone, Copy)]
struct Upright {
    shape: f64,
    cosine: f64,
}

struct Removal<'a> {
    surface: &'a mut Surface,
    kinds: Vec<VertexKind>,
    normals: &'a [DVec3],
    scratch: [Vec<u32>; 2],
}

impl Removal<'_> {
    /// Moves a vertex into the neighbour that leaves the best triangles. Returns whether one is good enough.
    fn take_out(&mut self, v: u32, least: Upright) -> bool {
        let mut around = Vec::new();
        self.surface.neighbours(v, &mut around);
        let mut best: Option<(f64, u32)> = None;
        for &w in &around {
            if self.kinds[w as usize] == VertexKind::Singular {
                continue;
            }
            let Some(worst) = self.worst_after(v, w, least.cosine).filter(|worst| *worst > least.shape)
            else {
                continue;
            };
            if best.is_none_or(|(of, _)| worst > of)
                && self.surface.may_collapse(w, v, &self.kinds, &mut self.scratch)
            {
                best = Some((worst, w));
            }
        }
        let Some((_, w)) = best else { return false };
        let position = self.surface.positions[w as usize];
        self.surface.collapse(w, v, position);
        self.kinds[v as usize] = VertexKind::Unused;
        true
    }

    /// The least shape of the triangles that would be there if `v` moved into `w`; `None` if one would fold.
    fn worst_after(&self, v: u32, w: u32, cosine: f64) -> Option<f64> {
        let mut worst = f64::INFINITY;
        for (t, k) in self.surface.triangles_at(v) {
            let mut corners = self.surface.triangles[t as usize];
            if !corners.contains(&w) {
                corners[k] = w;
                worst = worst.min(self.shape_if_upright(corners, cosine)?);
            }
        }
        Some(worst)
    }

    /// The shape of a triangle between these vertices; `None` if it faces away from the surface.
    fn shape_if_upright(&self, corners: [u32; 3], cosine: f64) -> Option<f64> {
        let places = corners.map(|v| self.surface.position(v));
        let area_vector = (places[1] - places[0]).cross(places[2] - places[0]);
        let normal: DVec3 = corners.iter().map(|&v| self.normals[v as usize]).sum();
        let is_upright = area_vector.dot(normal) > cosine * area_vector.length() * normal.length();
        is_upright.then(|| shape(places, area_vector))
    }

    /// Flips edges where the worse of both triangles gets better by it.
    fn flip(&mut self) {
        for _ in 0..MOST_FLIPS {
            let mut edges = Vec::new();
            for (t, &corners) in (0..).zip(&self.surface.triangles) {
                if self.surface.is_alive(t) {
                    let of = [0, 1, 2].map(|k| [corners[k], corners[(k + 1) % 3]]);
                    edges.extend(of.into_iter().filter(|[u, v]| u < v));
                }
            }
            edges.sort_unstable();
            let flips = edges.into_iter().filter(|&[u, v]| self.flip_edge(u, v)).count();
            if flips == 0 {
                break;
            }
        }
    }

    fn flip_edge(&mut self, u: u32, v: u32) -> bool {
        if self.surface.triangles_of_edge(u, v).count() != 2 {
            return false;
        }
        let sides = (self.surface.triangle_along(u, v), self.surface.triangle_along(v, u));
        let (Some((t, w)), Some((other, x))) = sides else { return false };
        if w == x || self.surface.triangles_of_edge(w, x).next().is_some() {
            return false;
        }
        let own = |t: u32| shape(self.surface.corners(t), self.surface.area_vector(t));
        let before = own(t).min(own(other));
        let after = [[w, u, x], [x, v, w]].map(|corners| self.shape_if_upright(corners, FLIPPED));
        let [Some(first), Some(second)] = after else { return false };
        // What is turned over is never better than what is not.
        let is_folded = [[u, v, w], [v, u, x]].iter().any(|of| self.shape_if_upright(*of, 0.0).is_none());
        if first.min(second) > before + 1e-9 || (is_folded && first.min(second) > 0.0) {
            self.surface.flip(t, other, [u, v, w, x]);
            return true;
        }
        false
    }
}
