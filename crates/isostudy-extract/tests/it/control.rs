//! How an extraction is run: it ends when it is told to, starts no thread unasked, and does its work on threads of others.

use std::num::NonZeroUsize;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::thread::ThreadId;

use glam::Vec3;
use isostudy_extract::by_lattice::ExtractSettings;
use isostudy_extract::{
    Arrangement, BoxGrid, CellBox, Chunk, ChunkError, ChunkExtractor, ChunkSettings, Clustering, Control,
    Cubes, ExtractError, Extractor, Grid, Jobs, Method, Normals, Positions, Source, Tetrahedra, Threads,
    from_fn,
};
use isostudy_field::{Sphere, StudyField};
use isostudy_mesh::Bounds;

const BOX: BoxGrid =
    BoxGrid { bounds: Bounds { min: Vec3::splat(-1.1), max: Vec3::splat(1.1) }, spacing: 0.03 };

fn ball([x, y, z]: [f32; 3]) -> f32 {
    1.0 - (x * x + y * y + z * z).sqrt()
}

fn method(arrangement: Arrangement) -> Method {
    let clustering =
        if arrangement.supports(Clustering::Integrated) { Clustering::Integrated } else { Clustering::None };
    Method::Tetrahedra(Tetrahedra::new(arrangement).with_clustering(clustering))
}

fn chunks() -> (ChunkExtractor, CellBox) {
    chunks_by(&method(Arrangement::BodyCentred))
}

fn chunks_by(method: &Method) -> (ChunkExtractor, CellBox) {
    let grid = Grid::try_new([0.0; 3], 0.05).unwrap();
    let extractor = ChunkExtractor::try_new(&grid, method, &ChunkSettings::default());
    (extractor.unwrap(), CellBox { start: [0; 3], end: [30; 3] })
}

#[test]
fn a_chunk_that_is_cancelled_is_an_error_and_the_extractor_as_good_as_new() {
    let tetrahedra = Arrangement::ALL.map(method);
    for method in tetrahedra.iter().chain([&Method::Cubes(Cubes::default())]) {
        cancel_and_go_on(method);
    }
}

fn cancel_and_go_on(method: &Method) {
    let (mut extractor, cells) = chunks_by(method);
    let cancel = AtomicBool::new(false);
    let calls = AtomicUsize::new(0);
    let impatient = from_fn(|p| {
        if calls.fetch_add(1, Ordering::Relaxed) == 2000 {
            cancel.store(true, Ordering::Relaxed);
        }
        ball(p)
    });
    let control = Control::default().with_cancel(&cancel);
    let mut chunk = Chunk::default();
    let error = extractor.extract_into(&impatient, cells, control, &mut chunk).unwrap_err();
    assert_eq!(error, ChunkError::Extract(ExtractError::Cancelled));
    assert_eq!(chunk, Chunk::default());
    let until_then = calls.load(Ordering::Relaxed);
    assert!(until_then < 20_000, "{until_then} samples: it went on");
    // Before it begins, too.
    assert!(extractor.extract(&from_fn(ball), cells, control).is_err());
    cancel.store(false, Ordering::Relaxed);
    let again = extractor.extract(&from_fn(ball), cells, control).unwrap();
    assert_eq!(again, chunks_by(method).0.extract(&from_fn(ball), cells, Control::default()).unwrap());
}

