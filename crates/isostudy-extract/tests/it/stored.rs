//! Samples that are read layer by layer, or box by box, make the mesh of the same samples in memory, to the byte.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use glam::Vec3;
use isostudy_extract::by_lattice::Lattice;
use isostudy_extract::{
    BoxGrid, ChunkError, ChunkExtractor, ChunkSettings, Control, Execution, ExtractError, Extraction,
    Extractor, LatticeError, Method, MethodError, Source, StoredSamples, UnreadSamples, VolumeCells,
    VolumeCellsError, presets, weld_chunks,
};
use isostudy_field::{Beyond, StudyField, VolumeField, Walled};
use isostudy_mesh::{Bounds, TriangleMesh};

use crate::fields::Numbers;
use crate::fuzz::volume::Volume;

/// Samples in memory, read as if they were elsewhere; from some layer on they are gone.
struct Elsewhere {
    counts: [usize; 3],
    values: Vec<f32>,
    end: usize,
    /// How many samples were read.
    read: AtomicU64,
}

impl Elsewhere {
    fn new(counts: [usize; 3], values: &[f32]) -> Self {
        Self { counts, values: values.to_vec(), end: counts[2], read: AtomicU64::new(0) }
    }
}

impl StoredSamples for Elsewhere {
    fn counts(&self) -> [usize; 3] {
        self.counts
    }

    fn read_box(&self, first: [usize; 3], size: [usize; 3], values: &mut [f32]) -> Result<(), UnreadSamples> {
        assert_eq!(values.len(), size.iter().product::<usize>());
        self.read.fetch_add(values.len() as u64, Ordering::Relaxed);
        if first[2] + size[2] > self.end {
            values.fill(0.5);
            return Err(UnreadSamples(format!("gone at {first:?}")));
        }
        let [nx, ny, _] = self.counts;
        for (row, values) in values.chunks_exact_mut(size[0]).enumerate() {
            let (y, z) = (first[1] + row % size[1], first[2] + row / size[1]);
            values.copy_from_slice(&self.values[(z * ny + y) * nx + first[0]..][..size[0]]);
        }
        Ok(())
    }
}

fn bits(mesh: &TriangleMesh) -> (Vec<[u32; 3]>, Vec<[u32; 3]>) {
    let of = |points: &[Vec3]| points.iter().map(|p| p.to_array().map(f32::to_bits)).collect();
    (of(&mesh.positions), of(&mesh.normals))
}

fn assert_same(found: &Extraction, wanted: &Extraction, what: &str) {
    assert_eq!(found.mesh.triangles, wanted.mesh.triangles, "{what}");
    assert!(bits(&found.mesh) == bits(&wanted.mesh), "{what}: positions or normals");
}

/// A few balls and noise, cut off by the box, in so many layers that several threads have slabs.
fn balls(counts: [usize; 3], seed: u64) -> Vec<f32> {
    let mut numbers = Numbers::new(seed);
    let share = |numbers: &mut Numbers| numbers.below(1 << 16) as f32 / (1 << 16) as f32;
    let mut balls = Vec::new();
    for _ in 0..6 {
        let centre = counts.map(|n| n as f32 * share(&mut numbers));
        balls.push((centre, 3.0 + 8.0 * share(&mut numbers)));
    }
    let mut values = Vec::with_capacity(counts.iter().product());
    for z in 0..counts[2] {
        for y in 0..counts[1] {
            for x in 0..counts[0] {
                let p = [x, y, z].map(|i| i as f32);
                let depth = |(centre, radius): &([f32; 3], f32)| {
                    radius - (0..3).map(|k| (p[k] - centre[k]).powi(2)).sum::<f32>().sqrt()
                };
                let most = balls.iter().map(depth).fold(f32::NEG_INFINITY, f32::max);
                values.push((4.0 * most + share(&mut numbers)).round().max(-20.0));
            }
        }
    }
    values
}

/// Turned, mirrored, of unequal steps.
const STEPS: [[f64; 3]; 3] = [[0.6, 0.8, 0.0], [-0.8, 0.6, 0.0], [0.0, 0.0, -1.5]];

