//! An extractor that has seen a volume of a size allocates nothing for the next one, whatever the field or the samples.
//!
//! A binary of its own, with one test: the allocator counts for the whole process.

use glam::Vec3;
use isostudy_extract::by_lattice::{ExtractSettings, Lattice};
use isostudy_extract::{
    Aabb, Arrangement, Bound, CellBox, Chunk, ChunkExtractor, ChunkSettings, Clustering, Control, Cubes,
    Execution, Extraction, Extractor, Grid, LevelExtractor, Method, Neighbours, Normals, ScalarField, Source,
    Tetrahedra, Topology, presets,
};
use isostudy_field::{Asteroid, Gyroid, MeshDistance, Sphere, StudyField};
use isostudy_mesh::Bounds;
use stats_alloc::{INSTRUMENTED_SYSTEM, Region, StatsAlloc};
use std::alloc::System;

#[global_allocator]
static ALLOCATOR: &StatsAlloc<System> = &INSTRUMENTED_SYSTEM;

const ONE: Execution = Execution { threads: 1 };
const BOTH: [Arrangement; 2] = [Arrangement::BodyCentred, Arrangement::SimpleCubic];

/// No harness: its thread allocates, and the allocator counts for the whole process.
fn main() {
    allocations();
    println!("test allocations ... ok");
}

fn allocations() {
    the_second_volume_of_a_size_allocates_nothing();
    given_samples_allocate_nothing_either();
    an_extractor_holds_what_the_lattice_says();
    a_lattice_cut_by_cubes_takes_what_it_says();
    a_moving_window_allocates_nothing_from_the_second_chunk_on();
    so_does_that_of_every_preset();
    the_first_chunk_after_a_warm_up_allocates_nothing();
}

fn cube() -> Bounds {
    Bounds { min: Vec3::splat(-1.1), max: Vec3::splat(1.1) }
}

fn the_second_volume_of_a_size_allocates_nothing() {
    let coarse = Lattice::try_new(Arrangement::BodyCentred, cube(), 0.2).unwrap();
    let solid =
        isostudy_extract::by_lattice::extract(&Sphere::default(), &coarse, &ExtractSettings::default(), &ONE)
            .unwrap();
    let fields: [(&str, &dyn StudyField); 4] = [
        ("sphere", &Sphere { radius: 0.9 }),
        ("asteroid", &Asteroid::default()),
        // About three points a period: the guard has to look closely.
        ("gyroid", &Gyroid { frequency: 40.0 }),
        ("mesh", &MeshDistance::try_new(&solid.mesh).unwrap()),
    ];
    for arrangement in BOTH {
        let lattice = Lattice::try_new(arrangement, cube(), 0.05).unwrap();
        for clustering in [Clustering::Integrated, Clustering::None] {
            for topology in [Topology::Guarded, Topology::Published] {
                let settings = ExtractSettings::default().with_clustering(clustering).with_topology(topology);
                let (mut extractor, mut extraction) = (Extractor::new(), Extraction::default());
                let mut run = |field: &dyn StudyField| {
                    extractor
                        .extract_into(Source::Study(field), &lattice, &settings, &ONE, &mut extraction)
                        .unwrap();
                    assert!(extraction.counts.triangles > 1000);
                };
                for (name, field) in fields {
                    run(field);
                    let region = Region::new(ALLOCATOR);
                    run(field);
                    run(field);
                    let change = region.change();
                    let seen = (change.allocations, change.reallocations, change.deallocations);
                    assert_eq!(seen, (0, 0, 0), "{name} {arrangement:?} {clustering:?} {topology:?}");
                }
                // One surface after another, and no larger.
                let region = Region::new(ALLOCATOR);
                for radius in [0.7, 1.0, 0.95] {
                    run(&Sphere { radius });
                }
                let change = region.change();
                assert_eq!((change.allocations, change.reallocations, change.deallocations), (0, 0, 0));
            }
        }
    }
}

