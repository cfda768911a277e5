//! The solid angle of many triangles: exact nearby, by expansions from afar (Barill, Dickson, Schmidt, Levin & Jacobson
//! 2018, "Fast winding numbers for soups and clouds").
//!
//! A node of the tree stands for its triangles with the moments of their area vectors round its centre, up to the second.
//! What that leaves out is bounded. The term of degree k in the expansion of a dipole's field, the gradient of a solid
//! harmonic of degree k + 1, is at most (k + 1) q^k / R^2 at a distance R, if q R is the distance of the dipole from the
//! centre. Summed from k = 3 that makes q^3 (4 - 3 q) / (1 - q)^2 for each R^2 of area.

use std::f64::consts::PI;

use glam::{DMat3, DVec3, Vec3};

/// Up to so many triangles all solid angles are exact.
const FEW: usize = 64;
/// The most triangles of a leaf.
const LEAF: usize = 4;
/// What an expansion may leave out, in full spheres, by the bound; it leaves out far less, and either way.
const LEFT_OUT: f64 = 1e-3;

/// Triangles in a tree.
#[derive(Debug, Clone, Default)]
pub(super) struct SolidAngles {
    /// Those of a node stand together.
    triangles: Vec<[Vec3; 3]>,
    /// Every node before those below it.
    nodes: Vec<Node>,
}

#[derive(Debug, Clone)]
struct Node {
    /// The middle of its area.
    centre: DVec3,
    /// That of a ball round the centre that holds the triangles.
    radius: f64,
    area: f64,
    /// The square of the distance from which the expansion will do.
    far: f64,
    moments: Moments,
    /// Its triangles.
    first: usize,
    end: usize,
    /// The next node that is not below this one.
    after: usize,
}

impl SolidAngles {
    pub(super) fn of(mut triangles: Vec<[Vec3; 3]>) -> Self {
        let mut nodes = Vec::new();
        if !triangles.is_empty() {
            build(&mut triangles, 0, &mut nodes);
        }
        if triangles.len() <= FEW {
            nodes.iter_mut().for_each(|node| node.far = f64::INFINITY);
        }
        Self { triangles, nodes }
    }

    pub(super) fn triangles(&self) -> &[[Vec3; 3]] {
        &self.triangles
    }

    pub(super) fn area(&self) -> f64 {
        self.nodes.first().map_or(0.0, |root| root.area)
    }

    /// The part of the sphere round `p` that the triangles cover, positive from behind; less than 1e-3 from the exact sum.
    pub(super) fn share(&self, p: Vec3) -> f64 {
        let q = p.as_dvec3();
        let mut sum = 0.0;
        let mut at = 0;
        while let Some(node) = self.nodes.get(at) {
            let away = node.centre - q;
            if away.length_squared() > node.far {
                sum += node.moments.solid_angle(away);
                at = node.after;
                continue;
            }
            if node.after == at + 1 {
                let near = &self.triangles[node.first..node.end];
                sum += near.iter().map(|triangle| solid_angle(triangle, q)).sum::<f64>();
            }
            at += 1;
        }
        sum / (4.0 * PI)
    }

    /// Whether the triangles surely cover less than `share` of the sphere, at the distances that are given of points.
    ///
    /// A surface of area A, nowhere nearer than d, covers at most A / d^2 of the unit sphere round a point.
    pub(super) fn cover_less(&self, share: f64, distance: impl Fn(DVec3) -> f64) -> bool {
        let most = |centre: DVec3, radius: f64, area: f64| {
            let clear = (distance(centre) - radius).max(0.0);
            if area == 0.0 { 0.0 } else { area / (4.0 * PI * clear * clear) }
        };
        let mut sum = 0.0;
        let mut at = 0;
        while let Some(node) = self.nodes.get(at) {
            let of_node = most(node.centre, node.radius, node.area);
            if of_node < share / 16.0 {
                sum += of_node;
                at = node.after;
            } else {
                if node.after == at + 1 {
                    // Triangles of several holes, perhaps.
                    let each = self.triangles[node.first..node.end].iter().map(ball);
                    sum += each.map(|(centre, radius, area)| most(centre, radius, area)).sum::<f64>();
                }
                at += 1;
            }
            if sum >= share {
                return false;
            }
        }
        true
    }
}