#[test]
fn a_volumes_own_cells_are_the_same_from_layers_as_from_memory() {
    let counts = [33, 20, 90];
    let values = balls(counts, 1);
    let cells = VolumeCells { counts, values: &values, origin: [1.0, 2.0, 3.0], steps: STEPS };
    let elsewhere = VolumeCells { values: &[], ..cells };
    let stored = Elsewhere::new(counts, &values);
    let mut extractor = Extractor::new();
    let of_cubes: Vec<_> = presets().iter().filter(|preset| preset.method.is_of_cubes()).collect();
    assert!(of_cubes.len() >= 9, "{}", of_cubes.len());
    for preset in of_cubes {
        for threads in [1, 2, 3] {
            let (execution, what) = (Execution { threads }, format!("{}, {threads} threads", preset.id));
            let wanted = cells.extract(&preset.method, &mut extractor, 0.25, &execution).unwrap();
            let before = stored.read.load(Ordering::Relaxed);
            let found =
                elsewhere.extract_stored(&stored, &preset.method, &mut extractor, 0.25, &execution).unwrap();
            assert_same(&found, &wanted, &what);
            assert_eq!(found.counts, wanted.counts, "{what}");
            assert!(found.counts.triangles > 1000, "{what}");
            if threads == 1 && !preset.id.starts_with("continued") {
                assert_eq!(
                    stored.read.load(Ordering::Relaxed) - before,
                    values.len() as u64,
                    "{what}: each once"
                );
            }
        }
    }
}

/// Whatever takes samples takes them from elsewhere too, on the lattice that it asks for.
#[test]
fn every_method_that_samples_suffice_for_is_the_same_from_layers() {
    let grid =
        BoxGrid { bounds: Bounds { min: Vec3::splat(-2.0), max: Vec3::new(17.0, 9.0, 50.0) }, spacing: 1.0 };
    let mut extractor = Extractor::new();
    let mut tried = 0;
    for preset in presets().iter().filter(|preset| preset.method.promises().samples_suffice) {
        let arrangement = match preset.method {
            Method::Tetrahedra(of) => of.arrangement,
            _ => isostudy_extract::Arrangement::SimpleCubic,
        };
        let lattice: Lattice = grid.lattice(arrangement).unwrap();
        let counts = layout(&lattice);
        let values = balls(counts, 2);
        let stored = Elsewhere::new(counts, &values);
        for threads in [1, 3] {
            let execution = Execution { threads };
            let mut of =
                |source| preset.method.extract(&mut extractor, source, &grid, 0.25, &execution).unwrap();
            let wanted = of(Source::Samples(&values));
            let found = of(Source::Stored(&stored));
            assert_same(&found, &wanted, preset.id);
            assert!(found.counts.triangles > 300, "{}", preset.id);
        }
        tried += 1;
    }
    assert!(tried >= 20, "{tried}");
}

/// Points along each axis as a lattice stores them, by the formulas of `Lattice::stored_samples`.
fn layout(lattice: &Lattice) -> [usize; 3] {
    use isostudy_extract::Arrangement::*;
    let [x, y, z] = lattice.cells().map(|n| n as usize);
    let counts = match lattice.arrangement() {
        BodyCentred => [x + 2, y + 2, 2 * z + 3],
        SimpleCubic | FiveTetrahedra => [x + 1, y + 1, z + 1],
        FaceCentred => [2 * x + 1, 2 * y + 1, 2 * z + 1],
    };
    assert_eq!(counts.iter().product::<usize>() as u64, lattice.stored_samples());
    counts
}

