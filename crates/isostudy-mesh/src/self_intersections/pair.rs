//! Whether two triangles meet, decided by signs alone.

use std::cmp::Ordering;
use std::cmp::Ordering::{Equal, Greater, Less};

use glam::Vec3;

use super::exact::{side_of_plane, turn_without};

/// Whether the corners are not all on a line.
pub(super) fn has_area(corners: [Vec3; 3]) -> bool {
    (0..3).any(|axis| turn_without(axis, corners) != Equal)
}

/// Whether two triangles with areas have a point in common beside their common corners and sides. Corners at one place are one.
pub(super) fn meet_beyond_what_they_share(a: [Vec3; 3], b: [Vec3; 3]) -> bool {
    let in_b = |i: usize| b.iter().position(|corner| *corner == a[i]);
    let shared: Vec<(usize, usize)> = (0..3).filter_map(|i| Some((i, in_b(i)?))).collect();
    match *shared {
        [] => meet(a, b),
        // Whatever else they share goes on to the far side of one of them.
        [(i, j)] => {
            let opposite = |of: [Vec3; 3], corner: usize| [of[(corner + 1) % 3], of[(corner + 2) % 3]];
            segment_meets(opposite(a, i), b) || segment_meets(opposite(b, j), a)
        }
        [(i, j), (k, l)] => {
            let (own, other) = (a[3 - i - k], b[3 - j - l]);
            let edge = [a[i], a[k]];
            side_of_plane(a, other) == Equal && {
                let axis = flat_axis(a);
                let side = |p: Vec3| turn_without(axis, [edge[0], edge[1], p]);
                side(own) == side(other)
            }
        }
        // The same triangle twice.
        _ => true,
    }
}

/// Whether two triangles have a point in common.
fn meet(a: [Vec3; 3], b: [Vec3; 3]) -> bool {
    let is_apart = |of: [Vec3; 3], from: [Vec3; 3]| {
        let side = side_of_plane(from, of[0]);
        side != Equal && of[1..].iter().all(|p| side_of_plane(from, *p) == side)
    };
    if is_apart(a, b) || is_apart(b, a) {
        return false;
    }
    let sides = |of: [Vec3; 3]| (0..3).map(move |i| [of[i], of[(i + 1) % 3]]);
    sides(a).any(|side| segment_meets(side, b)) || sides(b).any(|side| segment_meets(side, a))
}

/// Whether a segment and a triangle with an area have a point in common.
fn segment_meets([p, q]: [Vec3; 2], of: [Vec3; 3]) -> bool {
    let [at_p, at_q] = [p, q].map(|end| side_of_plane(of, end));
    if at_p == Equal && at_q == Equal {
        return segment_meets_flat([p, q], of);
    }
    if at_p == at_q {
        return false;
    }
    let [a, b, c] = of;
    let turns = [[a, b], [b, c], [c, a]].map(|[from, to]| side_of_plane([p, q, from], to));
    !(turns.contains(&Less) && turns.contains(&Greater))
}

/// The same in a plane.
fn segment_meets_flat([p, q]: [Vec3; 2], of: [Vec3; 3]) -> bool {
    let axis = flat_axis(of);
    let turn = |a: Vec3, b: Vec3, c: Vec3| turn_without(axis, [a, b, c]);
    let is_in = |p: Vec3| {
        let turns = [0, 1, 2].map(|i| turn(of[i], of[(i + 1) % 3], p));
        !(turns.contains(&Less) && turns.contains(&Greater))
    };
    is_in(p) || is_in(q) || (0..3).any(|i| segments_cross(&turn, [p, q], [of[i], of[(i + 1) % 3]]))
}

/// Whether two segments cross each other, each with its ends on either side of the other or on it. Segments on one line are none, but
/// then one of the ends lies in the triangle, or the triangle's other sides are crossed.
fn segments_cross(
    turn: &impl Fn(Vec3, Vec3, Vec3) -> Ordering,
    [p, q]: [Vec3; 2],
    [a, b]: [Vec3; 2],
) -> bool {
    let of_ends = [turn(p, q, a), turn(p, q, b)];
    let of_own = [turn(a, b, p), turn(a, b, q)];
    let differ = |[a, b]: [Ordering; 2]| a != b;
    differ(of_ends) && differ(of_own)
}