/// Adds the node over some triangles, the first of which is the one with that number of all, and those below it. Halves
/// them where their middles are spread the most.
fn build(triangles: &mut [[Vec3; 3]], first: usize, nodes: &mut Vec<Node>) {
    let place = nodes.len();
    nodes.push(Node::over(triangles, first));
    if triangles.len() > LEAF {
        let middle = |t: &[Vec3; 3]| t[0].as_dvec3() + t[1].as_dvec3() + t[2].as_dvec3();
        let bounds = triangles.iter().map(middle);
        let (low, high) =
            bounds.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(l, h), p| (l.min(p), h.max(p)));
        let axis = (high - low).max_position();
        let half = triangles.len() / 2;
        triangles.select_nth_unstable_by(half, |a, b| middle(a)[axis].total_cmp(&middle(b)[axis]));
        let (left, right) = triangles.split_at_mut(half);
        build(left, first, nodes);
        build(right, first + half, nodes);
    }
    nodes[place].after = nodes.len();
}

impl Node {
    /// A leaf, for the time being the last.
    fn over(triangles: &[[Vec3; 3]], first: usize) -> Self {
        let corners = || triangles.iter().map(|t| t.map(|p| p.as_dvec3()));
        let (mut area, mut sum, mut middle) = (0.0, DVec3::ZERO, DVec3::ZERO);
        for [a, b, c] in corners() {
            let size = 0.5 * (b - a).cross(c - a).length();
            area += size;
            sum += size * (a + b + c) / 3.0;
            middle += (a + b + c) / (3.0 * triangles.len() as f64);
        }
        let centre = if area > 0.0 { sum / area } else { middle };
        let farthest = corners().flatten().map(|p| p.distance(centre)).fold(0.0, f64::max);
        let radius = farthest * (1.0 + 1e-9);
        let mut moments = Moments::default();
        corners().for_each(|t| moments.add(t.map(|p| p - centre)));
        let far = far_from(area, radius).powi(2);
        Self { centre, radius, area, far, moments, first, end: first + triangles.len(), after: first + 1 }
    }
}

/// A ball that holds a triangle, its centre and radius, and the triangle's area.
fn ball(triangle: &[Vec3; 3]) -> (DVec3, f64, f64) {
    let [a, b, c] = triangle.map(|p| p.as_dvec3());
    let centre = (a + b + c) / 3.0;
    let radius = [a, b, c].map(|p| p.distance(centre)).into_iter().fold(0.0, f64::max) * (1.0 + 1e-9);
    (centre, radius, 0.5 * (b - a).cross(c - a).length())
}

/// The distance from which an expansion leaves out little enough.
fn far_from(area: f64, radius: f64) -> f64 {
    let left_out = |distance: f64| {
        let q = radius / distance;
        area / (4.0 * PI * distance * distance) * q.powi(3) * (4.0 - 3.0 * q) / (1.0 - q).powi(2)
    };
    let (mut near, mut far) = (radius, 2.0 * radius);
    if area == 0.0 {
        return near;
    }
    while left_out(far) > LEFT_OUT {
        far *= 2.0;
    }
    for _ in 0..20 {
        let between = 0.5 * (near + far);
        *(if left_out(between) > LEFT_OUT { &mut near } else { &mut far }) = between;
    }
    far
}

/// Sums over triangles, with n their area vectors and y from the centre to their points.
#[derive(Debug, Clone, Default)]
struct Moments {
    /// Of n.
    area: DVec3,
    /// Of n y^T.
    first: DMat3,
    /// Of 2 (n . y) y + n (y . y).
    traces: DVec3,
    /// Of (n . r) (y . r)^2, by the powers of r: xxx, yyy, zzz, xxy, xxz, xyy, yyz, xzz, yzz, xyz.
    cubic: [f64; 10],
}

