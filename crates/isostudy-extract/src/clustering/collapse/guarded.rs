//! The guarded edge collapse: shortest edges first, and only where the surface stays what it is.

use std::cmp::{Ordering, Reverse};
use std::collections::{BinaryHeap, TryReserveError};

use glam::{DVec3, Vec3};

use super::{Merged, is_proper, unique_edges};
use crate::memory::{collected, copied, filled};

/// Least cosine between a triangle and the mean normal of the triangles round its edge: 78 degrees.
const LEAST_COSINE: f64 = 0.2;
/// An edge that had to stay may go when its neighbours have; a fourth pass found nothing on the evaluation's objects.
const PASSES: usize = 3;

/// Collapses edges up to half of `spacing`, shortest first: where vertices are then, and which are one.
///
/// The two ends meet at their midpoint or at one of them, wherever the worst triangle is best. An edge is left alone
/// when
/// - its ends have more than two common neighbours, or are two corners of a tetrahedron (the link condition: the
///   collapse would change the topology or fold two triangles onto each other);
/// - both ends lie on the boundary; with one on it, that end stays where it is;
/// - a triangle would turn away from the mean normal of those that are there now, or lose its area.
///
/// Normals are compared with the mean and not each with its own, because slivers have normals of noise. What gets
/// rid of slivers is the choice of three places and the later passes: with midpoints and one pass the evaluation's
/// body-centred sphere keeps 1,140 triangles of radius ratio below 0.1, with both none. Refusing a collapse because
/// the worst triangle gets worse was tried and leaves twice the triangles: the way to a good one leads through bad
/// ones.
///
/// Equal lengths go by vertex numbers, so the result depends on nothing else. The mesh must be a manifold, with or
/// without boundary.
///
/// Source of the link condition: Dey, Edelsbrunner, Guha & Nekhayev (1999).
pub(super) fn guarded(
    positions: Vec<Vec3>,
    triangles: &[[u32; 3]],
    spacing: f32,
) -> Result<(Vec<Vec3>, Merged), TryReserveError> {
    let mut surface = Surface::new(positions, triangles)?;
    let limit = spacing * spacing / 4.0;
    for _ in 0..PASSES {
        if !surface.collapse_up_to(limit)? {
            break;
        }
    }
    Ok((surface.positions, surface.merged))
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
    /// Scratch: neighbours of the two ends, and the triangles that stay when they meet.
    around: [Vec<u32>; 2],
    patch: Vec<Corner>,
}

/// The two other corners of a triangle with one at the edge that collapses, in the triangle's sense.
#[derive(Debug, Clone, Copy)]
struct Corner {
    others: [DVec3; 2],
}

impl Surface {
    fn new(positions: Vec<Vec3>, triangles: &[[u32; 3]]) -> Result<Self, TryReserveError> {
        let n = positions.len();
        let mut star_start = filled(n + 1, 0)?;
        for &v in triangles.iter().flatten() {
            star_start[v as usize + 1] += 1;
        }
        for v in 0..n {
            star_start[v + 1] += star_start[v];
        }
        let mut free = copied(&star_start)?;
        let mut star = filled(3 * triangles.len(), 0)?;
        for (t, triangle) in triangles.iter().enumerate() {
            for &v in triangle {
                star[free[v as usize] as usize] = t as u32;
                free[v as usize] += 1;
            }
        }
        let mut surface = Self {
            positions,
            triangles: copied(triangles)?,
            star,
            star_start,
            together: collected(0..n as u32)?,
            merged: Merged::none(n)?,
            age: filled(n, 0)?,
            on_boundary: filled(n, false)?,
            around: [Vec::new(), Vec::new()],
            patch: Vec::new(),
        };
        let mut neighbours = Vec::new();
        for v in 0..n as u32 {
            // Inside, each neighbour has two of the vertex's triangles.
            surface.neighbours(v, &mut neighbours);
            surface.on_boundary[v as usize] = neighbours.len() != surface.star(v).count();
        }
        Ok(surface)
    }

