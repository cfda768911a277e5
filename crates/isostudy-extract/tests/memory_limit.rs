//! Where memory runs out there is an error, and the extractor goes on.
//!
//! A binary of its own, with one test: the allocator has one limit for the whole process.

use cap::Cap;
use glam::Vec3;
use isostudy_extract::by_lattice::{ExtractSettings, Lattice};
use isostudy_extract::{
    Arrangement, BoxGrid, Clustering, Execution, ExtractError, Extractor, MethodError, Placement, Positions,
    Source, Topology, presets, watch_memory,
};
use isostudy_field::{Gyroid, Sphere, StudyField};
use isostudy_mesh::Bounds;
use std::alloc::System;
use std::sync::atomic::{AtomicUsize, Ordering};

#[global_allocator]
static ALLOCATOR: Cap<System> = Cap::new(System, usize::MAX);

const MB: usize = 1 << 20;

/// Runs with so many more bytes than are in use.
fn within<T>(bytes: usize, run: impl FnOnce() -> T) -> T {
    ALLOCATOR.set_limit(ALLOCATOR.allocated() + bytes).unwrap();
    let result = run();
    ALLOCATOR.set_limit(usize::MAX).unwrap();
    result
}

fn lattice(spacing: f32) -> Lattice {
    let bounds = Bounds { min: Vec3::NEG_ONE, max: Vec3::ONE };
    Lattice::try_new(Arrangement::BodyCentred, bounds, spacing).unwrap()
}

/// No harness: its thread allocates, and the allocator counts for the whole process.
fn main() {
    limits();
    println!("test limits ... ok");
}

fn limits() {
    memory_running_out_is_an_error();
    wherever_memory_runs_out_there_is_an_error();
    every_method_ends_with_an_error();
    a_long_row_takes_what_crosses();
    lattices_cut_by_cubes_take_what_they_say();
}

/// Of a lattice of which a sixtieth would be too much if it were stored.
fn lattices_cut_by_cubes_take_what_they_say() {
    let settings = ExtractSettings::default().with_clustering(Clustering::None);
    let bounds = Bounds { min: Vec3::NEG_ONE, max: Vec3::ONE };
    let sphere: &dyn StudyField = &Sphere { radius: 0.8 };
    for arrangement in [Arrangement::FiveTetrahedra, Arrangement::FaceCentred] {
        let fine = Lattice::try_new(arrangement, bounds, 1.0 / 128.0).unwrap();
        for threads in [1, 2] {
            let execution = Execution { threads };
            let run = || isostudy_extract::by_lattice::extract(sphere, &fine, &settings, &execution);
            let counts = run().unwrap().counts;
            let bytes = fine.memory_bytes_for(&settings, &execution);
            assert!(
                60 * bytes < threads as u64 * 3 * fine.memory_bytes(),
                "{bytes} of {}",
                fine.memory_bytes()
            );
            assert_eq!(within(MB / 4, run).unwrap_err(), ExtractError::OutOfMemory { bytes });
            // Vectors double as they grow, and those of slabs are joined.
            let mesh = 4 * (counts.vertex_bytes + counts.index_bytes);
            assert!(within(bytes as usize + mesh as usize + MB, run).is_ok(), "{arrangement:?}");
        }
    }
}

/// With many amounts from too little to enough on top of what the lattice takes, so that one request after another is
/// the one that fails. What does not grow with lattice or mesh is a few tables, for which there is room.
fn wherever_memory_runs_out_there_is_an_error() {
    const AMOUNTS: usize = 40;
    const TABLES: usize = MB / 8;
    let field: &dyn StudyField = &Gyroid::default();
    let lattice = lattice(0.1);
    let one = Execution { threads: 1 };
    let usual = ExtractSettings::default();
    let collapsed = |topology, positions| {
        usual.with_clustering(Clustering::EdgeCollapse).with_topology(topology).with_positions(positions)
    };
    let (guarded, published) = (Topology::Guarded, Topology::Published);
    let placed = |placement| usual.with_placement(placement).with_clustering(Clustering::IntegratedCollapse);
    for settings in [
        collapsed(guarded, Positions::Indexed),
        collapsed(published, Positions::Accumulated { chunks: 16 }),
        placed(Placement::CurvatureWeighted),
        placed(Placement::Projected),
        placed(Placement::Relaxed),
    ] {
        let run = || isostudy_extract::by_lattice::extract(field, &lattice, &settings, &one);
        let whole = run().unwrap().mesh;
        let floor = TABLES + lattice.memory_bytes_for(&settings, &one) as usize;
        let enough = (0..).map(|i| (MB / 8) << i).find(|room| within(floor + room, run).is_ok()).unwrap();
        let fails = |amount: &usize| match within(floor + enough * amount / AMOUNTS, run) {
            Ok(found) => {
                assert!(found.mesh == whole);
                false
            }
            Err(ExtractError::NoMemoryForMesh) => true,
            Err(error) => panic!("{settings:?}: {error}"),
        };
        let failed = (0..AMOUNTS).filter(fails).count();
        assert!(failed > AMOUNTS / 3, "{settings:?}: {failed}");
    }
}