fn given_samples_allocate_nothing_either() {
    for arrangement in BOTH {
        let lattice = Lattice::try_new(arrangement, cube(), 0.05).unwrap();
        let waves = |length: f32| -> Vec<f32> {
            (0..lattice.stored_samples()).map(|i| (i as f32 / length).sin()).collect()
        };
        let (rough, smooth) = (waves(3.0), waves(300.0));
        for clustering in [Clustering::Integrated, Clustering::None] {
            for topology in [Topology::Guarded, Topology::Published] {
                let settings = ExtractSettings::default().with_clustering(clustering).with_topology(topology);
                let (mut extractor, mut extraction) = (Extractor::new(), Extraction::default());
                let mut run = |samples: &[f32]| {
                    let source = Source::Samples(samples);
                    extractor.extract_into(source, &lattice, &settings, &ONE, &mut extraction).unwrap();
                    assert!(extraction.counts.triangles > 1000);
                };
                run(&rough);
                let region = Region::new(ALLOCATOR);
                run(&rough);
                run(&smooth);
                run(&rough);
                let change = region.change();
                let seen = (change.allocations, change.reallocations, change.deallocations);
                assert_eq!(seen, (0, 0, 0), "{arrangement:?} {clustering:?} {topology:?}");
            }
        }
    }
}

/// Of an empty surface, so that there is no mesh on top.
fn an_extractor_holds_what_the_lattice_says() {
    for arrangement in BOTH {
        let lattice = Lattice::try_new(arrangement, cube(), 0.01).unwrap();
        let mut extractor = Extractor::new();
        let mut run = || {
            let nothing: &dyn StudyField = &Sphere { radius: -1.0 };
            extractor.extract(nothing.into(), &lattice, &ExtractSettings::default(), &ONE).unwrap();
        };
        let region = Region::new(ALLOCATOR);
        run();
        let change = region.change();
        let held = (change.bytes_allocated - change.bytes_deallocated) as f64;
        let told = lattice.streaming_bytes(1) as f64;
        assert!(held > 0.98 * told && held < 1.1 * told, "{arrangement:?}: {held} bytes, {told} told");
    }
}

/// The same of the extractor that keeps no buffers: what it has had.
fn a_lattice_cut_by_cubes_takes_what_it_says() {
    for arrangement in [Arrangement::FiveTetrahedra, Arrangement::FaceCentred] {
        let lattice = Lattice::try_new(arrangement, cube(), 0.01).unwrap();
        let settings = ExtractSettings::default().with_clustering(Clustering::None);
        let nothing: &dyn StudyField = &Sphere { radius: -1.0 };
        let region = Region::new(ALLOCATOR);
        isostudy_extract::by_lattice::extract(nothing, &lattice, &settings, &ONE).unwrap();
        let (taken, told) = (region.change().bytes_allocated as f64, lattice.streaming_bytes(1) as f64);
        assert!(taken > 0.98 * told && taken < 1.1 * told, "{arrangement:?}: {taken} bytes, {told} told");
    }
}

/// Hills that are the same in all chunks of 16 cells: so is the surface, and no chunk is larger than the first.
struct Hills {
    slope: Option<f32>,
}

impl ScalarField for Hills {
    fn sample(&self, [x, y, z]: [f32; 3]) -> f32 {
        let wave = |c: f32| (c.rem_euclid(16.0) * std::f32::consts::TAU / 16.0).sin();
        4.0 * wave(x) * wave(y) + 8.3 - z
    }

    fn bound(&self, _: Aabb) -> Bound {
        self.slope.map_or(Bound::UNKNOWN, Bound::slope)
    }
}

/// Of every preset that has chunks, but the warp, which is a pass over a whole mesh.
fn so_does_that_of_every_preset() {
    let grid = Grid::try_new([0.0; 3], 1.0).unwrap();
    let mut tried = 0;
    let is_warped =
        |method: &Method| matches!(method, Method::Tetrahedra(of) if of.clustering == Clustering::Warp);
    for preset in presets().iter().filter(|preset| !is_warped(&preset.method)) {
        let settings = ChunkSettings::default();
        let Ok(mut extractor) = ChunkExtractor::try_new(&grid, &preset.method, &settings) else { continue };
        let mut chunk = Chunk::default();
        let mut seen = |id: [i32; 3]| {
            let cells = grid.chunk(id, 16);
            let region = Region::new(ALLOCATOR);
            let hills = Hills { slope: Some(3.0) };
            extractor.extract_into(&hills, cells, Control::default(), &mut chunk).unwrap();
            let change = region.change();
            assert!(chunk.triangles.len() > 300, "{}", preset.id);
            (change.allocations, change.reallocations, change.deallocations)
        };
        seen([0; 3]);
        for id in [[1, 0, 0], [0, 1, 0], [-1, -7, 0], [1000, 20, 0], [0; 3]] {
            assert_eq!(seen(id), (0, 0, 0), "{} {id:?}", preset.id);
        }
        tried += 1;
    }
    assert_eq!(tried, 22, "all that collapse no edge, do not turn edges and have one resolution");
}