    /// One pass. Whether anything was collapsed.
    fn collapse_up_to(&mut self, limit: f32) -> Result<bool, TryReserveError> {
        let mut queue = BinaryHeap::new();
        for (a, b) in unique_edges(&self.triangles)? {
            self.queue(&mut queue, limit, a, b)?;
        }
        let mut neighbours = Vec::new();
        let mut any = false;
        while let Some(Reverse(edge)) = queue.pop() {
            let ages = [edge.a, edge.b].map(|v| self.age[v as usize]);
            if edge.ages == ages && self.collapse(edge.a, edge.b) {
                any = true;
                // Those at the merged vertex have new lengths.
                self.neighbours(edge.a, &mut neighbours);
                for &neighbour in &neighbours {
                    self.queue(&mut queue, limit, edge.a.min(neighbour), edge.a.max(neighbour))?;
                }
            }
        }
        Ok(any)
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

    fn queue(
        &self,
        queue: &mut BinaryHeap<Reverse<Edge>>,
        limit: f32,
        a: u32,
        b: u32,
    ) -> Result<(), TryReserveError> {
        let squared_length = self.positions[a as usize].distance_squared(self.positions[b as usize]);
        let both_on_boundary = self.on_boundary[a as usize] && self.on_boundary[b as usize];
        if squared_length <= limit && !both_on_boundary {
            let ages = [self.age[a as usize], self.age[b as usize]];
            queue.try_reserve(1)?;
            queue.push(Reverse(Edge { squared_length, a, b, ages }));
        }
        Ok(())
    }

    /// Collapses an edge into its end `a`, if it may be.
    fn collapse(&mut self, a: u32, b: u32) -> bool {
        if !self.meets_link_condition(a, b) {
            return false;
        }
        let Some(to) = self.best_place(a, b) else {
            return false;
        };
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

    fn meets_link_condition(&mut self, a: u32, b: u32) -> bool {
        let [mut around_a, mut around_b] = std::mem::take(&mut self.around);
        self.neighbours(a, &mut around_a);
        self.neighbours(b, &mut around_b);
        let common = around_a.iter().filter(|&v| around_b.binary_search(v).is_ok()).count();
        let is_tetrahedron = around_a.len() == 3 && around_b.len() == 3;
        self.around = [around_a, around_b];
        common == 2 && !is_tetrahedron
    }

    /// Where the ends of an edge may meet so that the worst triangle is best; the midpoint among equals.
    fn best_place(&mut self, a: u32, b: u32) -> Option<Vec3> {
        let mean_normal = self.fill_patch(a, b);
        let [p, q] = [a, b].map(|v| self.positions[v as usize]);
        let places = match [a, b].map(|v| self.on_boundary[v as usize]) {
            [true, true] => &[][..],
            [true, false] => &[p],
            [false, true] => &[q],
            [false, false] => &[p.midpoint(q), p, q],
        };
        let mut best = None;
        for &place in places {
            if let Some(worst) = self.worst_shape(place, mean_normal)
                && best.is_none_or(|(least, _)| worst > least)
            {
                best = Some((worst, place));
            }
        }
        best.map(|(_, place)| place)
    }

    /// Collects the triangles at the edge's ends but for the two at the edge itself. Returns the sum of the area
    /// vectors of all.
    fn fill_patch(&mut self, a: u32, b: u32) -> DVec3 {
        let mut patch = std::mem::take(&mut self.patch);
        patch.clear();
        let mut sum = DVec3::ZERO;
        for (v, other) in [(a, b), (b, a)] {
            for t in self.star(v) {
                let triangle = self.triangles[t];
                let k = triangle.iter().position(|&w| w == v).expect("a corner of its star");
                let [at, next, last] =
                    [0, 1, 2].map(|i| self.positions[triangle[(k + i) % 3] as usize].as_dvec3());
                let corner = Corner { others: [next, last] };
                if !triangle.contains(&other) {
                    sum += corner.doubled_area(at);
                    patch.push(corner);
                } else if v == a {
                    sum += corner.doubled_area(at);
                }
            }
        }
        self.patch = patch;
        sum
    }

    /// The worst triangle of the patch with its corners moved to `place`; `None` if one would turn away or lose its area.
    fn worst_shape(&self, place: Vec3, mean_normal: DVec3) -> Option<f64> {
        let place = place.as_dvec3();
        self.patch.iter().try_fold(f64::INFINITY, |worst, corner| {
            let area = corner.doubled_area(place);
            let least = LEAST_COSINE * mean_normal.length() * area.length();
            let shape = corner.shape(place);
            (area.dot(mean_normal) >= least && shape > 0.0).then(|| worst.min(shape))
        })
    }
}

impl Corner {
    fn doubled_area(&self, at: DVec3) -> DVec3 {
        (self.others[0] - at).cross(self.others[1] - at)
    }

    /// Area over the sum of squared sides: largest for the equilateral triangle, 0 without area.
    fn shape(&self, at: DVec3) -> f64 {
        let [p, q] = self.others;
        let squares = p.distance_squared(at) + q.distance_squared(at) + p.distance_squared(q);
        if squares > 0.0 { self.doubled_area(at).length() / squares } else { 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::super::collapse_traced;
    use super::*;
    use crate::settings::Topology;

    /// Positions and triangles of what is left.
    fn collapsed(positions: Vec<Vec3>, triangles: &[[u32; 3]], spacing: f32) -> (Vec<Vec3>, Vec<[u32; 3]>) {
        let after = collapse_traced(Topology::Guarded, spacing, positions, triangles).unwrap();
        (after.positions, after.triangles)
    }

    /// A flat patch: two vertices close together in a ring of six, the ring on the boundary.
    fn patch() -> (Vec<Vec3>, Vec<[u32; 3]>) {
        let ring = (0..6).map(|i| Vec3::from_array([(i as f32).cos(), (i as f32).sin(), 0.0]));
        let positions =
            [Vec3::new(-0.1, 0.0, 0.0), Vec3::new(0.1, 0.0, 0.0)].into_iter().chain(ring).collect();
        // Vertex 0 sees ring points 2..=5 on the left, vertex 1 the others.
        let triangles =
            vec![[1, 2, 3], [1, 3, 4], [0, 1, 4], [0, 4, 5], [0, 5, 6], [0, 6, 7], [1, 0, 7], [1, 7, 2]];
        (positions, triangles)
    }

    #[test]
    fn a_short_edge_goes_and_the_boundary_stays() {
        let (positions, triangles) = patch();
        let (after, rest) = collapsed(positions.clone(), &triangles, 0.4);
        assert_eq!((after.len(), rest.len()), (7, 6));
        assert!(positions[2..].iter().all(|p| after.contains(p)));
        let (after, rest) = collapsed(positions, &triangles, 0.39);
        assert_eq!((after.len(), rest.len()), (8, 8), "longer than half the spacing");
    }

    #[test]
    fn an_edge_to_the_boundary_ends_on_it() {
        let (mut positions, triangles) = patch();
        positions[0] = Vec3::new(-0.5, 0.1, 0.0);
        positions[1] = positions[2] - Vec3::new(0.05, 0.0, 0.0);
        let (after, rest) = collapsed(positions.clone(), &triangles, 0.2);
        assert_eq!((after.len(), rest.len()), (7, 6));
        assert!(after.contains(&positions[2]) && !after.contains(&positions[1]));
    }

    #[test]
    fn a_tetrahedron_stays_however_small() {
        let corners = vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z];
        let faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]];
        assert_eq!(collapsed(corners, &faces, 1000.0).1.len(), 4);
    }

    #[test]
    fn nothing_turns_over() {
        // Neither end, nor what lies between, sees the whole ring.
        let (mut positions, triangles) = patch();
        let ring = [[0.5, -1.0], [0.03, 1.2], [0.06, 0.6], [-0.5, 1.0], [-0.03, -1.2], [-0.06, -0.6]];
        for (vertex, [x, y]) in positions[2..].iter_mut().zip(ring) {
            *vertex = Vec3::new(x, y, 0.0);
        }
        let up = |triangle: &[u32; 3]| {
            let [a, b, c] = triangle.map(|v| positions[v as usize]);
            (b - a).cross(c - a).z > 0.0
        };
        assert!(triangles.iter().all(up));
        assert_eq!(collapsed(positions.clone(), &triangles, 0.5).1.len(), 8);
    }
}
