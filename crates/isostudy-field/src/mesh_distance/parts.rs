//! Which way a mesh faces, as a whole and part by part.

use glam::{DVec3, Vec3};
use isostudy_mesh::repair::components;
use isostudy_mesh::{Bounds, TriangleMesh};

use super::MeshDistance;

/// How flat a part may be and still be said to face inward; see [`Enclosed::is_flat`].
const FLAT: f64 = 1e-6;
/// How many triangles of a part are looked behind.
const LOOKS: usize = 16;

/// A part of a mesh that faces inward and lies in no other, so that it encloses nothing.
#[derive(Debug, Clone, PartialEq)]
pub struct InwardPart {
    /// Its number, from 0, in the order of the parts' first triangles.
    pub part: usize,
    /// How many parts the mesh has.
    pub parts: usize,
    /// How many triangles it has.
    pub triangles: usize,
    /// The box round it.
    pub bounds: Bounds,
}

impl MeshDistance {
    /// The parts of `mesh`, of which this is the field, that face inward without being cavities: behind none of their
    /// triangles there is anything inside. Turned round ([`isostudy_mesh::repair::flip`]) they would be solid; as they are they leave
    /// no trace in the field's sign.
    ///
    /// Parts hang together by shared vertices. Up to 16 triangles of each are looked behind, evenly spread.
    ///
    /// # Panics
    /// If a triangle's index is out of range.
    pub fn inward_parts(&self, mesh: &TriangleMesh) -> Vec<InwardPart> {
        let numbers = components(mesh);
        let parts = numbers.iter().max().map_or(0, |&last| last as usize + 1);
        let mut triangles: Vec<Vec<usize>> = vec![Vec::new(); parts];
        for (t, &part) in numbers.iter().enumerate() {
            triangles[part as usize].push(t);
        }
        let corners = |part: usize| triangles[part].iter().map(|&t| mesh.corners(t));
        let inward = (0..parts).filter(|&part| {
            let enclosed = Enclosed::by(corners(part));
            enclosed.volume < 0.0 && !enclosed.is_flat(FLAT) && self.has_nothing_behind(corners(part))
        });
        let described = inward.map(|part| {
            let (min, max) = corners(part)
                .flatten()
                .fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), p| (low.min(p), high.max(p)));
            InwardPart { part, parts, triangles: triangles[part].len(), bounds: Bounds { min, max } }
        });
        described.collect()
    }

    /// Behind the triangles of an inward part, where its inside is, as it were.
    fn has_nothing_behind(&self, triangles: impl ExactSizeIterator<Item = [Vec3; 3]>) -> bool {
        let apart = triangles.len().div_ceil(LOOKS);
        let mut behind = triangles.step_by(apart).filter_map(|t| {
            let [a, b, c] = t.map(|p| p.as_dvec3());
            let normal = (b - a).cross(c - a);
            let middle = (a + b + c) / 3.0;
            let away = (1e-4 * normal.length().sqrt()).max(f64::from(2.0 * self.aside));
            Some((middle + normal.try_normalize()? * away).as_vec3())
        });
        behind.all(|p| self.winding_number(p) < -0.5)
    }
}

/// What triangles enclose with their common centre, the mean of their area.
#[derive(Debug, Clone, Copy)]
pub(super) struct Enclosed {
    /// The sum of the signed volumes of the tetrahedra that they make with it.
    pub(super) volume: f64,
    /// Theirs.
    pub(super) area: f64,
}

impl Enclosed {
    pub(super) fn by(triangles: impl Iterator<Item = [Vec3; 3]> + Clone) -> Self {
        let corners = triangles.map(|t| t.map(|p| p.as_dvec3()));
        let (mut area, mut sum) = (0.0, DVec3::ZERO);
        for [a, b, c] in corners.clone() {
            let size = 0.5 * (b - a).cross(c - a).length();
            area += size;
            sum += size * (a + b + c) / 3.0;
        }
        if area == 0.0 {
            return Self { volume: 0.0, area };
        }
        let centre = sum / area;
        let volume = |[a, b, c]: [DVec3; 3]| (a - centre).dot((b - a).cross(c - a)) / 6.0;
        Self { volume: corners.map(volume).sum(), area }
    }

    /// Whether the volume is no more than some part of that of a cube, whose edges' squares are the area.
    pub(super) fn is_flat(self, part: f64) -> bool {
        self.volume.abs() <= part * self.area * self.area.sqrt()
    }
}
