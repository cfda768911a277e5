//! `isostudy distance`: how far two surfaces are from each other.

use super::object_of_study::object_of_study;
use super::source_arguments::SourceArguments;
use crate::fields::Fields;
use crate::memory::OfVolume;
use crate::outcome::Outcome;
use crate::terminal::{say, significant};
use crate::{input, mesh_file, prepare};
use anyhow::{Context, Result};
use clap::{ArgGroup, Args};
use isostudy_extract::{Arrangement, BoxGrid, Execution, Method, Tetrahedra};
use isostudy_field::StudyField;
use isostudy_mesh::metro::{Amount, Deviation, Metro, Sampling, Surface};
use serde::Serialize;
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// The version of the JSON.
const SCHEMA: u32 = 1;

#[derive(Debug, Args)]
#[command(group(ArgGroup::new("second").args(["b", "field", "volume", "mesh", "points", "soup", "object"]).required(true)))]
#[command(
    override_usage = "isostudy distance [OPTIONS] <A> <B|--field <FORMULA>|--volume <FILE>|--mesh <FILE>|--object <ID>>"
)]
#[command(after_help = "\
Examples:
  isostudy distance coarse.ply fine.ply
  isostudy distance ball.ply --field 'sqrt(x^2+y^2+z^2) - 1' --bounds=-1.2,-1.2,-1.2,1.2,1.2,1.2
  isostudy distance head.ply --volume head.nrrd --isovalue 300.5
  isostudy distance bunny.ply --object bs --study configs/paper.toml")]
pub(crate) struct Arguments {
    /// Mesh: .obj, .ply or .stl
    a: PathBuf,
    /// Mesh to compare it with. The diagonal of its bounding box, or of the isosurface's, is the yardstick
    #[arg(conflicts_with_all = ["bounds", "spacing", "cells", "isovalue", "inside", "close", "allow_open", "memory"])]
    b: Option<PathBuf>,
    /// The isosurface of this object of a study instead; --spacing is the study's for its benchmark if not given
    #[arg(long, value_name = "ID", conflicts_with_all = ["bounds", "cells", "isovalue", "inside", "close", "allow_open"])]
    object: Option<String>,
    /// Study that has the object
    #[arg(long, value_name = "TOML", default_value = "configs/paper.toml", requires = "object")]
    study: PathBuf,
    /// Samples on each surface, spread over its area; its vertices come on top
    #[arg(long, value_name = "N", default_value_t = 1_000_000, value_parser = clap::value_parser!(u64).range(1..=isostudy_mesh::metro::MOST_SAMPLES))]
    samples: u64,
    /// Samples per unit of area, instead of a number for each surface
    #[arg(long, value_name = "N", conflicts_with = "samples")]
    density: Option<f64>,
    /// Seed of the samples' places; the same seed gives the same numbers on any number of threads
    #[arg(long, value_name = "SEED", default_value_t = 1)]
    seed: u64,
    /// Threads to work with; 0 takes every core
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = clap::value_parser!(u32).range(..=1024))]
    threads: u32,
    /// Print JSON instead
    #[arg(long)]
    json: bool,
    #[command(
        flatten,
        next_help_heading = "An isosurface to compare it with instead; the spacing sets how closely it is looked at"
    )]
    source: SourceArguments,
}

/// Measures both ways and prints.
///
/// # Errors
/// If a surface cannot be had or not be sampled.
pub(crate) fn run(arguments: &Arguments) -> Result<Outcome> {
    let amount = match arguments.density {
        Some(density) => Amount::Density(density),
        None => Amount::Samples(arguments.samples),
    };
    let sampling = Sampling { amount, seed: arguments.seed };
    let a = surface(&arguments.a)?;
    let (name, metro) = match (&arguments.b, &arguments.object) {
        (Some(path), _) => (path.display().to_string(), to_mesh(arguments, &a, path, &sampling)?),
        (None, Some(id)) => (id.clone(), to_object(arguments, &a, id, &sampling)?),
        (None, None) => to_source(arguments, &a, &sampling)?,
    };
    if arguments.json {
        let report = Report::new([arguments.a.display().to_string(), name], &metro, arguments.seed);
        say(&serde_json::to_string_pretty(&report)?)?;
    } else {
        say(text(&metro, arguments.seed).trim_end())?;
    }
    Ok(Outcome::Done)
}

