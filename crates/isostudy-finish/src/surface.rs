//! A mesh whose edges can be collapsed and flipped, and the conditions under which its topology stays.

use isostudy_mesh::TriangleMesh;
use isostudy_mesh::glam::{DVec3, Vec3};

/// The end of a chain of corners.
const NONE: u32 = u32::MAX;

/// What the triangles at a vertex form.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum VertexKind {
    /// No triangle.
    Unused,
    /// One closed fan.
    Inner,
    /// One open fan: the vertex lies on a border.
    Border,
    /// Several fans, or an edge with more than two triangles or with two that face opposite ways: what no step may touch.
    Singular,
}

/// Triangles that know their neighbours. Corners are numbered `3 * triangle + k`, and those of a vertex form a chain.
pub(crate) struct Surface {
    pub(crate) positions: Vec<Vec3>,
    pub(crate) triangles: Vec<[u32; 3]>,
    is_alive: Vec<bool>,
    alive: usize,
    first_corner: Vec<u32>,
    next_corner: Vec<u32>,
}

impl Surface {
    /// The triangles of a mesh that have three different vertices.
    pub(crate) fn of(mesh: &TriangleMesh) -> Self {
        let triangles: Vec<[u32; 3]> = mesh.triangles.iter().copied().filter(is_proper).collect();
        let mut surface = Self {
            positions: mesh.positions.clone(),
            is_alive: Vec::with_capacity(triangles.len()),
            alive: 0,
            first_corner: vec![NONE; mesh.positions.len()],
            next_corner: Vec::with_capacity(3 * triangles.len()),
            triangles: Vec::with_capacity(triangles.len()),
        };
        for triangle in triangles {
            surface.add_triangle(triangle);
        }
        surface
    }

    /// Triangles that are left.
    pub(crate) fn triangle_count(&self) -> usize {
        self.alive
    }

    /// Whether a triangle is left.
    pub(crate) fn is_alive(&self, triangle: u32) -> bool {
        self.is_alive[triangle as usize]
    }

    /// The corners of a triangle, in double precision.
    pub(crate) fn corners(&self, triangle: u32) -> [DVec3; 3] {
        self.triangles[triangle as usize].map(|v| self.position(v))
    }

    /// Where a vertex is, in double precision.
    pub(crate) fn position(&self, v: u32) -> DVec3 {
        self.positions[v as usize].as_dvec3()
    }

    /// Adds a vertex without triangles.
    pub(crate) fn add_vertex(&mut self, position: Vec3) -> u32 {
        self.positions.push(position);
        self.first_corner.push(NONE);
        self.positions.len() as u32 - 1
    }

    /// Adds a triangle.
    pub(crate) fn add_triangle(&mut self, corners: [u32; 3]) -> u32 {
        let t = self.triangles.len() as u32;
        self.triangles.push(corners);
        self.is_alive.push(true);
        self.alive += 1;
        self.next_corner.extend([NONE; 3]);
        for (k, &v) in (0..).zip(&corners) {
            self.link(3 * t + k, v);
        }
        t
    }

    /// Takes a triangle out.
    pub(crate) fn remove_triangle(&mut self, t: u32) {
        for (k, v) in (0..).zip(self.triangles[t as usize]) {
            self.unlink(3 * t + k, v);
        }
        self.is_alive[t as usize] = false;
        self.alive -= 1;
    }

    fn link(&mut self, corner: u32, v: u32) {
        self.next_corner[corner as usize] = self.first_corner[v as usize];
        self.first_corner[v as usize] = corner;
    }

    fn unlink(&mut self, corner: u32, v: u32) {
        let next = self.next_corner[corner as usize];
        if self.first_corner[v as usize] == corner {
            self.first_corner[v as usize] = next;
            return;
        }
        let mut before = self.first_corner[v as usize];
        while self.next_corner[before as usize] != corner {
            before = self.next_corner[before as usize];
        }
        self.next_corner[before as usize] = next;
    }