/// Small volumes with ties, numbers that are none, infinities, thin and turned boxes: on their own cells and interpolated.
fn random_volumes(seeds: std::ops::Range<u64>) {
    let mut extractor = Extractor::new();
    let mut compared = 0;
    for seed in seeds {
        let volume = Volume::random(seed);
        let Volume { counts, ref values, origin, steps, isovalue, threads, .. } = volume;
        let execution = Execution { threads };
        let stored = Arc::new(Elsewhere::new(counts, values));
        let whole = VolumeField::try_new(counts, values.clone(), origin, steps, Beyond::Continued);
        // Room for one brick.
        let of_stored = VolumeField::try_stored(stored.clone(), origin, steps, Beyond::Continued, 0, 1);
        assert_eq!(whole.as_ref().err(), of_stored.as_ref().err(), "{seed}");
        for preset in presets() {
            let what = format!("{} of the volume {seed}", preset.id);
            if preset.method.is_of_cubes() {
                let cells = VolumeCells { counts, values, origin, steps };
                let wanted = cells.extract(&preset.method, &mut extractor, isovalue, &execution).unwrap();
                let found = cells
                    .extract_stored(&*stored, &preset.method, &mut extractor, isovalue, &execution)
                    .unwrap();
                assert_same(&found, &wanted, &what);
            }
            let (Ok(whole), Ok(of_stored)) = (&whole, &of_stored) else { continue };
            let [wanted, found] = [whole, of_stored].map(|field| {
                let (field, bounds): (Box<dyn StudyField>, _) = if field.is_axis_aligned() {
                    (Box::new(field.clone()), field.bounds())
                } else {
                    let field = field.clone().with_beyond(Beyond::Falling).closing_at(isovalue);
                    let bounds = field.closing_bounds();
                    (Box::new(Walled::new(field, bounds, isovalue)), bounds)
                };
                let grid = BoxGrid { bounds, spacing: whole.spacing() };
                preset.method.extract(&mut extractor, Source::Study(&*field), &grid, isovalue, &execution)
            });
            match (found, wanted) {
                (Ok(found), Ok(wanted)) => {
                    assert_same(&found, &wanted, &what);
                    compared += 1;
                }
                (found, wanted) => assert_eq!(found.err(), wanted.err(), "{what}"),
            }
        }
    }
    assert!(compared > 1000, "{compared}");
}

#[test]
fn random_volumes_are_the_same_from_elsewhere() {
    random_volumes(0..100);
}

#[test]
#[ignore = "minutes: run by make test-long"]
fn many_random_volumes_are_the_same_from_elsewhere() {
    let since = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH).unwrap();
    let seed = since.as_nanos() as u64 >> 8;
    println!("random_volumes({seed}..{})", seed + 10_000);
    random_volumes(seed..seed + 10_000);
}

/// An error says why, and the extractor is as good as before; the mesh is empty.
#[test]
fn samples_that_are_gone_are_an_error() {
    let counts = [20, 20, 80];
    let values = balls(counts, 3);
    let cells = VolumeCells { counts, values: &values, origin: [0.0; 3], steps: STEPS };
    let mut extractor = Extractor::new();
    for preset in presets().iter().filter(|preset| preset.method.is_of_cubes()) {
        for threads in [1, 3] {
            let execution = Execution { threads };
            for end in [0, 1, 40, 79] {
                let gone = Elsewhere { end, ..Elsewhere::new(counts, &values) };
                let error = cells
                    .extract_stored(&gone, &preset.method, &mut extractor, 0.25, &execution)
                    .unwrap_err();
                let is_said = matches!(
                    &error,
                    VolumeCellsError::Extract(MethodError::Extract(ExtractError::Unread(why)))
                        if why.to_string().starts_with("gone at [")
                );
                assert!(is_said && error.to_string().starts_with("gone at ["), "{}: {error}", preset.id);
            }
            let wanted = cells.extract(&preset.method, &mut Extractor::new(), 0.25, &execution).unwrap();
            let found = cells.extract(&preset.method, &mut extractor, 0.25, &execution).unwrap();
            assert_same(&found, &wanted, preset.id);
        }
    }
}

#[test]
fn samples_of_another_grid_are_refused() {
    let stored = Elsewhere::new([4, 5, 6], &[0.0; 120]);
    let cells = VolumeCells { counts: [4, 6, 5], values: &[], origin: [0.0; 3], steps: STEPS };
    let of = |id: &str| presets().iter().find(|preset| preset.id == id).unwrap().method;
    let (extractor, one) = (&mut Extractor::new(), &Execution { threads: 1 });
    let error = cells.extract_stored(&stored, &of("mc"), extractor, 0.0, one).unwrap_err();
    let wanted = ExtractError::StoredCounts { given: [4, 5, 6], wanted: [4, 6, 5] };
    assert_eq!(error, VolumeCellsError::Extract(MethodError::Extract(wanted)));
    let error = cells.extract_stored(&stored, &of("bi"), extractor, 0.0, one).unwrap_err();
    assert_eq!(error, VolumeCellsError::Method);
    let grid = BoxGrid { bounds: Bounds { min: Vec3::ZERO, max: Vec3::new(3.0, 4.0, 5.0) }, spacing: 1.0 };
    for (id, wanted) in [("dc", MethodError::NeedsField), ("macet", MethodError::NeedsField)] {
        let error = of(id).extract(extractor, Source::Stored(&stored), &grid, 0.0, one).unwrap_err();
        assert_eq!(error, wanted, "{id}");
    }
    let error = of("si-relaxed").extract(extractor, Source::Stored(&stored), &grid, 0.0, one).unwrap_err();
    assert!(matches!(error, MethodError::Extract(ExtractError::PlacementNeedsField { .. })), "{error}");
}