impl Moments {
    /// The means over a triangle are exact: that of y y^T is (a a^T + b b^T + c c^T + 9 m m^T) / 12, m the middle.
    fn add(&mut self, [a, b, c]: [DVec3; 3]) {
        let n = 0.5 * (b - a).cross(c - a);
        let middle = (a + b + c) / 3.0;
        let outer = |a: DVec3, b: DVec3| DMat3::from_cols(a * b.x, a * b.y, a * b.z);
        let q = (outer(a, a) + outer(b, b) + outer(c, c) + outer(middle, middle) * 9.0) * (1.0 / 12.0);
        let (xx, xy, xz) = (q.x_axis.x, q.x_axis.y, q.x_axis.z);
        let (yy, yz, zz) = (q.y_axis.y, q.y_axis.z, q.z_axis.z);
        self.area += n;
        self.first += outer(n, middle);
        self.traces += 2.0 * (q * n) + n * (xx + yy + zz);
        let cubic = [
            n.x * xx,
            n.y * yy,
            n.z * zz,
            2.0 * n.x * xy + n.y * xx,
            2.0 * n.x * xz + n.z * xx,
            n.x * yy + 2.0 * n.y * xy,
            2.0 * n.y * yz + n.z * yy,
            n.x * zz + 2.0 * n.z * xz,
            n.y * zz + 2.0 * n.z * yz,
            2.0 * (n.x * yz + n.y * xz + n.z * xy),
        ];
        self.cubic.iter_mut().zip(cubic).for_each(|(sum, part)| *sum += part);
    }

    /// The Taylor series of the integral of n . d / |d|^3, d from the point, about the centre, which is `r` away from it.
    fn solid_angle(&self, r: DVec3) -> f64 {
        let one = 1.0 / r.length_squared();
        let three = one * one.sqrt();
        let (xx, yy, zz) = (r.x * r.x, r.y * r.y, r.z * r.z);
        let [c0, c1, c2, c3, c4, c5, c6, c7, c8, c9] = self.cubic;
        let cubic = r.x * (c0 * xx + c5 * yy + c7 * zz)
            + r.y * (c1 * yy + c3 * xx + c8 * zz)
            + r.z * (c2 * zz + c4 * xx + c6 * yy)
            + c9 * r.x * r.y * r.z;
        let trace = self.first.x_axis.x + self.first.y_axis.y + self.first.z_axis.z;
        let at_three = self.area.dot(r) + trace;
        let at_five = 3.0 * r.dot(self.first * r) + 1.5 * self.traces.dot(r);
        three * (at_three + one * (7.5 * cubic * one - at_five))
    }
}

