//! Extracts given samples as often as it is told, and says how long it took: the half of `scripts/flying-edges.sh` that is ours.
//!
//! `given_samples FIELD N FILE` writes N^3 samples of a field to a file, little-endian floats, x fastest. For each line `METHOD THREADS`
//! of its input it then extracts once, into new memory, and prints wall-clock milliseconds, those of the CPU time of its first thread,
//! vertices and triangles. `sum 1` adds all samples up, the least that reads each of them once. Normals are not in the times: of the CPU time, their share of the wall-clock time is taken off.

mod given;

use std::collections::BTreeMap;
use std::error::Error;
use std::io::BufRead;
use std::time::Instant;

use given::{cpu_ms, samples};
use glam::Vec3;
use isostudy_extract::{Arrangement, BoxGrid, Execution, Extractor, Method, Source, presets};
use isostudy_field::{Asteroid, Gyroid, Sphere, StudyField};
use isostudy_mesh::Bounds;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [name, n, path] = &arguments[..] else { return Err("arguments: FIELD N FILE".into()) };
    let n: usize = n.parse()?;
    let field: &dyn StudyField = match name.as_str() {
        "sphere" => &Sphere { radius: 0.8 },
        "asteroid" => &Asteroid::default(),
        "gyroid" => &Gyroid::default(),
        other => return Err(format!("{other}: must be sphere, asteroid or gyroid").into()),
    };
    let bounds = Bounds { min: Vec3::NEG_ONE, max: Vec3::ONE };
    let grid = BoxGrid { bounds, spacing: 2.0 / (n - 1) as f32 };
    let of = |arrangement| Ok::<_, Box<dyn Error>>(samples(field, &grid.lattice(arrangement)?));
    let corners = of(Arrangement::SimpleCubic)?;
    if corners.len() != n.pow(3) {
        return Err(format!("the lattice has {} samples, not {n}^3", corners.len()).into());
    }
    std::fs::write(path, corners.iter().flat_map(|value| value.to_le_bytes()).collect::<Vec<u8>>())?;
    let mut body_centred = None;
    let mut extractors = BTreeMap::new();
    for line in std::io::stdin().lock().lines() {
        let line = line?;
        let (id, threads) = line.split_once(' ').ok_or("a line says METHOD THREADS")?;
        if id == "sum" {
            println!("{}", sum_times(&corners));
            continue;
        }
        let preset = presets().iter().find(|preset| preset.id == id).ok_or("no such preset")?;
        let values = match preset.method {
            Method::Tetrahedra(tetrahedra) if tetrahedra.arrangement == Arrangement::BodyCentred => {
                if body_centred.is_none() {
                    body_centred = Some(of(Arrangement::BodyCentred)?);
                }
                body_centred.as_ref().expect("it was just made")
            }
            _ => &corners,
        };
        let execution = Execution { threads: threads.parse()? };
        let extractor: &mut Extractor = extractors.entry(line.clone()).or_default();
        let start = cpu_ms();
        let found = preset.method.extract(extractor, Source::Samples(values), &grid, 0.0, &execution)?;
        let cpu = cpu_ms() - start;
        let [all, normals] = [found.times.total(), found.times.normals].map(|time| time.as_secs_f64() * 1e3);
        let (vertices, triangles) = (found.counts.vertices, found.counts.triangles);
        println!("{:.4} {:.4} {vertices} {triangles}", all - normals, cpu * (1.0 - normals / all));
    }
    Ok(())
}

/// What adding all samples up takes, in eight sums, so that the CPU waits for memory and not for additions. A mean over several times,
/// since the system counts CPU time in steps that are longer than once.
fn sum_times(samples: &[f32]) -> String {
    const TIMES: u32 = 16;
    let (cpu, start) = (cpu_ms(), Instant::now());
    for _ in 0..TIMES {
        let mut sums = [0.0f32; 8];
        for eight in std::hint::black_box(samples).chunks_exact(8) {
            sums.iter_mut().zip(eight).for_each(|(sum, value)| *sum += value);
        }
        std::hint::black_box(sums);
    }
    let [wall, cpu] = [start.elapsed().as_secs_f64() * 1e3, cpu_ms() - cpu].map(|ms| ms / f64::from(TIMES));
    format!("{wall:.4} {cpu:.4} 0 0")
}
