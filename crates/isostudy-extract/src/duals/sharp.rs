//! Where planes meet: the point that is nearest to the tangent planes of some crossings.

use glam::{DMat3, DVec3};

/// How far a point may lie beyond its cell, in edges of the cell, where it need not be in it. Corners of an object lie nearer to a cell
/// that all their planes cross. Farther away planes of a rough surface meet, which say nothing of its corners.
const REACH: f64 = 1.0;

/// What is done where the planes leave a choice, or lead out of the cell.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Sharp {
    /// Eigenvalues of the sum of the normals' outer products that are smaller than this share of the largest count as none: along their
    /// directions the point is that of the mean of the crossings.
    pub(crate) truncation: f32,
    /// Whether the point is the best one in the cell, rather than the best anywhere up to [`REACH`] beyond it.
    pub(crate) in_cell: bool,
}

/// A sum of squared distances to planes, as a function of the way from the mean of the crossings.
struct Distances {
    /// Sum of outer products of the normals.
    a: DMat3,
    /// Sum of normals times the way to their planes.
    b: DVec3,
}

impl Sharp {
    /// The point of crossings and unit normals at them, in a cell from `low` to `high`. Crossings without a normal count for the mean
    /// alone.
    pub(crate) fn vertex(&self, crossings: &[(DVec3, Option<DVec3>)], low: DVec3, high: DVec3) -> DVec3 {
        let mean = crossings.iter().map(|(p, _)| *p).sum::<DVec3>() / crossings.len() as f64;
        let mut sum = Distances { a: DMat3::ZERO, b: DVec3::ZERO };
        for (p, normal) in crossings {
            let Some(n) = *normal else { continue };
            sum.a += DMat3::from_cols(n * n.x, n * n.y, n * n.z);
            sum.b += n * n.dot(*p - mean);
        }
        let step = self.solve(&sum, [true; 3]);
        let reach = if self.in_cell { DVec3::ZERO } else { REACH * (high - low) };
        let point = mean + step;
        if point.cmpge(low - reach).all() && point.cmple(high + reach).all() {
            return point;
        }
        self.best_in(&sum, low - mean, high - mean).map_or(mean, |step| mean + step).clamp(low, high)
    }

    /// The best point of a box: that of the inside, a face, an edge or a corner, each without regard to its ends. Of equals the first.
    fn best_in(&self, sum: &Distances, low: DVec3, high: DVec3) -> Option<DVec3> {
        // Rounding may put a point that is on a side a little beyond it.
        let tolerance = 1e-9 * (high - low).max_element();
        let mut best: Option<(f64, DVec3)> = None;
        for choice in 1..27 {
            let of_axis = [choice % 3, choice / 3 % 3, choice / 9];
            let mut fixed = DVec3::ZERO;
            for axis in 0..3 {
                fixed[axis] = [0.0, low[axis], high[axis]][of_axis[axis]];
            }
            let rest = Distances { a: sum.a, b: sum.b - sum.a * fixed };
            let point = fixed + self.solve(&rest, of_axis.map(|of| of == 0));
            let is_in =
                (0..3).all(|axis| (low[axis] - tolerance..=high[axis] + tolerance).contains(&point[axis]));
            let error = point.dot(sum.a * point) - 2.0 * point.dot(sum.b);
            if is_in && best.is_none_or(|(least, _)| error < least - 1e-12 * least.abs()) {
                best = Some((error, point));
            }
        }
        best.map(|(_, point)| point)
    }

    /// The shortest of the ways along the free axes that end nearest to all planes.
    fn solve(&self, sum: &Distances, free: [bool; 3]) -> DVec3 {
        let mask = DVec3::from_array(free.map(|free| if free { 1.0 } else { 0.0 }));
        let a = DMat3::from_diagonal(mask) * sum.a * DMat3::from_diagonal(mask);
        let (values, vectors) = eigen(a);
        let largest = values.max_element();
        let mut way = DVec3::ZERO;
        for axis in 0..3 {
            if values[axis] > f64::from(self.truncation) * largest && values[axis] > 0.0 {
                let direction = vectors.col(axis);
                way += direction * (direction.dot(sum.b * mask) / values[axis]);
            }
        }
        way * mask
    }
}

