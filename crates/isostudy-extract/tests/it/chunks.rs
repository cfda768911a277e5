//! Chunks weld to the mesh of the whole, to the byte, whatever the samples, the arrangement, the clustering, the
//! topology and the boxes.

use std::sync::Mutex;

use crate::fields::{FAMILIES, Family, Numbers, Volume};
use glam::Vec3;
use isostudy_extract::by_lattice::{ExtractSettings, Lattice, extract};
use isostudy_extract::{
    Aabb, Arrangement, BoxGrid, CellBox, Chunk, ChunkError, ChunkExtractor, ChunkSettings, Clustering,
    Control, Cubes, Execution, ExtractError, Faces, Grid, LevelError, LevelExtractor, Method, Normals,
    Placement, Positions, ScalarField, Source, SurfaceNets, Tetrahedra, Topology, WeldError, from_fn,
    presets, weld_chunks,
};
use isostudy_field::{Asteroid, Sphere, StudyField};
use isostudy_mesh::{Bounds, TriangleMesh};
use rayon::prelude::*;

const ONE: Execution = Execution { threads: 1 };

/// Every clustering that the arrangement has, by both topologies.
fn all_settings(arrangement: Arrangement) -> impl Iterator<Item = ExtractSettings> {
    let clusterings =
        [Clustering::None, Clustering::Integrated, Clustering::EdgeCollapse, Clustering::IntegratedCollapse];
    clusterings.into_iter().filter(move |&clustering| arrangement.supports(clustering)).flat_map(
        |clustering| {
            [Topology::Guarded, Topology::Published].map(|topology| {
                ExtractSettings::default().with_clustering(clustering).with_topology(topology)
            })
        },
    )
}

fn try_chunks_of(lattice: &Lattice, settings: &ExtractSettings) -> Result<ChunkExtractor, ChunkError> {
    let ExtractSettings { clustering, topology, positions, placement, refine_crossings, edge_clamp, .. } =
        *settings;
    let arrangement = lattice.arrangement();
    let method = Method::Tetrahedra(
        Tetrahedra::new(arrangement)
            .with_clustering(clustering)
            .with_topology(topology)
            .with_positions(positions)
            .with_placement(placement)
            .with_refine_crossings(refine_crossings)
            .with_edge_clamp(edge_clamp),
    );
    let settings = ChunkSettings::default().with_isovalue(settings.isovalue);
    ChunkExtractor::in_box(&BoxGrid::from(lattice), &method, &settings)
}

fn chunks_of(lattice: &Lattice, settings: &ExtractSettings) -> ChunkExtractor {
    try_chunks_of(lattice, settings).unwrap()
}

/// Bits, so that no two numbers that compare equal pass for one.
fn bits(mesh: &TriangleMesh) -> [Vec<[u32; 3]>; 3] {
    let of = |points: &[Vec3]| points.iter().map(|p| p.to_array().map(f32::to_bits)).collect();
    [of(&mesh.positions), of(&mesh.normals), mesh.triangles.clone()]
}

/// Cuts the cells in two at random places, over and over.
fn random_boxes(all: CellBox, pieces: usize, numbers: &mut Numbers) -> Vec<CellBox> {
    let mut boxes = vec![all];
    for _ in 0..100 * pieces {
        if boxes.len() == pieces {
            break;
        }
        let whole = boxes.swap_remove(numbers.below(boxes.len() as u64) as usize);
        let axis = numbers.below(3) as usize;
        let size = whole.end[axis] - whole.start[axis];
        if size < 2 {
            boxes.push(whole);
            continue;
        }
        let (mut low, mut high) = (whole, whole);
        let place = whole.start[axis] + 1 + numbers.below(size as u64 - 1) as i32;
        (low.end[axis], high.start[axis]) = (place, place);
        boxes.extend([low, high]);
    }
    boxes
}

fn chunks(source: Source, lattice: &Lattice, settings: &ExtractSettings, boxes: &[CellBox]) -> Vec<Chunk> {
    let mut extractor = chunks_of(lattice, settings);
    boxes.iter().map(|&cells| extractor.extract(source, cells, &ONE).unwrap()).collect()
}

