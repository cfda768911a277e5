//! Looks beside the published one: flat shading, light on the camera, colours that stand for numbers.

use crate::shapes;
use crate::sheets;
use isostudy_mesh::TriangleMesh;
use isostudy_mesh::glam::Vec3;
use isostudy_raster::tiny_skia::Pixmap;
use isostudy_raster::{
    Animation, Camera, Colouring, LightFollows, Look, Palette, RasterError, Shading, Turntable, Values,
    Viewport, map_colour, render, render_coloured, turntable, turntable_coloured, turntable_in,
};
use std::collections::BTreeSet;

const ONE_SAMPLE: Viewport = Viewport { width: 96, height: 96, supersampling: 1 };

fn settings() -> Turntable {
    Turntable { width: 96, height: 96, frames: 8, ..Turntable::default() }
}

/// The colours of a picture but the background's.
fn colours(picture: &Pixmap) -> BTreeSet<[u8; 3]> {
    picture.pixels().iter().map(|p| [p.red(), p.green(), p.blue()]).filter(|c| *c != [1, 130, 129]).collect()
}

/// A cube whose sides share corners, with normals that point away from the middle.
fn cube() -> TriangleMesh {
    let corner = |i: usize| Vec3::from([i & 1, i >> 1 & 1, i >> 2].map(|bit| bit as f32 - 0.5));
    let positions: Vec<Vec3> = (0..8).map(corner).collect();
    let sides = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let triangles = sides.into_iter().flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    TriangleMesh { normals: positions.iter().map(|p| p.normalize()).collect(), positions, triangles }
}

#[test]
fn a_flat_side_has_one_shade() {
    let mesh = cube();
    let camera = Camera { eye: Vec3::new(2.0, 1.5, 1.2), ..Camera::around(&mesh.bounds().unwrap()) };
    let shading = Shading::default();
    let picture = |look| render(&mesh, &camera, ONE_SAMPLE, &shading, look).unwrap();
    let want: BTreeSet<[u8; 3]> = [Vec3::X, Vec3::Y, Vec3::Z]
        .map(|normal| shading.colour(shading.exposure(normal)).map(|v| (v * 255.0 + 0.5) as u8))
        .into();
    let found = colours(&picture(Look::Flat));
    assert_eq!(found.len(), 3, "three sides are seen");
    for (a, b) in found.iter().zip(&want) {
        assert!((0..3).all(|c| a[c].abs_diff(b[c]) <= 1), "{found:?} is not {want:?}");
    }
    assert!(colours(&picture(Look::Smooth)).len() > 100);
}

/// Pictures from all around, whole bytes.
fn turn(mesh: &TriangleMesh, shading: &Shading, look: Look) -> Vec<Vec<u8>> {
    let picture =
        |frame| render(mesh, &settings().camera(frame), ONE_SAMPLE, shading, look).unwrap().data().to_vec();
    (0..8).map(picture).collect()
}

/// The flat cube is the authority: every edge of it turns by 90 degrees.
#[test]
fn a_creased_cube_is_the_flat_cube() {
    let (mesh, shading) = (cube(), Shading::default());
    let creased = turn(&mesh, &shading, Look::Creased);
    assert_eq!(creased, turn(&mesh, &shading, Look::Flat));
    assert_ne!(creased, turn(&mesh, &shading, Look::Smooth));
    // With edges beyond the angle, the smooth cube.
    let dull = Shading { crease_deg: 95.0, ..shading };
    assert_eq!(turn(&mesh, &dull, Look::Creased), turn(&mesh, &dull, Look::Smooth));
    let flat = |mesh, look| turntable(mesh, &settings(), &shading, look, &|| ()).unwrap();
    assert_eq!(flat(&mesh, Look::Creased), flat(&mesh, Look::Flat));
}