/// An axis that a triangle with an area can do without: seen along it, it has an area too.
fn flat_axis(of: [Vec3; 3]) -> usize {
    (0..3).find(|&axis| turn_without(axis, of) != Equal).unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    type Place = [i128; 3];

    fn minus(a: Place, b: Place) -> Place {
        [0, 1, 2].map(|i| a[i] - b[i])
    }

    fn cross(a: Place, b: Place) -> Place {
        [0, 1, 2].map(|i| {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            a[j] * b[k] - a[k] * b[j]
        })
    }

    fn dot(a: Place, b: Place) -> i128 {
        a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
    }

    /// Whether two flat convex shapes have a point in common, in whole numbers: if not, an axis of a known few has them apart.
    fn shapes_meet(a: &[Place], b: &[Place]) -> bool {
        let edges = |of: &[Place]| -> Vec<Place> {
            (0..of.len()).map(|i| minus(of[(i + 1) % of.len()], of[i])).collect()
        };
        let (of_a, of_b) = (edges(a), edges(b));
        let normals = [cross(of_a[0], of_a[1]), cross(of_b[0], of_b[1])];
        let mut axes = normals.to_vec();
        for x in &of_a {
            axes.extend(of_b.iter().map(|y| cross(*x, *y)));
            axes.push(cross(normals[0], *x));
        }
        axes.extend(of_b.iter().map(|y| cross(normals[1], *y)));
        let range = |of: &[Place], axis: Place| {
            let along = of.iter().map(|p| dot(*p, axis));
            (along.clone().min().unwrap(), along.max().unwrap())
        };
        axes.iter().all(|axis| {
            let ((low_a, high_a), (low_b, high_b)) = (range(a, *axis), range(b, *axis));
            low_a <= high_b && low_b <= high_a
        })
    }

    /// What is wanted, by other means: shared corners are cut off a little first.
    fn wanted(a: [Place; 3], b: [Place; 3]) -> bool {
        const FINE: i128 = 1 << 14;
        let large = |of: [Place; 3]| of.map(|p| p.map(|v| v * FINE));
        let (large_a, large_b) = (large(a), large(b));
        let shared: Vec<usize> = (0..3).filter(|&i| b.contains(&a[i])).collect();
        match *shared {
            [] => shapes_meet(&large_a, &large_b),
            [i] => {
                let [v, p, q] = [0, 1, 2].map(|k| a[(i + k) % 3]);
                let near = |p: Place| [0, 1, 2].map(|k| v[k] * FINE + (p[k] - v[k]));
                let cut = [near(p), p.map(|v| v * FINE), q.map(|v| v * FINE), near(q)];
                shapes_meet(&cut, &large_b)
            }
            [i, j] => {
                // Beside the shared side: the part of one that is off it by a little.
                let own = a[3 - i - j];
                let near = |p: Place| [0, 1, 2].map(|k| p[k] * FINE + (own[k] - p[k]));
                let cut = [near(a[i]), near(a[j]), own.map(|v| v * FINE)];
                shapes_meet(&cut, &large_b)
            }
            _ => true,
        }
    }

    fn corner() -> impl Strategy<Value = [i32; 3]> {
        [-3..=3, -3..=3, -3..=3]
    }

    fn shape() -> impl Strategy<Value = [[i32; 3]; 3]> {
        [corner(), corner(), corner()]
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 40_000, max_global_rejects: 40_000, failure_persistence: None, ..ProptestConfig::default() })]

        /// On few whole numbers everything touches and lies in planes; corners are shared by chance and on purpose.
        #[test]
        fn pairs_meet_as_they_do_in_whole_numbers(a in shape(), b in shape(), shared in 0..4_usize, flat in any::<bool>()) {
            let mut b = b;
            b[..shared.min(3)].copy_from_slice(&a[..shared.min(3)]);
            let mut a = a;
            if flat {
                a.iter_mut().chain(&mut b).for_each(|p| p[2] = p[0] - p[1]);
            }
            let float = |of: [[i32; 3]; 3]| of.map(|p| Vec3::from_array(p.map(|v| v as f32)));
            let whole = |of: [[i32; 3]; 3]| of.map(|p| p.map(i128::from));
            let [fa, fb] = [float(a), float(b)];
            prop_assume!(has_area(fa) && has_area(fb));
            let want = wanted(whole(a), whole(b));
            prop_assert_eq!(meet_beyond_what_they_share(fa, fb), want, "{:?} {:?}", a, b);
            prop_assert_eq!(meet_beyond_what_they_share(fb, fa), want, "{:?} {:?}", b, a);
        }
    }
}
