//! Points put into the triangles that they lie in.

use super::spread::Place;
use crate::surface::Surface;
use isostudy_mesh::glam::{DVec3, Vec3};

type Point = [f64; 2];

/// Puts a vertex at each place, which cuts the triangle there into triangles of Delaunay. Returns the normal of the surface at every
/// vertex: that of a new vertex is its triangle's, that of an old one the mean of its triangles, weighted by area.
pub(crate) fn insert(surface: &mut Surface, places: &[Place], at: &[Vec3]) -> Vec<DVec3> {
    let mut normals = vec![DVec3::ZERO; surface.positions.len()];
    let triangles = surface.triangles.len();
    for t in 0..triangles as u32 {
        let area_vector = surface.area_vector(t);
        surface.triangles[t as usize].iter().for_each(|&v| normals[v as usize] += area_vector);
    }
    normals.iter_mut().for_each(|normal| *normal = normal.normalize_or_zero());
    let mut of_triangle: Vec<Vec<u32>> = vec![Vec::new(); triangles];
    for (i, place) in (0..).zip(places) {
        of_triangle[place.triangle as usize].push(i);
        normals.push(surface.area_vector(place.triangle).normalize_or_zero());
    }
    let first = surface.positions.len() as u32;
    at.iter().for_each(|&p| {
        surface.add_vertex(p);
    });
    for (t, points) in (0..).zip(&of_triangle).filter(|(_, points)| !points.is_empty()) {
        Cut::begin(surface, t).insert_all(points.iter().map(|&i| (first + i, places[i as usize].position)));
    }
    normals
}

/// A triangle that is being cut.
struct Cut<'a> {
    surface: &'a mut Surface,
    origin: DVec3,
    axes: [DVec3; 2],
    corners: [(u32, Point); 3],
    /// Places in the plane of the new vertices, which follow each other in no order.
    inner: Vec<(u32, Point)>,
    pieces: Vec<u32>,
}

impl<'a> Cut<'a> {
    fn begin(surface: &'a mut Surface, t: u32) -> Self {
        let [a, b, c] = surface.corners(t);
        let along = (b - a).normalize();
        let across = (b - a).cross(c - a).normalize().cross(along);
        let flat = |p: DVec3| [(p - a).dot(along), (p - a).dot(across)];
        let [u, v, w] = surface.triangles[t as usize];
        let corners = [(u, flat(a)), (v, flat(b)), (w, flat(c))];
        Self { surface, origin: a, axes: [along, across], corners, inner: Vec::new(), pieces: vec![t] }
    }

    fn flat(&self, v: u32) -> Point {
        if let Some((_, p)) = self.corners.iter().find(|(corner, _)| *corner == v) {
            return *p;
        }
        let place = self.inner.binary_search_by_key(&v, |(v, _)| *v);
        self.inner[place.expect("a vertex of this triangle")].1
    }

    /// Inserts vertices, whose numbers rise.
    fn insert_all(mut self, points: impl Iterator<Item = (u32, DVec3)>) {
        for (v, p) in points {
            let p = self.axes.map(|axis| (p - self.origin).dot(axis));
            self.inner.push((v, p));
            let t = self.find(p);
            let [a, b, c] = self.surface.triangles[t as usize];
            self.surface.remove_triangle(t);
            for [from, to] in [[a, b], [b, c], [c, a]] {
                let piece = self.surface.add_triangle([from, to, v]);
                self.pieces.push(piece);
            }
            self.legalise(v, vec![[a, b], [b, c], [c, a]]);
        }
    }

    /// The piece that a point lies in: over edges that have it beyond them, from the newest.
    fn find(&self, p: Point) -> u32 {
        let mut t = *self.pieces.last().expect("the triangle itself");
        for _ in 0..self.pieces.len() {
            let corners = self.surface.triangles[t as usize];
            let beyond = (0..3).find_map(|k| {
                let [u, v] = [corners[k], corners[(k + 1) % 3]];
                let is_beyond = turn(self.flat(u), self.flat(v), p) < 0.0;
                if is_beyond { self.beyond(u, v) } else { None }
            });
            match beyond {
                Some(other) => t = other,
                None => return t,
            }
        }
        t
    }