/// Eigenvalues and unit eigenvectors of a symmetric matrix, by Jacobi's rotations.
fn eigen(mut a: DMat3) -> (DVec3, DMat3) {
    const SWEEPS: usize = 16;
    let mut vectors = DMat3::IDENTITY;
    for _ in 0..SWEEPS {
        let off = a.col(1)[0].abs() + a.col(2)[0].abs() + a.col(2)[1].abs();
        if off <= 1e-16 * (a.col(0)[0].abs() + a.col(1)[1].abs() + a.col(2)[2].abs()) {
            break;
        }
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            let apq = a.col(q)[p];
            if apq == 0.0 {
                continue;
            }
            let theta = (a.col(q)[q] - a.col(p)[p]) / (2.0 * apq);
            // A square that overflows turns by nothing, as it should.
            let t = theta.signum() / (theta.abs() + (theta * theta + 1.0).sqrt());
            let c = 1.0 / (t * t + 1.0).sqrt();
            let s = t * c;
            // Rows and columns p and q turn by the angle; products with zeros and ones are left out.
            turn_rows(&mut a, p, q, c, s);
            turn_columns(&mut a, p, q, c, s);
            turn_columns(&mut vectors, p, q, c, s);
        }
    }
    (DVec3::new(a.col(0)[0], a.col(1)[1], a.col(2)[2]), vectors)
}

/// The matrix by a rotation in the plane of two axes, from the right.
fn turn_columns(of: &mut DMat3, p: usize, q: usize, c: f64, s: f64) {
    let (at_p, at_q) = (of.col(p), of.col(q));
    *of.col_mut(p) = at_p * c - at_q * s;
    *of.col_mut(q) = at_p * s + at_q * c;
}

