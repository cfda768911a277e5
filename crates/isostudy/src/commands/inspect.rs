//! `isostudy inspect`: one configuration at one resolution, extracted, measured, timed, printed.

use crate::consent;
use crate::fields::Fields;
use crate::made::Made;
use crate::measured::Clock;
use crate::outcome::Outcome;
use crate::pipeline::Pipeline;
use crate::prepare::{self, Prepared, Spacings, Wanted, prepare};
use crate::recipe::{self, Recipe, recipe};
use crate::records::{mesh_record, of_mesh};
use crate::region;
use crate::store::Store;
use crate::terminal::say;
use crate::{input, machine};
use anyhow::{Context, Result, anyhow, bail};
use clap::Args;
use isostudy_bench::Measured;
use isostudy_design::config::RegionSection;
use isostudy_design::machine::CpuProfile;
use isostudy_design::record::{BenchSample, Purpose, RegionMeasures};
use isostudy_design::{ConfigurationId, Study};
use isostudy_extract::{Execution, Extractor, IsosurfacePoints, accuracy_beside};
use isostudy_foreign::Folder;
use isostudy_report::Panel;
use std::path::{Path, PathBuf};

#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// Configuration, such as ss_bi
    id: String,
    /// Cells along the longest axis of the volume [default: those of the benchmark]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=4096))]
    resolution: Option<u32>,
    /// Study that has the configuration [default: configs/balanced.toml, which this program has in itself as well]
    #[arg(long, value_name = "TOML")]
    study: Option<PathBuf>,
    /// Extractions to take the median time of, after one of warm-up
    #[arg(long, value_name = "N", default_value_t = 11, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    iterations: u32,
    /// Threads in the sampling stage; 0 takes every core
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = clap::value_parser!(u32).range(..=1024))]
    threads: u32,
    /// Run the configuration's program, if one makes it; it may do whatever you may do
    #[arg(long)]
    allow_programs: bool,
    /// Run it by bubblewrap: without a network, in a folder of its own, the system read-only
    #[arg(long)]
    sandbox: bool,
    /// Print JSON instead
    #[arg(long)]
    json: bool,
}

/// The default study as it stands in a checkout. Elsewhere it is the copy in this program, whose bunny is not there.
const BALANCED: &str = "configs/balanced.toml";
const BALANCED_TEXT: &str = include_str!("../../../../configs/balanced.toml");
const TARGET_TEXT: &str = include_str!("../../../../configs/cpu/x86-64-v3.toml");

fn default_study() -> Result<Study> {
    let path = Path::new(BALANCED);
    if path.is_file() {
        return input::study(path);
    }
    let target = CpuProfile::parse(TARGET_TEXT, Path::new("cpu/x86-64-v3.toml"))?;
    Ok(Study::in_memory(BALANCED_TEXT, target)?)
}

/// What a study repeats of the paper's faults, and which extractor its times are of; nothing of one that lists methods itself.
fn note(study: &Study) -> Option<String> {
    let section = study.file.extraction.as_ref()?;
    let is = |key: &str, value: &str| section.get(key).and_then(|of| of.as_str()) == Some(value);
    let mut faults = Vec::new();
    if is("positions", "accumulated") {
        faults.push(
            "accumulated positions, which leave a surface open where it touches its box and make slivers",
        );
    }
    if is("topology", "published") {
        faults.push("the published topology, which can join sheets and fold fins");
    }
    let id = &study.file.study.id;
    let extractor = match is("positions", "accumulated") {
        true => "the dense extractor, which takes every sample",
        false => "the streaming extractor, which takes samples near the surface",
    };
    let timed = format!("times are of {extractor}, from field to mesh in memory");
    Some(match faults.is_empty() {
        true => format!("study {id}: {timed}"),
        false => format!(
            "study {id} repeats faults of the paper: {}; {BALANCED} has none of them; {timed}",
            faults.join(", and ")
        ),
    })
}

