//! How long it takes to find the cells of 100 isovalues of a volume, by bricks and by every structure that was published for it, and to make their triangles.
//!
//! ```sh
//! cargo bench --locked -p isostudy-volume --bench isovalues -- FILE       # a volume
//! cargo bench --locked -p isostudy-volume --bench isovalues -- head 256   # made up, of so many samples a side
//! ```
//!
//! Isovalues are spread evenly between the least and the greatest sample. Each search is done twice, on one thread; the shorter
//! of both sums counts. Prints a table for docs/isovalues.md.

mod structures;

use std::error::Error;
use std::path::Path;
use std::time::{Duration, Instant};

use isostudy_extract::active::{ActiveCells, Bricks, GridSamples};
use isostudy_extract::{Execution, Extractor, VolumeCells, presets};
use isostudy_volume::{NO_LIMIT, Volume};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use structures::{IntervalTree, KdTree, Octree, Scan, SeedSet, SpanSpace};

const ISOVALUES: usize = 100;
const TIMES: usize = 2;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> =
        // Cargo says `--bench` to every benchmark.
        std::env::args().skip(1).filter(|argument| argument != "--bench").collect();
    let volume = match &arguments[..] {
        [word, n] if word == "head" => head(n.parse()?),
        [file] => isostudy_volume::read(Path::new(file), NO_LIMIT)?,
        _ => return Err("arguments: FILE, or head N".into()),
    };
    let samples = GridSamples::try_new(volume.counts, &volume.values)?;
    let finite = || volume.values.iter().copied().filter(|value| value.is_finite());
    let (low, high) = (finite().fold(f32::MAX, f32::min), finite().fold(f32::MIN, f32::max));
    let at = |i: usize| low + (high - low) * (i as f32 + 0.5) / ISOVALUES as f32;
    let isovalues: Vec<f32> = (0..ISOVALUES).map(at).collect();
    let cells: usize = samples.cells().iter().product();
    println!("{:?} samples from {low} to {high}, {cells} cells\n", volume.counts);

    println!("| structure | made in | bytes per cell | {ISOVALUES} searches | per isovalue |");
    println!("|---|---:|---:|---:|---:|");
    let scan = timed("every cell", cells, &isovalues, || Ok(Scan::new(samples)))?;
    for found in [
        timed("bricks of 8 x 8 x 8", cells, &isovalues, || Ok(Bricks::try_new(samples)?))?,
        timed("octree", cells, &isovalues, || Ok(Octree::try_new(samples)?))?,
        timed("rows of span space", cells, &isovalues, || Ok(SpanSpace::try_new(samples)?))?,
        timed("k-d tree (NOISE)", cells, &isovalues, || Ok(KdTree::try_new(samples)?))?,
        timed("interval tree", cells, &isovalues, || Ok(IntervalTree::try_new(samples)?))?,
        timed("seeds", cells, &isovalues, || Ok(SeedSet::try_new(samples)?))?,
    ] {
        assert_eq!(found, scan, "active cells");
    }
    println!("\nactive cells of all isovalues: {scan}");
    println!("nodes of the octree: {}", Octree::try_new(samples)?.nodes());
    println!("seeds: {}\n", SeedSet::try_new(samples)?.seeds());

    println!("| extraction | sides of samples | triangles, normals included | triangles |");
    println!("|---|---:|---:|---:|");
    let own = VolumeCells {
        counts: volume.counts,
        values: &volume.values,
        origin: volume.origin,
        steps: volume.steps,
    };
    let bricks = own.bricks()?;
    for id in ["mc", "nets"] {
        let method = presets().iter().find(|preset| preset.id == id).ok_or("no such preset")?.method;
        for with_bricks in [false, true] {
            let mut extractor = Extractor::new();
            let (mut best, mut triangles) = ([Duration::MAX; 2], 0);
            for _ in 0..TIMES {
                let mut sums = [Duration::ZERO; 2];
                triangles = 0;
                for &isovalue in &isovalues {
                    let execution = Execution { threads: 1 };
                    let found = match with_bricks {
                        true => {
                            own.extract_by_bricks(&bricks, &method, &mut extractor, isovalue, &execution)?
                        }
                        false => own.extract(&method, &mut extractor, isovalue, &execution)?,
                    };
                    triangles += found.counts.triangles;
                    sums[0] += found.times.sampling;
                    sums[1] += found.times.total() - found.times.sampling;
                }
                if sums[0] + sums[1] < best[0].saturating_add(best[1]) {
                    best = sums;
                }
            }
            let by = if with_bricks { ", by bricks" } else { "" };
            println!("| `{id}`{by} | {} | {} | {triangles} |", ms(best[0]), ms(best[1]));
        }
    }
    Ok(())
}

/// Makes a structure, searches with it, and prints its row; returns how many cells were found.
fn timed<S: ActiveCells>(
    name: &str,
    cells: usize,
    isovalues: &[f32],
    make: impl Fn() -> Result<S, Box<dyn Error>>,
) -> Result<u64, Box<dyn Error>> {
    let began = Instant::now();
    let structure = make()?;
    let made = began.elapsed();
    let (mut best, mut count, mut found) = (Duration::MAX, 0, Vec::new());
    for _ in 0..TIMES {
        let began = Instant::now();
        count = 0;
        for &isovalue in isovalues {
            structure.find(isovalue, &mut found);
            count += found.len() as u64;
        }
        best = best.min(began.elapsed());
    }
    let bytes = structure.bytes() as f64 / cells as f64;
    println!("| {name} | {} | {bytes:.3} | {} | {} |", ms(made), ms(best), ms(best / isovalues.len() as u32));
    Ok(count)
}

fn ms(time: Duration) -> String {
    let ms = 1e3 * time.as_secs_f64();
    if ms < 10.0 { format!("{ms:.2} ms") } else { format!("{ms:.0} ms") }
}

/// A head in whole Hounsfield units: skin, fat, bone, brain, ventricles, with edges as wide as a sample and noise.
fn head(n: usize) -> Volume {
    let mut random = Pcg64Mcg::seed_from_u64(1);
    // Half axes in units of half the side, from outside in, and what is inside.
    let shells: [([f64; 3], f64); 6] = [
        ([0.80, 0.92, 0.90], 40.0),
        ([0.78, 0.90, 0.88], -90.0),
        ([0.74, 0.86, 0.84], 1300.0),
        ([0.71, 0.83, 0.81], 700.0),
        ([0.68, 0.80, 0.78], 35.0),
        ([0.12, 0.30, 0.20], 8.0),
    ];
    let mut sample = |i: usize| {
        let p = [i % n, i / n % n, i / n / n].map(|at| 2.0 * at as f64 / (n - 1) as f64 - 1.0);
        let mut value = -1000.0;
        for (axes, inside) in shells {
            let away = (0..3).map(|k| (p[k] / axes[k]).powi(2)).sum::<f64>().sqrt() - 1.0;
            // In samples, about.
            let share = (0.5 - away * axes[0] * n as f64 / 2.0).clamp(0.0, 1.0);
            value += (inside - value) * share;
        }
        let noise: f64 = (0..4).map(|_| random.random_range(-1.0..1.0)).sum::<f64>() * 12.0;
        (value + noise).round() as f32
    };
    let values = (0..n.pow(3)).map(&mut sample).collect();
    let steps = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    Volume { counts: [n; 3], origin: [0.0; 3], steps, values }
}
