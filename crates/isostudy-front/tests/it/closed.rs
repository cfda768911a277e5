//! Surfaces that stay clear of the box.

use crate::shapes::{cube, double_torus, grown, sound, torus};
use isostudy_field::{Asteroid, Sphere, from_fn};
use isostudy_front::{Front, Seeds, Sizing, grow};
use isostudy_mesh::glam::Vec3;
use isostudy_mesh::quality::quality;
use isostudy_mesh::self_intersections;
use std::f64::consts::PI;

/// The smallest angle of all meshes below, in degrees; 13.0 was measured.
const SMALLEST_ANGLE: f64 = 12.0;

#[test]
fn area_and_volume_of_a_sphere_come_near_with_the_square_of_the_edge() {
    let errors = |edge| {
        let mesh = grow(&Sphere { radius: 1.0 }, cube(1.1), 0.0, &Front::of_edge(edge)).unwrap().mesh;
        let report = sound(&mesh, cube(1.1));
        assert_eq!((report.euler_characteristic, report.boundary_edges, report.components), (2, 0, 1));
        assert_eq!(self_intersections(&mesh), Ok(0));
        assert!(quality(&mesh).min_angle_deg.min > SMALLEST_ANGLE, "{edge}");
        for (p, normal) in mesh.positions.iter().zip(&mesh.normals) {
            assert!((p.length() - 1.0).abs() < 1e-5 && normal.dot(*p) > 0.9999, "{p}");
        }
        [1.0 - mesh.area() / (4.0 * PI), 1.0 - mesh.volume() / (4.0 / 3.0 * PI)]
    };
    let all = [0.2, 0.1, 0.05].map(errors);
    for of in 0..2 {
        for pair in all.windows(2) {
            let order = (pair[0][of] / pair[1][of]).log2();
            assert!((1.8..2.2).contains(&order), "{order}: {all:?}");
        }
    }
}

#[test]
fn surfaces_of_any_genus_are_closed() {
    let (torus, double) = (torus(0.7, 0.25), double_torus());
    for edge in [0.15, 0.1, 0.07, 0.05, 0.03] {
        for (field, characteristic) in [(&torus as &dyn isostudy_field::ScalarField, 0), (&double, -2)] {
            let mesh = grown(field, cube(1.3), &Front::of_edge(edge)).unwrap().mesh;
            let report = sound(&mesh, cube(1.3));
            assert_eq!(report.euler_characteristic, characteristic, "{edge}");
            assert_eq!((report.boundary_edges, report.components), (0, 1), "{edge}");
            assert!(mesh.volume() > 0.0);
        }
    }
    let mesh = grown(&torus, cube(1.3), &Front::of_edge(0.03)).unwrap().mesh;
    let volume = 2.0 * PI * PI * 0.7 * 0.25 * 0.25;
    assert!((mesh.volume() / volume - 1.0).abs() < 0.005, "{} of {volume}", mesh.volume());
}

#[test]
fn two_parts_are_found() {
    let field = from_fn(|[x, y, z]: [f32; 3]| {
        let ball = |cx: f32, r: f32| r - ((x - cx).powi(2) + y * y + z * z).sqrt();
        ball(-0.5, 0.4).max(ball(0.5, 0.3))
    });
    for edge in [0.2, 0.05] {
        let made = grown(&field, cube(1.0), &Front::of_edge(edge)).unwrap();
        let report = sound(&made.mesh, cube(1.0));
        assert_eq!((report.components, report.euler_characteristic, report.boundary_edges), (2, 4, 0));
        assert_eq!(made.counts.seeds, 2);
    }
    // A seed reaches its own part, and a second seed on it begins nothing.
    let points = [Vec3::new(0.6, 0.0, 0.1), Vec3::new(0.5, 0.2, 0.0)];
    let seeded = Front { seeds: Seeds::Points(points.to_vec()), ..Front::of_edge(0.1) };
    let made = grown(&field, cube(1.0), &seeded).unwrap();
    assert_eq!((sound(&made.mesh, cube(1.0)).components, made.counts.seeds), (1, 1));
    assert!(made.mesh.positions.iter().all(|p| p.x > 0.1));
}

#[test]
fn the_asteroid_is_one_part_without_handles() {
    for edge in [0.2, 0.1, 0.05] {
        let mesh = grow(&Asteroid::default(), cube(1.1), 0.0, &Front::of_edge(edge)).unwrap().mesh;
        let report = sound(&mesh, cube(1.1));
        assert_eq!((report.euler_characteristic, report.boundary_edges, report.components), (2, 0, 1));
        assert!(quality(&mesh).min_angle_deg.min > SMALLEST_ANGLE, "{edge}");
    }
}

#[test]
fn edges_are_shorter_where_the_surface_curves() {
    let field = torus(0.7, 0.1);
    let sizing = Sizing::Curvature { smallest: 0.02, angle: 0.5 };
    let by_curvature = Front { sizing, ..Front::of_edge(0.2) };
    let made = grown(&field, cube(1.0), &by_curvature).unwrap();
    assert_eq!(sound(&made.mesh, cube(1.0)).euler_characteristic, 0);
    // The tube has the curvature 10 everywhere, so edges are about 0.05.
    let constant = grown(&field, cube(1.0), &Front::of_edge(0.05)).unwrap();
    let ratio = made.mesh.triangles.len() as f64 / constant.mesh.triangles.len() as f64;
    assert!((0.8..1.25).contains(&ratio), "{ratio}");
    // On an ellipsoid the tips have the shorter edges.
    let egg = from_fn(|[x, y, z]: [f32; 3]| 1.0 - (x * x + 9.0 * (y * y + z * z)).sqrt());
    let mesh = grown(&egg, cube(1.1), &Front { sizing, ..Front::of_edge(0.15) }).unwrap().mesh;
    assert_eq!(sound(&mesh, cube(1.1)).euler_characteristic, 2);
    let mean = |is_in: &dyn Fn(f32) -> bool| {
        let edges: Vec<f32> = (0..mesh.triangles.len())
            .map(|t| mesh.corners(t))
            .filter(|[a, b, c]| is_in((a.x + b.x + c.x).abs() / 3.0))
            .map(|[a, b, _]| a.distance(b))
            .collect();
        edges.iter().sum::<f32>() / edges.len() as f32
    };
    let (tip, waist) = (mean(&|x| x > 0.9), mean(&|x| x < 0.3));
    assert!(tip < 0.7 * waist, "{tip} {waist}");
}

#[test]
fn the_same_is_grown_again() {
    let once = grow(&Asteroid::default(), cube(1.1), 0.0, &Front::of_edge(0.1)).unwrap();
    let threads: Vec<_> = (0..3)
        .map(|_| {
            std::thread::spawn(|| grow(&Asteroid::default(), cube(1.1), 0.0, &Front::of_edge(0.1)).unwrap())
        })
        .collect();
    for thread in threads {
        assert_eq!(thread.join().unwrap(), once);
    }
}
