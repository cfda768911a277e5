//! Allocations that are planted are counted, in the stage that they are in.
//!
//! A binary of its own, with one test: the allocator counts for the whole process.

use glam::Vec3;
use isostudy_bench::{AllocationCounts, Asked, Prepared, count_allocations};
use isostudy_design::Stage;
use isostudy_extract::{
    Arrangement, BoxGrid, Clustering, Cubes, Method, Placement, Positions, SnapCubes, SurfaceNets, Tetrahedra,
};
use isostudy_field::StudyField;
use isostudy_mesh::Bounds;
use stats_alloc::{INSTRUMENTED_SYSTEM, StatsAlloc};
use std::alloc::System;
use std::hint::black_box;
use std::sync::atomic::{AtomicU64, Ordering};

#[global_allocator]
static ALLOCATOR: &StatsAlloc<System> = &INSTRUMENTED_SYSTEM;

fn asked() -> Asked {
    let stats = ALLOCATOR.stats();
    let calls = (stats.allocations + stats.reallocations) as u64;
    Asked { calls, bytes: stats.bytes_allocated as u64 }
}

/// A ball that asks for some bytes, or none, whenever it is sampled.
struct Ball {
    bytes: usize,
    samples: AtomicU64,
}

impl StudyField for Ball {
    fn sample(&self, p: Vec3) -> f32 {
        self.samples.fetch_add(1, Ordering::Relaxed);
        if self.bytes > 0 {
            drop(black_box(Vec::<u8>::with_capacity(self.bytes)));
        }
        1.0 - p.length()
    }
}

const BYTES: usize = 1000;

fn grid() -> BoxGrid {
    BoxGrid { bounds: Bounds { min: Vec3::splat(-1.1), max: Vec3::splat(1.1) }, spacing: 0.1 }
}

/// What is counted, and how often the field was sampled in each of the three extractions.
fn counted(method: Method, bytes: usize) -> (AllocationCounts, u64) {
    let ball = Ball { bytes, samples: AtomicU64::new(0) };
    let prepared = Prepared { field: &ball, method, grid: grid(), isovalue: 0.0 };
    let counts = prepared.allocations(None).unwrap().expect("somebody counts");
    (counts, ball.samples.into_inner() / 3)
}

/// No harness: its thread allocates, and the allocator counts for the whole process.
fn main() {
    what_is_planted_is_counted_where_it_is();
    println!("test what_is_planted_is_counted_where_it_is ... ok");
}

fn what_is_planted_is_counted_where_it_is() {
    let ball = Ball { bytes: 0, samples: AtomicU64::new(0) };
    let plain = Method::Tetrahedra(Tetrahedra::new(Arrangement::BodyCentred));
    let prepared = Prepared { field: &ball, method: plain, grid: grid(), isovalue: 0.0 };
    assert_eq!(prepared.allocations(None), Ok(None), "nobody counts yet");
    count_allocations(asked);
    a_field_that_allocates_does_so_in_the_sampling_stage();
    the_dense_extractor_takes_what_its_lattice_says();
    stages_add_up_and_those_that_are_not_there_ask_for_nothing();
}

fn a_field_that_allocates_does_so_in_the_sampling_stage() {
    let body_centred = Tetrahedra::new(Arrangement::BodyCentred);
    let dense = body_centred.with_positions(Positions::Accumulated { chunks: 1 });
    for method in [
        Method::Tetrahedra(body_centred),
        Method::Tetrahedra(Tetrahedra::new(Arrangement::SimpleCubic)),
        Method::Tetrahedra(dense),
        Method::Cubes(Cubes::default()),
        Method::SnapCubes(SnapCubes::default()),
        Method::SurfaceNets(SurfaceNets::default()),
    ] {
        let (without, samples) = counted(method, 0);
        let (with, again) = counted(method, BYTES);
        assert!(samples > 1000 && samples == again, "{method:?}: {samples} {again}");
        for stage in Stage::ALL {
            let planted = if matches!(stage, Stage::Sampling | Stage::Total) { samples } else { 0 };
            let [calls, more_calls] = [without, with].map(|counts| stage.count(&counts.calls));
            let [bytes, more_bytes] = [without, with].map(|counts| stage.count(&counts.bytes));
            assert_eq!(more_calls, calls + planted, "{method:?} {stage:?}");
            assert_eq!(more_bytes, bytes + BYTES as u64 * planted, "{method:?} {stage:?}");
        }
    }
}

/// It asks for all once and gives it back, so that too much is an error; then for the parts.
fn the_dense_extractor_takes_what_its_lattice_says() {
    let positions = Positions::Accumulated { chunks: 1 };
    let (counts, _) =
        counted(Method::Tetrahedra(Tetrahedra::new(Arrangement::BodyCentred).with_positions(positions)), 0);
    let told = 2.0 * grid().lattice(Arrangement::BodyCentred).unwrap().memory_bytes() as f64;
    let found = counts.bytes.allocation as f64;
    assert!(found > 0.99 * told && found < 1.01 * told, "{found} bytes, {told} told");
    assert!((2..20).contains(&counts.calls.allocation), "{counts:?}");
}

fn stages_add_up_and_those_that_are_not_there_ask_for_nothing() {
    for (clustering, placement) in [
        (Clustering::None, Placement::MeanOfCrossings),
        (Clustering::EdgeCollapse, Placement::MeanOfCrossings),
        (Clustering::Integrated, Placement::Relaxed),
    ] {
        let method =
            Tetrahedra::new(Arrangement::BodyCentred).with_clustering(clustering).with_placement(placement);
        let (counts, _) = counted(Method::Tetrahedra(method), 0);
        let collapses = clustering == Clustering::EdgeCollapse;
        let is_there = |stage: Stage| stage != Stage::Clustering || collapses;
        for stage in &Stage::ALL[..6] {
            let (calls, bytes) = (stage.count(&counts.calls), stage.count(&counts.bytes));
            assert_eq!(calls > 0, bytes > 0, "{clustering:?} {stage:?}");
            assert!(is_there(*stage) || calls == 0, "{clustering:?} {stage:?}: {calls}");
        }
        assert!(!collapses || counts.calls.clustering > 0);
        // The mesh that comes out is in there: normals are asked for once.
        assert!(counts.calls.normals == 1 && counts.calls.allocation > 0, "{counts:?}");
        for counts in [counts.calls, counts.bytes] {
            let sum: u64 = Stage::ALL[..6].iter().map(|stage| stage.count(&counts)).sum();
            assert!(sum <= counts.total && 10 * sum > 9 * counts.total, "{counts:?}: {sum}");
        }
    }
}