fn check(
    field: &dyn StudyField,
    lattice: &Lattice,
    settings: &ExtractSettings,
    boxes: &[CellBox],
    what: &str,
) {
    let whole = extract(field, lattice, settings, &ONE).unwrap().mesh;
    let parts = chunks(Source::Study(field), lattice, settings, boxes);
    for part in &parts {
        let mesh = &part.mesh();
        assert_eq!((mesh.normals.len(), part.keys.len()), (mesh.positions.len(), mesh.positions.len()));
        assert_eq!(part.triangle_cells.len(), mesh.triangles.len());
        assert!(part.triangle_cells.is_sorted(), "{what}");
    }
    let welded = weld_chunks(&parts).unwrap_or_else(|error| panic!("{what}: {error}"));
    assert!(bits(&welded) == bits(&whole), "{what}: {settings:?}");
}

/// Whether what happens somewhere depends on nothing far away.
fn is_local(settings: &ExtractSettings) -> bool {
    matches!(settings.clustering, Clustering::None | Clustering::Integrated)
}

fn whole_box(lattice: &Lattice) -> CellBox {
    CellBox { start: [0; 3], end: lattice.cells().map(|n| n as i32) }
}

#[test]
fn any_boxes_of_any_samples_weld_to_the_whole() {
    let cases: Vec<_> = FAMILIES
        .into_iter()
        .enumerate()
        // Open and closed by turns.
        .map(|(i, family)| (family, i as u64 % 2))
        .flat_map(|(family, seed)| Arrangement::ALL.map(|arrangement| (family, seed, arrangement)))
        .collect();
    cases.par_iter().for_each(|&(family, seed, arrangement)| {
        for cells in [3, 9] {
            let volume = Volume::random(arrangement, cells, family, seed);
            let volume = if seed == 0 { volume.closed() } else { volume };
            let lattice = volume.lattice();
            let mut numbers = Numbers::new(seed + cells as u64);
            for settings in all_settings(arrangement) {
                let pieces = 2 + numbers.below(5) as usize;
                let boxes = random_boxes(whole_box(&lattice), pieces, &mut numbers);
                check(
                    &volume,
                    &lattice,
                    &settings,
                    &boxes,
                    &format!("{family:?} {seed} {arrangement:?} {cells}"),
                );
            }
        }
    });
}

#[test]
fn smooth_surfaces_weld_cell_by_cell_and_chunk_by_chunk() {
    let bounds = Bounds { min: Vec3::splat(-1.03), max: Vec3::new(1.1, 1.02, 0.7) };
    for arrangement in Arrangement::ALL {
        let lattice = Lattice::try_new(arrangement, bounds, 0.11).unwrap();
        for settings in all_settings(arrangement) {
            let grid = |size| chunks_of(&lattice, &settings).grid(size).collect::<Vec<_>>();
            check(&Asteroid::default(), &lattice, &settings, &grid(11), "asteroid");
            if is_local(&settings) {
                check(&Sphere { radius: 1.0 }, &lattice, &settings, &grid(5), "sphere");
                check(&Asteroid::default(), &lattice, &settings, &grid(2), "small chunks");
            }
        }
    }
}

#[test]
fn samples_threads_and_order_do_not_show() {
    for arrangement in Arrangement::ALL {
        let volume = Volume::random(arrangement, 12, Family::FbmAsteroid, 3);
        let lattice = volume.lattice();
        let sampled = Mutex::new(Vec::new());
        let recorder = Recorder { volume: &volume, places: &sampled };
        // All samples of the whole, in storage order.
        let samples = match arrangement {
            Arrangement::BodyCentred => body_centred_samples(&volume),
            _ => storage_samples(&volume),
        };
        let settings = all_settings(arrangement).next().map(|s| s.with_isovalue(0.01)).unwrap();
        let mut extractor = chunks_of(&lattice, &settings);
        let boxes: Vec<CellBox> = extractor.grid(5).collect();
        let called = chunks(Source::Study(&volume), &lattice, &settings, &boxes);
        let given = chunks(Source::Samples(&samples), &lattice, &settings, &boxes);
        assert!(called == given, "{arrangement:?}: called or given");
        let threads: Vec<Chunk> = boxes
            .iter()
            .rev()
            .map(|&cells| {
                extractor.extract(Source::Study(&volume), cells, &Execution { threads: 3 }).unwrap()
            })
            .collect();
        assert!(threads.iter().rev().eq(&called), "{arrangement:?}: threads");
        assert_eq!(weld_chunks(&threads).unwrap(), weld_chunks(&called).unwrap());
        // Nothing beyond the box that a chunk names is looked at.
        for &cells in &boxes {
            sampled.lock().unwrap().clear();
            let chunk = extractor.extract(Source::Study(&recorder), cells, &ONE).unwrap();
            for &p in sampled.lock().unwrap().iter() {
                assert!(chunk.is_touched_by(Aabb::from(Bounds { min: p, max: p })), "{arrangement:?}: {p}");
            }
        }
    }
}

