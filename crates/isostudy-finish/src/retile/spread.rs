//! Points that push each other apart on a surface.

use crate::surface::Surface;
use isostudy_mesh::glam::DVec3;
use rand::{Rng, SeedableRng};
use rand_pcg::Pcg64;
use std::collections::HashMap;

/// A point of a surface.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Place {
    /// The triangle it lies in.
    pub(crate) triangle: u32,
    /// Where, in its inside.
    pub(crate) position: DVec3,
}

/// How often points push each other, and how much of its push each follows (Turk, section 3).
const ROUNDS: usize = 40;
const FOLLOWED: f64 = 0.15;
/// The radius of repulsion, where the mean area of a point is 1.
const RADIUS: f64 = 2.0;
/// The least cosine between the normals of points that push each other: those of another sheet do not.
const SAME_SHEET: f64 = -0.3;
/// Edges that a point crosses in a round at most.
const MOST_EDGES: usize = 64;
/// How far into its triangle a point lies at least, as a share of its height.
const INSIDE: f64 = 1e-4;

/// So many points of the surface. `None` if it has no area.
pub(crate) fn spread(surface: &Surface, density: &[f64], count: usize, seed: u64) -> Option<Vec<Place>> {
    let triangles = 0..surface.triangles.len() as u32;
    let weights: Vec<f64> =
        triangles.map(|t| 0.5 * surface.area_vector(t).length() * density[t as usize]).collect();
    let total: f64 = weights.iter().sum();
    if total.is_nan() || total <= 0.0 {
        return None;
    }
    let standing = standing(surface, |t| 0.5 * RADIUS * (total / count as f64 / density[t as usize]).sqrt());
    let mut places = thrown(surface, &weights, total, count, seed);
    let unit = RADIUS * (total / count as f64).sqrt();
    for _ in 0..ROUNDS {
        let pushes = pushes(surface, &places, &standing, |t| unit / density[t as usize].sqrt());
        for (place, push) in places.iter_mut().zip(pushes) {
            *place = walk(surface, *place, push);
        }
    }
    Some(places)
}

/// One point in each equal part of the area, as the triangles are numbered.
fn thrown(surface: &Surface, weights: &[f64], total: f64, count: usize, seed: u64) -> Vec<Place> {
    let mut random = Pcg64::seed_from_u64(seed);
    let mut unit = || (random.next_u64() >> 11) as f64 / (1u64 << 53) as f64;
    let (mut t, mut below) = (0, 0.0);
    (0..count)
        .map(|i| {
            let at = (i as f64 + unit()) / count as f64 * total;
            while t + 1 < weights.len() && below + weights[t] <= at {
                below += weights[t];
                t += 1;
            }
            // The last that has an area, where sums are rounded.
            let t = (0..=t).rev().find(|&t| weights[t] > 0.0).unwrap_or(t) as u32;
            // Uniform in a triangle (Turk 1990).
            let (root, share) = (unit().sqrt(), unit());
            inside(surface, t, [1.0 - root, root * (1.0 - share), root * share])
        })
        .collect()
}

/// The point of a triangle with these barycentric coordinates, moved in if it lies at its edge.
fn inside(surface: &Surface, triangle: u32, coordinates: [f64; 3]) -> Place {
    let kept = coordinates.map(|share| share.max(INSIDE));
    let sum: f64 = kept.iter().sum();
    let corners = surface.corners(triangle);
    let position = (0..3).map(|k| corners[k] * (kept[k] / sum)).sum();
    Place { triangle, position }
}

/// Points on borders that push and stay, for there is nothing beyond a border that would: about as far from each other as points will be.
fn standing(surface: &Surface, apart: impl Fn(u32) -> f64) -> Vec<Place> {
    let mut standing = Vec::new();
    for (triangle, corners) in (0..).zip(&surface.triangles) {
        for k in 0..3 {
            let [u, v] = [corners[k], corners[(k + 1) % 3]];
            if surface.triangles_of_edge(u, v).count() == 1 {
                let [p, q] = [u, v].map(|w| surface.position(w));
                let parts = (p.distance(q) / apart(triangle)).round().max(1.0) as u32;
                let at = |part: u32| p.lerp(q, f64::from(part) / f64::from(parts));
                standing.extend((0..parts).map(|part| Place { triangle, position: at(part) }));
            }
        }
    }
    standing
}

