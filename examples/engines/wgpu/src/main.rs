//! An endless world that is dug, drawn by wgpu without a window: a flight, frame by frame, into a folder of pictures.
//!
//! `cargo run --release --manifest-path examples/engines/Cargo.toml --target-dir target/engines --package isostudy-wgpu-world -- FOLDER [FRAMES]`
//!
//! Any driver of Vulkan, Metal or Direct3D 12 will do, one that draws by software too (Debian: `apt install mesa-vulkan-drivers`).

mod painter;

use std::error::Error;
use std::fs::{self, File};
use std::path::Path;
use std::time::Instant;

use glam::Vec3;
use isostudy_world::{Ground, Hole, World};

use crate::painter::Painter;

const SIZE: [u32; 2] = [960, 540];
/// Metres from frame to frame.
const STEP: f32 = 0.5;
/// The camera looks above the ground that is dug, so that there is a sky.
const HORIZON: Vec3 = Vec3::new(0.0, 0.0, 9.0);
/// A hole is dug in one frame of so many, and a picture kept.
const EVERY: u32 = 30;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let (folder, frames) = match &arguments[..] {
        [folder] => (folder, 240),
        [folder, frames] => (folder, frames.parse()?),
        _ => return Err("arguments: FOLDER [FRAMES]".into()),
    };
    fs::create_dir_all(folder)?;
    let mut painter = Painter::new(SIZE)?;
    println!("{}", painter.adapter());
    let mut flight = Flight::new()?;
    let begin = Instant::now();
    for frame in 0..frames {
        let picture = flight.frame(&mut painter, frame, frame % EVERY == 0)?;
        if let Some(pixels) = picture {
            write_png(&Path::new(folder).join(format!("{frame:04}.png")), &pixels)?;
        }
    }
    let ms = begin.elapsed().as_secs_f64() * 1e3 / f64::from(frames.max(1));
    println!("{frames} frames, {ms:.1} ms each; {} triangles in the last", painter.triangles());
    Ok(())
}

/// A camera over the world.
struct Flight {
    world: World,
    /// To fly over, before anything is dug.
    ground: Ground,
}

impl Flight {
    fn new() -> Result<Self, Box<dyn Error>> {
        Ok(Self { world: World::new()?, ground: Ground::default() })
    }

    /// Draws a frame, and returns its pixels if it is to be kept.
    fn frame(
        &mut self,
        painter: &mut Painter,
        frame: u32,
        keep: bool,
    ) -> Result<Option<Vec<u8>>, Box<dyn Error>> {
        let (x, y) = (-STEP * frame as f32, -0.4 * STEP * frame as f32);
        let eye = Vec3::new(x, y, self.ground.height(x, y) + 12.0);
        let ahead = Vec3::new(x - 22.0, y - 9.0, self.ground.height(x - 22.0, y - 9.0));
        // A game draws what is there. These pictures are to be the same every time, so the flight waits for each answer.
        if frame % EVERY == EVERY / 2 {
            self.world.dig(Hole { centre: ahead.to_array(), radius: 5.0 });
            painter.apply(self.world.wait());
        }
        self.world.go(eye.to_array());
        painter.apply(self.world.wait());
        painter.draw(eye, ahead + HORIZON);
        if keep { painter.pixels().map(Some) } else { Ok(None) }
    }
}

fn write_png(path: &Path, pixels: &[u8]) -> Result<(), Box<dyn Error>> {
    let mut encoder = png::Encoder::new(File::create(path)?, SIZE[0], SIZE[1]);
    encoder.set_color(png::ColorType::Rgba);
    encoder.write_header()?.write_image_data(pixels)?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The sky is blue, and nothing else is: the ground is on the lower side, and a hole changes what is seen of it.
    #[test]
    fn a_world_is_drawn_and_dug() {
        let mut painter = match Painter::new(SIZE) {
            Ok(painter) => painter,
            Err(error) => return eprintln!("SKIPPED: NO DRIVER FOR WGPU - nothing was drawn: {error}"),
        };
        let mut flight = Flight::new().unwrap();
        let first = flight.frame(&mut painter, 0, true).unwrap().unwrap();
        assert!(painter.triangles() > 5_000, "{}", painter.triangles());
        let is_sky = |pixel: &[u8]| pixel[2] > pixel[0] && pixel[2] > pixel[1];
        let sky: Vec<bool> = first.chunks_exact(4).map(is_sky).collect();
        let (upper, lower) = sky.split_at(sky.len() / 2);
        let share = |of: &[bool]| of.iter().filter(|sky| **sky).count() as f64 / of.len() as f64;
        assert!(share(upper) > 0.2 && share(lower) < 0.02, "{} {}", share(upper), share(lower));

        // From one place, before and after.
        let eye = Vec3::new(0.0, 0.0, flight.ground.height(0.0, 0.0) + 12.0);
        let ahead = Vec3::new(-22.0, -9.0, flight.ground.height(-22.0, -9.0));
        flight.world.dig(Hole { centre: ahead.to_array(), radius: 5.0 });
        painter.apply(flight.world.wait());
        painter.draw(eye, ahead + HORIZON);
        let dug = painter.pixels().unwrap();
        let changed = first.chunks_exact(4).zip(dug.chunks_exact(4)).filter(|(a, b)| a != b).count();
        assert!(changed > 2_000, "{changed} pixels");
    }
}
