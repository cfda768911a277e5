//! One configuration at one resolution: extracted, measured, timed, printed.

use crate::args::Inspect;
use crate::fields::Fields;
use crate::prepare::{self, Spacings, Wanted, prepare};
use crate::records::{self, mesh_record};
use crate::{input, machine, say};
use analysis::Panel;
use anyhow::{Context, Result, bail};
use bench::{Prepared, StageSeconds};
use design::ConfigurationId;
use design::record::Purpose;
use extract::Execution;

/// Prints the panel.
pub(crate) fn inspect(arguments: &Inspect) -> Result<()> {
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
    say(&if arguments.json { serde_json::to_string_pretty(&panel)? } else { panel.to_text() })
}