fn to_mesh(arguments: &Arguments, a: &Surface, path: &Path, sampling: &Sampling) -> Result<Metro> {
    let b = surface(path)?;
    let way = |from: &Surface, to: &Surface, path: &Path| {
        from.deviation_from(to, sampling).with_context(|| path.display().to_string())
    };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(arguments.threads as usize).build()?;
    pool.install(|| {
        let forward = way(a, &b, &arguments.a)?;
        Ok(Metro { forward, backward: way(&b, a, path)?, diagonal: b.diagonal() })
    })
}

/// Against the isosurface of a study's object, in the object's volume.
fn to_object(arguments: &Arguments, a: &Surface, id: &str, sampling: &Sampling) -> Result<Metro> {
    let study = input::study(&arguments.study)?;
    let index = object_of_study(&study, id)?;
    let object = &study.file.objects[index];
    let spacing = arguments.source.spacing.map_or(object.benchmark_spacing, f64::from);
    let grid = prepare::grid(object, spacing);
    let fields = Fields::new(&study);
    let made = fields.get(index)?;
    to_isosurface(arguments, a, (&*made.field, None), made.isovalue, &grid, sampling)
        .with_context(|| format!("{} and {id}, with spacing {spacing}", arguments.a.display()))
}

/// Against the isosurface of a formula, a volume, a mesh's distance, points or soup, in its box.
fn to_source(arguments: &Arguments, a: &Surface, sampling: &Sampling) -> Result<(String, Metro)> {
    let (method, execution) = (lattice(), Execution { threads: arguments.threads as usize });
    let source =
        arguments.source.read_for(&method, &execution)?.context("something to compare with is needed")?;
    let field: (&dyn StudyField, Option<OfVolume>) = (&*source.field, source.held);
    let metro = to_isosurface(arguments, a, field, source.isovalue, &source.grid(), sampling)
        .with_context(|| format!("{} and {}", arguments.a.display(), source.name))?;
    Ok((source.name, metro))
}

/// `held` bytes are the field's.
fn to_isosurface(
    arguments: &Arguments,
    a: &Surface,
    (field, held): (&dyn StudyField, Option<OfVolume>),
    isovalue: f32,
    grid: &BoxGrid,
    sampling: &Sampling,
) -> Result<Metro> {
    let execution = Execution { threads: arguments.threads as usize };
    arguments.source.limit().check_method(&lattice(), grid, &execution, held)?;
    Ok(isostudy_extract::distances(a, field, isovalue, grid, sampling, &execution)?)
}

/// The isosurface is looked for on such a lattice.
fn lattice() -> Method {
    Method::Tetrahedra(Tetrahedra::new(Arrangement::BodyCentred))
}

fn surface(path: &Path) -> Result<Surface> {
    Surface::try_new(&mesh_file::read(path)?).with_context(|| path.display().to_string())
}

fn text(metro: &Metro, seed: u64) -> String {
    let mut text = String::new();
    let mut line = |name: &str, value: f64| {
        let share = 100.0 * value / metro.diagonal;
        writeln!(text, "  {name:<22}{:>14}  {:>11} %", significant(value), significant(share))
            .expect("a string takes everything");
    };
    line("Hausdorff distance", metro.hausdorff());
    for (heading, way) in [("A to B", &metro.forward), ("B to A", &metro.backward)] {
        line(&format!("{heading}, mean"), way.mean);
        line("  RMS", way.rms);
        line("  max", way.max);
    }
    let mut text = format!(
        "distance                          units  of B's diagonal, {}\n{text}\n",
        significant(metro.diagonal)
    );
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
    let mut sampled = format!(
        "{} samples, {} per unit of area, and {} vertices",
        way.samples,
        significant(way.density),
        way.vertices
    );
    if way.lost_samples + way.lost_vertices > 0 {
        let (samples, vertices) = (way.lost_samples, way.lost_vertices);
        sampled += &format!(" ({samples} and {vertices} without a distance)");
    }
    way.farthest.map_or(sampled.clone(), |farthest| {
        let [from, to] =
            [farthest.from, farthest.to].map(|p| format!("({})", p.to_array().map(significant).join(", ")));
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
    lost_samples: u64,
    lost_vertices: u64,
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
    fn new([a, b]: [String; 2], metro: &Metro, seed: u64) -> Self {
        let way = |way: &Deviation| Way {
            samples: way.samples,
            samples_per_area: way.density,
            vertices: way.vertices,
            lost_samples: way.lost_samples,
            lost_vertices: way.lost_vertices,
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
            a,
            b,
            seed,
            diagonal: metro.diagonal,
            hausdorff: metro.hausdorff(),
            hausdorff_of_diagonal: metro.hausdorff() / metro.diagonal,
            a_to_b: way(&metro.forward),
            b_to_a: way(&metro.backward),
        }
    }
}
