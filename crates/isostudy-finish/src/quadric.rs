//! Squared distances to planes, summed (Garland and Heckbert 1997).

use isostudy_mesh::glam::DVec3;

/// A sum of squared distances to planes, each times its weight: `p A p + 2 b p + c`.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct Quadric {
    /// The upper triangle of A: xx, xy, xz, yy, yz, zz.
    a: [f64; 6],
    b: DVec3,
    c: f64,
    /// The sum of the weights that count as area.
    area: f64,
}

/// Share of the trace that is added to A, so that what it does not decide stays at the place that is asked for. Two more rounds take
/// the bias out of what it does decide.
const REGULARISATION: f64 = 1e-4;
const ROUNDS: usize = 3;

impl Quadric {
    /// Of the plane through a point, whose normal has unit length. Only what is a part of the surface counts as area.
    pub(crate) fn of_plane(normal: DVec3, through: DVec3, weight: f64, area: f64) -> Self {
        let [x, y, z] = normal.to_array();
        let d = -normal.dot(through);
        Self {
            a: [x * x, x * y, x * z, y * y, y * z, z * z].map(|product| product * weight),
            b: normal * (d * weight),
            c: d * d * weight,
            area,
        }
    }

    pub(crate) fn plus(&self, other: &Self) -> Self {
        let mut a = self.a;
        a.iter_mut().zip(other.a).for_each(|(sum, other)| *sum += other);
        Self { a, b: self.b + other.b, c: self.c + other.c, area: self.area + other.area }
    }

    fn times(&self, p: DVec3) -> DVec3 {
        let [xx, xy, xz, yy, yz, zz] = self.a;
        let [x, y, z] = p.to_array();
        DVec3::new(xx * x + xy * y + xz * z, xy * x + yy * y + yz * z, xz * x + yz * y + zz * z)
    }

    /// The sum at a point; what rounding makes negative is 0.
    pub(crate) fn at(&self, p: DVec3) -> f64 {
        (p.dot(self.times(p)) + 2.0 * self.b.dot(p) + self.c).max(0.0)
    }

    /// The area of the planes.
    pub(crate) fn area(&self) -> f64 {
        self.area
    }

    /// The root of the mean square distance from a point to the planes, over their area.
    pub(crate) fn distance_at(&self, p: DVec3) -> f64 {
        if self.area > 0.0 { (self.at(p) / self.area).sqrt() } else { 0.0 }
    }

    /// The point with the least sum; along directions in which the sum hardly changes, as near as may be to `near`.
    pub(crate) fn minimum(&self, near: DVec3) -> DVec3 {
        let [xx, xy, xz, yy, yz, zz] = self.a;
        let trace = xx + yy + zz;
        let added = REGULARISATION * trace;
        let (xx, yy, zz) = (xx + added, yy + added, zz + added);
        // The inverse of a symmetric matrix by cofactors; its condition is at most that of the regularisation.
        let (cxx, cxy, cxz) = (yy * zz - yz * yz, xz * yz - xy * zz, xy * yz - xz * yy);
        let (cyy, cyz, czz) = (xx * zz - xz * xz, xy * xz - xx * yz, xx * yy - xy * xy);
        let determinant = xx * cxx + xy * cxy + xz * cxz;
        // Without planes the determinant is 0.
        if determinant.is_nan() || determinant <= 0.0 {
            return near;
        }
        let solve = |r: DVec3| {
            let x = cxx * r.x + cxy * r.y + cxz * r.z;
            let y = cxy * r.x + cyy * r.y + cyz * r.z;
            let z = cxz * r.x + cyz * r.y + czz * r.z;
            DVec3::new(x, y, z) / determinant
        };
        let mut p = near;
        for _ in 0..ROUNDS {
            p -= solve(self.times(p) + self.b);
        }
        if p.is_finite() { p } else { near }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_corner_is_where_three_planes_meet() {
        let corner = DVec3::new(0.3, -0.2, 0.7);
        let normals = [DVec3::X, DVec3::new(0.6, 0.8, 0.0), DVec3::new(0.0, 0.6, 0.8)];
        let of = |normal| Quadric::of_plane(normal, corner, 0.5, 0.5);
        let sum = normals.map(of).iter().fold(Quadric::default(), |sum, q| sum.plus(q));
        let far = corner + DVec3::new(0.1, 0.2, -0.3);
        assert!(sum.minimum(far).distance(corner) < 1e-8, "{}", sum.minimum(far));
        let squares: f64 = normals.iter().map(|n| 0.5 * n.dot(far - corner).powi(2)).sum();
        assert!((sum.at(far) - squares).abs() < 1e-12);
        assert!((sum.distance_at(far) - (squares / 1.5).sqrt()).abs() < 1e-12);
    }

    #[test]
    fn along_a_plane_and_an_edge_the_place_stays() {
        let plane = Quadric::of_plane(DVec3::Z, DVec3::Z, 2.0, 2.0);
        assert!(plane.minimum(DVec3::new(3.0, 4.0, 5.0)).distance(DVec3::new(3.0, 4.0, 1.0)) < 1e-8);
        let edge = plane.plus(&Quadric::of_plane(DVec3::X, DVec3::ZERO, 2.0, 2.0));
        assert!(edge.minimum(DVec3::new(3.0, 4.0, 5.0)).distance(DVec3::new(0.0, 4.0, 1.0)) < 1e-8);
        assert_eq!(Quadric::default().minimum(DVec3::ONE), DVec3::ONE);
    }
}
