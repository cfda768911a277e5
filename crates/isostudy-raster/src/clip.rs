//! Cutting triangles that leave what can be projected safely.
//!
//! Cut against the near and far planes and a guard band round the picture, which keeps snapped coordinates small
//! enough for exact edge functions. The picture's own border needs no cut: the fill skips what lies outside.
//!
//! A cut edge is always walked from its kept end to its lost end, so two triangles that share it get the same new
//! corner and the fill stays watertight. In the wireframe looks a cut shows as a line.

use glam::Vec3;

/// A corner in view coordinates with what its colour follows from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Corner {
    pub(crate) position: Vec3,
    pub(crate) exposure: f32,
    /// On the scale of colours.
    pub(crate) place: f32,
}

/// The volume that is kept.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Bounds {
    pub(crate) near: f32,
    pub(crate) far: f32,
    /// Largest `|x| / z` and `|y| / z`.
    pub(crate) slope: f32,
}

impl Bounds {
    #[inline]
    pub(crate) fn holds(&self, p: Vec3) -> bool {
        let reach = self.slope * p.z;
        p.z >= self.near && p.z <= self.far && p.x.abs() <= reach && p.y.abs() <= reach
    }

    /// The part of a triangle inside, a convex polygon of 0 or 3 to 9 corners in the triangle's order.
    pub(crate) fn cut(&self, triangle: [Corner; 3]) -> Vec<Corner> {
        let planes: [&dyn Fn(Vec3) -> f32; 6] = [
            &|p| p.z - self.near,
            &|p| self.far - p.z,
            &|p| self.slope * p.z - p.x,
            &|p| self.slope * p.z + p.x,
            &|p| self.slope * p.z - p.y,
            &|p| self.slope * p.z + p.y,
        ];
        let mut polygon = triangle.to_vec();
        for inside in planes {
            polygon = cut_by_plane(&polygon, inside);
        }
        // Rounding in a cut must not put a corner on or behind the eye.
        for corner in &mut polygon {
            corner.position.z = corner.position.z.max(self.near);
        }
        polygon
    }
}

fn cut_by_plane(polygon: &[Corner], inside: &dyn Fn(Vec3) -> f32) -> Vec<Corner> {
    let mut kept = Vec::with_capacity(polygon.len() + 1);
    for (i, &a) in polygon.iter().enumerate() {
        let b = polygon[(i + 1) % polygon.len()];
        let (da, db) = (inside(a.position), inside(b.position));
        if da >= 0.0 {
            kept.push(a);
        }
        match (da >= 0.0, db >= 0.0) {
            (true, false) => kept.push(between(a, b, da / (da - db))),
            (false, true) => kept.push(between(b, a, db / (db - da))),
            _ => {}
        }
    }
    kept
}

fn between(kept: Corner, lost: Corner, t: f32) -> Corner {
    Corner {
        position: kept.position + (lost.position - kept.position) * t,
        exposure: kept.exposure + (lost.exposure - kept.exposure) * t,
        place: kept.place + (lost.place - kept.place) * t,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const BOUNDS: Bounds = Bounds { near: 1.0, far: 10.0, slope: 4.0 };

    fn corner(x: f32, y: f32, z: f32) -> Corner {
        Corner { position: Vec3::new(x, y, z), exposure: z, place: 0.0 }
    }

    #[test]
    fn what_is_inside_stays() {
        let triangle = [corner(0.0, 0.0, 2.0), corner(1.0, 0.0, 2.0), corner(0.0, 1.0, 3.0)];
        assert_eq!(BOUNDS.cut(triangle), triangle.to_vec());
    }

    #[test]
    fn what_is_behind_goes() {
        assert!(
            BOUNDS.cut([corner(0.0, 0.0, -2.0), corner(1.0, 0.0, 0.5), corner(0.0, 1.0, -3.0)]).is_empty()
        );
    }

    #[test]
    fn a_cut_through_the_near_plane_is_on_it_and_the_same_from_both_sides() {
        let (a, b) = (corner(0.0, 0.0, 3.0), corner(0.1, 0.3, -5.0));
        let left = BOUNDS.cut([a, b, corner(-1.0, 0.0, 3.0)]);
        let right = BOUNDS.cut([b, a, corner(1.0, 0.0, 3.0)]);
        let shared: Vec<_> = left.iter().filter(|c| right.contains(c)).collect();
        assert_eq!(shared.len(), 2, "{left:?} {right:?}");
        assert!(left.iter().all(|c| c.position.z >= 1.0 && (c.exposure - c.position.z).abs() < 1e-5));
    }
}