/// No edge of these turns by 40 degrees, so the mesh's own normals are shown, to the bit.
#[test]
fn what_is_smooth_stays_as_it_is() {
    let shading = Shading::default();
    for mesh in [shapes::sphere(1.0, 16), shapes::torus(0.7, 0.3, 30, 14)] {
        assert_eq!(turn(&mesh, &shading, Look::Creased), turn(&mesh, &shading, Look::Smooth));
        assert_ne!(turn(&mesh, &shading, Look::Creased), turn(&mesh, &shading, Look::Flat));
    }
}

/// A closed cylinder with shared rims, from above its corner: the colour of each pixel against the cylinder's own normal there.
#[test]
fn a_cylinder_is_shaded_as_its_equation_says() {
    const STEPS: u32 = 180;
    let mut mesh = TriangleMesh { positions: vec![Vec3::NEG_Z, Vec3::Z], ..TriangleMesh::default() };
    for i in 0..STEPS {
        let (sin, cos) = (std::f32::consts::TAU * i as f32 / STEPS as f32).sin_cos();
        mesh.positions.extend([-1.0, 1.0].map(|z| Vec3::new(cos, sin, z)));
    }
    let at = |i: u32, top: u32| 2 + 2 * (i % STEPS) + top;
    for i in 0..STEPS {
        let [a, b, c, d] = [at(i, 0), at(i + 1, 0), at(i + 1, 1), at(i, 1)];
        mesh.triangles.extend([[a, b, c], [a, c, d], [0, b, a], [1, d, c]]);
    }
    mesh.normals = mesh.positions.iter().map(|p| p.normalize()).collect();
    let (camera, shading) = (Camera::around(&mesh.bounds().unwrap()), Shading::default());
    let worst = |look| {
        let picture = render(&mesh, &camera, ONE_SAMPLE, &shading, look).unwrap();
        let mut worst = 0.0f32;
        let mut seen = [0; 2];
        for (x, y) in (0..96).flat_map(|x| (0..96).map(move |y| (x, y))) {
            let Some((point, normal)) = first_hit(&camera, [x as f32 + 0.5, y as f32 + 0.5]) else {
                continue;
            };
            // Not where a pixel may fall to the other side of an outline or a rim.
            let turned = normal.dot((point - camera.eye).normalize()).abs() < 0.2;
            if turned || (point.z.abs() - 1.0).abs() < 0.04 && point.truncate().length() > 0.96 {
                continue;
            }
            seen[usize::from(normal.z > 0.5)] += 1;
            let p = picture.pixels()[y * 96 + x];
            let want = shading.colour(shading.exposure(normal)).map(|v| v * 255.0);
            let found = [p.red(), p.green(), p.blue()].map(f32::from);
            worst = (0..3).fold(worst, |worst, c| worst.max((found[c] - want[c]).abs()));
        }
        assert!(seen[0] > 800 && seen[1] > 200, "{seen:?}");
        worst
    };
    let (creased, smooth) = (worst(Look::Creased), worst(Look::Smooth));
    assert!(creased < 3.5 && smooth > 40.0, "{creased} and {smooth} levels");
}

/// Where the ray through a point of the picture meets the cylinder of radius 1 from z = -1 to 1, and its normal there.
fn first_hit(camera: &Camera, [x, y]: [f32; 2]) -> Option<(Vec3, Vec3)> {
    let forward = (camera.target - camera.eye).normalize();
    let right = forward.cross(camera.up).normalize();
    let slope = (camera.vertical_fov_rad * 0.5).tan() / 48.0;
    let way = forward + (right * (x - 48.0) - right.cross(forward) * (y - 48.0)) * slope;
    let (eye, level) = (camera.eye, way.truncate());
    let up = (1.0 - eye.z) / way.z;
    let on_top = eye + way * up;
    if on_top.truncate().length() <= 1.0 {
        return Some((on_top, Vec3::Z));
    }
    let half = eye.truncate().dot(level);
    let inside = half * half - level.length_squared() * (eye.truncate().length_squared() - 1.0);
    let at = eye + way * ((-half - inside.max(0.0).sqrt()) / level.length_squared());
    (inside > 0.0 && at.z.abs() <= 1.0).then(|| (at, Vec3::new(at.x, at.y, 0.0)))
}

