//! Where things fall in the picture.

use crate::shapes;
use isostudy_mesh::glam::Vec3;
use isostudy_raster::{Camera, Look, Shading, Turntable, Viewport, render};

const PIXELS: Viewport = Viewport { width: 200, height: 100, supersampling: 2 };

fn ahead(vertical_fov_rad: f32) -> Camera {
    Camera {
        eye: Vec3::new(0.0, -2.0, 0.0),
        target: Vec3::ZERO,
        up: Vec3::Z,
        vertical_fov_rad,
        near: 1e-4,
        far: 100.0,
    }
}

#[test]
fn known_points_fall_where_they_should() {
    // At 90 degrees and distance 2 the picture's upper border is at z = 2: 25 pixels a unit of length.
    let camera = ahead(std::f32::consts::FRAC_PI_2);
    for (point, expected, distance) in [
        ([0.0, 0.0, 0.0], [100.0, 50.0], 2.0),
        ([1.0, 0.0, 0.0], [125.0, 50.0], 2.0),
        ([0.0, 0.0, 1.0], [100.0, 25.0], 2.0),
        ([1.0, 2.0, -1.0], [112.5, 62.5], 4.0),
    ] {
        let (at, z) = camera.project(Vec3::from(point), &PIXELS).unwrap();
        assert!(
            (at[0] - expected[0]).abs() < 1e-3 && (at[1] - expected[1]).abs() < 1e-3,
            "{point:?}: {at:?}"
        );
        assert!((z - distance).abs() < 1e-5);
    }
    assert_eq!(camera.project(Vec3::new(0.0, -3.0, 0.0), &PIXELS), None, "behind the eye");
    assert_eq!(camera.project(Vec3::new(0.0, 99.0, 0.0), &PIXELS), None, "beyond the far plane");
}

#[test]
fn the_turntable_is_the_papers() {
    let turntable = Turntable::default();
    assert!((turntable.eye_distance() / turntable.distance - 1.3229).abs() < 1e-4);
    assert!((turntable.eye_elevation_rad().to_degrees() - 22.2077).abs() < 1e-3);
    assert_eq!(turntable.frame_delay_cs(), 6);
    // t = 0: D (cos u, cos u, sin u). t = 90 deg: D (-cos u, cos u, sin u).
    let (cos, sin) = (0.75f32.sqrt(), 0.5);
    let close = |frame, expected: Vec3| (turntable.camera(frame).eye - expected * 1.2).length() < 1e-6;
    assert!(close(0, Vec3::new(cos, cos, sin)));
    assert!(close(30, Vec3::new(-cos, cos, sin)));
    assert!(close(120, Vec3::new(cos, cos, sin)), "a turn closes");
    for frame in 0..120 {
        assert!((turntable.camera(frame).eye.length() - turntable.eye_distance()).abs() < 1e-6);
    }
    assert_eq!(Turntable { duration_s: 1.2, ..turntable }.frame_delay_cs(), 1);
}

/// A sphere of radius r at distance l shows as a disc of radius f r / sqrt(l^2 - r^2), f = height / 2 / tan(fov / 2).
#[test]
fn a_spheres_outline_has_the_right_radius() {
    let camera = ahead(0.9);
    let viewport = Viewport { width: 300, height: 300, supersampling: 2 };
    let shading = Shading { background: [0.0, 1.0, 0.0], ..Shading::default() };
    let picture = render(&shapes::sphere(0.8, 160), &camera, viewport, &shading, Look::Smooth).unwrap();
    // The surface's green is at most 0.95 and mixes linearly at the rim: count what is plainly surface.
    let covered = picture.pixels().iter().filter(|p| p.green() < 247).count() as f32;
    let expected = 150.0 / 0.45f32.tan() * 0.8 / (4.0f32 - 0.64).sqrt();
    let radius = (covered / std::f32::consts::PI).sqrt();
    assert!((radius - expected).abs() < 0.7, "radius {radius}, expected {expected}");
    let row = |y: u32| (0..300).filter(|&x| picture.pixel(x, y).unwrap().green() < 247).collect::<Vec<_>>();
    let middle = row(150);
    assert!((middle[0] as f32 - (150.0 - expected)).abs() < 1.0, "{middle:?}");
    assert!((middle[middle.len() - 1] as f32 + 1.0 - (150.0 + expected)).abs() < 1.0, "{middle:?}");
}

/// The outline of a ball as seen from the eye: just inside the border of every frame, and nothing is cut off in depth.
#[test]
fn a_turn_around_a_ball_has_it_to_the_border() {
    for radius in [0.01, 1.0, 250.0] {
        let turn = Turntable::around(radius);
        for frame in [0, 17, 60] {
            let camera = turn.camera(frame);
            let distance = camera.eye.length();
            // Where a line from the eye touches the ball, straight above the middle of the picture.
            let (sin, cos) = (radius / distance, (1.0 - (radius / distance).powi(2)).sqrt());
            let back = camera.eye / distance;
            let up = (Vec3::Z - back * back.z).normalize();
            let ([x, y], _) = camera.project((back * sin + up * cos) * radius, &turn.viewport()).unwrap();
            assert!((x - 256.0).abs() < 0.5 && y.abs() < 0.5, "{radius}: {x}, {y}");
            assert!(camera.near < distance - radius && camera.far > distance + radius);
        }
    }
}
