//! Field to mesh and samples to mesh, one thread; `cargo bench -p isostudy-extract`, or a part of it by name.
//!
//! `whole` calls the field where the surface can be; `all_samples` has the samples in memory; `stage_` and
//! `all_samples_stage_` are single stages of the two, as the extractor times them itself. Body-centred, integrated, `CELLS` cells along the
//! axes of the box (the bunny: the spacing that this gives a box of side 2).

#[path = "../tests/it/bunny.rs"]
mod bunny;

use std::sync::LazyLock;
use std::time::Duration;

use bunny::{BOX, bunny};
use divan::Bencher;
use divan::counter::ItemsCount;
use glam::Vec3;
use isostudy_extract::by_lattice::{ExtractSettings, Lattice};
use isostudy_extract::{
    Arrangement, Clustering, Execution, Extraction, Extractor, Placement, Source, StageTimes,
};
use isostudy_field::{Asteroid, Gyroid, MeshDistance, Sphere, StudyField};
use isostudy_mesh::Bounds;

const CELLS: [u32; 3] = [64, 128, 256];
const FIELDS: [&str; 4] = ["sphere", "asteroid", "gyroid", "bunny"];

fn main() {
    if BUNNY.is_none() {
        eprintln!("WITHOUT BUNNY: the benches named bunny measure nothing");
    }
    divan::main();
}

static BUNNY: LazyLock<Option<MeshDistance>> =
    LazyLock::new(|| bunny().map(|mesh| MeshDistance::try_new(&mesh).expect("the bunny is a solid")));

/// `None` for a bunny that is not there.
fn field(name: &str) -> Option<(Box<dyn StudyField>, Bounds)> {
    let cube = Bounds { min: Vec3::NEG_ONE, max: Vec3::ONE };
    Some(match name {
        "sphere" => (Box::new(Sphere { radius: 0.8 }), cube),
        "asteroid" => (Box::new(Asteroid::default()), cube),
        "gyroid" => (Box::new(Gyroid::default()), cube),
        "bunny" => (Box::new(BUNNY.clone()?), BOX),
        other => panic!("no field is called {other}"),
    })
}

struct Case {
    field: Box<dyn StudyField>,
    lattice: Lattice,
    extractor: Extractor,
    extraction: Extraction,
}

impl Case {
    fn new(name: &str, cells: u32) -> Option<Self> {
        let (field, bounds) = field(name)?;
        let lattice =
            Lattice::try_new(Arrangement::BodyCentred, bounds, 2.0 / cells as f32).expect("a sound lattice");
        Some(Self { field, lattice, extractor: Extractor::new(), extraction: Extraction::default() })
    }

    fn run(&mut self, samples: Option<&[f32]>, clustering: Clustering, threads: usize) {
        let source = samples.map_or(Source::Study(&*self.field), Source::Samples);
        let settings = ExtractSettings::default().with_clustering(clustering);
        let execution = Execution { threads };
        self.extractor
            .extract_into(source, &self.lattice, &settings, &execution, &mut self.extraction)
            .expect("the subjects can be extracted");
    }

    /// All samples in storage order.
    fn samples(&self) -> Vec<f32> {
        let [x, y, z] = self.lattice.cells().map(|n| n as usize);
        let (min, h) = (self.lattice.bounds().min, self.lattice.spacing());
        let [nx, ny, nz] = [x + 2, y + 2, 2 * z + 3];
        let mut values = vec![0.0; nx * ny * nz];
        for (k, layer) in values.chunks_mut(nx * ny).enumerate() {
            let half = if k % 2 == 0 { 0.5 } else { 0.0 };
            let at = |i: usize| (i as f32 - half) * h;
            let xs: Vec<f32> = (0..nx).map(|i| min.x + at(i)).collect();
            for (j, row) in layer.chunks_mut(nx).enumerate() {
                self.field.sample_row(&xs, min.y + at(j), min.z + at(k / 2), row);
            }
        }
        values
    }
}

#[divan::bench(args = FIELDS, consts = CELLS)]
fn whole<const N: u32>(bencher: Bencher, name: &str) {
    let Some(mut case) = Case::new(name, N) else { return };
    bencher.counter(ItemsCount::new(case.lattice.stored_samples())).bench_local(|| {
        case.run(None, Clustering::Integrated, 1);
    });
}

/// [`whole`] with another placement of vertices.
fn placed<const N: u32>(bencher: Bencher, name: &str, placement: Placement, refine_crossings: bool) {
    let Some(mut case) = Case::new(name, N) else { return };
    let settings =
        ExtractSettings::default().with_placement(placement).with_refine_crossings(refine_crossings);
    bencher.bench_local(|| {
        let Case { field, lattice, extractor, extraction } = &mut case;
        extractor
            .extract_into(Source::Study(&**field), lattice, &settings, &Execution { threads: 1 }, extraction)
            .expect("the subjects can be extracted");
    });
}