/// The solid angle of a triangle seen from `p`, positive from behind (Van Oosterom & Strackee 1983).
fn solid_angle(triangle: &[Vec3; 3], p: DVec3) -> f64 {
    let [a, b, c] = triangle.map(|corner| corner.as_dvec3() - p);
    let (la, lb, lc) = (a.length(), b.length(), c.length());
    let spread = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
    2.0 * libm::atan2(a.dot(b.cross(c)), spread)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers in 0..1 by Marsaglia's xorshift: the same every time.
    fn numbers(mut state: u64) -> impl FnMut() -> f32 {
        move || {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            (state >> 40) as f32 / (1u32 << 24) as f32
        }
    }

    /// Soups of triangles of one size or of many, turned anyhow or all one way, near the surface of a ball or all over it.
    fn soup(number: &mut impl FnMut() -> f32, count: usize, size: f32, is_shell: bool) -> Vec<[Vec3; 3]> {
        let mut point = || Vec3::new(number() - 0.5, number() - 0.5, number() - 0.5) * 2.0;
        let one = |_| {
            let centre = if is_shell { point().normalize_or(Vec3::X) } else { point() };
            let size = size * point().x.abs().powi(3).max(0.01);
            let mut t = [(); 3].map(|()| centre + size * point());
            if is_shell && (t[1] - t[0]).cross(t[2] - t[0]).dot(centre) < 0.0 {
                t.swap(1, 2);
            }
            t
        };
        (0..count).map(one).collect()
    }

    #[test]
    fn the_expansion_is_below_a_thousandth_from_the_exact_sum() {
        let mut number = numbers(7);
        let mut worst = 0.0f64;
        for (count, size, is_shell) in [
            (65, 0.5, false),
            (300, 0.3, true),
            (2000, 0.1, true),
            (2000, 1.0, false),
            (2000, 1.0, true),
            (6000, 0.05, true),
        ] {
            let triangles = soup(&mut number, count, size, is_shell);
            let tree = SolidAngles::of(triangles.clone());
            assert_eq!(tree.triangles().len(), count);
            for _ in 0..300 {
                let p = Vec3::new(number() - 0.5, number() - 0.5, number() - 0.5) * 3.0;
                let exact = triangles.iter().map(|t| solid_angle(t, p.as_dvec3())).sum::<f64>() / (4.0 * PI);
                let error = (tree.share(p) - exact).abs();
                worst = worst.max(error);
                assert!(error < 1e-3, "{count} {size} {is_shell}: {error} at {p}");
            }
        }
        // The expansion is used at all.
        assert!(worst > 1e-7, "{worst}");
    }

    #[test]
    fn few_triangles_are_summed_exactly() {
        let mut number = numbers(8);
        let triangles = soup(&mut number, FEW, 1.0, false);
        let tree = SolidAngles::of(triangles.clone());
        for p in [Vec3::ZERO, Vec3::new(3.0, 1.0, -2.0), Vec3::splat(100.0)] {
            let exact = triangles.iter().map(|t| solid_angle(t, p.as_dvec3())).sum::<f64>() / (4.0 * PI);
            assert!((tree.share(p) - exact).abs() < 1e-14);
        }
        let none = SolidAngles::of(Vec::new());
        assert!(none.share(Vec3::ONE) == 0.0 && none.area() == 0.0 && none.cover_less(1e-9, |_| 0.0));
    }

    /// A few small holes far apart are no hole as large as all of them.
    #[test]
    fn few_triangles_far_apart_cover_little_between_them() {
        let small = |at: f32| [[0.0, 0.0], [0.1, 0.0], [0.0, 0.1]].map(|[y, z]| Vec3::new(at, y, z));
        let tree = SolidAngles::of((-10..=10).step_by(2).map(|at| small(at as f32)).collect());
        for p in [DVec3::new(1.0, 0.0, 0.0), DVec3::new(-5.0, 0.5, 0.0)] {
            assert!(tree.cover_less(0.25, |centre| p.distance(centre)), "{p}");
        }
        assert!(!tree.cover_less(0.25, |centre| centre.distance(DVec3::new(2.0, 0.0, 0.01))));
    }

    #[test]
    fn what_covers_less_does() {
        let mut number = numbers(9);
        let triangles = soup(&mut number, 1500, 0.5, true);
        let tree = SolidAngles::of(triangles.clone());
        let (mut yes, mut no) = (0, 0);
        for _ in 0..400 {
            let p = DVec3::new(number().into(), number().into(), number().into()) * 10.0 - 5.0;
            let all: f64 = triangles.iter().map(|t| solid_angle(t, p).abs()).sum::<f64>() / (4.0 * PI);
            if tree.cover_less(0.25, |centre| p.distance(centre)) {
                assert!(all < 0.25, "{all} at {p}");
                yes += 1;
            } else {
                no += 1;
            }
        }
        assert!(yes > 50 && no > 50, "{yes} {no}");
    }
}