/// Frames are drawn by as many threads as there are; their bytes are one thread's.
#[test]
fn creased_turntables_are_the_same_on_any_threads() {
    let mesh = cube();
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| turntable(&mesh, &settings(), &Shading::default(), Look::Creased, &|| ()).unwrap())
    };
    assert_eq!(on(1), on(3));
}

#[test]
fn a_crease_is_an_angle() {
    for value in [-1.0, 180.5, f32::NAN] {
        let shading = Shading { crease_deg: value, ..Shading::default() };
        let error = turntable(&cube(), &settings(), &shading, Look::Creased, &|| ()).unwrap_err();
        assert!(error.to_string().starts_with("crease_deg is"), "{error}");
        assert!(error.to_string().ends_with("allowed is 0 to 180"), "{error}");
    }
}

/// Mean brightness of each frame's surface.
fn brightness(animation: &Animation) -> Vec<f64> {
    let mean = |frame: usize| {
        let picture = animation.picture(frame);
        let surface: Vec<f64> = picture
            .pixels()
            .iter()
            .map(|p| [p.red(), p.green(), p.blue()])
            .filter(|c| *c != [1, 130, 129])
            .map(|[r, g, b]| f64::from(r) + f64::from(g) + f64::from(b))
            .collect();
        surface.iter().sum::<f64>() / surface.len() as f64
    };
    (0..animation.frames.len()).map(mean).collect()
}

#[test]
fn light_on_the_camera_is_the_same_all_around() {
    let sphere = shapes::sphere(1.0, 40);
    let spread = |shading: &Shading, look| {
        let of_frames = brightness(&turntable(&sphere, &settings(), shading, look, &|| ()).unwrap());
        let (low, high) = of_frames.iter().fold((f64::MAX, 0.0f64), |(a, b), &v| (a.min(v), b.max(v)));
        (high / low, of_frames[0])
    };
    for look in [Look::Smooth, Look::Flat, Look::SmoothWireframe] {
        let scene = Shading::default();
        let camera = Shading { light_follows: LightFollows::Camera, ..scene };
        let ((in_scene, first), (on_camera, same)) = (spread(&scene, look), spread(&camera, look));
        assert!(in_scene > 2.0, "{look:?}: half of the turn is dark: {in_scene}");
        assert!(on_camera < 1.01, "{look:?}: {on_camera}");
        assert!((first / same - 1.0).abs() < 1e-3, "{look:?}: the first frame is as in the scene");
        let (ambient, _) = spread(&Shading { ambient: 0.5, ..scene }, look);
        assert!(ambient < in_scene * 0.8, "{look:?}: {ambient}");
    }
}

#[test]
fn light_on_the_camera_keeps_its_side() {
    let sphere = shapes::sphere(1.0, 40);
    let shading = Shading { light_follows: LightFollows::Camera, ..Shading::default() };
    let animation = turntable(&sphere, &settings(), &shading, Look::Smooth, &|| ()).unwrap();
    let first = animation.picture(0);
    for frame in 1..8 {
        let picture = animation.picture(frame);
        let off = first.data().iter().zip(picture.data()).filter(|(a, b)| a.abs_diff(**b) > 6).count();
        assert!(off < first.data().len() / 200, "frame {frame}: {off} bytes differ");
    }
}

#[test]
fn ambient_light_is_a_share() {
    let shading = Shading { ambient: 1.5, ..Shading::default() };
    let error = turntable(&cube(), &settings(), &shading, Look::Flat, &|| ()).unwrap_err();
    assert_eq!(error, RasterError::Setting { setting: "ambient", value: 1.5, allowed: "0 to 1" });
}

