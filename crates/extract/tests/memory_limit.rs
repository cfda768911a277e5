//! Where memory runs out there is an error, and the extractor goes on.

use cap::Cap;
use extract::{
    Arrangement, Execution, ExtractError, ExtractSettings, Extractor, Gyroid, Lattice, Positions,
    ScalarField, Source, Sphere,
};
use glam::Vec3;
use mesh::Bounds;
use std::alloc::System;

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

/// One test only: the limit is the whole process's.
#[test]
fn memory_running_out_is_an_error() {
    let settings = ExtractSettings::default();
    let accumulated = ExtractSettings { positions: Positions::Accumulated { chunks: 16 }, ..settings };
    let sphere: &dyn ScalarField = &Sphere { radius: 0.8 };
    let wild: &dyn ScalarField = &Gyroid { frequency: 40.0 };
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
        let mut run = || extractor.extract(Source::Field(wild), &lattice_of_many, &settings, &execution);
        let whole = run().unwrap();
        assert!(whole.counts.vertex_bytes + whole.counts.index_bytes > 10 * MB as u64);
        let mut fresh = Extractor::new();
        let result =
            within(room, || fresh.extract(Source::Field(wild), &lattice_of_many, &settings, &execution));
        assert_eq!(result.unwrap_err(), ExtractError::NoMemoryForMesh);
        let again = fresh.extract(sphere.into(), &lattice(0.1), &settings, &execution).unwrap();
        assert_eq!(again.mesh, small.mesh);
    }
}
