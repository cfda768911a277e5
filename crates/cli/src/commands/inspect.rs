//! `isostudy inspect`: one configuration at one resolution, extracted, measured, timed, printed.

use crate::fields::Fields;
use crate::outcome::Outcome;
use crate::prepare::{self, Spacings, Wanted, prepare};
use crate::records::{self, mesh_record};
use crate::terminal::say;
use crate::{input, machine};
use analysis::Panel;
use anyhow::{Context, Result, bail};
use bench::{Prepared, StageSeconds};
use clap::Args;
use design::ConfigurationId;
use design::record::Purpose;
use extract::Execution;
use std::path::PathBuf;

#[derive(Debug, Args)]
pub(crate) struct Arguments {
    /// Configuration, such as ss_bi
    id: String,
    /// Cells along the longest axis of the volume [default: those of the benchmark]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=4096))]
    resolution: Option<u32>,
    /// Study that has the configuration
    #[arg(long, value_name = "TOML", default_value = "configs/paper.toml")]
    study: PathBuf,
    /// Extractions to take the median time of, after one of warm-up
    #[arg(long, value_name = "N", default_value_t = 11, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    iterations: u32,
    /// Threads in the sampling stage; 0 takes every core
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = clap::value_parser!(u32).range(..=1024))]
    threads: u32,
    /// Print JSON instead
    #[arg(long)]
    json: bool,
}

/// Prints the panel.
///
/// # Errors
/// If the study has no such configuration, or it cannot be extracted.
pub(crate) fn run(arguments: &Arguments) -> Result<Outcome> {
    let study = input::study(&arguments.study)?;
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
    let spacing = wanted.spacing(object);
    let fields = Fields::new(&study);
    let prepared = prepare(&study, &fields, &Spacings::default(), configuration, wanted)?;
    let Some(prepared) = prepared.extractor() else {
        bail!("{id}: is made by a program or is a file; what is timed here are extractors of ours");
    };
    let execution = Execution { threads: arguments.threads as usize };
    let machine = machine::read();
    prepare::check_memory(&study, &prepared.method, &prepared.grid, &execution, machine.memory_bytes)
        .with_context(|| format!("{id} with spacing {spacing}"))?;
    let extraction = prepared.extract(&execution)?;
    if extraction.mesh.triangles.is_empty() {
        bail!(
            "{id}: no surface at isovalue {} with spacing {spacing}: every sample lies on one side",
            object.isovalue
        );
    }
    let Prepared { field, grid, isovalue, method } = &prepared;
    let accuracy = extract::accuracy(&extraction.mesh, *field, *isovalue, grid, &execution)?;
    let (cells, counts) = (method.cells(grid)?, records::counts(&extraction.counts));
    let record = mesh_record(&id, Purpose::Benchmark, spacing, cells, counts, &extraction.mesh, &accuracy);
    // The extraction above was the warm-up.
    let mut samples = Vec::new();
    for iteration in 0..arguments.iterations {
        let times = prepared.extract(&execution)?.times;
        samples.push(StageSeconds::from(&times).sample(id.clone(), [0, iteration, 0], None));
    }
    let threads = match arguments.threads {
        0 => std::thread::available_parallelism().map_or(1, |n| n.get() as u32),
        threads => threads,
    };
    let panel = Panel::new(&study, configuration, machine, record, &samples, threads);
    say(&if arguments.json { serde_json::to_string_pretty(&panel)? } else { panel.to_text() })?;
    Ok(Outcome::Done)
}