/// A whole mesh, every way of extraction, on threads that are started and without.
#[test]
fn a_whole_mesh_that_is_cancelled_is_an_error() {
    for arrangement in Arrangement::ALL {
        let lattice = BOX.lattice(arrangement).unwrap();
        let mut all = vec![(Threads::Here, Positions::Indexed), (scoped(2), Positions::Indexed)];
        if arrangement == Arrangement::BodyCentred {
            all.push((scoped(2), Positions::Accumulated { chunks: 1 }));
        }
        for (threads, positions) in all {
            let settings =
                ExtractSettings::default().with_positions(positions).with_clustering(Clustering::None);
            let cancel = AtomicBool::new(false);
            let calls = AtomicUsize::new(0);
            let impatient = from_fn(|p| {
                if calls.fetch_add(1, Ordering::Relaxed) == 5000 {
                    cancel.store(true, Ordering::Relaxed);
                }
                ball(p)
            });
            let control = Control::default().with_threads(threads).with_cancel(&cancel);
            let mut extractor = Extractor::new();
            let source = Source::from(&impatient);
            let error = extractor.extract(source, &lattice, &settings, control).unwrap_err();
            assert_eq!(error, ExtractError::Cancelled, "{arrangement} {threads:?}");
            cancel.store(false, Ordering::Relaxed);
            calls.store(10_000, Ordering::Relaxed);
            let mesh = extractor.extract(source, &lattice, &settings, control).unwrap().mesh;
            let fresh =
                Extractor::new().extract(source, &lattice, &settings, Control::default()).unwrap().mesh;
            assert_eq!(mesh, fresh, "{arrangement} {threads:?}");
        }
    }
}

fn scoped(threads: usize) -> Threads<'static> {
    Threads::Scoped(NonZeroUsize::new(threads).unwrap())
}

#[test]
fn a_chunk_stays_on_the_thread_that_asks_for_it() {
    let seen = Mutex::new(Vec::<ThreadId>::new());
    let watching = from_fn(|p| {
        seen.lock().unwrap().push(std::thread::current().id());
        ball(p)
    });
    let (mut extractor, cells) = chunks();
    extractor.extract(&watching, cells, Control::default()).unwrap();
    let here = std::thread::current().id();
    let seen = seen.into_inner().unwrap();
    assert!(seen.len() > 1000 && seen.iter().all(|&id| id == here));
}

/// A job system of two threads that counts what it is given.
struct Two(AtomicUsize);

impl Jobs for Two {
    fn threads(&self) -> NonZeroUsize {
        NonZeroUsize::new(2).unwrap()
    }

    fn run(&self, job: &(dyn Fn(usize) + Sync)) {
        self.0.fetch_add(1, Ordering::Relaxed);
        std::thread::scope(|scope| {
            scope.spawn(|| job(1));
            job(0);
        });
    }
}

#[test]
fn threads_of_others_make_the_same_mesh() {
    for arrangement in Arrangement::ALL {
        let lattice = BOX.lattice(arrangement).unwrap();
        let Method::Tetrahedra(tetrahedra) = method(arrangement) else { panic!("a new family") };
        let settings = tetrahedra.settings(0.0);
        let ball = from_fn(ball);
        let mesh = |control: Control| {
            Extractor::new().extract((&ball).into(), &lattice, &settings, control).unwrap().mesh
        };
        let jobs = Two(AtomicUsize::new(0));
        let here = mesh(Control::default());
        assert_eq!(mesh(Control::default().with_threads(Threads::Jobs(&jobs))), here, "{arrangement}");
        assert!(jobs.0.load(Ordering::Relaxed) >= 2, "{arrangement}: for the mesh and for its normals");
        assert_eq!(mesh(Control::default().with_threads(scoped(3))), here, "{arrangement}");
    }
}

#[test]
fn progress_ends_with_all_layers() {
    for arrangement in [Arrangement::BodyCentred, Arrangement::FaceCentred] {
        let told = Mutex::new(Vec::new());
        let progress = |done, all| told.lock().unwrap().push((done, all));
        let Method::Tetrahedra(tetrahedra) = method(arrangement) else { panic!("a new family") };
        let lattice = BOX.lattice(arrangement).unwrap();
        let control = Control::default().with_progress(&progress);
        let ball = from_fn(ball);
        Extractor::new().extract((&ball).into(), &lattice, &tetrahedra.settings(0.0), control).unwrap();
        let told = told.into_inner().unwrap();
        let all = told[0].1;
        assert!(all > 50 && told.iter().map(|t| t.0).eq(1..=all), "{arrangement}");
    }
}

