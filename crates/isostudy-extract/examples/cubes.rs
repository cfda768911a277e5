//! How fast marching cubes goes through given samples, and what its triangles are like:
//! `cargo run --release -p isostudy-extract --example cubes -- 192 [threads]`.

use std::time::Duration;

use glam::Vec3;
use isostudy_extract::{
    Arrangement, BoxGrid, Cubes, Diagonals, Execution, Extractor, Faces, Method, SnapCubes, Source,
    Tetrahedra,
};
use isostudy_field::{Gyroid, StudyField};
use isostudy_mesh::Bounds;

const ROUNDS: usize = 5;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1).map(|text| text.parse::<usize>());
    let n = arguments.next().transpose()?.unwrap_or(192).max(2);
    let threads = arguments.next().transpose()?.unwrap_or(1);
    let side = (n - 1) as f32;
    let grid = BoxGrid { bounds: Bounds { min: Vec3::ZERO, max: Vec3::splat(side) }, spacing: 1.0 };
    // Three periods along a side.
    let gyroid = Gyroid { frequency: 3.0 * std::f32::consts::TAU };
    let at = |i: usize| Vec3::from_array([i % n, i / n % n, i / n / n].map(|x| x as f32 / side));
    let samples: Vec<f32> = (0..n * n * n).map(|i| gyroid.sample(at(i))).collect();
    let cubes =
        |faces, diagonals| Method::Cubes(Cubes::default().with_faces(faces).with_diagonals(diagonals));
    println!("{n}^3 samples of a gyroid, {threads} threads, best of {ROUNDS}");
    println!(
        "{:<28} {:>10} {:>8} {:>9} {:>9} {:>7} {:>8}",
        "", "triangles", "ms", "Mcell/s", "Mtri/s", "mean q", "q < 0.1"
    );
    for (name, method) in [
        ("separate inside, fan", cubes(Faces::SeparateInside, Diagonals::Fan)),
        ("separate inside, edge groups", cubes(Faces::SeparateInside, Diagonals::EdgeGroups)),
        ("separate inside, quality", cubes(Faces::SeparateInside, Diagonals::Quality)),
        ("decider, fan", cubes(Faces::Decider, Diagonals::Fan)),
        ("trilinear, fan", cubes(Faces::Trilinear, Diagonals::Fan)),
        ("snapped", Method::SnapCubes(SnapCubes::default())),
        (
            "simple cubic tetrahedra",
            Method::Tetrahedra(
                Tetrahedra::new(Arrangement::SimpleCubic).with_clustering(isostudy_extract::Clustering::None),
            ),
        ),
    ] {
        let (mut extractor, mut best, mut mesh) = (Extractor::new(), Duration::MAX, None);
        for _ in 0..ROUNDS {
            let source = Source::Samples(&samples);
            let found = method.extract(&mut extractor, source, &grid, 0.0, &Execution { threads })?;
            best = best.min(found.times.total() - found.times.normals);
            mesh = Some(found.mesh);
        }
        let mesh = mesh.expect("there was a round");
        let quality =
            |t: usize| isostudy_cells::radius_ratio(mesh.corners(t).map(|p| p.to_array().map(f64::from)));
        let all: Vec<f64> = (0..mesh.triangles.len()).map(quality).collect();
        let (seconds, count) = (best.as_secs_f64(), all.len() as f64);
        println!(
            "{name:<28} {count:>10} {:>8.1} {:>9.1} {:>9.1} {:>7.3} {:>8}",
            seconds * 1e3,
            ((n - 1) as f64).powi(3) / seconds / 1e6,
            count / seconds / 1e6,
            all.iter().sum::<f64>() / count,
            all.iter().filter(|q| **q < 0.1).count(),
        );
    }
    Ok(())
}