/// An equilateral triangle on the left and one with sides 3, 4, 5 on the right, seen from above.
fn two_triangles() -> (TriangleMesh, Camera) {
    let height = 0.75f32.sqrt();
    let mesh = TriangleMesh {
        positions: [
            [-1.1, 0.0, 0.0],
            [-0.1, 0.0, 0.0],
            [-0.6, height, 0.0],
            [0.1, 0.0, 0.0],
            [1.0, 0.0, 0.0],
            [0.1, 1.2, 0.0],
        ]
        .map(Vec3::from)
        .to_vec(),
        normals: vec![Vec3::Z; 6],
        triangles: vec![[0, 1, 2], [3, 4, 5]],
    };
    let camera = Camera {
        eye: Vec3::new(0.0, 0.5, 3.0),
        target: Vec3::new(0.0, 0.5, 0.0),
        up: Vec3::Y,
        vertical_fov_rad: 0.9,
        near: 0.1,
        far: 10.0,
    };
    (mesh, camera)
}

/// By hand: the inscribed radius of 3, 4, 5 is 1, the circumscribed one 5/2; twice their ratio is 0.8.
#[test]
fn triangles_have_the_colours_of_their_radius_ratios() {
    let (mesh, camera) = two_triangles();
    let colouring = Colouring::radius_ratio(&mesh);
    let even = Shading { ambient: 1.0, ..Shading::default() };
    let shaded = Shading::default();
    // d = 0.8 of at most 1.0198.
    let brightness = 0.8 + 0.2 * (0.5 + 0.5 * 0.8 / 1.0198);
    for (shading, brightness) in [(even, 1.0), (shaded, brightness)] {
        let picture = render_coloured(&mesh, &colouring, &camera, ONE_SAMPLE, &shading, Look::Flat).unwrap();
        let at = |x: f32, y: f32| {
            let ([px, py], _) = camera.project(Vec3::new(x, y, 0.0), &ONE_SAMPLE).unwrap();
            let p = picture.pixels()[py as usize * 96 + px as usize];
            [p.red(), p.green(), p.blue()]
        };
        for (place, found) in [(1.0, at(-0.6, 0.3)), (0.8, at(0.3, 0.3))] {
            let want = map_colour(place).map(|v| v * brightness * 255.0);
            assert!((0..3).all(|c| (f32::from(found[c]) - want[c]).abs() < 2.5), "{found:?} is not {want:?}");
        }
        assert_eq!(colours(&picture).len(), 2);
    }
}

#[test]
fn numbers_at_vertices_are_interpolated() {
    let mesh = sheets::sheet(Vec3::new(-1.0, -1.0, 0.0), Vec3::X * 2.0, Vec3::Y * 2.0, 1);
    let distances = mesh.positions.iter().map(|p| 0.05 * (p.x + 1.0)).collect();
    let colouring = Colouring::distance(Values::PerVertex(distances), 0.1);
    let (_, camera) = two_triangles();
    let shading = Shading { ambient: 1.0, ..Shading::default() };
    let picture = render_coloured(&mesh, &colouring, &camera, ONE_SAMPLE, &shading, Look::Smooth).unwrap();
    for x in [-0.75f32, -0.4, 0.0, 0.3, 0.8] {
        let ([px, py], _) = camera.project(Vec3::new(x, 0.4, 0.0), &ONE_SAMPLE).unwrap();
        let p = picture.pixels()[py as usize * 96 + px as usize];
        // Small distances are bright.
        let want = map_colour(1.0 - 0.5 * (x + 1.0)).map(|v| v * 255.0);
        let off = [p.red(), p.green(), p.blue()].map(f32::from);
        assert!((0..3).all(|c| (off[c] - want[c]).abs() < 6.0), "{x}: {off:?} is not {want:?}");
    }
}

