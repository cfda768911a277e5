//! How far two surfaces are from each other: `isostudy distance`.

use crate::args::Distance;
use crate::say;
use anyhow::{Context, Result, bail};
use mesh::metro::{Amount, Deviation, Metro, Sampling, Surface};
use mesh::{MeshFormat, TriangleMesh};
use serde::Serialize;
use std::fmt::Write;
use std::fs::File;
use std::path::Path;

/// The version of the JSON.
const SCHEMA: u32 = 1;

/// Measures both ways and prints.
pub(crate) fn distance(arguments: &Distance) -> Result<()> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(arguments.threads as usize).build()?;
    let surfaces = [&arguments.a, &arguments.b].map(|path| surface(path));
    let [a, b] = surfaces;
    let (a, b) = (a?, b?);
    let amount = match arguments.density {
        Some(density) => Amount::Density(density),
        None => Amount::Samples(arguments.samples),
    };
    let sampling = Sampling { amount, seed: arguments.seed };
    let metro = pool.install(|| -> Result<Metro> {
        let way = |from: &Surface, to: &Surface, path: &Path| {
            from.deviation_from(to, &sampling).with_context(|| path.display().to_string())
        };
        Ok(Metro {
            forward: way(&a, &b, &arguments.a)?,
            backward: way(&b, &a, &arguments.b)?,
            diagonal: b.diagonal(),
        })
    })?;
    let names = [&arguments.a, &arguments.b].map(|path| path.display().to_string());
    if arguments.json {
        let report = Report::new(&names, &metro, arguments.seed);
        return say(&serde_json::to_string_pretty(&report)?);
    }
    say(text(&metro, arguments.seed).trim_end())
}

fn surface(path: &Path) -> Result<Surface> {
    let name = || path.display().to_string();
    Surface::try_new(&read_mesh(path)?).with_context(name)
}

/// A mesh in the format that its file's name ends with.
fn read_mesh(path: &Path) -> Result<TriangleMesh> {
    let name = || path.display().to_string();
    let ending = path.extension().and_then(|extension| extension.to_str()).unwrap_or_default();
    let Some(format) = MeshFormat::from_extension(ending) else {
        bail!("{}: ends neither in .obj nor in .ply nor in .stl", name());
    };
    let file = File::open(path).with_context(name)?;
    format.read(file).with_context(name)
}

fn text(metro: &Metro, seed: u64) -> String {
    let mut text = String::new();
    let mut line = |name: &str, value: f64| {
        let share = 100.0 * value / metro.diagonal;
        writeln!(text, "  {name:<22}{value:>14.8}  {share:>11.6} %").expect("a string takes everything");
    };
    line("Hausdorff distance", metro.hausdorff());
    for (heading, way) in [("A to B", &metro.forward), ("B to A", &metro.backward)] {
        line(&format!("{heading}, mean"), way.mean);
        line("  RMS", way.rms);
        line("  max", way.max);
    }
    let mut text =
        format!("distance                          units  of B's diagonal, {:.8}\n{text}\n", metro.diagonal);
    for (heading, way) in [("A to B", &metro.forward), ("B to A", &metro.backward)] {
        writeln!(text, "{heading}: {}", places(way)).expect("a string takes everything");
    }
    writeln!(
        text,
        "seed {seed}; the maxima are over samples and vertices, and occur; mean and RMS are over the area"
    )
    .expect("a string takes everything");
    text
}

/// How a direction was sampled, and where its maximum is.
fn places(way: &Deviation) -> String {
    let sampled = format!(
        "{} samples, {:.6} per unit of area, and {} vertices",
        way.samples, way.density, way.vertices
    );
    way.farthest.map_or(sampled.clone(), |farthest| {
        let [from, to] =
            [farthest.from, farthest.to].map(|p| format!("({:.7}, {:.7}, {:.7})", p.x, p.y, p.z));
        let kind = if farthest.at_vertex { "vertex" } else { "sample" };
        format!("{sampled}; farthest {kind} {from}, nearest point {to}")
    })
}

/// What is printed as JSON.
#[derive(Serialize)]
struct Report {
    schema: u32,
    a: String,
    b: String,
    seed: u64,
    /// Length of the diagonal of B's bounding box.
    diagonal: f64,
    hausdorff: f64,
    hausdorff_of_diagonal: f64,
    a_to_b: Way,
    b_to_a: Way,
}

#[derive(Serialize)]
struct Way {
    samples: u64,
    samples_per_area: f64,
    vertices: u64,
    mean: f64,
    rms: f64,
    max: f64,
    mean_of_diagonal: f64,
    rms_of_diagonal: f64,
    max_of_diagonal: f64,
    farthest: Option<Farthest>,
}

#[derive(Serialize)]
struct Farthest {
    from: [f64; 3],
    to: [f64; 3],
    at_vertex: bool,
}

impl Report {
    fn new([a, b]: &[String; 2], metro: &Metro, seed: u64) -> Self {
        let way = |way: &Deviation| Way {
            samples: way.samples,
            samples_per_area: way.density,
            vertices: way.vertices,
            mean: way.mean,
            rms: way.rms,
            max: way.max,
            mean_of_diagonal: way.mean / metro.diagonal,
            rms_of_diagonal: way.rms / metro.diagonal,
            max_of_diagonal: way.max / metro.diagonal,
            farthest: way.farthest.map(|farthest| Farthest {
                from: farthest.from.to_array(),
                to: farthest.to.to_array(),
                at_vertex: farthest.at_vertex,
            }),
        };
        Self {
            schema: SCHEMA,
            a: a.clone(),
            b: b.clone(),
            seed,
            diagonal: metro.diagonal,
            hausdorff: metro.hausdorff(),
            hausdorff_of_diagonal: metro.hausdorff() / metro.diagonal,
            a_to_b: way(&metro.forward),
            b_to_a: way(&metro.backward),
        }
    }
}
