//! The surface in space-time is a closed manifold of three dimensions.

use isostudy_four::SpaceTime;
use isostudy_mesh::TriangleMesh;
use isostudy_mesh::glam::Vec3;
use isostudy_mesh::topology::topology;

use crate::series::{ball, random, sampled};
use crate::topology::{Complex, links, triangles};
use isostudy_four::Placement;

/// Each triangle is in two tetrahedra, once each way, and each vertex's link is a sphere.
fn check_closed(space_time: &SpaceTime, what: &str) {
    assert!(!space_time.tetrahedra.is_empty(), "{what}");
    for (triangle, ways) in triangles(&space_time.tetrahedra) {
        assert_eq!(ways, [1, 1], "{what}: {triangle:?}");
    }
    let links = links(&space_time.tetrahedra);
    assert_eq!(links.len(), space_time.positions.len(), "{what}: every vertex is used");
    for (vertex, link) in links {
        let report = topology(&compact(&link));
        let is_sphere =
            report.is_closed_manifold() && report.components == 1 && report.euler_characteristic == 2;
        assert!(is_sphere, "{what}: vertex {vertex}: {report:?}");
    }
}

/// A mesh of these triangles with vertices from 0 on.
fn compact(triangles: &[[u32; 3]]) -> TriangleMesh {
    let mut used: Vec<u32> = triangles.as_flattened().to_vec();
    used.sort_unstable();
    used.dedup();
    let number = |v: u32| used.binary_search(&v).unwrap() as u32;
    let triangles = triangles.iter().map(|triangle| triangle.map(number)).collect();
    TriangleMesh { positions: vec![Vec3::ZERO; used.len()], triangles, normals: Vec::new() }
}

fn check_random(rounds: u64, seed: u64) {
    for round in 0..rounds {
        let share = [0.5, 0.2, 0.8][round as usize % 3];
        let series = random([6, 5, 6], 5, share, seed + round);
        check_closed(&series.extract(0.0).unwrap(), &format!("seed {}", seed + round));
    }
}

#[test]
fn random_samples_have_a_closed_manifold() {
    check_random(12, 1);
}

#[test]
#[ignore = "minutes: run by make test-long"]
fn many_more_random_samples_have_a_closed_manifold() {
    check_random(1_000, 100_000);
}

#[test]
fn samples_that_equal_the_isovalue_are_outside_and_the_manifold_is_closed() {
    for seed in 0..4 {
        let series = random([5, 5, 5], 5, 0.6, seed);
        // Whole numbers: many samples are 0.
        let frames: Vec<Vec<f32>> = series
            .frames()
            .iter()
            .map(|samples| {
                samples.iter().map(|v| if *v > 0.0 { (3.0 * v).floor() } else { (2.0 * v).ceil() }).collect()
            })
            .collect();
        let equal = frames.iter().flatten().filter(|v| **v == 0.0).count();
        assert!(equal > 50, "{equal}");
        let series = isostudy_four::Series::try_new(*series.placement(), frames).unwrap();
        check_closed(&series.extract(0.0).unwrap(), "ties");
    }
}

#[test]
fn a_ball_that_grows_and_shrinks_is_a_sphere_of_three_dimensions() {
    for n in [7, 10] {
        let space_time = ball(n, 0.36 * n as f64).extract(0.0).unwrap();
        check_closed(&space_time, "ball");
        let complex = Complex::of(&space_time.tetrahedra);
        assert_eq!(complex.euler_characteristic(), 0);
        assert_eq!(complex.betti(), [1, 0, 0, 1], "n = {n}");
    }
}

#[test]
fn a_ball_that_splits_and_joins_again_is_no_sphere() {
    // The points within 1.6 of a circle of radius 3 in x and time.
    let series = sampled(Placement::unit([12, 7, 7]), 12, |[x, y, z, t]| {
        let from_circle = ((x - 5.5).powi(2) + (t - 5.5).powi(2)).sqrt() - 3.0;
        1.6 - (from_circle.powi(2) + (y - 3.0).powi(2) + (z - 3.0).powi(2)).sqrt()
    });
    let space_time = series.extract(0.0).unwrap();
    check_closed(&space_time, "ring");
    assert_eq!(Complex::of(&space_time.tetrahedra).betti(), [1, 1, 1, 1]);
    let components = |time: f64| topology(&space_time.slice(time).unwrap()).components;
    assert_eq!([1.9, 5.5, 9.1].map(components), [1, 2, 1]);
}

#[test]
fn two_balls_are_two_spheres() {
    let series = sampled(Placement::unit([12, 6, 6]), 6, |[x, y, z, t]| {
        let near = |middle: f64| {
            let rest = (y - 2.5).powi(2) + (z - 2.5).powi(2) + (t - 2.5).powi(2);
            2.1 - ((x - middle).powi(2) + rest).sqrt()
        };
        near(2.5).max(near(8.5))
    });
    let space_time = series.extract(0.0).unwrap();
    check_closed(&space_time, "two balls");
    assert_eq!(Complex::of(&space_time.tetrahedra).betti(), [2, 0, 0, 2]);
}

#[test]
fn the_boundary_of_a_ball_has_its_content_to_second_order() {
    let radius = 0.8f64;
    let exact = 2.0 * std::f64::consts::PI.powi(2) * radius.powi(3);
    let errors: Vec<f64> = [9, 17, 33]
        .map(|n| {
            let spacing = 2.0 / (n - 1) as f64;
            let placement = Placement::even([n; 3], [-1.0; 3], spacing);
            let series = sampled(placement, n, |at| {
                radius - at.iter().map(|x| (x * spacing - 1.0).powi(2)).sum::<f64>().sqrt()
            });
            let content = series.extract(0.0).unwrap().content(spacing);
            (exact - content) / exact
        })
        .to_vec();
    println!("relative errors of the content: {errors:?}");
    // Twice a quarter off: what is left is of a higher order.
    let extrapolated = (4.0 * errors[2] - errors[1]) / 3.0;
    assert!(extrapolated.abs() < 1e-3, "{extrapolated} of {errors:?}");
    for pair in errors.windows(2) {
        assert!((3.4..4.6).contains(&(pair[0] / pair[1])), "order two: {errors:?}");
    }
}

#[test]
fn the_normal_comes_first_and_points_to_lower_values() {
    let errors = [11, 21].map(|n| {
        let (radius, middle) = (0.36 * (n - 1) as f64, (n - 1) as f64 / 2.0);
        let space_time = ball(n, radius).extract(0.0).unwrap();
        // Vertices of a ball are nearly on a sphere, so the way from its middle is the normal. Each determinant is 24 times the content of
        // a simplex with a corner in the middle.
        let determinant = |tetrahedron: &[u32; 4]| {
            let [a, b, c, d] = tetrahedron.map(|v| space_time.positions[v as usize]);
            isostudy_mesh::glam::DMat4::from_cols(a - middle, b - a, c - a, d - a).determinant()
        };
        let all: Vec<f64> = space_time.tetrahedra.iter().map(determinant).collect();
        let (total, right) =
            (all.iter().map(|x| x.abs()).sum::<f64>(), all.iter().map(|x| x.max(0.0)).sum::<f64>());
        assert!(right / total > 0.9999, "{right} of {total}");
        1.0 - total / 24.0 / (std::f64::consts::PI.powi(2) / 2.0 * radius.powi(4))
    });
    println!("relative errors of the ball's content: {errors:?}");
    assert!((3.4..4.6).contains(&(errors[0] / errors[1])), "order two: {errors:?}");
}
