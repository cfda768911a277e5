//! Normals of points that have none.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use glam::{DMat3, DVec3, Vec3};

use crate::nearest_points::NearestPoints;
use crate::points::PointCloud;

/// Points whose common plane gives a normal, the point itself among them.
const NEIGHBOURS: usize = 12;
/// Sweeps that make a matrix diagonal; six are enough for any.
const SWEEPS: usize = 8;

/// Gives a cloud normals: each is across the plane that lies nearest to the point and its neighbours.
///
/// From the highest point, which faces up, sides are handed on from neighbour to neighbour, where their planes differ least. Points
/// that no chain of neighbours joins to others are a part of their own, with its own highest point. So a closed solid that was
/// scanned from outside faces outward. A sharp edge, a thin wall or a hole between sparse points may turn a part round.
///
/// Points that are not finite keep the normal zero.
///
/// Source: Hoppe et al. (1992), "Surface reconstruction from unorganized points", sections 3.2 and 3.3.
pub fn estimate_normals(cloud: &PointCloud) -> PointCloud {
    let is_finite = |p: &Vec3| p.is_finite();
    let used: Vec<usize> = (0..cloud.positions.len()).filter(|&i| is_finite(&cloud.positions[i])).collect();
    let points: Vec<DVec3> = used.iter().map(|&i| cloud.positions[i].as_dvec3()).collect();
    let tree = NearestPoints::new(&points);
    let near: Vec<Vec<u32>> = points
        .iter()
        .map(|&p| tree.nearest(p, NEIGHBOURS).into_iter().map(|(_, other)| other).collect())
        .collect();
    let mut normals: Vec<DVec3> = near.iter().map(|near| across(&points, near)).collect();
    face_outward(&points, &near, &mut normals);
    let mut all = vec![Vec3::ZERO; cloud.positions.len()];
    for (&i, normal) in used.iter().zip(normals) {
        all[i] = normal.as_vec3();
    }
    PointCloud { normals: all, ..cloud.clone() }
}

/// The direction in which some points reach least far.
fn across(points: &[DVec3], near: &[u32]) -> DVec3 {
    let of = |i: &u32| points[*i as usize];
    let middle = near.iter().map(of).sum::<DVec3>() / near.len() as f64;
    let mut spread = DMat3::ZERO;
    for d in near.iter().map(|i| of(i) - middle) {
        spread += DMat3::from_cols(d * d.x, d * d.y, d * d.z);
    }
    least_axis(spread)
}

/// The eigenvector of the least eigenvalue of a symmetric matrix, by Jacobi's rotations.
fn least_axis(mut matrix: DMat3) -> DVec3 {
    let mut axes = DMat3::IDENTITY;
    for _ in 0..SWEEPS {
        for (i, j) in [(0, 1), (0, 2), (1, 2)] {
            let off = matrix.col(i)[j];
            if off == 0.0 {
                continue;
            }
            let half = 0.5 * (matrix.col(j)[j] - matrix.col(i)[i]) / off;
            let tangent = half.signum() / (half.abs() + (half * half + 1.0).sqrt());
            let cosine = 1.0 / (tangent * tangent + 1.0).sqrt();
            let sine = tangent * cosine;
            let mut turn = DMat3::IDENTITY;
            turn.col_mut(i)[i] = cosine;
            turn.col_mut(j)[j] = cosine;
            turn.col_mut(j)[i] = sine;
            turn.col_mut(i)[j] = -sine;
            matrix = turn.transpose() * matrix * turn;
            axes *= turn;
        }
    }
    let least = (1..3).fold(0, |best, k| if matrix.col(k)[k] < matrix.col(best)[best] { k } else { best });
    axes.col(least)
}

/// A neighbour that waits for its side: how much the planes differ, in bits that order as the numbers do, who waits, and who hands on.
type Waiting = Reverse<(u64, u32, u32)>;

/// Turns normals so that neighbours agree, each part from its highest point.
fn face_outward(points: &[DVec3], near: &[Vec<u32>], normals: &mut [DVec3]) {
    // Who is a neighbour of another has it for one.
    let mut both = near.to_vec();
    for (i, near) in near.iter().enumerate() {
        near.iter().for_each(|&other| both[other as usize].push(i as u32));
    }
    let mut highest: Vec<usize> = (0..points.len()).collect();
    highest.sort_unstable_by(|&a, &b| points[b].z.total_cmp(&points[a].z).then(a.cmp(&b)));
    let mut is_done = vec![false; points.len()];
    let mut waiting: BinaryHeap<Waiting> = BinaryHeap::new();
    for first in highest {
        if is_done[first] {
            continue;
        }
        if normals[first].z < 0.0 {
            normals[first] = -normals[first];
        }
        is_done[first] = true;
        let mut from = first;
        loop {
            for &other in &both[from] {
                let differ = 1.0 - normals[from].dot(normals[other as usize]).abs().min(1.0);
                waiting.push(Reverse((differ.to_bits(), other, from as u32)));
            }
            let next =
                std::iter::from_fn(|| waiting.pop()).find(|Reverse((_, who, _))| !is_done[*who as usize]);
            let Some(Reverse((_, who, by))) = next else { break };
            let who = who as usize;
            if normals[by as usize].dot(normals[who]) < 0.0 {
                normals[who] = -normals[who];
            }
            is_done[who] = true;
            from = who;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_least_axis_is_that_of_a_known_matrix() {
        // Turned by a rotation whose last column is (2, 1, 2) / 3.
        let turn = DMat3::from_cols_array(&[1.0, 2.0, -2.0, -2.0, 2.0, 1.0, 2.0, 1.0, 2.0].map(|x| x / 3.0));
        let matrix = turn * DMat3::from_diagonal(DVec3::new(3.0, 2.0, 1.0)) * turn.transpose();
        let found = least_axis(matrix);
        assert!((found.dot(turn.col(2)).abs() - 1.0).abs() < 1e-14, "{found}");
        assert_eq!(least_axis(DMat3::from_diagonal(DVec3::new(2.0, 1.0, 3.0))), DVec3::Y);
    }

    /// Two balls apart, of points in a spiral: outward is away from the middle of each.
    #[test]
    fn scans_of_balls_face_outward() {
        let spiral = |i: usize, middle: Vec3| {
            let z = 1.0 - (2 * i + 1) as f32 / 400.0;
            let (turn, r) = (2.399_963 * i as f32, (1.0 - z * z).sqrt());
            middle + Vec3::new(r * turn.cos(), r * turn.sin(), z)
        };
        let middles = [Vec3::ZERO, Vec3::new(5.0, 0.0, -3.0)];
        let positions: Vec<Vec3> =
            middles.iter().flat_map(|&middle| (0..400).map(move |i| spiral(i, middle))).collect();
        let cloud = PointCloud { positions, ..PointCloud::default() };
        let found = estimate_normals(&cloud);
        for (i, (p, normal)) in found.positions.iter().zip(&found.normals).enumerate() {
            let outward = *p - middles[i / 400];
            assert!(normal.dot(outward) > 0.98, "{i}: {normal} at {outward}");
        }
    }
}
