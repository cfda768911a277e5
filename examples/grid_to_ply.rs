//! The surface of a grid in a file becomes a PLY, and the times are printed that it takes to read and to extract.
//!
//! cargo run --release -p isostudy-grid --example grid_to_ply -- FILE ARRAY ISOVALUE OUT.ply

use std::error::Error;
use std::fs::File;
use std::path::Path;
use std::time::Instant;

use isostudy_mesh::MeshFormat;

/// Times that the extraction is repeated; the least time is printed.
const ROUNDS: u32 = 7;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [file, array, isovalue, out] = arguments.as_slice() else {
        return Err("give a file, an array, an isovalue and a .ply to write".into());
    };
    let isovalue: f64 = isovalue.parse()?;
    let began = Instant::now();
    let grid = isostudy_grid::read(Path::new(file), Some(array), 8 << 30)?;
    let read_ms = 1e3 * began.elapsed().as_secs_f64();
    let mut surface = grid.extract(isovalue);
    let mut least_ms = f64::INFINITY;
    for _ in 0..ROUNDS {
        let began = Instant::now();
        surface = grid.extract(isovalue);
        least_ms = least_ms.min(1e3 * began.elapsed().as_secs_f64());
    }
    println!(
        "{} tetrahedra read in {read_ms:.0} ms; {} crossed, {} vertices, {} triangles in {least_ms:.1} ms",
        grid.tetrahedra().len(),
        surface.crossed_tetrahedra,
        surface.mesh.positions.len(),
        surface.mesh.triangles.len()
    );
    MeshFormat::Ply.write(&surface.mesh, &mut File::create(out)?)?;
    Ok(())
}