fn a_moving_window_allocates_nothing_from_the_second_chunk_on() {
    let grid = Grid::try_new([0.0; 3], 1.0).unwrap();
    for arrangement in Arrangement::ALL {
        let clustering = if arrangement.supports(Clustering::Integrated) {
            Clustering::Integrated
        } else {
            Clustering::None
        };
        let method = Method::Tetrahedra(Tetrahedra::new(arrangement).with_clustering(clustering));
        for (slope, normals) in
            [(None, Normals::Triangles), (Some(3.0), Normals::None), (Some(3.0), Normals::Field)]
        {
            let hills = Hills { slope };
            let settings = ChunkSettings::default().with_normals(normals);
            let mut extractor = ChunkExtractor::try_new(&grid, &method, &settings).unwrap();
            let mut chunk = Chunk::default();
            let mut samples = Vec::new();
            let mut seen = |id: [i32; 3], given: bool| {
                let cells = grid.chunk(id, 16);
                let window = extractor.window(cells).unwrap().unwrap();
                if given {
                    extractor.layout(window).unwrap().fill(&hills, &mut samples);
                }
                let source = if given {
                    Source::Window { cells: window, samples: &samples }
                } else {
                    Source::from(&hills)
                };
                let region = Region::new(ALLOCATOR);
                extractor.extract_into(source, cells, Control::default(), &mut chunk).unwrap();
                let change = region.change();
                assert!(chunk.triangles.len() > 400);
                (change.allocations, change.reallocations, change.deallocations)
            };
            for given in [false, true] {
                if given && normals == Normals::Field {
                    continue;
                }
                seen([0; 3], given);
                for id in [[1, 0, 0], [0, 1, 0], [-1, -7, 0], [1000, 20, 0], [0; 3]] {
                    assert_eq!(seen(id, given), (0, 0, 0), "{arrangement} {normals:?} given {given} {id:?}");
                }
            }
        }
    }
}

/// Tables and buffers are there, of one level and of several.
fn the_first_chunk_after_a_warm_up_allocates_nothing() {
    let grid = Grid::try_new([0.0; 3], 1.0).unwrap();
    let cells = CellBox { start: [-16; 3], end: [16; 3] };
    let sphere: &dyn StudyField = &Sphere { radius: 10.0 };
    for id in ["mc", "mc33", "mc-edge-groups", "nets", "nets-manifold", "snapmc", "si", "bi", "dc"] {
        let method = presets().iter().find(|preset| preset.id == id).unwrap().method;
        let mut extractor = ChunkExtractor::try_new(&grid, &method, &ChunkSettings::default()).unwrap();
        extractor.warm_up(32).unwrap();
        let mut chunk = Chunk::default();
        chunk.reserve(8_000);
        let region = Region::new(ALLOCATOR);
        extractor.extract_into(sphere, cells, Control::default(), &mut chunk).unwrap();
        let change = region.change();
        assert!(chunk.triangles.len() > 1_000, "{id}");
        // Tangents are kept in tables that grow with the edges that are met.
        assert!(id == "dc" || change.allocations + change.reallocations == 0, "{id}: {change:?}");
    }
    let method = Method::Cubes(Cubes::default());
    let mut levels = LevelExtractor::try_new(&grid, &method, &ChunkSettings::default()).unwrap();
    let neighbours = Neighbours::try_new(1, |[x, _, _]| if x > 0 { 0 } else { 1 }).unwrap();
    let cells = CellBox { start: [-16, -8, -8], end: [0, 8, 8] };
    let mut first_seam = |is_warm: bool| {
        if is_warm {
            levels.warm_up(2, 32).unwrap();
            levels.reserve(2, 8_000).unwrap();
        }
        let mut chunk = Chunk::default();
        chunk.reserve(8_000);
        let region = Region::new(ALLOCATOR);
        let field = &Sphere { radius: 10.0 } as &dyn StudyField;
        levels.extract_into(field, 1, cells, &neighbours, Control::default(), &mut chunk).unwrap();
        assert!(chunk.seam > 10);
        let change = region.change();
        (change.allocations + change.reallocations, chunk)
    };
    let (warm, chunk) = first_seam(true);
    assert!(warm < 500, "{warm}: a table of one kind of cell takes thousands");
    assert_eq!(first_seam(false).1, chunk);
}
