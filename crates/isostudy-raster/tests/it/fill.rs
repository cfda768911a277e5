//! What is drawn where, once, and what is in front.

use crate::shapes;
use crate::sheets;
use isostudy_mesh::TriangleMesh;
use isostudy_mesh::glam::Vec3;
use isostudy_raster::{Camera, Look, RasterError, Shading, Turntable, Viewport, render, turntable};
use proptest::prelude::*;

const ONE_SAMPLE: Viewport = Viewport { width: 64, height: 64, supersampling: 1 };

fn above() -> Camera {
    Camera {
        eye: Vec3::new(0.0, 0.0, 2.0),
        target: Vec3::ZERO,
        up: Vec3::Y,
        vertical_fov_rad: 0.9,
        near: 1e-4,
        far: 100.0,
    }
}

/// Which pixels differ from the background.
fn covered(mesh: &TriangleMesh, camera: &Camera) -> Vec<bool> {
    let shading = Shading { background: [0.0, 1.0, 1.0], ..Shading::default() };
    let picture = render(mesh, camera, ONE_SAMPLE, &shading, Look::Flat).unwrap();
    picture.pixels().iter().map(|p| (p.red(), p.green(), p.blue()) != (0, 255, 255)).collect()
}

#[test]
fn triangles_that_share_edges_cover_every_sample_once() {
    // 36 turns, among them edges through sample centres (0, 45, 90 degrees), and a tilt that adds perspective.
    for turn in 0..36 {
        let (sin, cos) = (turn as f32 * 10.0).to_radians().sin_cos();
        for tilt in [0.0, 0.6] {
            let (a, b) = (Vec3::new(cos, sin, tilt), Vec3::new(-sin, cos, 0.0));
            let mesh = sheets::sheet((a + b) * -0.5, a, b, 4);
            let mut count = vec![0; 64 * 64];
            for &triangle in &mesh.triangles {
                let alone = TriangleMesh { triangles: vec![triangle], ..mesh.clone() };
                let one = covered(&alone, &above());
                count.iter_mut().zip(one).for_each(|(count, hit)| *count += hit as u32);
            }
            let together = covered(&mesh, &above());
            assert!(together.iter().filter(|&&hit| hit).count() > 500);
            for (i, (&count, hit)) in count.iter().zip(together).enumerate() {
                assert_eq!(count, hit as u32, "turn {turn}, tilt {tilt}, pixel {}, {}", i % 64, i / 64);
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(200) })]

    /// A fan round an inner point covers what its outline covers, each sample once. Corners lie on a grid of half
    /// pixels' worth of steps, so that edges often run through sample centres.
    #[test]
    fn a_fan_covers_every_sample_once(steps in prop::array::uniform8(-12i32..12), inner in prop::array::uniform2(-3i32..3)) {
        // A pixel is 2 tan(0.45) 2 / 64 wide at z = 0.
        let half_pixel = 2.0 * 0.45f32.tan() / 64.0;
        let at = |x: i32, y: i32| Vec3::new(x as f32, y as f32, 0.0) * half_pixel;
        let [a, b, c, d, e, f, g, h] = steps;
        let positions = vec![at(-30 + a, -30 + b), at(30 + c, -30 + d), at(30 + e, 30 + f), at(-30 + g, 30 + h), at(inner[0], inner[1])];
        let fan = TriangleMesh { positions, normals: vec![], triangles: vec![[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]] };
        let together = covered(&fan, &above());
        let mut count = vec![0; 64 * 64];
        for &triangle in &fan.triangles {
            let one = covered(&TriangleMesh { triangles: vec![triangle], ..fan.clone() }, &above());
            count.iter_mut().zip(one).for_each(|(count, hit)| *count += hit as u32);
        }
        for (i, (&count, hit)) in count.iter().zip(together).enumerate() {
            prop_assert_eq!(count, hit as u32, "pixel {}, {}", i % 64, i / 64);
        }
    }
}

#[test]
fn a_closed_mesh_has_no_hole() {
    // Every pixel of the disc's inner part, for triangles far smaller than a pixel too.
    for rings in [8, 40, 200] {
        let hit = covered(&shapes::sphere(0.5, rings), &above());
        for (i, &hit) in hit.iter().enumerate() {
            let (x, y) = ((i % 64) as f32 - 31.5, (i / 64) as f32 - 31.5);
            assert!(hit || x.hypot(y) > 14.0, "{rings} rings, pixel {}, {}", i % 64, i / 64);
        }
    }
}

