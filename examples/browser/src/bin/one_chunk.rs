//! Extracts a ball in chunks and checks it. Ends with 0 if all is well, so that it can be run where nothing can be
//! printed: `scripts/test-wasm.sh` builds it for `wasm32-unknown-unknown` and has Node call its `main`.
//!
//! `cargo run --release -p isostudy-browser --bin one_chunk`

use std::process::ExitCode;

use glam::Vec3;
use isostudy_extract::{
    Arrangement, BoxGrid, ChunkExtractor, ChunkSettings, Clustering, Control, Method, Tetrahedra, weld_chunks,
};
use isostudy_field::Sphere;
use isostudy_mesh::Bounds;

fn main() -> ExitCode {
    for (arrangement, clustering) in [
        (Arrangement::BodyCentred, Clustering::Integrated),
        (Arrangement::SimpleCubic, Clustering::EdgeCollapse),
        (Arrangement::FaceCentred, Clustering::None),
    ] {
        match volume(arrangement, clustering) {
            // Inside the unit ball, by a little.
            Ok(volume) if (4.15..4.19).contains(&volume) => {}
            Ok(_) => return ExitCode::from(1),
            Err(_) => return ExitCode::from(2),
        }
    }
    ExitCode::SUCCESS
}

fn volume(arrangement: Arrangement, clustering: Clustering) -> Result<f64, Box<dyn std::error::Error>> {
    let bounds = Bounds { min: Vec3::splat(-1.25), max: Vec3::splat(1.25) };
    let grid = BoxGrid { bounds, spacing: 0.078125 };
    let method = Method::Tetrahedra(Tetrahedra::new(arrangement).with_clustering(clustering));
    let mut extractor = ChunkExtractor::in_box(&grid, &method, &ChunkSettings::default())?;
    let mut chunks = Vec::new();
    for cells in extractor.grid(16) {
        chunks.push(extractor.extract(&Sphere { radius: 1.0 }, cells, Control::default())?);
    }
    Ok(weld_chunks(&chunks)?.volume())
}
