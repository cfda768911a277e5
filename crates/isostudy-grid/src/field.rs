//! A grid as a scalar field, for methods that sample.

mod bins;

use std::sync::Arc;

use glam::{DVec3, Vec3};
use isostudy_field::StudyField;
use isostudy_mesh::{Bounds, NearestTriangles};

use crate::error::Problem;
use crate::grid::Grid;
use bins::Bins;

/// How far a point may be outside of a tetrahedron, as a share of its heights, to count as inside: coordinates are in single precision.
const ROUNDING: f64 = 1e-6;

/// The linear interpolant of a grid's values; beyond the grid, the value at the nearest point of its boundary.
///
/// Where cells fold over each other, the value is that of one of them. A tetrahedron with a value that is not finite has `NaN`.
#[derive(Debug, Clone)]
pub struct GridField {
    grid: Arc<Grid>,
    bounds: Bounds,
    bins: Bins,
    /// The faces that one tetrahedron has.
    boundary: Vec<[u32; 3]>,
    corners: Vec<[Vec3; 3]>,
    nearest: NearestTriangles,
}

impl GridField {
    /// The field of a grid.
    ///
    /// # Errors
    /// If the grid has no tetrahedra with a volume, so no inside.
    pub fn try_new(grid: Arc<Grid>) -> Result<Self, Problem> {
        let none = || Problem::Whole("the grid has no cells with a volume".to_owned());
        let [min, max] = grid.bounds().ok_or_else(none)?;
        let bounds = Bounds { min: min.as_vec3(), max: max.as_vec3() };
        let boundary = boundary(&grid);
        if boundary.is_empty() || grid.cells().without_volume == grid.cells().solid {
            return Err(none());
        }
        let corners: Vec<_> =
            boundary.iter().map(|face| face.map(|point| grid.point(point).as_vec3())).collect();
        let (bins, nearest) = (Bins::new(&grid, [min, max]), NearestTriangles::new(&corners));
        Ok(Self { grid, bounds, bins, boundary, corners, nearest })
    }

    /// The smallest box round the grid.
    pub fn bounds(&self) -> Bounds {
        self.bounds
    }

    /// The tetrahedron at a point, and the shares of its corners there; `None` beyond the grid.
    fn at(&self, p: DVec3) -> Option<([u32; 4], [f64; 4])> {
        let mut best: Option<([u32; 4], [f64; 4], f64)> = None;
        for &number in self.bins.at(p) {
            let of = self.grid.tetrahedra()[number as usize];
            let Some(shares) = self.shares(of, p) else { continue };
            let least = shares.into_iter().fold(f64::INFINITY, f64::min);
            if least >= 0.0 {
                return Some((of, shares));
            }
            if least >= -ROUNDING && best.as_ref().is_none_or(|(.., before)| least > *before) {
                best = Some((of, shares, least));
            }
        }
        best.map(|(of, shares, _)| (of, shares))
    }

    /// The barycentric coordinates of a point; `None` of a tetrahedron without volume.
    fn shares(&self, of: [u32; 4], p: DVec3) -> Option<[f64; 4]> {
        let [a, b, c, d] = of.map(|point| self.grid.point(point));
        let [ab, ac, ad, ap] = [b - a, c - a, d - a, p - a];
        let whole = ab.cross(ac).dot(ad);
        let shares =
            [ap.cross(ac).dot(ad), ab.cross(ap).dot(ad), ab.cross(ac).dot(ap)].map(|part| part / whole);
        let [b, c, d] = shares;
        shares.iter().all(|share| share.is_finite()).then_some([1.0 - b - c - d, b, c, d])
    }

    /// The value at the nearest point of the boundary.
    fn beyond(&self, p: DVec3) -> f64 {
        let found = self.nearest.nearest(p, f64::INFINITY, |triangle| self.corners[triangle]);
        let face = self.boundary[found.triangle];
        let [a, b, c] = face.map(|point| self.grid.point(point));
        let (ab, ac, ap) = (b - a, c - a, found.position - a);
        let across = ab.cross(ac);
        let whole = across.length_squared();
        let values = face.map(|point| self.grid.values()[point as usize]);
        if whole <= 0.0 || !whole.is_finite() {
            return values[0];
        }
        let (b, c) = (ap.cross(ac).dot(across) / whole, ab.cross(ap).dot(across) / whole);
        values[0] * (1.0 - b - c) + values[1] * b + values[2] * c
    }
}

impl StudyField for GridField {
    fn sample(&self, p: Vec3) -> f32 {
        let p = p.as_dvec3();
        let value = match self.at(p) {
            Some((of, shares)) => (0..4).map(|i| shares[i] * self.grid.values()[of[i] as usize]).sum(),
            None if p.is_finite() => self.beyond(p),
            None => f64::NAN,
        };
        value as f32
    }

    /// That of the tetrahedron; none beyond the grid.
    fn gradient(&self, p: Vec3) -> Option<Vec3> {
        let (of, _) = self.at(p.as_dvec3())?;
        let [a, b, c, d] = of.map(|point| self.grid.point(point));
        let [ab, ac, ad] = [b - a, c - a, d - a];
        let [va, vb, vc, vd] = of.map(|point| self.grid.values()[point as usize]);
        let whole = ab.cross(ac).dot(ad);
        let gradient = (vb - va) * ac.cross(ad) + (vc - va) * ad.cross(ab) + (vd - va) * ab.cross(ac);
        let gradient = (gradient / whole).as_vec3();
        gradient.is_finite().then_some(gradient)
    }
}

/// The faces that one tetrahedron has, sorted.
fn boundary(grid: &Grid) -> Vec<[u32; 3]> {
    let mut faces: Vec<[u32; 3]> = Vec::with_capacity(4 * grid.tetrahedra().len());
    for &[a, b, c, d] in grid.tetrahedra() {
        for mut face in [[b, c, d], [a, c, d], [a, b, d], [a, b, c]] {
            face.sort_unstable();
            faces.push(face);
        }
    }
    faces.sort_unstable();
    faces.chunk_by(|a, b| a == b).filter(|same| same.len() == 1).map(|same| same[0]).collect()
}
