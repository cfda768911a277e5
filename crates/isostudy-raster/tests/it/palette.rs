//! How far an animation's colours are from the still's.

use crate::shapes;
use isostudy_mesh::TriangleMesh;
use isostudy_raster::{Look, Palette, Shading, Turntable, render, turntable};

/// Differences in 8-bit levels over all channels of all pixels that are not plain background.
struct Error {
    mean: f64,
    max: u8,
    psnr_db: f64,
    /// Share of channels that are off by more than 2 levels.
    beyond_2: f64,
}

fn error(mesh: &TriangleMesh, look: Look, supersampling: u32) -> Error {
    let shading = Shading::default();
    let settings = Turntable { width: 256, height: 256, frames: 12, supersampling, ..Turntable::default() };
    let animation = turntable(mesh, &settings, &shading, look, &|| ()).unwrap();
    let (mut channels, mut sum, mut squares, mut max, mut beyond) = (0u64, 0u64, 0u64, 0, 0u64);
    for frame in 0..settings.frames {
        let still = render(mesh, &settings.camera(frame), settings.viewport(), &shading, look).unwrap();
        let indexed = animation.picture(frame as usize);
        for (a, b) in still.pixels().iter().zip(indexed.pixels()) {
            let a = [a.red(), a.green(), a.blue()];
            if a == [1, 130, 129] {
                assert_eq!((b.red(), b.green(), b.blue()), (1, 130, 129), "the background is exact");
                continue;
            }
            for (a, b) in a.into_iter().zip([b.red(), b.green(), b.blue()]) {
                let difference = a.abs_diff(b);
                channels += 1;
                sum += difference as u64;
                squares += (difference as u64).pow(2);
                max = max.max(difference);
                beyond += (difference > 2) as u64;
            }
        }
    }
    let mean_square = squares as f64 / channels as f64;
    Error {
        mean: sum as f64 / channels as f64,
        max,
        psnr_db: 10.0 * (255.0f64.powi(2) / mean_square).log10(),
        beyond_2: beyond as f64 / channels as f64,
    }
}

#[test]
fn turntables_are_close_to_stills() {
    let meshes = [("sphere", shapes::sphere(1.0, 40)), ("torus", shapes::torus(0.7, 0.3, 60, 30))];
    for (look, supersampling, mean, max, psnr_db) in [
        (Look::Smooth, 2, 0.45, 28, 50.5),
        (Look::Flat, 2, 0.45, 28, 50.0),
        (Look::Smooth, 1, 0.40, 2, 52.0),
        (Look::Smooth, 3, 0.60, 32, 44.5),
        (Look::Wireframe, 2, 0.95, 28, 45.5),
        (Look::SmoothWireframe, 2, 0.70, 12, 47.5),
    ] {
        for (name, mesh) in &meshes {
            let e = error(mesh, look, supersampling);
            println!(
                "{look:?} {name} at {supersampling} x {supersampling}: mean {:.3}, max {}, beyond 2: {:.2} %, {:.1} dB",
                e.mean,
                e.max,
                e.beyond_2 * 100.0,
                e.psnr_db
            );
            assert!(e.mean <= mean && e.max <= max && e.psnr_db >= psnr_db);
        }
    }
}

#[test]
fn the_ramp_is_covered_from_end_to_end() {
    let shading = Shading::default();
    for (look, allowed) in [(Look::Smooth, 2), (Look::SmoothWireframe, 3)] {
        let palette = Palette::of_look(&shading, look);
        assert_eq!(palette.colours().len(), 256);
        assert_eq!(palette.colours()[0], [1, 130, 129]);
        let mut worst = 0;
        for i in 0..=2000 {
            let d = shading.max_exposure() * (i as f32 / 1000.0 - 1.0);
            let colour = shading.colour(d).map(|v| (v * 255.0).round() as u8);
            let off = |entry: &[u8; 3]| (0..3).map(|c| entry[c].abs_diff(colour[c])).max().unwrap();
            worst = worst.max(palette.colours().iter().map(off).min().unwrap());
        }
        println!("{look:?}: worst ramp colour off by {worst}");
        assert!(worst <= allowed, "{look:?}: {worst}");
    }
}
