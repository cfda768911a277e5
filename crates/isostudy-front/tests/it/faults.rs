//! Fields and settings that cannot be grown: an error that says where.

use crate::shapes::{cube, grown};
use isostudy_field::{Sphere, from_fn};
use isostudy_front::{Front, FrontError, Seeds, Sizing, grow};
use isostudy_mesh::Bounds;
use isostudy_mesh::glam::Vec3;

fn length([x, y, z]: [f32; 3]) -> f32 {
    (x * x + y * y + z * z).sqrt()
}

#[test]
fn without_a_gradient_the_place_is_named() {
    let step = from_fn(|p| if length(p) < 0.7 { 1.0 } else { -1.0 });
    match grown(&step, cube(1.0), &Front::of_edge(0.1)) {
        Err(FrontError::NoGradient { place }) => {
            assert!((place.length() - 0.7).abs() < 0.1, "{place}");
        }
        other => panic!("{:?}", other.map(|made| made.counts)),
    }
    let zero = from_fn(|_| 0.0);
    assert!(grown(&zero, cube(1.0), &Front::of_edge(0.1)).unwrap().mesh.triangles.is_empty());
    let seeded = Front { seeds: Seeds::Points(vec![Vec3::splat(0.3)]), ..Front::of_edge(0.1) };
    let error = grown(&zero, cube(1.0), &seeded).unwrap_err();
    assert!(matches!(error, FrontError::NoGradient { .. }) && error.to_string().contains("0.3"), "{error}");
}

#[test]
fn a_field_that_is_no_number_is_named() {
    let never = from_fn(|_| f32::NAN);
    assert!(grown(&never, cube(1.0), &Front::of_edge(0.1)).unwrap().mesh.triangles.is_empty());
    let half = from_fn(|p: [f32; 3]| if p[0] > 0.2 { f32::NAN } else { 0.7 - length(p) });
    match grown(&half, cube(1.0), &Front::of_edge(0.1)) {
        Err(FrontError::NoNumber { place }) => assert!((place.x - 0.2).abs() < 0.15, "{place}"),
        other => panic!("{:?}", other.map(|made| made.counts)),
    }
    let infinite = from_fn(|p| if length(p) < 0.5 { f32::INFINITY } else { f32::NEG_INFINITY });
    let error = grown(&infinite, cube(1.0), &Front::of_edge(0.1)).map(|made| made.counts).unwrap_err();
    assert!(matches!(error, FrontError::NoNumber { .. } | FrontError::NoGradient { .. }), "{error}");
}

#[test]
fn no_surface_is_an_empty_mesh() {
    let made = grow(&Sphere { radius: 3.0 }, cube(1.0), 0.0, &Front::of_edge(0.1)).unwrap();
    assert!(made.mesh.triangles.is_empty() && made.mesh.positions.is_empty());
    assert!(made.counts.evaluations > 0);
}

#[test]
fn seeds_are_checked() {
    let at = |p: Vec3| Front { seeds: Seeds::Points(vec![p]), ..Front::of_edge(0.1) };
    let ball = Sphere { radius: 0.7 };
    // Off the surface, and reached.
    let made = grow(&ball, cube(1.0), 0.0, &at(Vec3::new(0.1, 0.2, 0.3))).unwrap();
    assert_eq!(made.counts.seeds, 1);
    let outside = Vec3::new(0.0, 2.0, 0.0);
    let error = grow(&ball, cube(1.0), 0.0, &at(outside)).unwrap_err();
    assert_eq!(error, FrontError::SeedOutside { place: outside.as_dvec3() });
    // No surface anywhere, but a gradient.
    let field = from_fn(|p| -1.0 - length(p));
    let error = grown(&field, cube(1.0), &at(Vec3::splat(0.5))).unwrap_err();
    assert!(matches!(error, FrontError::Seed { .. } | FrontError::NoGradient { .. }), "{error}");
    let nan = grow(&ball, cube(1.0), 0.0, &at(Vec3::NAN));
    assert!(matches!(nan, Err(FrontError::SeedOutside { .. })));
}

#[test]
fn settings_are_checked() {
    let ball = Sphere { radius: 0.7 };
    let refused = |settings: Front, named: &str| match grow(&ball, cube(1.0), 0.0, &settings) {
        Err(FrontError::Setting { name, .. }) => assert_eq!(name, named),
        other => panic!("{:?}", other.map(|made| made.counts)),
    };
    for edge in [0.0, -1.0, f64::NAN, f64::INFINITY, 2.1, 1e-9] {
        refused(Front::of_edge(edge), "edge");
    }
    for cells in [0, 513] {
        refused(Front { seeds: Seeds::Sampled { cells }, ..Front::of_edge(0.1) }, "cells");
    }
    let by_curvature =
        |smallest, angle| Front { sizing: Sizing::Curvature { smallest, angle }, ..Front::of_edge(0.1) };
    refused(by_curvature(0.2, 0.5), "smallest");
    refused(by_curvature(f64::NAN, 0.5), "smallest");
    refused(by_curvature(0.05, 0.0), "angle");
    let flat = Bounds { min: Vec3::ZERO, max: Vec3::new(1.0, 0.0, 1.0) };
    assert!(matches!(grow(&ball, flat, 0.0, &Front::of_edge(0.1)), Err(FrontError::Box { .. })));
    assert!(matches!(
        grow(&ball, cube(1.0), f32::NAN, &Front::of_edge(0.1)),
        Err(FrontError::Isovalue { .. })
    ));
    // An edge as long as the box is allowed, and the ball is grown with shorter ones or refused.
    match grow(&ball, cube(1.0), 0.0, &Front::of_edge(2.0)) {
        Ok(made) => assert_eq!(isostudy_mesh::topology::topology(&made.mesh).euler_characteristic, 2),
        Err(error) => {
            assert!(matches!(error, FrontError::Seed { .. } | FrontError::Unclosed { .. }), "{error}")
        }
    }
}

#[test]
fn growth_ends_at_its_limit() {
    let settings = Front { most_triangles: 100, ..Front::of_edge(0.05) };
    let error = grow(&Sphere { radius: 0.7 }, cube(1.0), 0.0, &settings).unwrap_err();
    assert!(matches!(error, FrontError::TooMany { limit: 100, .. }), "{error}");
}

/// Noise without any scale: whatever comes, it comes soon, and is no panic.
#[test]
fn a_rough_field_ends() {
    let rough = from_fn(|p: [f32; 3]| {
        let bits =
            p.iter().fold(7u32, |bits, v| (bits ^ v.to_bits()).wrapping_mul(0x9e37_79b9).rotate_left(13));
        bits as f32 / u32::MAX as f32 - 0.5
    });
    let settings = Front { seeds: Seeds::Sampled { cells: 4 }, ..Front::of_edge(0.5) };
    let _ = grown(&rough, cube(1.0), &settings);
}