    /// The piece beyond an edge; `None` beyond an edge of the whole triangle.
    fn beyond(&self, u: u32, v: u32) -> Option<u32> {
        let is_corner = |w: u32| self.corners.iter().any(|(corner, _)| *corner == w);
        if is_corner(u) && is_corner(v) {
            return None;
        }
        self.surface.triangle_along(v, u).map(|(other, _)| other)
    }

    /// Flips edges opposite a new vertex until all are of Delaunay (Lawson 1977).
    fn legalise(&mut self, v: u32, mut edges: Vec<[u32; 2]>) {
        while let Some([a, b]) = edges.pop() {
            let Some(other) = self.beyond(a, b) else { continue };
            let Some((own, _)) = self.surface.triangle_along(a, b).filter(|(_, third)| *third == v) else {
                continue;
            };
            let far = self.surface.triangles[other as usize].into_iter().find(|w| *w != a && *w != b);
            let Some(far) = far else { continue };
            // Rounding may say so of a quadrilateral that has no other diagonal.
            let has_other = self.surface.triangles_of_edge(v, far).next().is_none()
                && [[v, a, far], [far, b, v]].iter().all(|of| {
                    let [p, q, r] = of.map(|w| self.flat(w));
                    turn(p, q, r) > 0.0
                });
            if has_other && in_circle([a, b, v].map(|w| self.flat(w)), self.flat(far)) {
                self.surface.flip(own, other, [a, b, v, far]);
                edges.extend([[a, far], [far, b]]);
            }
        }
    }
}

fn turn([ax, ay]: Point, [bx, by]: Point, [cx, cy]: Point) -> f64 {
    (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
}

/// Whether a point lies inside the circle through three others, which turn left.
fn in_circle(corners: [Point; 3], p: Point) -> bool {
    let [a, b, c] = corners.map(|q| {
        let (x, y) = (q[0] - p[0], q[1] - p[1]);
        [x, y, x * x + y * y]
    });
    let minor = |s: [f64; 3], t: [f64; 3]| s[0] * t[1] - s[1] * t[0];
    let sum = a[2] * minor(b, c) + b[2] * minor(c, a) + c[2] * minor(a, b);
    let size = a[2] * minor(b, c).abs() + b[2] * minor(c, a).abs() + c[2] * minor(a, b).abs();
    sum > 1e-12 * size
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::retile::spread::spread;
    use crate::shapes::{cube, icosphere, sheet};
    use isostudy_mesh::topology::topology;

    #[test]
    fn inserted_points_leave_the_surface_as_it_is() {
        for mesh in [cube(1), icosphere(2), sheet(3)] {
            let mut surface = Surface::of(&mesh);
            let places = spread(&surface, &vec![1.0; mesh.triangles.len()], 300, 5).unwrap();
            let at: Vec<Vec3> = places.iter().map(|place| place.position.as_vec3()).collect();
            let normals = insert(&mut surface, &places, &at);
            assert_eq!(normals.len(), mesh.positions.len() + 300);
            let found = surface.into_mesh();
            let (before, after) = (topology(&mesh), topology(&found));
            assert_eq!(found.triangles.len(), mesh.triangles.len() + 600);
            assert_eq!(after.euler_characteristic, before.euler_characteristic);
            assert_eq!((after.misoriented_edges, after.non_manifold_edges), (0, 0));
            assert!((found.area() - mesh.area()).abs() < 1e-5);
            assert!((found.volume() - mesh.volume()).abs() < 1e-5);
        }
    }

    #[test]
    fn pieces_of_one_triangle_are_delaunays() {
        let mesh = isostudy_mesh::TriangleMesh {
            positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y],
            triangles: vec![[0, 1, 2]],
            ..Default::default()
        };
        let mut surface = Surface::of(&mesh);
        let places = spread(&surface, &[1.0], 60, 5).unwrap();
        let at: Vec<Vec3> = places.iter().map(|place| place.position.as_vec3()).collect();
        insert(&mut surface, &places, &at);
        let found = surface.into_mesh();
        assert_eq!(found.triangles.len(), 121);
        let flat = |p: Vec3| [f64::from(p.x), f64::from(p.y)];
        for t in 0..found.triangles.len() {
            for p in &found.positions {
                let corners = found.corners(t);
                assert!(
                    corners.contains(p) || !in_circle(corners.map(flat), flat(*p)),
                    "{p} in triangle {t}"
                );
            }
        }
    }
}
