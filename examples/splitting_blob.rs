//! A blob that grows, splits and shrinks, as a GIF of slices of its surface in space-time. Frames are few, and slices are many.
//!
//! cargo run --release -p isostudy-four --example splitting_blob -- OUT.gif [FOLDER for pictures]

use std::error::Error;
use std::fs::{self, File};
use std::path::Path;

use isostudy_four::{Placement, Series};
use isostudy_mesh::normals::area_weighted_normals;
use isostudy_raster::{Animation, Look, Palette, Shading, Turntable, pixmap_to_png, turntable_in};

/// Samples along each axis.
const SAMPLES: usize = 40;
/// Volumes in the series.
const FRAMES: usize = 13;
/// Pictures between two of them.
const BETWEEN: usize = 5;
/// Half of the box.
const HALF: f32 = 1.0;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let (out, folder) = match arguments.as_slice() {
        [out] => (out, None),
        [out, folder] => (out, Some(Path::new(folder))),
        _ => return Err("give a .gif to write, and a folder for pictures if you like".into()),
    };
    let spacing = 2.0 * f64::from(HALF) / (SAMPLES - 1) as f64;
    let placement = Placement::even([SAMPLES; 3], [-f64::from(HALF); 3], spacing);
    let series = Series::try_new(placement, (0..FRAMES).map(samples).collect())?;

    // One picture of a turn each: the camera stands still.
    let camera =
        Turntable { width: 320, height: 320, frames: 1, duration_s: 0.06, ..Turntable::around(0.9 * HALF) };
    let (shading, look) = (Shading::default(), Look::Smooth);
    let palette = Palette::of_look(&shading, look);
    let mut animation: Option<Animation> = None;
    for picture in 0..=(FRAMES - 1) * BETWEEN {
        let time = picture as f64 / BETWEEN as f64;
        let mut mesh = series.slice(0.0, time)?;
        if mesh.triangles.is_empty() {
            continue;
        }
        mesh.normals = area_weighted_normals(&mesh.positions, &mesh.triangles);
        mesh.normals.iter_mut().filter(|n| !n.is_finite()).for_each(|n| *n = glam::Vec3::Z);
        let components = isostudy_mesh::topology::topology(&mesh).components;
        println!("time {time:.2}: {} triangles, components: {components}", mesh.triangles.len());
        let made = turntable_in(&mesh, &camera, &shading, look, &palette, &|| {})?;
        if let Some(folder) = folder {
            fs::create_dir_all(folder)?;
            fs::write(folder.join(format!("{picture:04}.png")), pixmap_to_png(&made.picture(0)))?;
        }
        match &mut animation {
            None => animation = Some(made),
            Some(animation) => animation.frames.extend(made.frames),
        }
    }
    animation.ok_or("there is no surface")?.write_gif(File::create(out)?)?;
    Ok(())
}

/// Two balls of smooth density, which move apart while they grow and shrink.
fn samples(frame: usize) -> Vec<f32> {
    let share = frame as f32 / (FRAMES - 1) as f32;
    let apart = 0.55 * share.powi(2);
    let level = 1.0 - 0.95 * (std::f32::consts::PI * share).sin();
    let at = |i: usize| HALF * (2.0 * i as f32 / (SAMPLES - 1) as f32 - 1.0);
    let value = |n: usize| {
        let [x, y, z] = [n % SAMPLES, n / SAMPLES % SAMPLES, n / SAMPLES / SAMPLES].map(at);
        let ball = |middle: f32| (-((x - middle).powi(2) + y * y + z * z) / 0.09).exp();
        0.5 * (ball(apart) + ball(-apart)) - 0.5 * level
    };
    (0..SAMPLES.pow(3)).map(value).collect()
}