/// The scale lies below the frames, another reader sees the same, and every pixel is near what a still shows.
#[test]
fn coloured_turntables_are_close_to_stills() {
    let mesh = shapes::torus(0.7, 0.3, 60, 12);
    let colouring = Colouring::radius_ratio(&mesh);
    for (look, mean, psnr_db) in
        [(Look::Flat, 2.2, 40.0), (Look::Smooth, 2.2, 40.0), (Look::SmoothWireframe, 2.6, 35.5)]
    {
        let shading = Shading { ambient: 0.25, light_follows: LightFollows::Scene, ..Shading::default() };
        let turn = Turntable { width: 256, height: 256, frames: 6, ..Turntable::default() };
        let animation = turntable_coloured(&mesh, &colouring, &turn, &shading, look, &|| ()).unwrap();
        assert!(animation.height > 256 && animation.height < 320);
        assert!(animation.palette.colours().len() <= 256);
        assert_eq!(animation.palette, Palette::of_numbers(&shading, look));
        let mut file = Vec::new();
        animation.write_gif(&mut file).unwrap();
        assert_eq!(Animation::read_gif(&file[..]).unwrap(), animation);

        let (mut channels, mut sum, mut squares) = (0.0, 0.0, 0.0);
        for frame in 0..6 {
            let camera = turn.camera(frame);
            let still = render_coloured(&mesh, &colouring, &camera, turn.viewport(), &shading, look).unwrap();
            let indexed = animation.picture(frame as usize);
            for (a, b) in still.pixels().iter().zip(indexed.pixels()) {
                let [a, b] = [a, b].map(|p| [p.red(), p.green(), p.blue()]);
                if a == [1, 130, 129] {
                    assert_eq!(b, a, "the background is exact");
                    continue;
                }
                for c in 0..3 {
                    let off = f64::from(a[c].abs_diff(b[c]));
                    channels += 1.0;
                    sum += off;
                    squares += off * off;
                }
            }
            // White paper, and ink on it.
            let strip = &indexed.pixels()[256 * 256..];
            assert!(strip.iter().any(|p| p.red() < 60 && p.red() == p.blue()));
            assert!(strip.iter().filter(|p| p.red() == 255 && p.blue() == 255).count() > strip.len() / 2);
        }
        let (off, psnr) = (sum / channels, 10.0 * (255.0 * 255.0 * channels / squares).log10());
        println!("{look:?}: mean {off:.2}, {psnr:.1} dB");
        assert!(off <= mean && psnr >= psnr_db, "{look:?}: mean {off}, {psnr} dB");
    }
}

#[test]
fn numbers_must_fit_the_mesh() {
    let (mesh, camera) = two_triangles();
    let colouring = Colouring::distance(Values::PerVertex(vec![0.0; 5]), 0.1);
    let error =
        render_coloured(&mesh, &colouring, &camera, ONE_SAMPLE, &Shading::default(), Look::Flat).unwrap_err();
    assert_eq!(error, RasterError::Values { values: 5, of: "vertex", count: 6 });
    assert_eq!(error.to_string(), "5 numbers to colour the mesh, one for each vertex are 6");
}

#[test]
fn two_looks_pair_in_a_palette_that_both_have() {
    let mesh = shapes::torus(0.7, 0.3, 24, 12);
    let (turn, shading) = (settings(), Shading::default());
    let alone = |look| turntable(&mesh, &turn, &shading, look, &|| ()).unwrap();
    assert!(alone(Look::Smooth).side_by_side(&alone(Look::Flat)).is_ok());
    assert!(alone(Look::Smooth).side_by_side(&alone(Look::Creased)).is_ok());
    assert!(alone(Look::Smooth).side_by_side(&alone(Look::SmoothWireframe)).is_err());
    let looks = [Look::Smooth, Look::SmoothWireframe];
    let palette = Palette::of_looks(&shading, &looks);
    let [smooth, lined] =
        looks.map(|look| turntable_in(&mesh, &turn, &shading, look, &palette, &|| ()).unwrap());
    let pair = smooth.side_by_side(&lined).unwrap();
    assert_eq!((pair.width, pair.palette.colours().len()), (192, 256));
    assert_eq!(lined, alone(Look::SmoothWireframe), "the look with lines loses nothing");
    // The other is a little coarser.
    let far = |a: &Animation, b: &Animation| {
        let (a, b) = (a.picture(2), b.picture(2));
        a.data().iter().zip(b.data()).map(|(a, b)| a.abs_diff(*b)).max().unwrap()
    };
    assert!(far(&smooth, &alone(Look::Smooth)) <= 16);
}
