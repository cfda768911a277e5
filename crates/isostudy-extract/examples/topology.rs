//! What the guard costs and what it saves, on the evaluation's sphere and asteroid: the numbers of docs/why.md.
//!
//! `cargo run --release -p isostudy-extract --example topology`

use glam::Vec3;
use isostudy_extract::by_lattice::{ExtractSettings, Lattice, extract};
use isostudy_extract::{Arrangement, Clustering, Execution, Topology};
use isostudy_field::{Asteroid, Sphere, StudyField};
use isostudy_mesh::quality::{TriangleQuality, quality};
use isostudy_mesh::topology::topology;
use isostudy_mesh::{Bounds, TriangleMesh};

fn main() {
    println!(
        "object    lattice  clustering          topology   V      T      mean q q<0.1 min q  inverted four-face chi   ms"
    );
    let objects: [(&str, &dyn StudyField); 2] =
        [("sphere", &Sphere { radius: 1.0 }), ("asteroid", &Asteroid::default())];
    for (name, field) in objects {
        for arrangement in Arrangement::ALL {
            for clustering in [
                Clustering::None,
                Clustering::Integrated,
                Clustering::EdgeCollapse,
                Clustering::IntegratedCollapse,
            ]
            .into_iter()
            .filter(|&clustering| arrangement.supports(clustering))
            {
                for guard in [Topology::Published, Topology::Guarded] {
                    row(name, field, arrangement, clustering, guard);
                }
            }
        }
    }
}

fn row(
    name: &str,
    field: &dyn StudyField,
    arrangement: Arrangement,
    clustering: Clustering,
    guard: Topology,
) {
    let bounds = Bounds { min: Vec3::NEG_ONE, max: Vec3::ONE };
    let lattice = Lattice::try_new(arrangement, bounds, 0.04).expect("a lattice");
    let settings = ExtractSettings::default().with_clustering(clustering).with_topology(guard);
    let extraction = extract(field, &lattice, &settings, &Execution { threads: 1 }).expect("a surface");
    let mesh = extraction.mesh;
    let report = topology(&mesh);
    let ratios: Vec<f64> = (0..mesh.triangles.len())
        .map(|t| {
            let quality = TriangleQuality::of(mesh.corners(t));
            quality.shape.map_or(0.0, |shape| shape.radius_ratio)
        })
        .collect();
    let slivers = ratios.iter().filter(|&&q| q < 0.1).count();
    println!(
        "{name:9} {:8} {:19} {:10} {:6} {:6} {:.4} {slivers:5} {:.4} {:8} {:9} {:4} {:5.1}",
        match arrangement {
            Arrangement::BodyCentred => "body",
            Arrangement::SimpleCubic => "simple",
            Arrangement::FiveTetrahedra => "five",
            Arrangement::FaceCentred => "face",
        },
        format!("{clustering:?}"),
        format!("{guard:?}"),
        mesh.positions.len(),
        mesh.triangles.len(),
        quality(&mesh).radius_ratio.mean,
        ratios.iter().copied().fold(1.0, f64::min),
        inverted(&mesh, field),
        report.non_manifold_edges,
        report.euler_characteristic,
        1e3 * (extraction.times.vertex + extraction.times.geometry).as_secs_f64(),
    );
}

/// Triangles that face along the field's gradient, to the inside.
fn inverted(mesh: &TriangleMesh, field: &dyn StudyField) -> usize {
    (0..mesh.triangles.len())
        .filter(|&t| {
            let [a, b, c] = mesh.corners(t);
            let centre = (a + b + c) / 3.0;
            let along = |axis: Vec3| field.sample(centre + axis * 1e-3) - field.sample(centre - axis * 1e-3);
            let gradient = Vec3::new(along(Vec3::X), along(Vec3::Y), along(Vec3::Z));
            (b - a).cross(c - a).dot(gradient) > 0.0
        })
        .count()
}