/// The matrix by the inverse of the rotation, from the left.
fn turn_rows(of: &mut DMat3, p: usize, q: usize, c: f64, s: f64) {
    for column in 0..3 {
        let column = of.col_mut(column);
        (column[p], column[q]) = (c * column[p] - s * column[q], s * column[p] + c * column[q]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ANYWHERE: Sharp = Sharp { truncation: 1e-3, in_cell: false };
    const FAR: [DVec3; 2] = [DVec3::splat(-9.0), DVec3::splat(9.0)];

    #[test]
    fn eigenvectors_are_those_of_the_matrix() {
        for a in [
            DMat3::from_cols_array(&[2.0, -1.0, 0.5, -1.0, 3.0, 0.25, 0.5, 0.25, 1.0]),
            DMat3::from_cols_array(&[1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0]),
            DMat3::ZERO,
            DMat3::from_diagonal(DVec3::new(3.0, 1e-9, 2.0)),
        ] {
            let (values, vectors) = eigen(a);
            assert!((vectors * vectors.transpose()).abs_diff_eq(DMat3::IDENTITY, 1e-12));
            for axis in 0..3 {
                let v = vectors.col(axis);
                assert!((a * v).abs_diff_eq(v * values[axis], 1e-12), "{a} {values} {axis}");
            }
        }
    }

    /// A plane has the foot of the mean, an edge the point of it nearest to the mean, a corner itself.
    #[test]
    fn planes_edges_and_corners_are_met() {
        let p = |x: f64, y: f64, z: f64| DVec3::new(x, y, z);
        let n = |x: f64, y: f64, z: f64| Some(p(x, y, z).normalize());
        let plane = [(p(0.1, 0.0, 0.5), n(0.0, 0.0, 1.0)), (p(0.7, 0.4, 0.5), n(0.0, 0.0, 1.0))];
        assert!(ANYWHERE.vertex(&plane, FAR[0], FAR[1]).abs_diff_eq(p(0.4, 0.2, 0.5), 1e-12));
        let edge = [(p(0.2, 0.1, 0.5), n(0.0, 0.0, 1.0)), (p(0.6, 0.7, 0.1), n(1.0, 0.0, 0.0))];
        assert!(ANYWHERE.vertex(&edge, FAR[0], FAR[1]).abs_diff_eq(p(0.6, 0.4, 0.5), 1e-12));
        let corner = [edge[0], edge[1], (p(0.9, 0.3, 0.2), n(0.0, 1.0, 0.0))];
        assert!(ANYWHERE.vertex(&corner, FAR[0], FAR[1]).abs_diff_eq(p(0.6, 0.3, 0.5), 1e-12));
        // Without normals it is the mean.
        let bare = edge.map(|(p, _)| (p, None));
        assert!(ANYWHERE.vertex(&bare, FAR[0], FAR[1]).abs_diff_eq(p(0.4, 0.4, 0.3), 1e-12));
    }

    /// Beyond the cell by less than an edge a meeting of planes counts; farther away the best point of the cell is taken.
    #[test]
    fn points_far_away_are_not_taken() {
        // Planes x = along, y = 0.5 and z = 0.5, crossed in the unit cell's edges and faces.
        let found = |along: f64| {
            let slope = DVec3::new(0.1, 1.0, 0.0).normalize();
            let corner = DVec3::new(along, 0.5, 0.5);
            let on = |x: f64| corner + (x - along) * DVec3::new(1.0, -0.1, 0.0);
            let crossings = [
                (on(0.2), Some(slope)),
                (DVec3::new(0.3, 0.5, 0.1), Some(DVec3::Y)),
                (DVec3::new(0.6, 0.4, 0.5), Some(DVec3::Z)),
            ];
            Sharp { truncation: 1e-6, in_cell: false }.vertex(&crossings, DVec3::ZERO, DVec3::ONE)
        };
        assert!(found(1.9).abs_diff_eq(DVec3::new(1.9, 0.5, 0.5), 1e-9), "{}", found(1.9));
        let near = found(2.1);
        assert!(near.cmpge(DVec3::ZERO).all() && near.cmple(DVec3::ONE).all(), "{near}");
    }

    /// Two sets of eigenvalues that a kernel's author met: a cone's tip must keep rank 3, a worn edge must have rank 2.
    #[test]
    fn truncation_keeps_a_cone_and_drops_noise() {
        let rank = |values: DVec3| {
            let sum = Distances { a: DMat3::from_diagonal(values), b: values };
            let way = ANYWHERE.solve(&sum, [true; 3]);
            (0..3).filter(|&axis| (way[axis] - 1.0).abs() < 1e-9).count()
        };
        assert_eq!(rank(DVec3::new(1.563, 1.431, 0.00588)), 3);
        assert_eq!(rank(DVec3::new(2.87, 0.13, 5.6e-7)), 2);
    }

    /// The best point in a box, against a fine grid of its points.
    #[test]
    fn a_point_in_the_cell_is_the_best_there() {
        let sharp = Sharp { truncation: 1e-6, in_cell: true };
        let mut state = 1_u64;
        let mut random = || {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (state >> 40) as f64 / f64::from(1 << 24)
        };
        for _ in 0..200 {
            let crossings: Vec<_> = (0..5)
                .map(|_| {
                    let p = DVec3::new(random(), random(), random());
                    let n = DVec3::new(random() - 0.5, random() - 0.5, random() - 0.5);
                    (p, n.try_normalize())
                })
                .collect();
            let error =
                |x: DVec3| -> f64 { crossings.iter().map(|(p, n)| n.unwrap().dot(x - *p).powi(2)).sum() };
            let found = sharp.vertex(&crossings, DVec3::ZERO, DVec3::ONE);
            assert!(found.cmpge(DVec3::ZERO).all() && found.cmple(DVec3::ONE).all());
            let least = (0..21 * 21 * 21)
                .map(|i| error(DVec3::new((i % 21) as f64, (i / 21 % 21) as f64, (i / 441) as f64) / 20.0))
                .fold(f64::INFINITY, f64::min);
            assert!(error(found) <= least + 1e-9, "{found} {} {least}", error(found));
        }
    }
}