#[test]
fn of_two_planes_that_cross_the_nearer_half_shows() {
    // Seen from +z, z = x / 2 hides z = -x / 2 on the right; the other is nearer on the left.
    let rising = sheets::sheet(Vec3::new(-1.0, -1.0, -0.5), Vec3::new(2.0, 0.0, 1.0), Vec3::Y * 2.0, 3);
    let falling = sheets::sheet(Vec3::new(-1.0, -1.0, 0.5), Vec3::new(2.0, 0.0, -1.0), Vec3::Y * 2.0, 3);
    let shading = Shading::default();
    let level = |plane: &TriangleMesh| {
        shading.colour(shading.exposure(plane.normals[0])).map(|v| (v * 255.0).round() as u8)
    };
    for both in [sheets::together(rising.clone(), &falling), sheets::together(falling.clone(), &rising)] {
        for look in [Look::Flat, Look::Smooth] {
            let picture = render(&both, &above(), ONE_SAMPLE, &shading, look).unwrap();
            let at = |x, y| picture.pixel(x, y).map(|p| [p.red(), p.green(), p.blue()]).unwrap();
            for y in [10, 32, 50] {
                assert_eq!(at(40, y), level(&rising));
                assert_eq!(at(33, y), level(&rising));
                assert_eq!(at(30, y), level(&falling));
                assert_eq!(at(20, y), level(&falling));
            }
        }
    }
}

#[test]
fn back_faces_show_the_colour_of_their_normal() {
    let down = sheets::sheet(Vec3::new(-1.0, -1.0, 0.0), Vec3::Y * 2.0, Vec3::X * 2.0, 2);
    assert_eq!(down.normals[0], Vec3::NEG_Z);
    let shading = Shading::default();
    let expected = shading.colour(-0.8).map(|v| (v * 255.0).round() as u8);
    for look in [Look::Flat, Look::Smooth] {
        let middle = render(&down, &above(), ONE_SAMPLE, &shading, look).unwrap().pixel(32, 32).unwrap();
        assert_eq!([middle.red(), middle.green(), middle.blue()], expected);
    }
}

#[test]
fn exposure_is_interpolated_with_perspective_and_not_renormalised() {
    // A strip running away from the eye, lit at the near end only: its exposure is linear along the strip, not on
    // the screen. The middle of the screen is at the strip's point y = 0, a third of the way from -1 to 2.
    let mut strip = sheets::sheet(Vec3::new(-1.0, -1.0, 0.0), Vec3::X * 2.0, Vec3::Y * 3.0, 1);
    strip.normals = vec![Vec3::Z, Vec3::Z, Vec3::ZERO, Vec3::ZERO];
    let camera = Camera { eye: Vec3::new(0.0, -1.5, 0.5), up: Vec3::Z, ..above() };
    let viewport = Viewport { width: 65, height: 65, supersampling: 1 };
    let shading = Shading::default();
    let pixel = render(&strip, &camera, viewport, &shading, Look::Smooth).unwrap().pixel(32, 32).unwrap();
    let expected = shading.colour(0.8 * 2.0 / 3.0).map(|v| v * 255.0);
    for (got, expected) in [pixel.red(), pixel.green(), pixel.blue()].iter().zip(expected) {
        assert!((*got as f32 - expected).abs() < 1.0, "{got} for {expected}");
    }
}

#[test]
fn flat_has_one_colour_a_face_and_smooth_many() {
    let mesh = shapes::sphere(0.5, 6);
    let colours = |look| {
        let picture = render(&mesh, &above(), ONE_SAMPLE, &Shading::default(), look).unwrap();
        let mut colours: Vec<_> = picture.pixels().iter().map(|p| (p.red(), p.green(), p.blue())).collect();
        colours.sort();
        colours.dedup();
        colours.len()
    };
    assert!(colours(Look::Flat) <= mesh.triangles.len() + 1);
    assert!(colours(Look::Smooth) > 2 * colours(Look::Flat));
}

