//! A sphere on a lattice larger than memory, body-centred and integrated, with progress and the most memory used.
//! Arguments: cells along an axis, threads, radius in a box from -1 to 1.

use glam::Vec3;
use isostudy_extract::by_lattice::{ExtractSettings, Lattice};
use isostudy_extract::{Arrangement, Execution, Extractor, Source};
use isostudy_field::{Sphere, StudyField};
use isostudy_mesh::Bounds;
use std::io::IsTerminal;
use std::time::Instant;

/// Every point is sampled: no bound is offered.
struct Unbounded(Sphere);

impl StudyField for Unbounded {
    fn sample(&self, p: Vec3) -> f32 {
        self.0.sample(p)
    }
}

/// A bar on a terminal, a line every eighth in a file. With several threads calls come in any order.
fn bar(done: usize, all: usize) {
    let percent = 100 * done / all;
    if std::io::stderr().is_terminal() {
        let end = if done == all { "\n" } else { "" };
        eprint!("\r[{:<50}] {percent:3} %, {done} of {all} layers{end}", "#".repeat(percent / 2));
    } else if done.is_multiple_of((all / 8).max(1)) {
        eprintln!("{percent} %, {done} of {all} layers");
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let cells: u32 = arguments.next().map_or(Ok(512), |a| a.parse())?;
    let threads: usize = arguments.next().map_or(Ok(1), |a| a.parse())?;
    let radius: f32 = arguments.next().map_or(Ok(0.8), |a| a.parse())?;
    let bounds = Bounds { min: Vec3::NEG_ONE, max: Vec3::ONE };
    let lattice = Lattice::try_new(Arrangement::BodyCentred, bounds, 2.0 / cells as f32)?;
    let field = Unbounded(Sphere { radius });
    let start = Instant::now();
    let mut extractor = Extractor::new().with_progress(bar);
    let extraction = extractor.extract(
        Source::Study(&field),
        &lattice,
        &ExtractSettings::default(),
        &Execution { threads },
    )?;
    println!(
        "{} samples, {} triangles, {:.1} s",
        extraction.counts.samples,
        extraction.counts.triangles,
        start.elapsed().as_secs_f64()
    );
    let status = std::fs::read_to_string("/proc/self/status")?;
    println!("{}", status.lines().find(|line| line.starts_with("VmHWM")).unwrap_or("no VmHWM"));
    Ok(())
}