/// How far each point shall move, along its triangle.
fn pushes(
    surface: &Surface,
    moving: &[Place],
    standing: &[Place],
    radius: impl Fn(u32) -> f64,
) -> Vec<DVec3> {
    let places = [moving, standing].concat();
    let radii: Vec<f64> = places.iter().map(|place| radius(place.triangle)).collect();
    let normals: Vec<DVec3> =
        places.iter().map(|place| surface.area_vector(place.triangle).normalize_or_zero()).collect();
    let cell = radii.iter().copied().fold(0.0, f64::max);
    let cell_of = |p: DVec3| (p / cell).floor().as_i64vec3().to_array();
    let mut cells: HashMap<[i64; 3], Vec<u32>> = HashMap::new();
    for (i, place) in (0..).zip(&places) {
        cells.entry(cell_of(place.position)).or_default().push(i);
    }
    let push = |i: usize, near: &[u32]| {
        let p = places[i].position;
        let mut sum = DVec3::ZERO;
        for j in near.iter().map(|&j| j as usize) {
            let away = p - places[j].position;
            let (far, reach) = (away.length(), 0.5 * (radii[i] + radii[j]));
            let is_near = j != i && far < reach && far > 0.0;
            if is_near && normals[i].dot(normals[j]) > SAME_SHEET {
                let along = away - normals[i] * away.dot(normals[i]);
                sum += along.normalize_or_zero() * (reach - far);
            }
        }
        // No farther than half the radius, or points would leap over each other.
        (sum * FOLLOWED).clamp_length_max(0.5 * radii[i])
    };
    let mut pushes = vec![DVec3::ZERO; moving.len()];
    let mut near = Vec::new();
    // Each cell on its own, in any order: what pushes a point is in the order of its neighbour cells.
    for (home, own) in &cells {
        near.clear();
        for step in 0..27 {
            let key = [home[0] + step % 3 - 1, home[1] + step / 3 % 3 - 1, home[2] + step / 9 - 1];
            near.extend(cells.get(&key).into_iter().flatten());
        }
        for i in own.iter().map(|&i| i as usize).filter(|&i| i < moving.len()) {
            pushes[i] = push(i, &near);
        }
    }
    pushes
}

/// Where a point comes to that walks straight on over the surface. It ends at borders, and at triangles without area.
fn walk(surface: &Surface, from: Place, push: DVec3) -> Place {
    let Place { triangle: mut t, position: mut p } = from;
    let mut rest = push;
    for _ in 0..MOST_EDGES {
        let corners = surface.corners(t);
        let normal = surface.area_vector(t).normalize_or_zero();
        rest -= normal * rest.dot(normal);
        let mut first: Option<(f64, usize)> = None;
        for k in 0..3 {
            let inwards = normal.cross(corners[(k + 1) % 3] - corners[k]);
            let (height, rate) = ((p - corners[k]).dot(inwards).max(0.0), rest.dot(inwards));
            if rate < 0.0 && height < -rate && first.is_none_or(|(least, _)| height / -rate < least) {
                first = Some((height / -rate, k));
            }
        }
        let Some((share, k)) = first else {
            p += rest;
            break;
        };
        p += rest * share;
        rest *= 1.0 - share;
        let [u, v] = [surface.triangles[t as usize][k], surface.triangles[t as usize][(k + 1) % 3]];
        let beyond = surface.triangle_along(v, u).filter(|_| surface.triangles_of_edge(u, v).count() == 2);
        let Some((next, _)) = beyond.filter(|(next, _)| surface.area_vector(*next) != DVec3::ZERO) else {
            break;
        };
        // What was along the edge stays so, and what led away from it leads away from it.
        let edge = (surface.position(u) - surface.position(v)).normalize_or_zero();
        let inwards = surface.area_vector(next).normalize_or_zero().cross(edge);
        let along = rest.dot(edge);
        rest = edge * along + inwards * (rest - edge * along).length();
        t = next;
    }
    inside(surface, t, barycentric(surface.corners(t), p))
}