/// Chunks read their windows and nothing else, and weld to the mesh of the whole.
#[test]
fn chunks_of_stored_samples_are_those_of_samples() {
    let grid = BoxGrid { bounds: Bounds { min: Vec3::ZERO, max: Vec3::new(30.0, 20.0, 25.0) }, spacing: 1.0 };
    let counts = [31, 21, 26];
    let values = balls(counts, 4);
    let stored = Elsewhere::new(counts, &values);
    for id in ["mc33", "nets", "si", "sp"] {
        let method = presets().iter().find(|preset| preset.id == id).unwrap().method;
        let mut extractor =
            ChunkExtractor::in_box(&grid, &method, &ChunkSettings::default().with_isovalue(0.25)).unwrap();
        let mut chunks = Vec::new();
        for cells in extractor.grid(9) {
            let before = stored.read.load(Ordering::Relaxed);
            let chunk = extractor.extract(Source::Stored(&stored), cells, Control::default()).unwrap();
            let read = stored.read.load(Ordering::Relaxed) - before;
            if let Some(window) = extractor.window(cells).unwrap() {
                assert_eq!(read, window.size().iter().map(|&n| u64::from(n) + 1).product::<u64>(), "{id}");
            }
            let wanted = extractor.extract(Source::Samples(&values), cells, Control::default()).unwrap();
            assert_eq!(chunk.triangles, wanted.triangles, "{id}");
            assert_eq!(chunk.positions, wanted.positions, "{id}");
            chunks.push(chunk);
        }
        let whole = method
            .extract(&mut Extractor::new(), Source::Samples(&values), &grid, 0.25, &Execution { threads: 1 })
            .unwrap();
        // With edge collapse a chunk has the whole piece's numbers.
        if id != "sp" {
            assert_eq!(weld_chunks(&chunks).unwrap(), whole.mesh, "{id}");
        }
        let gone = Elsewhere { end: 3, ..Elsewhere::new(counts, &values) };
        let last = extractor.grid(9).last().unwrap();
        let error = extractor.extract(Source::Stored(&gone), last, Control::default()).unwrap_err();
        assert!(matches!(error, ChunkError::Extract(ExtractError::Unread(_))), "{id}: {error}");
        let other = Elsewhere::new([31, 26, 21], &values);
        let error = extractor.extract(Source::Stored(&other), last, Control::default()).unwrap_err();
        assert!(matches!(error, ChunkError::Extract(ExtractError::StoredCounts { .. })), "{id}: {error}");
    }
}

/// A lattice may have more points than 32 bits can name; a chunk's window may not.
#[test]
fn a_lattice_is_larger_than_a_chunk_may_be() {
    let bounds = Bounds { min: Vec3::ZERO, max: Vec3::splat(2047.0) };
    let grid = BoxGrid { bounds, spacing: 1.0 };
    let method = presets().iter().find(|preset| preset.id == "mc").unwrap().method;
    assert_eq!(method.cells(&grid), Ok([2047; 3]));
    let mut extractor = ChunkExtractor::in_box(&grid, &method, &ChunkSettings::default()).unwrap();
    let ball = isostudy_extract::from_fn(|p: [f32; 3]| 5.0 - Vec3::from(p).distance(Vec3::splat(2040.0)));
    let whole = isostudy_extract::CellBox { start: [0; 3], end: [2047; 3] };
    let error = extractor.extract(&ball, whole, Control::default()).unwrap_err();
    let limit = Lattice::MAX_SAMPLES_OF_CHUNK;
    let wanted = LatticeError::TooManySamples { samples: 2048u128.pow(3), limit };
    assert!(matches!(&error, ChunkError::Extract(ExtractError::Grid(of)) if *of == wanted), "{error}");
    let corner = isostudy_extract::CellBox { start: [2030; 3], end: [2047; 3] };
    let chunk = extractor.extract(&ball, corner, Control::default()).unwrap();
    assert!(chunk.triangles.len() > 300);
}
