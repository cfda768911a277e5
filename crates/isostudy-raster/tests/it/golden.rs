//! Pictures compared with those in `tests/golden`. `ISOSTUDY_BLESS=1` writes them anew; after a failure the expected
//! and actual pictures and their difference (eightfold) lie in the folder the message names.
//!
//! The pictures are the program's own. What stands behind them: where points and outlines fall is computed in `camera.rs`, what is
//! covered and what is in front in `fill.rs`, shades and colours for numbers by hand in `looks.rs`, the scale from the definition of
//! CIELAB in `colour_map.rs`. On 2026-11-23 ten of them were looked at beside what their tests ask for; `smooth`, `flat` and
//! `wireframe` stand in `sheet`. There was no hole, faces were flat where asked for, hidden lines were hidden, captions were whole, and
//! the worse colours were towards the sphere's pole and the torus's top. Whoever blesses one looks at it and changes this date.

use crate::shapes;
use isostudy_raster::tiny_skia::Pixmap;
use isostudy_raster::{
    Caption, Colouring, LightFollows, Look, Panel, Shading, Sheet, Turntable, Values, legend, panels,
    pixmap_from_png, pixmap_to_png, render, render_coloured, turntable, turntable_coloured,
};
use std::path::Path;

/// A pixel at the edge of a sample may flip with another processor's trigonometry.
const ALLOWED_PIXELS: usize = 8;
/// Levels below which a channel counts as equal.
const ALLOWED_LEVELS: u8 = 2;

fn compare(name: &str, actual: &Pixmap) {
    let golden = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden").join(format!("{name}.png"));
    if std::env::var_os("ISOSTUDY_BLESS").is_some_and(|v| v == "1") {
        std::fs::write(&golden, pixmap_to_png(actual)).unwrap();
        return;
    }
    let file =
        std::fs::read(&golden).unwrap_or_else(|e| panic!("{}: {e}; ISOSTUDY_BLESS=1", golden.display()));
    let expected = pixmap_from_png(&file).unwrap();
    let sizes = [&expected, actual].map(|p| (p.width(), p.height()));
    let mut difference = expected.clone();
    let mut off = 0;
    if sizes[0] == sizes[1] {
        for (d, a) in difference.data_mut().chunks_exact_mut(4).zip(actual.data().chunks_exact(4)) {
            let levels = [0, 1, 2].map(|c| d[c].abs_diff(a[c]));
            off += levels.iter().any(|&l| l > ALLOWED_LEVELS) as usize;
            (0..3).for_each(|c| d[c] = levels[c].saturating_mul(8));
        }
    }
    if sizes[0] != sizes[1] || off > ALLOWED_PIXELS {
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
        std::fs::create_dir_all(&folder).unwrap();
        for (what, picture) in [("expected", &expected), ("actual", actual), ("difference", &difference)] {
            std::fs::write(folder.join(format!("{what}.png")), pixmap_to_png(picture)).unwrap();
        }
        panic!("{name}: {off} pixels differ, sizes {sizes:?}; see {}", folder.display());
    }
}

fn settings() -> Turntable {
    Turntable { width: 96, height: 96, frames: 8, ..Turntable::default() }
}

fn still(look: Look) -> Pixmap {
    let mesh = shapes::torus(0.7, 0.3, 24, 12);
    render(&mesh, &settings().camera(1), settings().viewport(), &Shading::default(), look).unwrap()
}

#[test]
fn smooth() {
    compare("smooth", &still(Look::Smooth));
}

#[test]
fn flat() {
    compare("flat", &still(Look::Flat));
}

#[test]
fn wireframe() {
    compare("wireframe", &still(Look::Wireframe));
}

#[test]
fn smooth_wireframe() {
    compare("smooth_wireframe", &still(Look::SmoothWireframe));
}

#[test]
fn frame_of_a_turntable() {
    let mesh = shapes::torus(0.7, 0.3, 24, 12);
    let animation = turntable(&mesh, &settings(), &Shading::default(), Look::Smooth, &|| ()).unwrap();
    compare("frame_3", &animation.picture(3));
}

#[test]
fn sheet_with_captions() {
    let pictures = [still(Look::Smooth), still(Look::Flat), still(Look::Wireframe)];
    let labels = ["smooth", "flat: a caption of two lines", "ä µ ≤ é"];
    let list: Vec<Panel> =
        pictures.iter().zip(labels).map(|(picture, label)| Panel { picture, label }).collect();
    let sheet =
        Sheet { columns: 2, title: Some("Looks".into()), text_px: 14.0, gap_px: 6, ..Sheet::default() };
    compare("sheet", &panels(&list, &sheet).unwrap());
    let above = Sheet { caption: Caption::Above, columns: 3, title: None, ..sheet };
    compare("sheet_above", &panels(&list, &above).unwrap());
}

/// Under a light that turns with the camera, some of it from all sides.
fn camera_light() -> Shading {
    Shading { light_follows: LightFollows::Camera, ambient: 0.25, ..Shading::default() }
}

#[test]
fn half_a_turn_later_with_the_light_on_the_camera() {
    let mesh = shapes::torus(0.7, 0.3, 24, 12);
    for (name, look) in [("camera_light", Look::Smooth), ("camera_light_flat", Look::Flat)] {
        let animation = turntable(&mesh, &settings(), &camera_light(), look, &|| ()).unwrap();
        compare(name, &animation.picture(4));
    }
}

#[test]
fn radius_ratios() {
    // Bad at the poles, good at the equator.
    let mesh = shapes::sphere(1.0, 10);
    let colouring = Colouring::radius_ratio(&mesh);
    let (camera, viewport) = (settings().camera(1), settings().viewport());
    let still = render_coloured(&mesh, &colouring, &camera, viewport, &Shading::default(), Look::Flat);
    compare("quality", &still.unwrap());
    let lined = render_coloured(&mesh, &colouring, &camera, viewport, &camera_light(), Look::SmoothWireframe);
    compare("quality_lined", &lined.unwrap());
}

#[test]
fn distances_at_vertices_with_their_scale() {
    let mesh = shapes::torus(0.7, 0.3, 24, 12);
    // From 0 at the bottom to 0.1, and beyond at the top.
    let distances = mesh.positions.iter().map(|p| (p.z + 0.3) / 5.0).collect();
    let colouring = Colouring::distance(Values::PerVertex(distances), 0.1);
    let settings = Turntable { width: 256, height: 128, ..settings() };
    let animation =
        turntable_coloured(&mesh, &colouring, &settings, &camera_light(), Look::Smooth, &|| ()).unwrap();
    compare("error_frame_3", &animation.picture(3));
    compare("scale", &legend(&colouring.scale, 512));
}
