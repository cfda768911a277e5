//! What each placement of vertices does to triangles and accuracy: the numbers of docs/why.md, as a Markdown table.
//! Arguments: cells along an axis (64; the bunny: the spacing that gives in a box of side 2), part of a row's name.
//!
//! Times are of the processor, best of a few. `cargo run --release -p isostudy-extract --example placement`

#[path = "../tests/it/bunny.rs"]
mod bunny;

use bunny::{BOX, bunny};
use glam::Vec3;
use isostudy_extract::by_lattice::{ExtractSettings, Lattice};
use isostudy_extract::{
    Arrangement, BoxGrid, Clustering, Execution, Extraction, Extractor, Placement, Source, accuracy,
};
use isostudy_field::{Asteroid, Gyroid, MeshDistance, Sphere, StudyField};
use isostudy_mesh::Bounds;
use isostudy_mesh::quality::quality;

const ONE: Execution = Execution { threads: 1 };
const REPETITIONS: usize = 5;

fn main() {
    let mut arguments = std::env::args().skip(1);
    let cells: u32 = arguments.next().map_or(64, |a| a.parse().expect("a number of cells"));
    let wanted = arguments.next().unwrap_or_default();
    let cube = Bounds { min: Vec3::NEG_ONE, max: Vec3::ONE };
    let mut fields: Vec<(&str, Box<dyn StudyField>, Bounds)> = vec![
        ("sphere", Box::new(Sphere { radius: 0.8 }), cube),
        ("asteroid", Box::new(Asteroid::default()), cube),
        ("gyroid", Box::new(Gyroid::default()), cube),
    ];
    if let Some(bunny) = bunny() {
        let field = MeshDistance::try_new(&bunny).expect("the bunny is a solid");
        fields.push(("bunny", Box::new(field), BOX));
    }
    println!(
        "| surface, lattice, {cells} cells | placement | radius ratio, mean | smallest angle, 5 % | distance / h, mean | \
         max | normal error, mean | 95 % | time, ms |\n|---|---|---:|---:|---:|---:|---:|---:|---:|"
    );
    for (name, field, bounds) in &fields {
        for arrangement in [Arrangement::BodyCentred, Arrangement::SimpleCubic] {
            let lattice = Lattice::try_new(arrangement, *bounds, 2.0 / cells as f32).expect("a lattice");
            for placement in [
                Placement::MeanOfCrossings,
                Placement::CurvatureWeighted,
                Placement::Projected,
                Placement::Relaxed,
            ] {
                for refine_crossings in [false, true] {
                    let id = format!("{name}, {arrangement:?}");
                    if id.contains(&wanted) {
                        let settings = ExtractSettings::default()
                            .with_placement(placement)
                            .with_refine_crossings(refine_crossings);
                        row(&id, &**field, &lattice, &settings);
                    }
                }
            }
        }
    }
}

fn row(id: &str, field: &dyn StudyField, lattice: &Lattice, settings: &ExtractSettings) {
    assert_eq!(settings.clustering, Clustering::Integrated);
    let (mut extractor, mut extraction) = (Extractor::new(), Extraction::default());
    let mut best = f64::INFINITY;
    for _ in 0..REPETITIONS {
        let start = cpu_ms();
        extractor
            .extract_into(Source::Study(field), lattice, settings, &ONE, &mut extraction)
            .expect("the surfaces can be extracted");
        best = best.min(cpu_ms() - start);
    }
    let h = f64::from(lattice.spacing());
    let shape = quality(&extraction.mesh);
    let found = accuracy(&extraction.mesh, field, 0.0, &BoxGrid::from(lattice), &ONE).expect("one thread");
    println!(
        "| {id} | {:?}{} | {:.4} | {:.1} | {:.5} | {:.3} | {:.2} | {:.2} | {:.1} |",
        settings.placement,
        if settings.refine_crossings { ", refined" } else { "" },
        shape.radius_ratio.mean,
        shape.min_angle_deg.q05,
        found.distance.mean / h,
        found.distance.max / h,
        found.normal_error_deg.mean,
        found.normal_error_deg.q95,
        best,
    );
}

/// Time this thread has run, which other work on the machine does not add to.
fn cpu_ms() -> f64 {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").expect("Linux");
    text.split(' ').next().and_then(|ns| ns.parse::<f64>().ok()).expect("a number") / 1e6
}
