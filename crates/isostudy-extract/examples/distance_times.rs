//! Best-of-many times of Metro distances between a mesh of half a million triangles and a coarser one of the same
//! surface. Arguments: samples, repetitions.

use glam::Vec3;
use isostudy_extract::by_lattice::{ExtractSettings, Lattice, extract};
use isostudy_extract::{Arrangement, Execution};
use isostudy_field::{Asteroid, Sphere, StudyField};
use isostudy_mesh::Bounds;
use isostudy_mesh::metro::{Amount, Sampling, Surface};
use std::time::{Duration, Instant};

fn main() {
    let mut arguments = std::env::args().skip(1);
    let samples: u64 = arguments.next().map_or(1_000_000, |a| a.parse().unwrap());
    let repetitions: usize = arguments.next().map_or(5, |a| a.parse().unwrap());
    let cube = Bounds { min: Vec3::NEG_ONE, max: Vec3::ONE };
    let cases: [(&str, &dyn StudyField); 2] =
        [("sphere", &Sphere { radius: 0.8 }), ("asteroid", &Asteroid::default())];
    for (name, field) in cases {
        let [fine, coarse] = [256, 100].map(|cells: u32| {
            let lattice = Lattice::try_new(Arrangement::BodyCentred, cube, 2.0 / cells as f32).unwrap();
            extract(field, &lattice, &ExtractSettings::default(), &Execution::default()).unwrap().mesh
        });
        let best = |work: &mut dyn FnMut()| {
            let time = || {
                let start = Instant::now();
                work();
                start.elapsed()
            };
            std::iter::repeat_with(time).take(repetitions).min().unwrap_or(Duration::MAX).as_secs_f64()
        };
        let (coarse, mut built) = (Surface::try_new(&coarse).unwrap(), None);
        let build = best(&mut || built = Some(Surface::try_new(&fine).unwrap()));
        let surface = built.expect("built above");
        println!("{name}: {} triangles, structure built in {build:.3} s", fine.triangles.len());
        let sampling = Sampling { amount: Amount::Samples(samples), seed: 1 };
        for threads in [1, 2] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            for (way, from, to) in
                [("coarse to fine", &coarse, &surface), ("fine to coarse", &surface, &coarse)]
            {
                let mut found = None;
                let seconds =
                    best(&mut || found = Some(pool.install(|| from.deviation_from(to, &sampling)).unwrap()));
                let found = found.expect("measured above");
                println!(
                    "  {way}, {samples} samples and {} vertices, {threads} threads: {seconds:.3} s, RMS {:.3e}",
                    found.vertices, found.rms
                );
            }
        }
    }
}
