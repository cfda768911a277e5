//! Our decimation beside meshopt's, which binds a C++ library, on the same mesh to the same number of triangles: time, error, faults.
//!
//! Arguments: PLY files. `scripts/decimators.sh` makes some.

use isostudy_finish::{Extent, Step};
use isostudy_mesh::metro::{Amount, Sampling, metro};
use isostudy_mesh::topology::topology;
use isostudy_mesh::{TriangleMesh, read_ply};
use meshopt::{SimplifyOptions, VertexDataAdapter, simplify, typed_to_bytes};
use std::time::Instant;

const RATIOS: [f64; 3] = [0.5, 0.25, 0.1];
const RUNS: usize = 5;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    println!("| mesh | triangles | by | left | ms | mean distance | largest | faults |\n|---|---:|---|---:|---:|---:|---:|---:|");
    for path in std::env::args().skip(1) {
        let mut mesh = read_ply(&*std::fs::read(&path)?)?;
        mesh.normals = Vec::new();
        let name = path.rsplit('/').next().unwrap_or(&path).trim_end_matches(".ply");
        for ratio in RATIOS {
            row(name, &mesh, "isostudy", || ours(&mesh, ratio));
            row(name, &mesh, "meshopt", || theirs(&mesh, ratio));
        }
    }
    Ok(())
}

fn ours(mesh: &TriangleMesh, ratio: f64) -> TriangleMesh {
    let step = Step::Decimate { triangles: None, ratio: Some(ratio), error: None, lock_borders: false };
    step.apply(mesh, Extent::Whole).expect("a share of the triangles").mesh
}

fn theirs(mesh: &TriangleMesh, ratio: f64) -> TriangleMesh {
    let positions: Vec<[f32; 3]> = mesh.positions.iter().map(|p| p.to_array()).collect();
    let indices: Vec<u32> = mesh.triangles.as_flattened().to_vec();
    let adapter = VertexDataAdapter::new(typed_to_bytes(&positions), 12, 0).expect("three floats for each");
    let goal = 3 * (ratio * mesh.triangles.len() as f64) as usize;
    // No bound on the error: the number of triangles is the goal of both.
    let left = simplify(&indices, &adapter, goal, f32::MAX, SimplifyOptions::None, None);
    TriangleMesh { positions: mesh.positions.clone(), normals: Vec::new(), triangles: left.as_chunks::<3>().0.to_vec() }
}

fn row(name: &str, mesh: &TriangleMesh, by: &str, make: impl Fn() -> TriangleMesh) {
    let timed = |_| {
        let began = Instant::now();
        let made = make();
        (made, began.elapsed().as_secs_f64() * 1e3)
    };
    let mut runs: Vec<(TriangleMesh, f64)> = (0..RUNS).map(timed).collect();
    runs.sort_by(|a, b| a.1.total_cmp(&b.1));
    let (made, ms) = &runs[RUNS / 2];
    let sampling = Sampling { amount: Amount::Samples(200_000), ..Sampling::default() };
    let distance = metro(mesh, made, &sampling).expect("two surfaces");
    let counts = topology(made);
    println!(
        "| {name} | {} | {by} | {} | {ms:.1} | {:.2e} | {:.2e} | {} |",
        mesh.triangles.len(),
        made.triangles.len(),
        distance.forward.mean.max(distance.backward.mean),
        distance.forward.max.max(distance.backward.max),
        counts.non_manifold_edges + counts.non_manifold_vertices,
    );
}
