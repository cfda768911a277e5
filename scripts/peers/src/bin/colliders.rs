//! Times how long parry3d takes to build a triangle mesh for collisions, of meshes in files, in turns, on one thread:
//! `colliders ROUNDS SPACING FILE..`; `scripts/colliders.sh` makes the files. Beside the times, what decides how a collider behaves: the
//! smallest edge, in spacings, and the worst angles, in degrees. A table in Markdown.

use std::error::Error;
use std::fs::File;
use std::hint::black_box;
use std::path::Path;
use std::time::Instant;

use isostudy_mesh::TriangleMesh;
use isostudy_mesh::quality::TriangleQuality;
use parry3d::math::Vector;
use parry3d::shape::{TriMesh, TriMeshFlags};

/// As it is, and with what keeps wheels from catching on edges between triangles.
const WAYS: [TriMeshFlags; 2] = [TriMeshFlags::empty(), TriMeshFlags::FIX_INTERNAL_EDGES];

fn main() -> Result<(), Box<dyn Error>> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let [rounds, spacing, files @ ..] = &words[..] else {
        return Err("usage: colliders ROUNDS SPACING FILE..".into());
    };
    let (rounds, spacing): (usize, f64) = (rounds.parse()?, spacing.parse()?);
    let mut meshes = Vec::new();
    for file in files {
        let name = Path::new(file).file_stem().ok_or("a file without a name")?.to_string_lossy().into_owned();
        meshes.push((name, isostudy_mesh::read_ply(File::open(file)?)?));
    }
    let mut times = vec![[const { Vec::new() }; WAYS.len()]; meshes.len()];
    // The first round makes room and does not count.
    for round in 0..=rounds {
        for ((_, mesh), times) in meshes.iter().zip(&mut times) {
            for (flags, times) in WAYS.into_iter().zip(times) {
                let time = build(mesh, flags)?;
                if round > 0 {
                    times.push(time);
                }
            }
        }
    }
    println!("| mesh | triangles | build, ms | with internal edges fixed, ms | smallest edge, spacings | smallest angle | largest angle |");
    println!("|---|---:|---:|---:|---:|---:|---:|");
    for ((name, mesh), [plain, fixed]) in meshes.iter().zip(times) {
        let [least, most] = angles(mesh);
        println!(
            "| `{name}` | {} | {} | {} | {:.3} | {least:.2} | {most:.2} |",
            mesh.triangles.len(),
            spread(plain),
            spread(fixed),
            smallest_edge(mesh) / spacing,
        );
    }
    Ok(())
}

/// Milliseconds; copies are made before.
fn build(mesh: &TriangleMesh, flags: TriMeshFlags) -> Result<f64, Box<dyn Error>> {
    let vertices: Vec<Vector> = mesh.positions.iter().map(|p| Vector::from_array(p.to_array())).collect();
    let indices = mesh.triangles.clone();
    let begin = Instant::now();
    black_box(TriMesh::with_flags(vertices, indices, flags)?);
    Ok(1e3 * begin.elapsed().as_secs_f64())
}

/// Median and quartiles.
fn spread(mut times: Vec<f64>) -> String {
    times.sort_by(f64::total_cmp);
    let at = |share: f64| times[((times.len() - 1) as f64 * share).round() as usize];
    format!("{:.1} ({:.1} to {:.1})", at(0.5), at(0.25), at(0.75))
}

fn smallest_edge(mesh: &TriangleMesh) -> f64 {
    let edges = (0..mesh.triangles.len()).flat_map(|t| {
        let [a, b, c] = mesh.corners(t).map(|p| p.as_dvec3());
        [a.distance(b), b.distance(c), c.distance(a)]
    });
    edges.fold(f64::INFINITY, f64::min)
}

/// The smallest and the largest of all triangles; of one without area, 0 and 180.
fn angles(mesh: &TriangleMesh) -> [f64; 2] {
    let of = (0..mesh.triangles.len()).map(|t| match TriangleQuality::of(mesh.corners(t)).shape {
        Some(shape) => [shape.min_angle_deg, shape.max_angle_deg],
        None => [0.0, 180.0],
    });
    of.fold([180.0, 0.0], |worst, of| [worst[0].min(of[0]), worst[1].max(of[1])])
}
