//! What each call of docs/engine.md costs: medians over the chunks of a terrain, on one thread.
//!
//! `cargo run --release -p isostudy-extract --example chunk_costs`

#[path = "browser/src/ground.rs"]
mod ground;

use std::hint::black_box;
use std::sync::Mutex;
use std::time::Instant;

use ground::{Ground, Hole};
use isostudy_extract::{
    Aabb, Arrangement, Bound, CellBox, Chunk, ChunkExtractor, ChunkSettings, Control, Grid, Method, Normals,
    Placement, ScalarField, Source, Tetrahedra, from_fn, presets,
};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let grid = Grid::try_new([0.0; 3], 1.0)?;
    let ground = Ground::default();
    let unbounded = from_fn(|p| ground.sample(p));
    let ids = || (0..100).map(|i| [i % 10 - 5, i / 10 - 5, 0]);
    for arrangement in [Arrangement::BodyCentred, Arrangement::SimpleCubic] {
        println!("{arrangement}, integrated, chunks of 32³ cells:");
        let plain = Tetrahedra::new(arrangement);
        let relaxed = plain.with_placement(Placement::Relaxed);
        let settings = ChunkSettings::default();
        for (what, method, settings, field) in [
            ("with a bound", plain, settings, Source::from(&ground)),
            ("without", plain, settings, Source::from(&unbounded)),
            (
                "with a bound, normals of the field",
                plain,
                settings.with_normals(Normals::Field),
                Source::from(&ground),
            ),
            ("with a bound, relaxed", relaxed, settings, Source::from(&ground)),
        ] {
            let mut extractor = ChunkExtractor::try_new(&grid, &Method::Tetrahedra(method), &settings)?;
            let mut chunk = Chunk::default();
            timed(what, ids().map(|id| grid.chunk(id, 32)), |cells| {
                extractor.extract_into(field, cells, Control::default(), &mut chunk).is_ok()
            });
        }
        let method = Method::Tetrahedra(plain);
        let mut extractor = ChunkExtractor::try_new(&grid, &method, &settings)?;
        let (mut chunk, mut samples, mut of_samples) = (Chunk::default(), Vec::new(), Vec::new());
        for id in ids() {
            let cells = grid.chunk(id, 32);
            let window = method.window(cells).ok_or("no edge is collapsed")?;
            extractor.layout(window)?.fill(&ground, &mut samples);
            let start = Instant::now();
            let source = Source::Window { cells: window, samples: &samples };
            extractor.extract_into(source, cells, Control::default(), &mut chunk)?;
            of_samples.push(start.elapsed().as_secs_f64() * 1e3);
        }
        report("samples given", &mut of_samples);
        let sky = ids().map(|[x, y, _]| grid.chunk([x, y, 9], 32));
        timed("an empty one, with a bound", sky, |cells| {
            extractor.extract_into(&ground, cells, Control::default(), &mut chunk).is_ok()
        });
        let hole = Hole { centre: [3.0, 7.0, ground.height(3.0, 7.0)], radius: 3.0 };
        timed("touched by a hole of 3", ids(), |_| {
            grid.touched(hole.reach(), 32, &method).is_ok_and(|touched| black_box(touched.count()) > 0)
        });
        let cells: CellBox = grid.chunk([0, 0, 0], 32);
        extractor.extract_into(&ground, cells, Control::default(), &mut chunk)?;
        let (mut relative, mut indices) = (Vec::new(), Vec::new());
        timed("relative positions and 16-bit indices", ids(), |_| {
            chunk.relative_positions(&mut relative);
            chunk.indices_u16(&mut indices).is_ok()
        });
    }
    // Tables are made once for the process, so each method has one chance to show its first chunk.
    for (preset, warmed) in [
        ("mc33", true),
        ("mc", true),
        ("nets", true),
        ("bi", true),
        ("mc-quality", false),
        ("nets-manifold", false),
    ] {
        let method = presets().iter().find(|of| of.id == preset).ok_or("a preset")?.method;
        let mut extractor = ChunkExtractor::try_new(&grid, &method, &ChunkSettings::default())?;
        let mut warming = 0.0;
        if warmed {
            let start = Instant::now();
            extractor.warm_up(32)?;
            warming = start.elapsed().as_secs_f64() * 1e3;
        }
        let mut chunk = Chunk::default();
        let cells = grid.chunk([0, 0, 0], 32);
        let start = Instant::now();
        extractor.extract_into(&ground, cells, Control::default(), &mut chunk)?;
        let first = start.elapsed().as_secs_f64() * 1e3;
        let start = Instant::now();
        extractor.extract_into(&ground, cells, Control::default(), &mut chunk)?;
        let second = start.elapsed().as_secs_f64() * 1e3;
        println!(
            "{preset}: warm-up {warming:.2} ms, first chunk {first:.2} ms, the same again {second:.2} ms"
        );
    }
    for preset in ["mc", "nets", "nets-manifold", "dc", "dc-in-cell"] {
        println!("{preset}, chunks of 32³ cells:");
        let method = presets().iter().find(|of| of.id == preset).ok_or("a preset")?.method;
        let mut extractor = ChunkExtractor::try_new(&grid, &method, &ChunkSettings::default())?;
        let mut chunk = Chunk::default();
        for (what, field) in [("with a bound", Source::from(&ground)), ("without", Source::from(&unbounded))]
        {
            timed(what, ids().map(|id| grid.chunk(id, 32)), |cells| {
                extractor.extract_into(field, cells, Control::default(), &mut chunk).is_ok()
            });
        }
    }
    // What of that are calls of the field.
    for preset in ["mc", "nets", "dc"] {
        let method = presets().iter().find(|of| of.id == preset).ok_or("a preset")?.method;
        let counted = Counted { ground: &ground, points: Mutex::default(), boxes: Mutex::default() };
        let mut extractor = ChunkExtractor::try_new(&grid, &method, &ChunkSettings::default())?;
        let mut chunk = Chunk::default();
        let mut vertices = 0;
        for id in ids() {
            extractor.extract_into(&counted, grid.chunk(id, 32), Control::default(), &mut chunk)?;
            vertices += chunk.positions.len();
        }
        let points = counted.points.into_inner()?;
        let start = Instant::now();
        points.iter().for_each(|p| _ = black_box(ground.sample(*p)));
        let ms = start.elapsed().as_secs_f64() * 1e3;
        let boxes = counted.boxes.into_inner()?;
        let start = Instant::now();
        boxes.iter().for_each(|b| _ = black_box(ground.bound(*b)));
        let boxes_ms = start.elapsed().as_secs_f64() * 1e3;
        let of_each = |sum: f64| sum / ids().count() as f64;
        println!(
            "{preset}: per chunk {} vertices, {} values of the field, which take {:.2} ms alone, {} bounds, {:.2} ms",
            of_each(vertices as f64),
            of_each(points.len() as f64),
            of_each(ms),
            of_each(boxes.len() as f64),
            of_each(boxes_ms)
        );
    }
    // What no method can do without that takes every sample.
    let method = Method::Tetrahedra(Tetrahedra::new(Arrangement::SimpleCubic));
    let extractor = ChunkExtractor::try_new(&grid, &method, &ChunkSettings::default())?;
    let mut samples = Vec::new();
    timed("33³ samples and nothing else", ids(), |id| {
        let layout = extractor.layout(grid.chunk(id, 32));
        layout.map(|layout| layout.fill(&ground, &mut samples)).is_ok()
    });
    Ok(())
}

/// The ground, with every point and every box that is asked for.
struct Counted<'a> {
    ground: &'a Ground,
    points: Mutex<Vec<[f32; 3]>>,
    boxes: Mutex<Vec<Aabb>>,
}

impl ScalarField for Counted<'_> {
    fn sample(&self, p: [f32; 3]) -> f32 {
        self.points.lock().expect("no thread panics").push(p);
        self.ground.sample(p)
    }

    fn bound(&self, bounds: Aabb) -> Bound {
        self.boxes.lock().expect("no thread panics").push(bounds);
        self.ground.bound(bounds)
    }
}

fn timed<T>(what: &str, items: impl Iterator<Item = T>, mut work: impl FnMut(T) -> bool) {
    let mut times: Vec<f64> = items
        .map(|item| {
            let start = Instant::now();
            assert!(work(item), "{what} fails");
            start.elapsed().as_secs_f64() * 1e3
        })
        .collect();
    report(what, &mut times);
}

fn report(what: &str, times: &mut [f64]) {
    times.sort_unstable_by(f64::total_cmp);
    println!("  {what}: median {:.4} ms, longest {:.2} ms", times[times.len() / 2], times[times.len() - 1]);
}