#[test]
fn a_field_that_panics_leaves_the_extractor_as_good_as_new() {
    let (mut extractor, cells) = chunks();
    let calls = AtomicUsize::new(0);
    let fragile = from_fn(|p| {
        assert!(calls.fetch_add(1, Ordering::Relaxed) < 3000, "out of patience");
        ball(p)
    });
    let failed = catch_unwind(AssertUnwindSafe(|| extractor.extract(&fragile, cells, Control::default())));
    assert!(failed.is_err());
    let again = extractor.extract(&from_fn(ball), cells, Control::default()).unwrap();
    assert_eq!(again, chunks().0.extract(&from_fn(ball), cells, Control::default()).unwrap());
}

/// A ball that knows its gradient.
struct Knowing;

impl isostudy_extract::ScalarField for Knowing {
    fn sample(&self, p: [f32; 3]) -> f32 {
        ball(p)
    }

    fn gradient(&self, p: [f32; 3]) -> Option<[f32; 3]> {
        Some((-Vec3::from(p).normalize()).to_array())
    }
}

#[test]
fn normals_come_from_where_the_settings_say() {
    let (_, cells) = chunks();
    let grid = Grid::try_new([0.0; 3], 0.05).unwrap();
    let worst = |normals: Normals, source: Source| {
        let settings = ChunkSettings::default().with_normals(normals);
        let mut extractor =
            ChunkExtractor::try_new(&grid, &method(Arrangement::SimpleCubic), &settings).unwrap();
        let chunk = extractor.extract(source, cells, Control::default()).unwrap();
        assert_eq!(chunk.normals.len(), if normals == Normals::None { 0 } else { chunk.positions.len() });
        let off = |(p, n): (&[f32; 3], &[f32; 3])| Vec3::from(*n).distance(Vec3::from(*p).normalize());
        chunk.positions.iter().zip(&chunk.normals).map(off).fold(0.0, f32::max)
    };
    let sampled = from_fn(ball);
    let of_triangles = worst(Normals::Triangles, Source::from(&sampled));
    let of_samples = worst(Normals::Field, Source::from(&sampled));
    let of_gradient = worst(Normals::Field, Source::from(&Knowing));
    assert!(of_gradient < 1e-6 && of_samples < 1e-3, "{of_gradient} {of_samples}");
    assert!((0.005..0.2).contains(&of_triangles), "{of_triangles}: cells are a twentieth of the radius");
    assert_eq!(worst(Normals::None, Source::from(&sampled)), 0.0);
    let settings = ChunkSettings::default().with_normals(Normals::Field);
    let mut extractor = ChunkExtractor::try_new(&grid, &method(Arrangement::SimpleCubic), &settings).unwrap();
    let window = extractor.window(cells).unwrap().unwrap();
    let samples = vec![0.0; extractor.layout(window).unwrap().len()];
    let error =
        extractor.extract(Source::Window { cells: window, samples: &samples }, cells, Control::default());
    assert_eq!(error.unwrap_err(), ChunkError::NormalsNeedField);
}

/// What a game stores in its own structures and sends to its own threads.
#[test]
fn what_a_game_keeps_can_go_to_another_thread() {
    fn assert_send<T: Send + std::fmt::Debug>() {}
    fn assert_sync<T: Sync>() {}
    assert_send::<ChunkExtractor>();
    assert_send::<Chunk>();
    assert_sync::<Chunk>();
    assert_sync::<Grid>();
    // Fields behind pointers are fields.
    let shared = std::sync::Arc::new(Knowing);
    let boxed: Box<dyn isostudy_extract::ScalarField + Send + Sync> = Box::new(Knowing);
    let study: &dyn StudyField = &Sphere { radius: 1.0 };
    let (mut extractor, cells) = chunks();
    let mut triangles =
        |source: Source| extractor.extract(source, cells, Control::default()).unwrap().triangles;
    let expected = triangles(Source::from(&Knowing));
    assert_eq!(triangles(Source::from(&shared)), expected);
    assert_eq!(triangles(Source::from(&boxed)), expected);
    assert_eq!(triangles(Source::from(&&Knowing)), expected);
    assert_eq!(triangles(Source::from(study)), expected);
}
