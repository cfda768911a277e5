//! Times chunks of 32³ cells by isostudy beside those by fast-surface-nets: of the same samples, with normals, on one thread, in turns.
//! `cargo run --release --manifest-path scripts/peers/Cargo.toml --bin chunks-beside`. Times are CPU times of the thread, of all chunks of
//! a round. Each ratio is one time over that of fast-surface-nets in the same round: median and quartiles. Our normals have unit length, and
//! theirs do not yet. A word after the name of the program takes rows with that word alone, such as `hills`.
//!
//! First it looks whether both make the same: a vertex of `nets` in each cell that fast-surface-nets has one in, in the same place.

use std::collections::HashMap;
use std::error::Error;
use std::f32::consts::TAU;
use std::hint::black_box;

use fast_surface_nets::ndshape::{ConstShape, ConstShape3u32};
use fast_surface_nets::{SurfaceNetsBuffer, surface_nets};
use isostudy_extract::glam::DVec3;
use isostudy_extract::{
    CellBox, Chunk, ChunkExtractor, ChunkSettings, Control, Grid, Method, Normals, ScalarField, Source,
    from_fn, presets,
};
use isostudy_field::{Fractal, NoiseShape};
use rustix::time::{ClockId, clock_gettime};

const CELLS: u32 = 32;
const CHUNKS: i32 = 40;
const ROUNDS: usize = 31;
/// How many samples beyond the chunks are known.
const BEYOND: i32 = 4;
/// How far apart vertices of both may be, in cells.
const APART: f32 = 1e-3;

/// The samples of fast-surface-nets for as many edges as our chunk has.
type Padded = ConstShape3u32<34, 34, 34>;

fn main() -> Result<(), Box<dyn Error>> {
    let waves = Fractal::new(NoiseShape::Plain, 4, 0.5, 7);
    let hills = from_fn(move |[x, y, z]: [f32; 3]| {
        let place = DVec3::new(f64::from(x) / 40.0, f64::from(y) / 40.0, 0.5);
        12.0 * waves.value(place) as f32 - (z - 16.0)
    });
    let wave = TAU / 19.5;
    let gyroid = from_fn(move |p: [f32; 3]| {
        let [x, y, z] = p.map(|of| of * wave);
        x.sin() * y.cos() + y.sin() * z.cos() + z.sin() * x.cos()
    });
    let only = std::env::args().nth(1).unwrap_or_default();
    let settings = ChunkSettings::default();
    for (name, field, [nx, ny]) in
        [("hills", &hills as &dyn ScalarField, [8, 5]), ("gyroid", &gyroid, [4, 4])]
    {
        let ids: Vec<[i32; 3]> = (0..CHUNKS).map(|i| [i % nx, i / nx % ny, i / nx / ny]).collect();
        let sampled = Sampled::of(field, &ids);
        for (what, settings) in [
            // What fast-surface-nets makes, and no more.
            ("normals of samples, no keys", settings.with_normals(Normals::Samples).with_keys(false)),
            ("normals of samples", settings.with_normals(Normals::Samples)),
            ("normals of triangles", settings),
            ("no normals, no keys", settings.with_normals(Normals::None).with_keys(false)),
            ("no normals", settings.with_normals(Normals::None)),
        ] {
            let what = format!("{name}, {what}");
            if what.contains(&only) {
                beside(&what, &sampled, &ids, settings)?;
            }
        }
    }
    Ok(())
}

/// A field by its values at whole numbers, so that each is computed once.
struct Sampled {
    low: [i32; 3],
    size: [i32; 3],
    values: Vec<f32>,
}

impl Sampled {
    fn of(field: &dyn ScalarField, ids: &[[i32; 3]]) -> Self {
        let cells = CELLS as i32;
        let low = [0, 1, 2].map(|axis| cells * ids.iter().map(|id| id[axis]).min().unwrap_or(0) - BEYOND);
        let high =
            [0, 1, 2].map(|axis| cells * ids.iter().map(|id| id[axis] + 1).max().unwrap_or(0) + BEYOND);
        let size = [0, 1, 2].map(|axis| high[axis] - low[axis] + 1);
        let mut values = Vec::new();
        for z in low[2]..=high[2] {
            for y in low[1]..=high[1] {
                values.extend((low[0]..=high[0]).map(|x| field.sample([x, y, z].map(|i| i as f32))));
            }
        }
        Self { low, size, values }
    }
}

impl ScalarField for Sampled {
    fn sample(&self, p: [f32; 3]) -> f32 {
        let [x, y, z] = [0, 1, 2].map(|axis| p[axis] as i32 - self.low[axis]);
        self.values[((z * self.size[1] + y) * self.size[0] + x) as usize]
    }
}

/// One of ours, with its samples.
struct Ours {
    id: &'static str,
    extractor: ChunkExtractor,
    samples: Vec<(CellBox, CellBox, Vec<f32>)>,
    chunk: Chunk,
    triangles: usize,
}