fn barycentric([a, b, c]: [DVec3; 3], p: DVec3) -> [f64; 3] {
    let normal = (b - a).cross(c - a);
    let squared = normal.length_squared();
    let second = (p - a).cross(c - a).dot(normal) / squared;
    let third = (b - a).cross(p - a).dot(normal) / squared;
    [1.0 - second - third, second, third]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shapes::{cube, icosphere, sheet};
    use isostudy_mesh::TriangleMesh;

    /// The distance of each point to the nearest other, by all pairs.
    fn nearest(places: &[Place]) -> Vec<f64> {
        let to = |i: usize, j: usize| places[i].position.distance(places[j].position);
        let least =
            |i: usize| (0..places.len()).filter(|&j| j != i).map(|j| to(i, j)).fold(f64::MAX, f64::min);
        (0..places.len()).map(least).collect()
    }

    fn spread_evenly(mesh: &TriangleMesh, count: usize) -> Vec<Place> {
        let surface = Surface::of(mesh);
        spread(&surface, &vec![1.0; surface.triangles.len()], count, 7).unwrap()
    }

    #[test]
    fn points_lie_in_their_triangles_and_apart() {
        for mesh in [icosphere(4), cube(5), sheet(6)] {
            let surface = Surface::of(&mesh);
            let places = spread_evenly(&mesh, 400);
            for place in &places {
                let corners = surface.corners(place.triangle);
                let coordinates = barycentric(corners, place.position);
                assert!(coordinates.iter().all(|share| *share > 0.0), "{coordinates:?}");
                let back: DVec3 = (0..3).map(|k| corners[k] * coordinates[k]).sum();
                assert!(back.distance(place.position) < 1e-12);
            }
            // The closest packing of equal circles puts neighbours sqrt (2 / sqrt 3 * area) apart.
            let packed = (2.0 / 3f64.sqrt() * mesh.area() / 400.0).sqrt();
            let apart = nearest(&places);
            let mean = apart.iter().sum::<f64>() / apart.len() as f64;
            assert!(mean > 0.8 * packed && mean < 1.01 * packed, "{} of the closest packing", mean / packed);
            let least = apart.iter().copied().fold(f64::MAX, f64::min);
            assert!(least > 0.5 * packed, "{} of the closest packing", least / packed);
        }
    }

    #[test]
    fn a_walk_round_a_cube_comes_back() {
        // Straight on round four faces of a cube of side 1: four edges of length 1.
        let surface = Surface::of(&cube(3));
        let near = |p: DVec3| {
            let inner = |t: &u32| {
                let of = barycentric(surface.corners(*t), p);
                let foot: DVec3 = (0..3).map(|k| surface.corners(*t)[k] * of[k]).sum();
                of.iter().all(|share| *share > 0.01) && foot.distance(p) < 1e-9
            };
            (0..surface.triangles.len() as u32).find(inner).unwrap()
        };
        let start = DVec3::new(0.4, 0.55, 1.0);
        let from = Place { triangle: near(start), position: start };
        let round = walk(&surface, from, DVec3::new(4.0, 0.0, 0.0));
        assert_eq!(round.triangle, from.triangle);
        assert!(round.position.distance(start) < 1e-9, "{}", round.position);
        let below = walk(&surface, from, DVec3::new(2.0, 0.0, 0.0));
        assert!(below.position.distance(DVec3::new(0.6, 0.55, 0.0)) < 1e-9, "{}", below.position);
    }

    #[test]
    fn a_walk_ends_at_the_border() {
        let surface = Surface::of(&sheet(2));
        let from = Place { triangle: 0, position: surface.corners(0).into_iter().sum::<DVec3>() / 3.0 };
        let end = walk(&surface, from, DVec3::new(0.0, -9.0, 0.0));
        assert!(end.position.y > 0.0 && end.position.y < 1e-3, "{}", end.position);
    }

    #[test]
    fn density_decides_how_many_lie_where() {
        // The upper half of a sphere four times as dense: four fifths of the points.
        let surface = Surface::of(&icosphere(4));
        let is_upper = |t: u32| surface.corners(t).iter().map(|p| p.z).sum::<f64>() > 0.0;
        let density: Vec<f64> =
            (0..surface.triangles.len() as u32).map(|t| if is_upper(t) { 4.0 } else { 1.0 }).collect();
        let places = spread(&surface, &density, 1000, 3).unwrap();
        let upper = places.iter().filter(|place| is_upper(place.triangle)).count();
        assert!((760..=840).contains(&upper), "{upper}");
    }
}
