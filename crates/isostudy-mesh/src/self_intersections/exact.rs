//! Signs of areas and volumes, exact for points in single precision.
//!
//! A determinant of such points is a sum of products of two or three numbers of 24 bits. A product of two is exact in double precision, and
//! one of three is the sum of two numbers. A rounded sum with a bound on its error decides nearly always; where it does not, the terms are
//! added as an expansion, without rounding (Shewchuk 1997).

use std::cmp::Ordering;

use glam::{DVec3, Vec3};

/// A unit in the last place of double precision, relative.
const EPSILON: f64 = f64::EPSILON;

/// On which side of the plane through `a`, `b` and `c` the point `d` lies: greater where they are counter-clockwise as seen from it.
pub(super) fn side_of_plane([a, b, c]: [Vec3; 3], d: Vec3) -> Ordering {
    let [ad, bd, cd] = [a, b, c].map(|p| p.as_dvec3() - d.as_dvec3());
    // Negative where counter-clockwise as seen from `d`, which is above.
    let volume = ad.dot(bd.cross(cd));
    let size = |v: DVec3| v.abs();
    let [sa, sb, sc] = [size(ad), size(bd), size(cd)];
    let permanent =
        sa.dot(DVec3::new(sb.y * sc.z + sb.z * sc.y, sb.z * sc.x + sb.x * sc.z, sb.x * sc.y + sb.y * sc.x));
    // Differences, products and sums each round once: seven at most on the way of a term.
    if volume.abs() > 16.0 * EPSILON * permanent {
        return 0.0_f64.total_cmp(&volume);
    }
    // Every term has a difference that is 0, as where all four points have one coordinate in common: walls of boxes are full of such.
    if permanent == 0.0 {
        return Ordering::Equal;
    }
    exact_volume([a, b, c, d]).reverse()
}

/// The sign of the determinant of `a - d`, `b - d`, `c - d`.
fn exact_volume([a, b, c, d]: [Vec3; 4]) -> Ordering {
    let mut sum = Expansion::default();
    // By the column of ones: each triple of points with its sign, each a determinant of six terms.
    for (sign, [p, q, r]) in [(1.0, [a, b, c]), (-1.0, [a, b, d]), (1.0, [a, c, d]), (-1.0, [b, c, d])] {
        for (parity, [x, y, z]) in [
            (1.0, [p.x, q.y, r.z]),
            (1.0, [p.y, q.z, r.x]),
            (1.0, [p.z, q.x, r.y]),
            (-1.0, [p.x, q.z, r.y]),
            (-1.0, [p.y, q.x, r.z]),
            (-1.0, [p.z, q.y, r.x]),
        ] {
            let of_two = sign * parity * f64::from(x) * f64::from(y);
            let product = of_two * f64::from(z);
            sum.add(of_two.mul_add(f64::from(z), -product));
            sum.add(product);
        }
    }
    sum.sign()
}

/// Which way `a`, `b` and `c` turn in a plane without one axis: greater where counter-clockwise.
pub(super) fn turn_without(axis: usize, [a, b, c]: [Vec3; 3]) -> Ordering {
    let [x, y] = [(axis + 1) % 3, (axis + 2) % 3];
    let [ax, ay, bx, by, cx, cy] = [a[x], a[y], b[x], b[y], c[x], c[y]].map(f64::from);
    let [left, right] = [(ax - cx) * (by - cy), (ay - cy) * (bx - cx)];
    let area = left - right;
    if area.abs() > 8.0 * EPSILON * (left.abs() + right.abs()) {
        return area.total_cmp(&0.0);
    }
    if left == 0.0 && right == 0.0 {
        return Ordering::Equal;
    }
    let mut sum = Expansion::default();
    for term in [ax * by, -(ax * cy), -(cx * by), -(ay * bx), ay * cx, cy * bx] {
        sum.add(term);
    }
    sum.sign()
}

/// A number as a sum of numbers that do not overlap, by growing magnitude. As many as the terms of a volume have parts.
struct Expansion {
    parts: [f64; 48],
    count: usize,
}

impl Default for Expansion {
    fn default() -> Self {
        Self { parts: [0.0; 48], count: 0 }
    }
}