/// Bytes beyond which extractions are to end.
static LIMIT: AtomicUsize = AtomicUsize::new(usize::MAX);
/// Room beyond them for what cannot be refused: threads that are started, tables of a request.
const MARGIN: usize = MB / 4;

/// Each named method, on one thread and on two, as the command has it: with a watch that ends what is beyond the limit, and no more than
/// a margin beyond it for whatever does not ask in time.
fn every_method_ends_with_an_error() {
    const AMOUNTS: usize = 12;
    watch_memory(|| ALLOCATOR.allocated() > LIMIT.load(Ordering::Relaxed));
    let field: &dyn StudyField = &Gyroid { frequency: 14.0 };
    let grid = BoxGrid { bounds: Bounds { min: Vec3::NEG_ONE, max: Vec3::ONE }, spacing: 0.125 };
    for (method, threads) in presets().iter().flat_map(|preset| [1, 2].map(|n| (preset.method, n))) {
        let execution = Execution { threads };
        let run = || method.extract(&mut Extractor::new(), field.into(), &grid, 0.0, &execution);
        let watched = |room: usize| {
            LIMIT.store(ALLOCATOR.allocated() + room, Ordering::Relaxed);
            let result = within(room + MARGIN, run);
            LIMIT.store(usize::MAX, Ordering::Relaxed);
            result
        };
        // Tables that are made once a process are not what is tested.
        let whole = run().unwrap().mesh;
        let enough = (0..).map(|i| (MB / 8) << i).find(|&room| watched(room).is_ok()).unwrap();
        let fails = |amount: &usize| match watched(enough * amount / AMOUNTS) {
            Ok(found) => {
                assert!(found.mesh == whole, "{method:?}");
                false
            }
            Err(MethodError::Extract(ExtractError::NoMemoryForMesh | ExtractError::OutOfMemory { .. })) => {
                true
            }
            Err(error) => panic!("{method:?}: {error}"),
        };
        let failed = (0..AMOUNTS).filter(fails).count();
        assert!(failed > 2, "{method:?} on {threads}: {failed}");
    }
}

/// A row of the longest kind of which one cell is crossed: no more than the lattice says, and that cell.
fn a_long_row_takes_what_crosses() {
    let cells = 1 << 20;
    let bounds = Bounds { min: Vec3::ZERO, max: Vec3::new(cells as f32, 1.0, 1.0) };
    let step: &dyn StudyField = &Step(77.3);
    for arrangement in [Arrangement::BodyCentred, Arrangement::SimpleCubic] {
        let lattice = Lattice::try_new(arrangement, bounds, 1.0).unwrap();
        let (settings, execution) = (ExtractSettings::default(), Execution { threads: 1 });
        let room = lattice.memory_bytes_for(&settings, &execution) as usize;
        let mesh = within(room + MB, || {
            isostudy_extract::by_lattice::extract(step, &lattice, &settings, &execution)
        })
        .unwrap()
        .mesh;
        assert!(mesh.positions.iter().all(|p| (p.x - 77.3).abs() < 0.6) && !mesh.triangles.is_empty());
    }
}

/// Inside below a place on the x axis.
struct Step(f32);

impl StudyField for Step {
    fn sample(&self, p: Vec3) -> f32 {
        self.0 - p.x
    }
}

fn memory_running_out_is_an_error() {
    let settings = ExtractSettings::default();
    let accumulated = settings.with_positions(Positions::Accumulated { chunks: 16 });
    let sphere: &dyn StudyField = &Sphere { radius: 0.8 };
    let wild: &dyn StudyField = &Gyroid { frequency: 40.0 };
    for threads in [1, 2] {
        let execution = Execution { threads };
        let mut extractor = Extractor::new();
        // Tables that are made once a process are not what is tested.
        let small = extractor.extract(sphere.into(), &lattice(0.1), &settings, &execution).unwrap();

        let fine = lattice(0.004);
        for settings in [settings, accumulated] {
            let bytes = fine.memory_bytes_for(&settings, &execution);
            assert!(bytes > 10 * MB as u64);
            let result = within(2 * MB, || extractor.extract(sphere.into(), &fine, &settings, &execution));
            assert_eq!(result.unwrap_err(), ExtractError::OutOfMemory { bytes }, "{settings:?}");
        }

        let lattice_of_many = lattice(0.02);
        let room = lattice_of_many.memory_bytes_for(&settings, &execution) as usize + 2 * MB;
        let mut run = || extractor.extract(Source::Study(wild), &lattice_of_many, &settings, &execution);
        let whole = run().unwrap();
        assert!(whole.counts.vertex_bytes + whole.counts.index_bytes > 10 * MB as u64);
        let mut fresh = Extractor::new();
        let result =
            within(room, || fresh.extract(Source::Study(wild), &lattice_of_many, &settings, &execution));
        assert_eq!(result.unwrap_err(), ExtractError::NoMemoryForMesh);
        let again = fresh.extract(sphere.into(), &lattice(0.1), &settings, &execution).unwrap();
        assert_eq!(again.mesh, small.mesh);
    }
}