fn beside(
    what: &str,
    field: &dyn ScalarField,
    ids: &[[i32; 3]],
    settings: ChunkSettings,
) -> Result<(), Box<dyn Error>> {
    let grid = Grid::try_new([0.0; 3], 1.0)?;
    let mut ours = Vec::new();
    for id in ["nets", "nets-manifold", "mc", "mc33"] {
        let method: Method = presets().iter().find(|of| of.id == id).ok_or("no such method")?.method;
        let extractor = ChunkExtractor::try_new(&grid, &method, &settings)?;
        let mut samples = Vec::new();
        for &id in ids {
            let cells = grid.chunk(id, CELLS);
            let window = extractor.window(cells)?.ok_or("no window")?;
            let mut of_window = Vec::new();
            extractor.layout(window)?.fill(field, &mut of_window);
            samples.push((cells, window, of_window));
        }
        ours.push(Ours { id, extractor, samples, chunk: Chunk::default(), triangles: 0 });
    }
    // From one cell below the chunk on: there is a vertex of a quadrilateral of each edge that the chunk has.
    let padded: Vec<Vec<f32>> = ids
        .iter()
        .map(|id| {
            let low = id.map(|i| i * CELLS as i32 - 1);
            let at = |i: u32| {
                let place = Padded::delinearize(i);
                [0, 1, 2].map(|axis| (low[axis] + place[axis] as i32) as f32)
            };
            (0..Padded::SIZE).map(|i| -field.sample(at(i))).collect()
        })
        .collect();
    let mut buffer = SurfaceNetsBuffer::default();
    let sides = ours.len() + 1;
    let mut times: Vec<Vec<f64>> = vec![Vec::new(); sides];
    let mut rivals_triangles = 0;
    // The first round makes room, compares what is made, and does not count.
    for round in 0..=ROUNDS {
        let mut of_round = vec![0.0; sides];
        for (i, &id) in ids.iter().enumerate() {
            // Each is first as often as any other.
            for turn in 0..sides {
                let which = (turn + i + round) % sides;
                let begin = now();
                match ours.get_mut(which) {
                    Some(Ours { extractor, samples, chunk, triangles, .. }) => {
                        let (cells, window, samples) = &samples[i];
                        let source = Source::Window { cells: *window, samples };
                        extractor.extract_into(source, *cells, Control::default(), chunk)?;
                        black_box(&*chunk);
                        if round == 0 {
                            *triangles += chunk.triangles.len();
                        }
                    }
                    None => {
                        surface_nets(&padded[i], &Padded {}, [0; 3], [33; 3], &mut buffer);
                        black_box(&buffer);
                        if round == 0 {
                            rivals_triangles += buffer.indices.len() / 3;
                        }
                    }
                }
                of_round[which] += now() - begin;
            }
            if round == 0 {
                surface_nets(&padded[i], &Padded {}, [0; 3], [33; 3], &mut buffer);
                compare(&ours[0].chunk, &buffer, id, settings.normals)?;
            }
        }
        if round > 0 {
            times.iter_mut().zip(of_round).for_each(|(times, time)| times.push(time / ids.len() as f64));
        }
    }
    let rival = times.pop().unwrap_or_default();
    println!("{what}: ms, triangles, over fast-surface-nets");
    let report = |name: &str, times: &[f64], triangles: usize| {
        let ratios = times.iter().zip(&rival).map(|(time, rival)| time / rival).collect();
        let [low, middle, high] = quartiles(ratios);
        let ms = 1e3 * quartiles(times.to_vec())[1];
        println!("  {name:<18} {ms:.3} {triangles:>6} {middle:.2} ({low:.2} to {high:.2})");
    };
    report("fast-surface-nets", &rival, rivals_triangles / ids.len());
    for (of, times) in ours.iter().zip(&times) {
        report(of.id, times, of.triangles / ids.len());
    }
    Ok(())
}

/// That each vertex of ours is one of theirs.
fn compare(
    chunk: &Chunk,
    buffer: &SurfaceNetsBuffer,
    id: [i32; 3],
    normals: Normals,
) -> Result<(), Box<dyn Error>> {
    let low = id.map(|i| i * CELLS as i32 - 1);
    let theirs: HashMap<[i32; 3], usize> = buffer
        .surface_points
        .iter()
        .enumerate()
        .map(|(v, cell)| ([0, 1, 2].map(|axis| low[axis] + cell[axis] as i32), v))
        .collect();
    for (v, key) in chunk.keys.iter().enumerate() {
        let other = *theirs.get(&key.cell()).ok_or("a vertex that fast-surface-nets has not")?;
        let [ours, there] = [chunk.positions[v], buffer.positions[other]];
        if (0..3).any(|axis| (ours[axis] - low[axis] as f32 - there[axis]).abs() > APART) {
            return Err(format!("a vertex at {ours:?}, where fast-surface-nets has {there:?}").into());
        }
        if normals == Normals::Samples {
            let [ours, mut there] = [chunk.normals[v], buffer.normals[other]];
            let length = there.map(|n| n * n).iter().sum::<f32>().sqrt();
            there = there.map(|n| n / length);
            if (0..3).any(|axis| (ours[axis] - there[axis]).abs() > APART) {
                return Err(format!("a normal {ours:?}, where fast-surface-nets has {there:?}").into());
            }
        }
    }
    Ok(())
}

fn now() -> f64 {
    let at = clock_gettime(ClockId::ThreadCPUTime);
    at.tv_sec as f64 + 1e-9 * at.tv_nsec as f64
}

fn quartiles(mut values: Vec<f64>) -> [f64; 3] {
    values.sort_unstable_by(f64::total_cmp);
    [1, 2, 3].map(|quarter| values[quarter * (values.len() - 1) / 4])
}
