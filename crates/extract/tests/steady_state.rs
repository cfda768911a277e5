//! An extractor that has seen a volume of a size allocates nothing for the next one.

use extract::{
    Arrangement, Clustering, Execution, ExtractSettings, Extraction, Extractor, Gyroid, Lattice, ScalarField,
    Source, Sphere, Topology,
};
use glam::Vec3;
use mesh::Bounds;
use stats_alloc::{INSTRUMENTED_SYSTEM, Region, StatsAlloc};
use std::alloc::System;

#[global_allocator]
static ALLOCATOR: &StatsAlloc<System> = &INSTRUMENTED_SYSTEM;

/// One test only: the allocator counts for the whole process.
#[test]
fn the_second_volume_of_a_size_allocates_nothing() {
    let bounds = Bounds { min: Vec3::splat(-1.1), max: Vec3::splat(1.1) };
    let execution = Execution { threads: 1 };
    for arrangement in [Arrangement::BodyCentred, Arrangement::SimpleCubic] {
        let lattice = Lattice::try_new(arrangement, bounds, 0.05).unwrap();
        for clustering in [Clustering::Integrated, Clustering::None] {
            for topology in [Topology::Guarded, Topology::Published] {
                let settings = ExtractSettings { clustering, topology, ..ExtractSettings::default() };
                let (mut extractor, mut extraction) = (Extractor::new(), Extraction::default());
                let mut run = |radius: f32| {
                    let sphere: &dyn ScalarField = &Sphere { radius };
                    extractor
                        .extract_into(Source::Field(sphere), &lattice, &settings, &execution, &mut extraction)
                        .unwrap();
                    assert!(extraction.counts.triangles > 1000);
                    // About three points a period: the guard has to look closely.
                    let gyroid: &dyn ScalarField = &Gyroid { frequency: 40.0 };
                    extractor
                        .extract_into(Source::Field(gyroid), &lattice, &settings, &execution, &mut extraction)
                        .unwrap();
                };
                run(1.0);
                let region = Region::new(ALLOCATOR);
                for radius in [1.0, 0.9, 0.95] {
                    run(radius);
                }
                let change = region.change();
                let seen = (change.allocations, change.reallocations, change.deallocations);
                assert_eq!(seen, (0, 0, 0), "{arrangement:?} {clustering:?} {topology:?}");
            }
        }
    }
}