/// Notes where it is sampled.
struct Recorder<'a> {
    volume: &'a Volume,
    places: &'a Mutex<Vec<Vec3>>,
}

impl StudyField for Recorder<'_> {
    fn sample(&self, p: Vec3) -> f32 {
        self.places.lock().unwrap().push(p);
        self.volume.sample(p)
    }
}

/// All stored points on a grid of one kind.
fn storage_samples(volume: &Volume) -> Vec<f32> {
    let (steps, size) = match volume.arrangement {
        Arrangement::FaceCentred => (2 * volume.cells, 0.5),
        _ => (volume.cells, 1.0),
    };
    let places = (0..=steps).flat_map(|z| (0..=steps).flat_map(move |y| (0..=steps).map(move |x| [x, y, z])));
    places.map(|place| volume.sample(Vec3::from_array(place.map(|i| i as f32 * size)))).collect()
}

fn body_centred_samples(volume: &Volume) -> Vec<f32> {
    let n = volume.cells + 2;
    let layer = |k: usize| {
        let (offset, z) = if k.is_multiple_of(2) { (-0.5, k / 2) } else { (0.0, k / 2) };
        let row = move |y: usize| {
            (0..n).map(move |x| Vec3::new(x as f32, y as f32, z as f32) + Vec3::splat(offset))
        };
        (0..n).flat_map(row)
    };
    (0..2 * volume.cells + 3).flat_map(layer).map(|p| volume.sample(p)).collect()
}

/// A ball with bites taken out of it.
struct Bitten(Vec<(Vec3, f32)>);

impl StudyField for Bitten {
    fn sample(&self, p: Vec3) -> f32 {
        self.0
            .iter()
            .fold(0.9 - p.length(), |value, (centre, radius)| value.min(p.distance(*centre) - radius))
    }
}

#[test]
fn only_chunks_that_an_edit_touches_change() {
    let bounds = Bounds { min: Vec3::NEG_ONE, max: Vec3::ONE };
    for arrangement in Arrangement::ALL {
        let lattice = Lattice::try_new(arrangement, bounds, 0.1).unwrap();
        for settings in all_settings(arrangement) {
            let mut extractor = chunks_of(&lattice, &settings);
            let boxes: Vec<CellBox> = extractor.grid(if is_local(&settings) { 5 } else { 10 }).collect();
            let mut field = Bitten(Vec::new());
            let mut parts = chunks(Source::Study(&field), &lattice, &settings, &boxes);
            for (place, radius) in [(Vec3::new(0.85, 0.1, 0.0), 0.15), (Vec3::new(-0.3, 0.3, 0.8), 0.2)] {
                field.0.push((place, radius));
                // The value changes only where the bite is deeper than the rest.
                let reach = Vec3::splat(1.0);
                let changed = Bounds { min: place - reach, max: place + reach };
                let mut touched = 0;
                for part in parts.iter_mut().filter(|part| part.is_touched_by(changed)) {
                    *part = extractor.extract(Source::Study(&field), part.cells, &ONE).unwrap();
                    touched += 1;
                }
                assert!(
                    touched > 0 && (!is_local(&settings) || touched < boxes.len()),
                    "{touched} of {}",
                    boxes.len()
                );
                let whole = extract(&field, &lattice, &settings, &ONE).unwrap().mesh;
                assert!(bits(&weld_chunks(&parts).unwrap()) == bits(&whole), "{arrangement:?} {settings:?}");
            }
        }
    }
}

#[test]
fn chunks_that_do_not_belong_together_are_refused() {
    let bounds = Bounds { min: Vec3::NEG_ONE, max: Vec3::ONE };
    let lattice = Lattice::try_new(Arrangement::BodyCentred, bounds, 0.1).unwrap();
    let settings = ExtractSettings::default();
    let mut extractor = chunks_of(&lattice, &settings);
    let boxes: Vec<CellBox> = extractor.grid(10).collect();
    let [small, large] = [Sphere { radius: 0.8 }, Sphere { radius: 0.81 }];
    let mut parts = chunks(Source::Study(&small), &lattice, &settings, &boxes);
    let old = parts[0].clone();
    parts[0] = extractor.extract(Source::Study(&large), boxes[0], &ONE).unwrap();
    assert!(matches!(weld_chunks(&parts), Err(WeldError::Mismatch(_))));
    parts[0] = old.clone();
    parts.push(old);
    assert!(matches!(weld_chunks(&parts), Err(WeldError::Overlap { .. })));
    assert_eq!(weld_chunks(&[]).unwrap(), TriangleMesh::default());
}

