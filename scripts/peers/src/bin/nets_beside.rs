//! Times isostudy's surface nets beside fast-surface-nets and beside isostudy's marching cubes, on the same samples, one thread, in turns:
//! `cargo run --release --manifest-path scripts/peers/Cargo.toml --bin nets-beside -- 128 256`. Each number is a time divided by that of
//! `nets` in the same round: median and quartiles.

use std::error::Error;
use std::hint::black_box;
use std::time::Instant;

use isostudy_extract::{BoxGrid, Execution, Extraction, Extractor, Method, Source, presets};
use fast_surface_nets::ndshape::RuntimeShape;
use fast_surface_nets::{SurfaceNetsBuffer, surface_nets};
use isostudy_field::{Gyroid, Sphere, StudyField};
use isostudy_mesh::Bounds;
use isostudy_mesh::glam::Vec3;

const ROUNDS: usize = 31;

fn main() -> Result<(), Box<dyn Error>> {
    let sizes: Result<Vec<usize>, _> = std::env::args().skip(1).map(|text| text.parse()).collect();
    let method =
        |id: &str| presets().iter().find(|of| of.id == id).map(|of| of.method).ok_or("no such method");
    let ours =
        [("nets", method("nets")?), ("nets-manifold", method("nets-manifold")?), ("mc", method("mc")?)];
    println!("times, normals included, over that of nets: median (quartiles) of {ROUNDS} rounds, one thread");
    for n in sizes? {
        let gyroid = Gyroid { frequency: 1.5 * std::f32::consts::TAU };
        for (name, field) in [("sphere", &Sphere { radius: 0.8013 } as &dyn StudyField), ("gyroid", &gyroid)]
        {
            beside(name, field, n, &ours)?;
        }
    }
    Ok(())
}

fn beside(
    name: &str,
    field: &dyn StudyField,
    n: usize,
    ours: &[(&str, Method)],
) -> Result<(), Box<dyn Error>> {
    let step = 2.0 / (n - 1) as f32;
    let grid = BoxGrid { bounds: Bounds { min: Vec3::NEG_ONE, max: Vec3::ONE }, spacing: step };
    let at = |i: usize| Vec3::from_array([i % n, i / n % n, i / n / n].map(|x| x as f32 * step - 1.0));
    let samples: Vec<f32> = (0..n * n * n).map(|i| field.sample(at(i))).collect();
    let negated: Vec<f32> = samples.iter().map(|value| -value).collect();
    let size = [n as u32; 3];
    let mut buffer = SurfaceNetsBuffer::default();
    let mut made: Vec<(Extractor, Extraction)> = ours.iter().map(|_| Default::default()).collect();
    let mut times: Vec<Vec<f64>> = vec![Vec::new(); ours.len() + 1];
    // The first round makes room and does not count.
    for round in 0..=ROUNDS {
        for ((_, method), ((extractor, extraction), times)) in
            ours.iter().zip(made.iter_mut().zip(&mut times))
        {
            let begin = Instant::now();
            let source = Source::Samples(&samples);
            method.extract_into(extractor, source, &grid, 0.0, &Execution { threads: 1 }, extraction)?;
            black_box(&extraction.mesh);
            times.push(begin.elapsed().as_secs_f64());
        }
        let begin = Instant::now();
        surface_nets(&negated, &RuntimeShape::<u32, 3>::new(size), [0; 3], size.map(|n| n - 1), &mut buffer);
        black_box(&buffer);
        times[ours.len()].push(begin.elapsed().as_secs_f64());
        if round == 0 {
            times.iter_mut().for_each(Vec::clear);
        }
    }
    let triangles = made[0].1.mesh.triangles.len();
    println!("{name}, {n}^3 samples, {triangles} triangles, {:.2} ms", 1e3 * quartiles(times[0].clone())[1]);
    let names = ours.iter().map(|(name, _)| *name).chain(["fast-surface-nets"]);
    for (name, of) in names.zip(&times).skip(1) {
        let [low, middle, high] =
            quartiles(of.iter().zip(&times[0]).map(|(time, nets)| time / nets).collect());
        println!("  {name:<18} {middle:.2} ({low:.2} to {high:.2})");
    }
    Ok(())
}

fn quartiles(mut values: Vec<f64>) -> [f64; 3] {
    values.sort_unstable_by(f64::total_cmp);
    [1, 2, 3].map(|quarter| values[quarter * (values.len() - 1) / 4])
}
