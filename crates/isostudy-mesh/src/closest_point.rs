//! The point of a triangle that is nearest to another point, in double precision.

use glam::DVec3;

/// The point of the triangle `a`, `b`, `c` that is nearest to `p`. A triangle without area is the segment or the point
/// that it covers.
///
/// The candidates are the nearest points of the edges and, where it falls inside, the foot of the perpendicular, as in
/// the single-precision search.
pub(crate) fn closest_point([a, b, c]: [DVec3; 3], p: DVec3) -> DVec3 {
    let (ab, ac, ap) = (b - a, c - a, p - a);
    let normal = ab.cross(ac);
    let squared = normal.length_squared();
    // Barycentric coordinates of the foot, from areas.
    let (v, w) = (ap.cross(ac).dot(normal) / squared, ab.cross(ap).dot(normal) / squared);
    // Without area they are not numbers, and no comparison with them holds.
    if v >= 0.0 && w >= 0.0 && v + w <= 1.0 {
        return a + ab * v + ac * w;
    }
    let on_edges = [on_segment(a, b, p), on_segment(b, c, p), on_segment(c, a, p)];
    let nearer = |x: DVec3, y: DVec3| if y.distance_squared(p) < x.distance_squared(p) { y } else { x };
    nearer(nearer(on_edges[0], on_edges[1]), on_edges[2])
}

fn on_segment(a: DVec3, b: DVec3, p: DVec3) -> DVec3 {
    let ab = b - a;
    let along = ab.dot(p - a) / ab.length_squared();
    // A segment without length gives NaN, and its start.
    if along > 0.0 { a + ab * along.min(1.0) } else { a }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::dvec3;
    use proptest::prelude::*;

    const TRIANGLE: [DVec3; 3] = [dvec3(0.0, 0.0, 0.0), dvec3(4.0, 0.0, 0.0), dvec3(0.0, 3.0, 0.0)];

    #[test]
    fn every_region_by_hand() {
        for (p, want) in [
            (dvec3(1.0, 1.0, 5.0), dvec3(1.0, 1.0, 0.0)),
            (dvec3(2.0, -1.0, 1.0), dvec3(2.0, 0.0, 0.0)),
            (dvec3(-1.0, 1.0, 1.0), dvec3(0.0, 1.0, 0.0)),
            (dvec3(-1.0, -1.0, 1.0), dvec3(0.0, 0.0, 0.0)),
            (dvec3(6.0, -1.0, 0.0), dvec3(4.0, 0.0, 0.0)),
            (dvec3(0.0, 4.0, -2.0), dvec3(0.0, 3.0, 0.0)),
            // Beyond the hypotenuse: 4 y + 3 x = 12, foot of its middle moved along (3, 4).
            (dvec3(2.0 + 3.0, 1.5 + 4.0, 1.0), dvec3(2.0, 1.5, 0.0)),
        ] {
            assert!(closest_point(TRIANGLE, p).distance(want) < 1e-12, "{p}");
        }
    }

    #[test]
    fn without_area_it_is_a_segment_or_a_point() {
        let [a, b, _] = TRIANGLE;
        let p = dvec3(1.0, 2.0, 3.0);
        assert_eq!(closest_point([a, b, (a + b) * 0.5], p), dvec3(1.0, 0.0, 0.0));
        assert_eq!(closest_point([b, b, a], p), dvec3(1.0, 0.0, 0.0));
        assert_eq!(closest_point([b; 3], p), b);
    }

    proptest! {
        /// Nothing on a fine grid of the triangle is nearer, and the point is in the triangle.
        #[test]
        fn none_is_nearer(c in prop::array::uniform9(-1.0..1.0f64), p in prop::array::uniform3(-2.0..2.0f64)) {
            let corners = [0, 3, 6].map(|i| DVec3::from_slice(&c[i..]));
            let p = DVec3::from(p);
            let found = closest_point(corners, p);
            let mut nearest = f64::INFINITY;
            for i in 0..=60u32 {
                for j in 0..=60 - i {
                    let (v, w) = (f64::from(i) / 60.0, f64::from(j) / 60.0);
                    let q = corners[0] * (1.0 - v - w) + corners[1] * v + corners[2] * w;
                    prop_assert!(found.distance(p) <= q.distance(p) + 1e-9);
                    nearest = nearest.min(q.distance(found));
                }
            }
            // The grid's cells are a sixtieth of the triangle, whose sides are below 3.5.
            prop_assert!(nearest <= 3.5 / 60.0, "{nearest} from the triangle");
        }
    }
}