#[test]
fn what_cannot_be_cut_into_chunks_is_an_error() {
    let bounds = Bounds { min: Vec3::NEG_ONE, max: Vec3::ONE };
    let lattice = Lattice::try_new(Arrangement::BodyCentred, bounds, 0.5).unwrap();
    let settings = ExtractSettings::default();
    let refused = |settings: ExtractSettings, lattice: &Lattice| {
        try_chunks_of(lattice, &settings).expect_err("refused")
    };
    let positions = Positions::Accumulated { chunks: 1 };
    assert_eq!(refused(settings.with_positions(positions), &lattice), ChunkError::Accumulated);
    let placement = Placement::CurvatureWeighted;
    let error = refused(settings.with_placement(placement), &lattice);
    assert_eq!(error, ChunkError::Placement { placement, refine_crossings: false });
    let (placement, clustering) = (Placement::Relaxed, Clustering::EdgeCollapse);
    let error = refused(settings.with_placement(placement).with_clustering(clustering), &lattice);
    assert_eq!(error, ChunkError::Placement { placement, refine_crossings: false });
    let five = Lattice::try_new(Arrangement::FiveTetrahedra, bounds, 0.5).unwrap();
    let error = ExtractError::ArrangementClustering {
        arrangement: Arrangement::FiveTetrahedra,
        clustering: Clustering::Integrated,
    };
    assert_eq!(refused(settings, &five), ChunkError::Extract(error));

    let mut extractor = chunks_of(&lattice, &settings);
    let sphere = Sphere { radius: 0.8 };
    for (start, end) in [([0; 3], [5, 4, 4]), ([2; 3], [2, 3, 3]), ([3; 3], [1, 4, 4])] {
        let given = CellBox { start, end };
        let error = extractor.extract(Source::Study(&sphere), given, &ONE).unwrap_err();
        assert_eq!(error, ChunkError::Cells { given, whole: whole_box(&lattice) });
    }
    let samples = [0.0; 7];
    let cells = CellBox { start: [0; 3], end: [2; 3] };
    let error = extractor.extract(Source::Samples(&samples), cells, &ONE).unwrap_err();
    let wanted = lattice.stored_samples();
    assert_eq!(error, ChunkError::Extract(ExtractError::SampleCount { given: 7, wanted }));
    assert_eq!(extractor.grid(0).count(), 0);
    assert_eq!(extractor.grid(u32::MAX).collect::<Vec<_>>(), [whole_box(&lattice)]);
}

/// Balls far from each other.
struct Balls;

impl StudyField for Balls {
    fn sample(&self, p: Vec3) -> f32 {
        0.1 - (p - (p * 2.0).round() * 0.5).length()
    }
}

/// With edge collapse a chunk's window holds every piece of surface that enters the chunk, and need not hold more.
#[test]
fn collapses_look_as_far_as_a_piece_of_surface_goes() {
    let bounds = Bounds { min: Vec3::splat(-0.98), max: Vec3::splat(1.02) };
    for arrangement in Arrangement::ALL {
        let lattice = Lattice::try_new(arrangement, bounds, 0.04).unwrap();
        for settings in all_settings(arrangement).filter(|settings| !is_local(settings)) {
            let mut extractor = chunks_of(&lattice, &settings);
            let boxes: Vec<CellBox> = extractor.grid(25).collect();
            check(&Asteroid::default(), &lattice, &settings, &boxes, "one piece");
            let corner = CellBox { start: [6; 3], end: [14; 3] };
            let mut window = |field: &dyn StudyField, cells: CellBox| {
                extractor.extract(Source::Study(field), cells, &ONE).unwrap().window
            };
            let seen = window(&Asteroid::default(), boxes[0]);
            for p in extract(&Asteroid::default(), &lattice, &settings, &ONE).unwrap().mesh.positions {
                let cell = ((p - bounds.min) / lattice.spacing()).to_array().map(|c| c as i32);
                assert!(seen.contains(cell), "{arrangement:?}: {cell:?} is not in {seen:?}");
            }
            assert_ne!(window(&Balls, corner), whole_box(&lattice), "{arrangement:?}");
        }
    }
}