impl Expansion {
    /// Adds a number, without rounding.
    fn add(&mut self, term: f64) {
        let mut carried = term;
        let mut kept = 0;
        for i in 0..self.count {
            let (sum, error) = two_sum(carried, self.parts[i]);
            if error != 0.0 {
                self.parts[kept] = error;
                kept += 1;
            }
            carried = sum;
        }
        if carried != 0.0 {
            self.parts[kept] = carried;
            kept += 1;
        }
        self.count = kept;
    }

    /// That of its largest part.
    fn sign(&self) -> Ordering {
        self.parts[..self.count].last().map_or(Ordering::Equal, |last| last.total_cmp(&0.0))
    }
}

/// A rounded sum, and what rounding took (Knuth).
fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let of_b = sum - a;
    (sum, (a - (sum - of_b)) + (b - of_b))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Numbers of few bits and many sizes, so that sums in whole numbers are exact.
    fn coordinate() -> impl Strategy<Value = i32> {
        prop_oneof![-4..=4, -1000..=1000, (-8_000_000..=8_000_000)]
    }

    fn point() -> impl Strategy<Value = [i32; 3]> {
        [coordinate(), coordinate(), coordinate()]
    }

    fn float(p: [i32; 3]) -> Vec3 {
        Vec3::from_array(p.map(|v| v as f32))
    }

    fn volume(p: [[i32; 3]; 4]) -> i128 {
        let [a, b, c] = [0, 1, 2].map(|i| [0, 1, 2].map(|k| i128::from(p[i][k]) - i128::from(p[3][k])));
        a[0] * (b[1] * c[2] - b[2] * c[1])
            + a[1] * (b[2] * c[0] - b[0] * c[2])
            + a[2] * (b[0] * c[1] - b[1] * c[0])
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 4_000, failure_persistence: None, ..ProptestConfig::default() })]

        #[test]
        fn signs_are_those_of_whole_numbers(
            a in point(), b in point(), c in point(), d in point(), u in -3..=3_i32, v in -3..=3_i32,
        ) {
            // The last case lies in the plane, as far as numbers have the bits for it.
            let within = [0, 1, 2].map(|k| a[k] + u * (b[k] / 8 - a[k] / 8) + v * (c[k] / 8 - a[k] / 8));
            let within = within.map(|v| v.clamp(-8_000_000, 8_000_000));
            for d in [d, within] {
                let want = 0.cmp(&volume([a, b, c, d]));
                let of = [a, b, c, d].map(float);
                prop_assert_eq!(side_of_plane([of[0], of[1], of[2]], of[3]), want);
                prop_assert_eq!(exact_volume(of).reverse(), want);
                // A power of two scales all alike.
                let small = of.map(|p| p * 2f32.powi(-60));
                prop_assert_eq!(side_of_plane([small[0], small[1], small[2]], small[3]), want);
            }
            for axis in 0..3 {
                let [x, y] = [(axis + 1) % 3, (axis + 2) % 3];
                let of = |p: [i32; 3]| [i64::from(p[x]), i64::from(p[y])];
                let [a2, b2, c2] = [of(a), of(b), of(c)];
                let want = ((a2[0] - c2[0]) * (b2[1] - c2[1]) - (a2[1] - c2[1]) * (b2[0] - c2[0])).cmp(&0);
                prop_assert_eq!(turn_without(axis, [float(a), float(b), float(c)]), want);
            }
        }
    }

    #[test]
    fn counter_clockwise_is_greater() {
        assert_eq!(side_of_plane([Vec3::ZERO, Vec3::X, Vec3::Y], Vec3::Z), Ordering::Greater);
        assert_eq!(turn_without(2, [Vec3::ZERO, Vec3::X, Vec3::Y]), Ordering::Greater);
        assert_eq!(turn_without(0, [Vec3::ZERO, Vec3::Y, Vec3::Z]), Ordering::Greater);
    }

    /// Points near a line, where doubles alone may err.
    #[test]
    fn what_doubles_cannot_tell_is_told() {
        let step = f32::EPSILON * 16.0;
        for i in 0..64 {
            for j in 0..64 {
                let a = Vec3::new(0.5 + i as f32 * step, 0.5 + j as f32 * step, 0.0);
                let [b, c] = [Vec3::new(12.0, 12.0, 0.0), Vec3::new(24.0, 24.0, 0.0)];
                // Above the diagonal is left of it.
                assert_eq!(turn_without(2, [b, c, a]), j.cmp(&i));
            }
        }
    }
}