    /// The triangles at a vertex, each with which of its corners the vertex is.
    pub(crate) fn triangles_at(&self, v: u32) -> impl Iterator<Item = (u32, usize)> + '_ {
        let mut corner = self.first_corner[v as usize];
        std::iter::from_fn(move || {
            let here = (corner != NONE).then_some(corner)?;
            corner = self.next_corner[here as usize];
            Some((here / 3, here as usize % 3))
        })
    }

    /// The vertices that share an edge with a vertex, each once, in rising order.
    pub(crate) fn neighbours(&self, v: u32, found: &mut Vec<u32>) {
        found.clear();
        for (t, k) in self.triangles_at(v) {
            let corners = self.triangles[t as usize];
            found.extend([corners[(k + 1) % 3], corners[(k + 2) % 3]]);
        }
        found.sort_unstable();
        found.dedup();
    }

    /// The triangles at an edge, each with its third vertex.
    pub(crate) fn triangles_of_edge(&self, u: u32, v: u32) -> impl Iterator<Item = (u32, u32)> + '_ {
        self.triangles_at(u).filter_map(move |(t, k)| {
            let corners = self.triangles[t as usize];
            let (after, before) = (corners[(k + 1) % 3], corners[(k + 2) % 3]);
            match (after == v, before == v) {
                (true, _) => Some((t, before)),
                (_, true) => Some((t, after)),
                _ => None,
            }
        })
    }

    /// The triangle that runs an edge in this direction, with its third vertex; `None` if there is none or more than one.
    pub(crate) fn triangle_along(&self, from: u32, to: u32) -> Option<(u32, u32)> {
        let mut along = self.triangles_at(from).filter_map(|(t, k)| {
            let corners = self.triangles[t as usize];
            (corners[(k + 1) % 3] == to).then_some((t, corners[(k + 2) % 3]))
        });
        let found = along.next()?;
        along.next().is_none().then_some(found)
    }

    /// What the triangles at a vertex form.
    pub(crate) fn kind(&self, v: u32) -> VertexKind {
        // Each triangle leads from the vertex after it to the vertex before it. The fan is one if these steps form one chain.
        let steps: Vec<[u32; 2]> = self
            .triangles_at(v)
            .map(|(t, k)| {
                let corners = self.triangles[t as usize];
                [corners[(k + 1) % 3], corners[(k + 2) % 3]]
            })
            .collect();
        let Some(&[first, mut at]) = steps.first() else { return VertexKind::Unused };
        let is_repeated = |side: usize| {
            let mut ends: Vec<u32> = steps.iter().map(|step| step[side]).collect();
            ends.sort_unstable();
            ends.windows(2).any(|pair| pair[0] == pair[1])
        };
        if is_repeated(0) || is_repeated(1) {
            return VertexKind::Singular;
        }
        let mut walked = 1;
        while at != first {
            let Some(next) = steps.iter().find(|step| step[0] == at) else { break };
            at = next[1];
            walked += 1;
        }
        let is_closed = at == first;
        let mut start = first;
        if !is_closed {
            while let Some(before) = steps.iter().find(|step| step[1] == start) {
                start = before[0];
                walked += 1;
            }
        }
        match (walked == steps.len(), is_closed) {
            (false, _) => VertexKind::Singular,
            (true, true) => VertexKind::Inner,
            (true, false) => VertexKind::Border,
        }
    }

    /// The kind of every vertex.
    pub(crate) fn kinds(&self) -> Vec<VertexKind> {
        (0..self.positions.len() as u32).map(|v| self.kind(v)).collect()
    }

    /// Whether the collapse of an edge between two vertices that are not singular leaves the topology as it is: the link condition of
    /// Dey, Edelsbrunner, Guha and Nekhayev (1999), with a vertex beyond each border.
    pub(crate) fn may_collapse(
        &self,
        u: u32,
        v: u32,
        kinds: &[VertexKind],
        scratch: &mut [Vec<u32>; 2],
    ) -> bool {
        let is_border = |w: u32| kinds[w as usize] == VertexKind::Border;
        let mut opposite = [NONE; 2];
        let mut count = 0;
        for (_, third) in self.triangles_of_edge(u, v) {
            if count == 2 || opposite[0] == third {
                return false;
            }
            opposite[count] = third;
            count += 1;
        }
        // An edge across, between two borders: both would meet in a point.
        if count == 0 || (count == 2 && is_border(u) && is_border(v)) {
            return false;
        }
        let [of_u, of_v] = scratch;
        self.neighbours(u, of_u);
        self.neighbours(v, of_v);
        let common = of_u.iter().filter(|w| of_v.binary_search(w).is_ok()).count();
        if common != count {
            return false;
        }
        // A lone triangle would vanish.
        let is_side = |w: u32| self.triangles_of_edge(w, opposite[0]).count() == 1;
        if count == 1 && is_side(u) && is_side(v) {
            return false;
        }
        // The edge between both third vertices must not lie opposite both ends: a tetrahedron would fold.
        count == 1 || !(self.has_triangle(u, opposite) && self.has_triangle(v, opposite))
    }

    fn has_triangle(&self, v: u32, others: [u32; 2]) -> bool {
        self.triangles_of_edge(v, others[0]).any(|(_, third)| third == others[1])
    }

    /// The corners of the first triangle that is left.
    ///
    /// # Panics
    /// If none is.
    pub(crate) fn first_alive(&self) -> [u32; 3] {
        let t = self.is_alive.iter().position(|is_alive| *is_alive).expect("triangles are left");
        self.triangles[t]
    }

    /// Moves vertex `gone` into `kept`, which is put at `position`. The triangles at their edge vanish.
    pub(crate) fn collapse(&mut self, kept: u32, gone: u32, position: Vec3) {
        let vanishing: Vec<u32> = self.triangles_of_edge(kept, gone).map(|(t, _)| t).collect();
        for t in vanishing {
            self.remove_triangle(t);
        }
        let moving: Vec<(u32, usize)> = self.triangles_at(gone).collect();
        self.first_corner[gone as usize] = NONE;
        for (t, k) in moving {
            self.triangles[t as usize][k] = kept;
            self.link(3 * t + k as u32, kept);
        }
        self.positions[kept as usize] = position;
    }

    /// Puts the other diagonal of a quadrilateral in: of triangle `t` from `u` by `v` to `w` and of `other` from `v` by `u` to `x`.
    pub(crate) fn flip(&mut self, t: u32, other: u32, [u, v, w, x]: [u32; 4]) {
        for (triangle, corners) in [(t, [w, u, x]), (other, [x, v, w])] {
            for (k, old) in (0..).zip(self.triangles[triangle as usize]) {
                self.unlink(3 * triangle + k, old);
            }
            self.triangles[triangle as usize] = corners;
            for (k, new) in (0..).zip(corners) {
                self.link(3 * triangle + k, new);
            }
        }
    }

    /// Twice the area of a triangle along its normal, if one of its vertices were elsewhere.
    pub(crate) fn area_vector_with(&self, t: u32, moved: u32, to: DVec3) -> DVec3 {
        let [a, b, c] = self.triangles[t as usize].map(|v| if v == moved { to } else { self.position(v) });
        (b - a).cross(c - a)
    }

    /// Twice the area of a triangle along its normal.
    pub(crate) fn area_vector(&self, t: u32) -> DVec3 {
        let [a, b, c] = self.corners(t);
        (b - a).cross(c - a)
    }

    /// The mesh of what is left: vertices that a triangle uses, in their order, and triangles in theirs.
    pub(crate) fn into_mesh(self) -> TriangleMesh {
        let alive = (0..self.triangles.len()).filter(|&t| self.is_alive[t]);
        let triangles: Vec<[u32; 3]> = alive.map(|t| self.triangles[t]).collect();
        compact(&self.positions, &triangles)
    }
}