/// Without normals a chunk looks at fewer samples, and is the same otherwise: at samples that equal the isovalue, too.
#[test]
fn chunks_without_normals_are_the_same_otherwise() {
    let noise = crate::two_levels::noise(5, 8.0, 40.0);
    let waves = from_fn(|[x, y, z]: [f32; 3]| (0.7 * x).sin() + (0.6 * y + 1.0).sin() + (0.8 * z).cos());
    let grid = Grid::try_new([0.0; 3], 1.0).unwrap();
    let smoothed = [false, true]
        .map(|patches| Method::SurfaceNets(SurfaceNets::default().with_smoothing(2).with_patches(patches)));
    let methods = presets().iter().map(|preset| preset.method).filter(|method| method.promises().chunks);
    let (mut compared, mut narrower) = (0, 0);
    for method in methods.chain(smoothed) {
        let settings = ChunkSettings::default().with_isovalue(0.1);
        let Ok(mut with) = ChunkExtractor::try_new(&grid, &method, &settings) else { continue };
        let without = settings.with_normals(Normals::None);
        let mut without = ChunkExtractor::try_new(&grid, &method, &without).unwrap();
        let fields: &[&dyn ScalarField] =
            if method.promises().samples_suffice { &[&noise, &waves] } else { &[&waves] };
        for field in fields {
            for start in [[0, 0, 0], [-7, 3, 2], [5, -9, -4]] {
                let cells = CellBox { start, end: start.map(|i| i + 7) };
                let expected = with.extract(*field, cells, Control::default()).unwrap();
                let found = without.extract(*field, cells, Control::default()).unwrap();
                assert!(found.normals.is_empty() && expected.normals.len() == expected.positions.len());
                assert!(found.triangles.len() > 50, "{method:?}");
                assert_eq!(found.keys, expected.keys, "{method:?} {start:?}");
                assert_eq!(found.positions, expected.positions, "{method:?} {start:?}");
                assert_eq!(found.triangles, expected.triangles, "{method:?} {start:?}");
                assert_eq!(found.triangle_cells, expected.triangle_cells, "{method:?} {start:?}");
                compared += 1;
                narrower += usize::from(found.window != expected.window);
            }
        }
    }
    assert!(compared > 60 && narrower > 20, "{compared} {narrower}");
}

/// Samples of a chunk's window.
fn window_of(extractor: &ChunkExtractor, field: &dyn ScalarField, cells: CellBox) -> (CellBox, Vec<f32>) {
    let window = extractor.window(cells).unwrap().unwrap();
    let mut samples = Vec::new();
    extractor.layout(window).unwrap().fill(field, &mut samples);
    (window, samples)
}

/// Methods that have normals by samples: with one vertex in a cell and several, with vertices on edges and within cells.
fn with_normals_of_samples() -> [Method; 4] {
    let patches = SurfaceNets::default().with_patches(true);
    let trilinear = Cubes::default().with_faces(Faces::Trilinear);
    [
        Method::SurfaceNets(SurfaceNets::default()),
        Method::SurfaceNets(patches),
        Method::Cubes(Cubes::default()),
        Method::Cubes(trilinear),
    ]
}

/// Of noise, whose cells have all patterns there are: the chunk with normals by samples is the chunk, and its normals are those of its
/// neighbours, to the bit.
#[test]
fn chunks_with_normals_of_samples_are_the_same_otherwise_and_fit() {
    let noise = crate::two_levels::noise(5, 8.0, 40.0);
    let grid = Grid::try_new([0.0; 3], 0.5).unwrap();
    let mut shared = 0;
    for method in with_normals_of_samples() {
        let settings = ChunkSettings::default().with_isovalue(0.1);
        let mut by_triangles = ChunkExtractor::try_new(&grid, &method, &settings).unwrap();
        let settings = settings.with_normals(Normals::Samples);
        let mut by_samples = ChunkExtractor::try_new(&grid, &method, &settings).unwrap();
        let mut chunks = Vec::new();
        for start in [[-7, 3, 2], [0, 3, 2], [-7, 10, 2], [-7, 3, 9]] {
            let cells = CellBox { start, end: start.map(|i| i + 7) };
            let expected = by_triangles.extract(&noise, cells, Control::default()).unwrap();
            let (window, samples) = window_of(&by_samples, &noise, cells);
            let source = Source::Window { cells: window, samples: &samples };
            let found = by_samples.extract(source, cells, Control::default()).unwrap();
            assert_eq!(found.keys, expected.keys, "{method:?} {start:?}");
            assert_eq!(found.positions, expected.positions, "{method:?} {start:?}");
            assert_eq!(found.triangles, expected.triangles, "{method:?} {start:?}");
            assert_eq!(found.triangle_cells, expected.triangle_cells, "{method:?} {start:?}");
            assert_eq!(found.normals.len(), found.positions.len());
            for normal in &found.normals {
                let length = Vec3::from(*normal).length();
                assert!((length - 1.0).abs() < 1e-5 || length == 0.0, "{normal:?}");
            }
            chunks.push(found);
        }
        let first = &chunks[0];
        for other in &chunks[1..] {
            for (v, key) in first.keys.iter().enumerate() {
                if let Some(w) = other.keys.iter().position(|of| of == key) {
                    assert_eq!(first.normals[v].map(f32::to_bits), other.normals[w].map(f32::to_bits));
                    shared += 1;
                }
            }
        }
        weld_chunks(&chunks).unwrap();
    }
    assert!(shared > 200, "{shared}");
}

