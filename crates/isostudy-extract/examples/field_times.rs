//! Best-of-many CPU times from field to mesh, one thread, with sampling only where the surface can be.
//! Arguments: cells along an axis, repetitions, part of a case's name. The bunny is at the paper's lattice.

#[path = "../tests/it/bunny.rs"]
mod bunny;

use bunny::{BOX, bunny};
use glam::Vec3;
use isostudy_extract::by_lattice::{ExtractSettings, Lattice};
use isostudy_extract::{Arrangement, Execution, Extraction, Extractor, Source};
use isostudy_field::{Asteroid, Gyroid, MeshDistance, Sphere, StudyField};
use isostudy_mesh::Bounds;
use std::sync::atomic::{AtomicUsize, Ordering};

struct Counting<'a>(&'a dyn StudyField, &'a AtomicUsize);

impl StudyField for Counting<'_> {
    fn sample(&self, p: Vec3) -> f32 {
        self.1.fetch_add(1, Ordering::Relaxed);
        self.0.sample(p)
    }
    fn slope(&self, bounds: Bounds) -> Option<f32> {
        self.0.slope(bounds)
    }
    fn range(&self, bounds: Bounds, value: f32) -> Option<(f32, f32)> {
        self.0.range(bounds, value)
    }
}

/// Time this thread has run, which other work on the machine does not add to.
fn cpu_ms() -> f64 {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").expect("Linux");
    text.split(' ').next().and_then(|ns| ns.parse::<f64>().ok()).expect("a number") / 1e6
}

fn main() {
    let mut arguments = std::env::args().skip(1);
    let cells: u32 = arguments.next().map_or(256, |a| a.parse().unwrap());
    let repetitions: usize = arguments.next().map_or(10, |a| a.parse().unwrap());
    let wanted = arguments.next().unwrap_or_default();
    let cube = Bounds { min: Vec3::NEG_ONE, max: Vec3::ONE };
    let spacing = 2.0 / cells as f32;
    let bunny = bunny().map(|mesh| MeshDistance::try_new(&mesh).unwrap());
    let mut cases: Vec<(&str, &dyn StudyField, Bounds, f32)> = vec![
        ("sphere 0.8", &Sphere { radius: 0.8 }, cube, spacing),
        (
            "asteroid",
            const {
                &Asteroid {
                    radius: 0.65,
                    stretch: Vec3::new(0.9, 1.0, 0.9),
                    amplitude: 0.35,
                    frequency: 1.5,
                    octaves: 3,
                    lacunarity: 3.0,
                    gain: 0.15,
                }
            },
            cube,
            spacing,
        ),
        ("gyroid", &Gyroid { frequency: 9.424778 }, cube, spacing),
    ];
    if let Some(bunny) = &bunny {
        cases.push(("bunny", bunny, BOX, 0.02));
    }
    for arrangement in [Arrangement::BodyCentred, Arrangement::SimpleCubic] {
        for &(name, field, bounds, spacing) in &cases {
            if !format!("{arrangement:?} {name}").contains(&wanted) {
                continue;
            }
            let lattice = Lattice::try_new(arrangement, bounds, spacing).unwrap();
            let (settings, execution) = (ExtractSettings::default(), Execution { threads: 1 });
            let (mut extractor, mut extraction) = (Extractor::new(), Extraction::default());
            let mut all = Vec::new();
            let mut best: Option<(f64, isostudy_extract::StageTimes)> = None;
            for _ in 0..repetitions {
                let start = cpu_ms();
                extractor
                    .extract_into(Source::Study(field), &lattice, &settings, &execution, &mut extraction)
                    .unwrap();
                let ms = cpu_ms() - start;
                all.push(ms);
                if best.is_none_or(|b| ms < b.0) {
                    best = Some((ms, extraction.times));
                }
            }
            let taken = AtomicUsize::new(0);
            let mut kept = isostudy_field::FieldCache::default();
            let prepared = field.prepared(&mut kept);
            let counting = Counting(prepared.unwrap_or(field), &taken);
            extractor.extract(Source::Study(&counting), &lattice, &settings, &execution).unwrap();
            all.sort_by(f64::total_cmp);
            let median = all[all.len() / 2];
            let (ms, times) = best.unwrap();
            println!(
                "{arrangement:?} {name}: {ms:.1} ms, median {median:.1} ms, sampling {:.1}, {} samples of {}, T {}",
                times.sampling.as_secs_f64() * 1e3,
                taken.load(Ordering::Relaxed),
                lattice.stored_samples(),
                extraction.counts.triangles
            );
        }
    }
}