/// Whether the three vertices differ.
pub(crate) fn is_proper(&[a, b, c]: &[u32; 3]) -> bool {
    a != b && b != c && c != a
}

/// A mesh without the vertices that no triangle uses.
pub(crate) fn compact(positions: &[Vec3], triangles: &[[u32; 3]]) -> TriangleMesh {
    let mut moved_to = vec![NONE; positions.len()];
    for &v in triangles.iter().flatten() {
        moved_to[v as usize] = 0;
    }
    let mut kept = Vec::new();
    for (v, place) in moved_to.iter_mut().enumerate().filter(|(_, place)| **place == 0) {
        *place = kept.len() as u32;
        kept.push(positions[v]);
    }
    let triangles = triangles.iter().map(|t| t.map(|v| moved_to[v as usize])).collect();
    TriangleMesh { positions: kept, normals: Vec::new(), triangles }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes::{icosphere, sheet};

    fn mesh(triangles: &[[u32; 3]]) -> Surface {
        let count = triangles.iter().flatten().max().map_or(0, |&v| v as usize + 1);
        let positions = (0..count).map(|i| Vec3::new(i as f32, (i * i) as f32, (i % 3) as f32)).collect();
        Surface::of(&TriangleMesh { positions, normals: Vec::new(), triangles: triangles.to_vec() })
    }

    #[test]
    fn vertices_know_what_they_are() {
        assert!(Surface::of(&icosphere(1)).kinds().iter().all(|kind| *kind == VertexKind::Inner));
        let sheet = Surface::of(&sheet(2));
        let inner = sheet.kinds().iter().filter(|kind| **kind == VertexKind::Inner).count();
        let border = sheet.kinds().iter().filter(|kind| **kind == VertexKind::Border).count();
        assert_eq!((inner, border), (1, 8));
        let bow_tie = mesh(&[[0, 1, 2], [0, 3, 4]]);
        assert_eq!(bow_tie.kind(0), VertexKind::Singular);
        let three_at_an_edge = mesh(&[[0, 1, 2], [1, 0, 3], [0, 1, 4]]);
        assert_eq!(
            [0, 1, 2].map(|v| three_at_an_edge.kind(v)),
            [VertexKind::Singular, VertexKind::Singular, VertexKind::Border]
        );
        let facing_away = mesh(&[[0, 1, 2], [0, 1, 3]]);
        assert_eq!(facing_away.kind(0), VertexKind::Singular);
    }

    #[test]
    fn a_tetrahedron_and_a_lone_triangle_stay() {
        let mut scratch = [Vec::new(), Vec::new()];
        let tetrahedron = mesh(&[[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]);
        let lone = mesh(&[[0, 1, 2]]);
        for surface in [&tetrahedron, &lone] {
            let kinds = surface.kinds();
            for (u, v) in [(0, 1), (1, 2), (2, 0)] {
                assert!(!surface.may_collapse(u, v, &kinds, &mut scratch));
            }
        }
    }

    #[test]
    fn a_neck_of_three_edges_does_not_close() {
        // Two pyramids joined at the ring 0, 1, 2 by a prism: the ring's edges have a common neighbour that no triangle has.
        let prism = mesh(&[
            [0, 1, 3],
            [1, 4, 3],
            [1, 2, 4],
            [2, 5, 4],
            [2, 0, 5],
            [0, 3, 5],
            [6, 1, 0],
            [6, 2, 1],
            [6, 0, 2],
            [7, 3, 4],
            [7, 4, 5],
            [7, 5, 3],
        ]);
        let kinds = prism.kinds();
        assert!(kinds.iter().all(|kind| *kind == VertexKind::Inner));
        let mut scratch = [Vec::new(), Vec::new()];
        assert!(!prism.may_collapse(0, 1, &kinds, &mut scratch), "0, 1 and 2 are a ring");
        assert!(prism.may_collapse(6, 0, &kinds, &mut scratch), "a pyramid flattens");
    }

    #[test]
    fn a_collapse_takes_two_triangles_and_a_vertex() {
        let mut surface = Surface::of(&icosphere(1));
        let middle = Vec3::new(1.0, 2.0, 3.0);
        let mut of = Vec::new();
        surface.neighbours(0, &mut of);
        let (gone, before) = (of[0], surface.triangle_count());
        surface.collapse(0, gone, middle);
        assert_eq!(surface.triangle_count(), before - 2);
        let mesh = surface.into_mesh();
        assert!(isostudy_mesh::topology::topology(&mesh).is_closed_manifold());
        assert_eq!(mesh.positions[0], middle);
    }
}