/// A value that changes alike everywhere has one normal; that of a ball points away from its centre, to the angle of half a cell's side
/// there, which is 0.04. In a box, too, whose last cells are thin.
#[test]
fn normals_of_samples_are_against_the_gradient() {
    let plane = from_fn(|[x, y, z]: [f32; 3]| 3.3 - (x + 2.0 * y - 0.5 * z));
    let ball = from_fn(|[x, y, z]: [f32; 3]| 3.1 - (x * x + y * y + z * z).sqrt());
    let down = Vec3::new(1.0, 2.0, -0.5).normalize();
    let thin =
        BoxGrid { bounds: Bounds { min: Vec3::splat(-4.1), max: Vec3::new(4.0, 4.05, 4.0) }, spacing: 0.25 };
    let grid = Grid::try_new([0.0; 3], 0.25).unwrap();
    let settings = ChunkSettings::default().with_normals(Normals::Samples);
    for method in with_normals_of_samples() {
        let endless = ChunkExtractor::try_new(&grid, &method, &settings).unwrap();
        let cells = CellBox { start: [-14; 3], end: [14; 3] };
        let of_box = ChunkExtractor::in_box(&thin, &method, &settings).unwrap();
        let whole = of_box.grid(64).next().unwrap();
        for (mut extractor, cells) in [(endless, cells), (of_box, whole)] {
            for (field, normal_at, most) in
                [(&plane as &dyn ScalarField, None, 2e-3), (&ball, Some(Vec3::ZERO), 0.06)]
            {
                let (window, samples) = window_of(&extractor, field, cells);
                let source = Source::Window { cells: window, samples: &samples };
                let chunk = extractor.extract(source, cells, Control::default()).unwrap();
                assert!(chunk.positions.len() > 500);
                for (position, normal) in chunk.positions.iter().zip(&chunk.normals) {
                    let expected = match normal_at {
                        None => down,
                        Some(centre) => (Vec3::from(*position) - centre).normalize(),
                    };
                    let off = (Vec3::from(*normal) - expected).length();
                    assert!(off < most, "{method:?} {position:?}: {normal:?}, not {expected:?}");
                }
            }
        }
    }
}

#[test]
fn normals_of_samples_are_refused_where_there_are_none() {
    let grid = Grid::try_new([0.0; 3], 1.0).unwrap();
    let settings = ChunkSettings::default().with_normals(Normals::Samples);
    let tetrahedra = Method::Tetrahedra(Tetrahedra::new(Arrangement::BodyCentred));
    let smoothed = Method::SurfaceNets(SurfaceNets::default().with_smoothing(1));
    for method in [tetrahedra, smoothed] {
        assert_eq!(
            ChunkExtractor::try_new(&grid, &method, &settings).err(),
            Some(ChunkError::NormalsNeedSamples)
        );
    }
    let nets = Method::SurfaceNets(SurfaceNets::default());
    let mut extractor = ChunkExtractor::try_new(&grid, &nets, &settings).unwrap();
    extractor.warm_up(16).unwrap();
    let field = from_fn(|[_, _, z]: [f32; 3]| 3.5 - z);
    let found = extractor.extract(&field, grid.chunk([0; 3], 8), Control::default());
    assert_eq!(found.err(), Some(ChunkError::NormalsNeedSamples));
    let levels = LevelExtractor::try_new(&grid, &nets, &settings);
    assert_eq!(levels.err(), Some(LevelError::Chunk(ChunkError::NormalsNeedSamples)));
}
