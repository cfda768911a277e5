//! Errors of normals, vertex by vertex.

use glam::Vec3;
use isostudy_extract::{BoxGrid, Execution, accuracy, normal_errors_deg};
use isostudy_field::{Sphere, StudyField};
use isostudy_mesh::{Bounds, TriangleMesh};

const ONE: Execution = Execution { threads: 1 };
const SPACING: f32 = 0.2;
const BALL: Sphere = Sphere { radius: 1.0 };

/// Triangles on the unit sphere whose normals are turned away from the radius, vertex by vertex, by `degrees`.
fn turned(degrees: impl Fn(usize) -> f32) -> TriangleMesh {
    let mut mesh = TriangleMesh::default();
    for step in 0..40 {
        let (sin, cos) = (0.15 * step as f32).sin_cos();
        let height = -0.9 + 1.8 * step as f32 / 40.0;
        let around = (1.0 - height * height).sqrt();
        let radius = Vec3::new(around * cos, around * sin, height);
        let across = radius.any_orthonormal_vector();
        let angle = degrees(step).to_radians();
        mesh.positions.push(radius);
        mesh.normals.push(radius * angle.cos() + across * angle.sin());
    }
    mesh.triangles = (0..38).map(|first| [first, first + 1, first + 2]).collect();
    mesh
}

#[test]
fn they_are_the_angles_by_which_normals_were_turned() {
    let mesh = turned(|step| 4.0 * step as f32);
    let found = normal_errors_deg(&mesh, &BALL, 0.0, SPACING, &ONE).unwrap();
    assert_eq!(found.len(), 40);
    for (step, found) in found.iter().enumerate() {
        let wanted = 4.0 * step as f64;
        // The gradient is a difference over 1/32 spacings.
        assert!((found.unwrap() - wanted).abs() < 0.05, "{found:?} is not {wanted}");
    }
    let threads = normal_errors_deg(&mesh, &BALL, 0.0, SPACING, &Execution { threads: 3 });
    assert_eq!(threads.unwrap(), found);
}

#[test]
fn they_are_what_accuracy_summarises() {
    let mesh = turned(|step| 0.5 * step as f32);
    let found = normal_errors_deg(&mesh, &BALL, 0.0, SPACING, &ONE).unwrap();
    let mean = found.iter().map(|angle| angle.unwrap()).sum::<f64>() / 40.0;
    let bounds = Bounds { min: Vec3::splat(-1.2), max: Vec3::splat(1.2) };
    let grid = BoxGrid { bounds, spacing: SPACING };
    let summary = accuracy(&mesh, &BALL, 0.0, &grid, &ONE).unwrap().normal_error_deg;
    assert_eq!(summary.count, 40);
    assert!((summary.mean - mean).abs() < 1e-9, "{} is not {mean}", summary.mean);
}

/// Does not know its surface, and has none.
struct Nowhere;

impl StudyField for Nowhere {
    fn sample(&self, _: Vec3) -> f32 {
        -1.0
    }
}

#[test]
fn what_has_no_direction_has_no_angle() {
    let mut mesh = turned(|_| 10.0);
    mesh.normals[3] = Vec3::ZERO;
    let found = normal_errors_deg(&mesh, &BALL, 0.0, SPACING, &ONE).unwrap();
    assert!(found.iter().enumerate().all(|(v, angle)| angle.is_some() == (v != 3)));
    let found = normal_errors_deg(&mesh, &Nowhere, 0.0, SPACING, &ONE).unwrap();
    assert!(found.iter().all(Option::is_none));
    mesh.normals.clear();
    assert_eq!(normal_errors_deg(&mesh, &BALL, 0.0, SPACING, &ONE).unwrap(), []);
}