#[divan::bench(args = FIELDS, consts = CELLS, sample_count = 20)]
fn placed_by_curvature<const N: u32>(bencher: Bencher, name: &str) {
    placed::<N>(bencher, name, Placement::CurvatureWeighted, false);
}

#[divan::bench(args = FIELDS, consts = CELLS, sample_count = 20)]
fn placed_projected<const N: u32>(bencher: Bencher, name: &str) {
    placed::<N>(bencher, name, Placement::Projected, false);
}

#[divan::bench(args = FIELDS, consts = CELLS, sample_count = 20)]
fn placed_relaxed<const N: u32>(bencher: Bencher, name: &str) {
    placed::<N>(bencher, name, Placement::Relaxed, false);
}

#[divan::bench(args = FIELDS, consts = CELLS, sample_count = 20)]
fn placed_at_refined_crossings<const N: u32>(bencher: Bencher, name: &str) {
    placed::<N>(bencher, name, Placement::MeanOfCrossings, true);
}

/// [`whole`] with an edge collapse after it.
#[divan::bench(args = FIELDS, consts = CELLS, sample_count = 20)]
fn collapsed<const N: u32>(bencher: Bencher, name: &str) {
    let Some(mut case) = Case::new(name, N) else { return };
    bencher.bench_local(|| case.run(None, Clustering::IntegratedCollapse, 1));
}

#[divan::bench(args = FIELDS, consts = CELLS)]
fn all_samples<const N: u32>(bencher: Bencher, name: &str) {
    let Some(mut case) = Case::new(name, N) else { return };
    let samples = case.samples();
    bencher.counter(ItemsCount::new(samples.len())).bench_local(|| {
        case.run(Some(&samples), Clustering::Integrated, 1);
    });
}

#[divan::bench(args = FIELDS, consts = CELLS)]
fn all_samples_two_threads<const N: u32>(bencher: Bencher, name: &str) {
    let Some(mut case) = Case::new(name, N) else { return };
    let samples = case.samples();
    bencher.bench_local(|| case.run(Some(&samples), Clustering::Integrated, 2));
}

#[divan::bench(args = FIELDS, consts = CELLS)]
fn all_samples_unclustered<const N: u32>(bencher: Bencher, name: &str) {
    let Some(mut case) = Case::new(name, N) else { return };
    let samples = case.samples();
    bencher.bench_local(|| case.run(Some(&samples), Clustering::None, 1));
}

/// Stages are not functions of their own but run turn and turn about, layer by layer: each is timed inside, and its
/// share is spun away again for the benchmark to see. So every sample takes the whole and its stage on top.
fn stage<const N: u32>(bencher: Bencher, name: &str, given: bool, of: fn(&StageTimes) -> Duration) {
    let Some(mut case) = Case::new(name, N) else { return };
    let samples = given.then(|| case.samples());
    bencher
        .with_inputs(|| {
            case.run(samples.as_deref(), Clustering::Integrated, 1);
            of(&case.extraction.times)
        })
        .bench_local_values(|time| {
            let start = std::time::Instant::now();
            while start.elapsed() < time {
                std::hint::spin_loop();
            }
        });
}

#[divan::bench(args = FIELDS, consts = CELLS, sample_count = 20)]
fn stage_sampling<const N: u32>(bencher: Bencher, name: &str) {
    stage::<N>(bencher, name, false, |times| times.sampling);
}

#[divan::bench(args = FIELDS, consts = CELLS, sample_count = 20)]
fn stage_vertex<const N: u32>(bencher: Bencher, name: &str) {
    stage::<N>(bencher, name, false, |times| times.vertex);
}

#[divan::bench(args = FIELDS, consts = CELLS, sample_count = 20)]
fn stage_geometry<const N: u32>(bencher: Bencher, name: &str) {
    stage::<N>(bencher, name, false, |times| times.geometry);
}

#[divan::bench(args = FIELDS, consts = CELLS, sample_count = 20)]
fn stage_normals<const N: u32>(bencher: Bencher, name: &str) {
    stage::<N>(bencher, name, false, |times| times.normals);
}

#[divan::bench(args = FIELDS, consts = CELLS, sample_count = 20)]
fn all_samples_stage_signs<const N: u32>(bencher: Bencher, name: &str) {
    stage::<N>(bencher, name, true, |times| times.sampling);
}

#[divan::bench(args = FIELDS, consts = CELLS, sample_count = 20)]
fn all_samples_stage_vertex<const N: u32>(bencher: Bencher, name: &str) {
    stage::<N>(bencher, name, true, |times| times.vertex);
}

#[divan::bench(args = FIELDS, consts = CELLS, sample_count = 20)]
fn all_samples_stage_geometry<const N: u32>(bencher: Bencher, name: &str) {
    stage::<N>(bencher, name, true, |times| times.geometry);
}

#[divan::bench(args = FIELDS, consts = CELLS, sample_count = 20)]
fn all_samples_stage_normals<const N: u32>(bencher: Bencher, name: &str) {
    stage::<N>(bencher, name, true, |times| times.normals);
}
