//! Extracts a volume as often as it is told, and says how long it took: the half of `scripts/bench-wheel.py` that is Rust.
//!
//! `volume_times N FILE` reads N^3 samples, little-endian floats. For each line `METHOD THREADS` of its input it extracts once, into new
//! memory, by what the wheel calls, and prints wall-clock milliseconds, vertices and triangles.

use std::error::Error;
use std::io::BufRead;
use std::time::Instant;

use isostudy_extract::{Execution, Extractor, VolumeCells, presets};

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [n, path] = &arguments[..] else { return Err("arguments: N FILE".into()) };
    let n: usize = n.parse()?;
    let bytes = std::fs::read(path)?;
    let values: Vec<f32> = bytes.as_chunks().0.iter().map(|of| f32::from_le_bytes(*of)).collect();
    // As the wheel has them: an array's last axis is the fastest.
    let steps = [[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]];
    for line in std::io::stdin().lock().lines() {
        let line = line?;
        let (id, threads) = line.split_once(' ').ok_or("a line says METHOD THREADS")?;
        let method = presets().iter().find(|preset| preset.id == id).ok_or("no such preset")?.method;
        let execution = Execution { threads: threads.parse()? };
        let start = Instant::now();
        let cells = VolumeCells { counts: [n; 3], values: &values, origin: [0.0; 3], steps };
        let mesh = cells.extract_interpolated(&method, &mut Extractor::new(), 0.0, &execution)?.mesh;
        let elapsed = start.elapsed().as_secs_f64() * 1e3;
        println!("{elapsed} {} {}", mesh.positions.len(), mesh.triangles.len());
    }
    Ok(())
}