#[test]
fn what_is_behind_or_through_the_eye_is_cut_without_a_panic() {
    // The eye sits inside the sphere: everything around it shows, whatever is behind is cut.
    let inside = Camera { eye: Vec3::new(0.0, 0.0, 0.2), ..above() };
    assert!(covered(&shapes::sphere(0.5, 12), &inside).iter().all(|&hit| hit));
    // A floor that runs from far behind to far ahead fills the lower half, up to the horizon.
    let floor = sheets::sheet(Vec3::new(-90.0, -90.0, -1.0), Vec3::X * 180.0, Vec3::Y * 180.0, 1);
    let ahead = Camera { eye: Vec3::ZERO, target: Vec3::Y, up: Vec3::Z, far: 1e4, ..above() };
    let hit = covered(&floor, &ahead);
    assert!((0..64 * 64).all(|i| hit[i] == (i / 64 >= 33) || i / 64 == 32), "the floor ends at the horizon");
    // In the plane of the floor, and with the eye on a corner.
    covered(&floor, &Camera { eye: Vec3::new(0.0, 0.0, -1.0), target: Vec3::new(0.0, 1.0, -1.0), ..ahead });
    covered(&floor, &Camera { eye: Vec3::new(-90.0, -90.0, -1.0), ..ahead });
    let huge = sheets::sheet(Vec3::new(-1e18, -1e18, -1.0), Vec3::X * 2e18, Vec3::Y * 2e18, 1);
    covered(&huge, &ahead);
    let behind = sheets::sheet(Vec3::new(-1.0, -3.0, -1.0), Vec3::X, Vec3::Z, 1);
    assert!(covered(&behind, &ahead).iter().all(|&hit| !hit));
}

#[test]
fn an_empty_mesh_is_background() {
    let (turntable_, shading) =
        (Turntable { width: 8, height: 4, frames: 2, ..Turntable::default() }, Shading::default());
    for look in [Look::Smooth, Look::Flat, Look::Wireframe, Look::SmoothWireframe] {
        let empty = TriangleMesh::default();
        let picture = render(&empty, &turntable_.camera(0), turntable_.viewport(), &shading, look).unwrap();
        assert!(
            picture.pixels().iter().all(|p| (p.red(), p.green(), p.blue(), p.alpha()) == (1, 130, 129, 255))
        );
        let animation = turntable(&empty, &turntable_, &shading, look, &|| ()).unwrap();
        assert_eq!(animation.picture(1).data(), picture.data());
    }
}

#[test]
fn bad_meshes_are_typed_errors() {
    let good = shapes::sphere(0.5, 4);
    let draw = |mesh: &TriangleMesh, look| {
        render(mesh, &above(), ONE_SAMPLE, &Shading::default(), look).map(|_| ()).unwrap_err()
    };
    let mut bad = good.clone();
    bad.positions[3].y = f32::NAN;
    assert_eq!(draw(&bad, Look::Flat), RasterError::NotFinite { vertex: 3, part: "position" });
    let mut bad = good.clone();
    bad.normals[3].y = f32::INFINITY;
    assert_eq!(draw(&bad, Look::Smooth), RasterError::NotFinite { vertex: 3, part: "normal" });
    let mut bad = good.clone();
    bad.normals.pop();
    let (normals, vertices) = (bad.normals.len(), bad.positions.len());
    assert_eq!(draw(&bad, Look::Wireframe), RasterError::Normals { normals, vertices });
    bad.triangles[5][1] = 1000;
    assert_eq!(draw(&bad, Look::Flat), RasterError::NoSuchVertex { triangle: 5, vertex: 1000, vertices });
}

#[test]
fn settings_out_of_range_are_typed_errors() {
    let good = || Turntable { width: 8, height: 8, frames: 2, ..Turntable::default() };
    for (bad, name) in [
        (Turntable { frames: 0, ..good() }, "frames"),
        (Turntable { width: 0, ..good() }, "width"),
        (Turntable { height: 20_000, ..good() }, "height"),
        (Turntable { supersampling: 9, ..good() }, "supersampling"),
        (Turntable { duration_s: 0.01, ..good() }, "duration_s"),
        (Turntable { duration_s: f64::NAN, ..good() }, "duration_s"),
        (Turntable { distance: 0.0, ..good() }, "camera distance"),
        (Turntable { vertical_fov_rad: 3.2, ..good() }, "vertical_fov_rad"),
        (Turntable { near: 0.0, ..good() }, "near"),
        (Turntable { far: f32::NAN, ..good() }, "far"),
    ] {
        let error =
            turntable(&shapes::sphere(1.0, 4), &bad, &Shading::default(), Look::Flat, &|| ()).unwrap_err();
        assert!(matches!(error, RasterError::Setting { setting, .. } if setting == name), "{name}: {error}");
    }
}
