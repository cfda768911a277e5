//! The guarded edge collapse: shortest edges first, and only where the surface stays what it is.

use std::cmp::{Ordering, Reverse};
use std::collections::BinaryHeap;

use glam::{DVec3, Vec3};

use super::{Merged, rebuild, unique_edges};

/// A triangle may turn by 78 degrees at the most.
const LEAST_COSINE: f64 = 0.2;

/// Collapses edges up to half of `spacing`, shortest first, onto their midpoint, and renumbers what is left.
///
/// An edge is left alone when
/// - its ends have more than two common neighbours, or are two corners of a tetrahedron (the link condition: the
///   collapse would change topology or fold two triangles onto each other);
/// - both ends lie on the boundary; with one on it, that end stays where it is;
/// - a triangle would turn over or become a sliver, worse than any was before.
///
/// When an edge is collapsed those at the merged vertex have new lengths and are looked at again. Equal lengths go by
/// vertex numbers, so the result depends on nothing else. The mesh must be a manifold, with or without boundary.
///
/// Source of the link condition: Dey, Edelsbrunner, Guha & Nekhayev (1999).
pub(crate) fn guarded(
    positions: Vec<Vec3>,
    triangles: &[[u32; 3]],
    spacing: f32,
) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let mut surface = Surface::new(positions, triangles);
    let limit = spacing * spacing / 4.0;
    let mut queue = BinaryHeap::new();
    for (a, b) in unique_edges(triangles) {
        surface.queue(&mut queue, limit, a, b);
    }
    let mut neighbours = Vec::new();
    while let Some(Reverse(edge)) = queue.pop() {
        if edge.ages != [surface.age[edge.a as usize], surface.age[edge.b as usize]] {
            continue;
        }
        if surface.collapse(edge.a, edge.b) {
            surface.neighbours(edge.a, &mut neighbours);
            for &neighbour in &neighbours {
                surface.queue(&mut queue, limit, edge.a.min(neighbour), edge.a.max(neighbour));
            }
        }
    }
    rebuild(&surface.positions, triangles, &mut surface.merged)
}

/// An edge as it was when queued. Ordered by length, then by vertex numbers.
#[derive(Debug, Clone, Copy)]
struct Edge {
    squared_length: f32,
    a: u32,
    b: u32,
    ages: [u32; 2],
}

impl Ord for Edge {
    fn cmp(&self, other: &Self) -> Ordering {
        let by_length = self.squared_length.total_cmp(&other.squared_length);
        by_length.then((self.a, self.b, self.ages).cmp(&(other.a, other.b, other.ages)))
    }
}

impl PartialOrd for Edge {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Edge {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Edge {}

struct Surface {
    positions: Vec<Vec3>,
    /// Corners as they are now.
    triangles: Vec<[u32; 3]>,
    /// The triangles of each vertex of the original mesh, one after the other.
    star: Vec<u32>,
    star_start: Vec<u32>,
    /// A circle through the original vertices that are now one vertex.
    together: Vec<u32>,
    merged: Merged,
    /// How often a vertex has been moved; the last value once it is gone.
    age: Vec<u32>,
    on_boundary: Vec<bool>,
    /// Scratch.
    around: [Vec<u32>; 2],
}

impl Surface {
    fn new(positions: Vec<Vec3>, triangles: &[[u32; 3]]) -> Self {
        let n = positions.len();
        let mut star_start = vec![0; n + 1];
        for &v in triangles.iter().flatten() {
            star_start[v as usize + 1] += 1;
        }
        for v in 0..n {
            star_start[v + 1] += star_start[v];
        }
        let mut free = star_start.clone();
        let mut star = vec![0; 3 * triangles.len()];
        for (t, triangle) in triangles.iter().enumerate() {
            for &v in triangle {
                star[free[v as usize] as usize] = t as u32;
                free[v as usize] += 1;
            }
        }
        let mut surface = Self {
            positions,
            triangles: triangles.to_vec(),
            star,
            star_start,
            together: (0..n as u32).collect(),
            merged: Merged { into: (0..n as u32).collect() },
            age: vec![0; n],
            on_boundary: vec![false; n],
            around: [Vec::new(), Vec::new()],
        };
        let mut neighbours = Vec::new();
        for v in 0..n as u32 {
            // Inside, each neighbour has two of the vertex's triangles.
            surface.neighbours(v, &mut neighbours);
            surface.on_boundary[v as usize] = neighbours.len() != surface.star(v).count();
        }
        surface
    }