/// Prints the panel.
///
/// # Errors
/// If the study has no such configuration, or it cannot be extracted.
pub(crate) fn run(arguments: &Arguments) -> Result<Outcome> {
    let study = match &arguments.study {
        Some(path) => input::study(path)?,
        None => default_study()?,
    };
    if let Some(note) = note(&study) {
        tell!("{note}");
    }
    let id: ConfigurationId = arguments.id.parse().with_context(|| arguments.id.clone())?;
    let Some(configuration) = study.configurations.iter().find(|configuration| configuration.id == id) else {
        let known: Vec<String> = study.configurations.iter().map(|c| c.id.to_string()).collect();
        bail!("{id}: {} has {}", study.path.display(), known.join(", "));
    };
    let object = study.object(configuration);
    let wanted = match arguments.resolution {
        Some(cells) => Wanted::Cells(cells, Purpose::Benchmark),
        None => Wanted::For(Purpose::Benchmark),
    };
    let fields = Fields::new(&study);
    let budget = study.method(id.method).budget.filter(|_| arguments.resolution.is_none());
    let is_program =
        |of| Ok::<_, anyhow::Error>(matches!(recipe(&study, of, Purpose::Benchmark)?, Recipe::Program(_)));
    let needs_program = is_program(id.method)? || budget.map_or(Ok(false), |budget| is_program(budget.of))?;
    if needs_program {
        consent::ask(&study, arguments.allow_programs, arguments.sandbox)?;
        recipe::check(&study)?;
    }
    let spacings = match budget {
        Some(_) => found_spacings(&study, &id, arguments.threads)?,
        None => Spacings::default(),
    };
    let spacing = spacings.of(&id, Purpose::Benchmark).unwrap_or_else(|| wanted.spacing(object));
    let prepared = prepare(&study, &fields, &spacings, configuration, wanted)?;
    let execution = Execution { threads: arguments.threads as usize };
    let machine = machine::read();
    if let Recipe::Extractor(method) = &prepared.recipe {
        let object = configuration.object;
        prepare::check_memory(&study, object, method, &prepared.grid, &execution, machine.memory_bytes)
            .with_context(|| format!("{id} with spacing {spacing}"))?;
    }
    let Made { mesh, counts, .. } =
        prepared.make(&mut Extractor::new(), &execution).with_context(|| id.to_string())?;
    let Prepared { field, grid, isovalue, .. } = &prepared;
    let accuracy = isostudy_extract::accuracy(&mesh, *field, *isovalue, grid, &execution)?;
    let within = |at: &RegionSection| -> Result<RegionMeasures> {
        let points = IsosurfacePoints::of(*field, *isovalue, grid, Some(region::bounds(at)), &execution)?;
        let of = accuracy_beside(&points, &mesh, *field, *isovalue, grid.spacing, &execution)?;
        Ok(region::measures(at, &mesh, &of))
    };
    let region = study.object(configuration).region.as_ref().map(within).transpose()?;
    let measures = (&accuracy, region);
    let record =
        mesh_record(&id, Purpose::Benchmark, spacing, prepared.cells()?, counts, of_mesh(&mesh), measures);
    let samples = times(&prepared, arguments)?;
    let threads = match arguments.threads {
        0 => std::thread::available_parallelism().map_or(1, |n| n.get() as u32),
        threads => threads,
    };
    let panel = Panel::new(&study, configuration, machine, record, &samples, threads);
    say(&if arguments.json { serde_json::to_string_pretty(&panel)? } else { panel.to_text() })?;
    Ok(Outcome::Done)
}

/// The spacing that a configuration's budget leads to, looked for in a folder that vanishes.
fn found_spacings(study: &Study, id: &ConfigurationId, threads: u32) -> Result<Spacings> {
    let folder = Folder::new().context("cannot make a temporary folder")?;
    let pipeline = Pipeline::new(study, Store::open(folder.path(), false)?, threads as usize);
    pipeline.budgets(&[Purpose::Benchmark], std::slice::from_ref(id))?;
    Ok(pipeline.found_spacings())
}

/// The times of all extractions but the first, which is warm-up; none of a mesh that is read from a file.
fn times(prepared: &Prepared<'_>, arguments: &Arguments) -> Result<Vec<BenchSample>> {
    if let Recipe::Meshes(_) = &prepared.recipe {
        return Ok(Vec::new());
    }
    let mut clock = Clock::new(|_| Ok(prepared.clone()));
    let mut samples = Vec::new();
    for iteration in 0..=arguments.iterations {
        let timed = clock.time(0, arguments.threads).map_err(|why| anyhow!(why))?;
        samples.push(timed.stages.sample(prepared.id.clone(), [0, iteration, 0], None));
    }
    samples.remove(0);
    Ok(samples)
}