    /// Triangles at a vertex that still have three corners.
    fn star(&self, v: u32) -> impl Iterator<Item = usize> + '_ {
        let mut at = Some(v);
        std::iter::from_fn(move || {
            let here = at?;
            let next = self.together[here as usize];
            at = (next != v).then_some(next);
            Some(here)
        })
        .flat_map(|w| {
            let [from, to] = [w, w + 1].map(|w| self.star_start[w as usize] as usize);
            self.star[from..to].iter().map(|&t| t as usize)
        })
        .filter(|&t| is_proper(self.triangles[t]))
    }

    /// The vertices joined to `v`, each once.
    fn neighbours(&self, v: u32, neighbours: &mut Vec<u32>) {
        neighbours.clear();
        neighbours.extend(self.star(v).flat_map(|t| self.triangles[t]).filter(|&w| w != v));
        neighbours.sort_unstable();
        neighbours.dedup();
    }

    fn queue(&self, queue: &mut BinaryHeap<Reverse<Edge>>, limit: f32, a: u32, b: u32) {
        let squared_length = self.positions[a as usize].distance_squared(self.positions[b as usize]);
        let both_on_boundary = self.on_boundary[a as usize] && self.on_boundary[b as usize];
        if squared_length <= limit && !both_on_boundary {
            let ages = [self.age[a as usize], self.age[b as usize]];
            queue.push(Reverse(Edge { squared_length, a, b, ages }));
        }
    }

    /// Collapses an edge into its end `a`, if it may be.
    fn collapse(&mut self, a: u32, b: u32) -> bool {
        let mut around = std::mem::take(&mut self.around);
        let [around_a, around_b] = &mut around;
        self.neighbours(a, around_a);
        self.neighbours(b, around_b);
        let common = around_a.iter().filter(|&v| around_b.binary_search(v).is_ok()).count();
        let is_tetrahedron = around_a.len() == 3 && around_b.len() == 3;
        self.around = around;
        let [p, q] = [a, b].map(|v| self.positions[v as usize]);
        let to = match [a, b].map(|v| self.on_boundary[v as usize]) {
            [false, false] => (p + q) * 0.5,
            [true, _] => p,
            [_, true] => q,
        };
        if common != 2 || is_tetrahedron || !self.keeps_shape(a, b, to) {
            return false;
        }
        let star: Vec<usize> = self.star(b).collect();
        for t in star {
            self.triangles[t] = self.triangles[t].map(|v| if v == b { a } else { v });
        }
        self.positions[a as usize] = to;
        self.on_boundary[a as usize] |= self.on_boundary[b as usize];
        self.together.swap(a as usize, b as usize);
        self.merged.into[b as usize] = a;
        self.age[a as usize] += 1;
        self.age[b as usize] = u32::MAX;
        true
    }

    /// Whether no triangle turns over or becomes a sliver when `a` and `b` meet at `to`.
    fn keeps_shape(&self, a: u32, b: u32, to: Vec3) -> bool {
        let kept = |(v, other): (u32, u32)| {
            self.star(v).map(|t| self.triangles[t]).filter(move |triangle| !triangle.contains(&other))
        };
        [(a, b), (b, a)].into_iter().flat_map(kept).all(|triangle| {
            let old = triangle.map(|v| self.positions[v as usize]);
            let new = triangle.map(|v| if v == a || v == b { to } else { self.positions[v as usize] });
            let (before, after) = (doubled_area(old), doubled_area(new));
            before.dot(after) >= LEAST_COSINE * before.length() * after.length()
        })
    }
}

fn is_proper([a, b, c]: [u32; 3]) -> bool {
    a != b && b != c && c != a
}

fn doubled_area(corners: [Vec3; 3]) -> DVec3 {
    let [a, b, c] = corners.map(|p| p.as_dvec3());
    (b - a).cross(c - a)
}
