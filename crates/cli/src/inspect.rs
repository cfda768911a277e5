//! One configuration at one resolution: extracted, measured, timed, printed.

use crate::args::Inspect;
use crate::records::mesh_record;
use crate::subject::Fields;
use crate::{input, machine, say, subject};
use analysis::Panel;
use anyhow::{Context, Result, bail};
use bench::StageSeconds;
use design::ConfigurationId;
use design::record::Purpose;
use extract::{Execution, extract};

/// Prints the panel.
pub(crate) fn inspect(arguments: &Inspect) -> Result<()> {
    let study = input::study(&arguments.study)?;
    let id: ConfigurationId = arguments.id.parse().with_context(|| arguments.id.clone())?;
    let Some(configuration) = study.configurations.iter().find(|configuration| configuration.id == id) else {
        let known: Vec<String> = study.configurations.iter().map(|c| c.id.to_string()).collect();
        bail!("{id}: {} has {}", study.path.display(), known.join(", "));
    };
    let object = study.object(configuration);
    let spacing = match arguments.resolution {
        Some(cells) => subject::spacing_of_cells(object, cells),
        None => object.benchmark_spacing,
    };
    let method = configuration.id.method;
    let lattice = subject::lattice(object, method.arrangement, spacing)?;
    let settings = subject::settings(&study, configuration, Purpose::Benchmark);
    let execution = Execution { threads: arguments.threads as usize };
    let machine = machine::read();
    subject::check_memory(&study, &lattice, &settings, &execution, machine.memory_bytes)
        .with_context(|| format!("{id} with spacing {spacing}"))?;
    let fields = Fields::new(&study);
    let field = fields.get(configuration.object)?;
    let extraction = extract(field, &lattice, &settings, &execution)?;
    if extraction.mesh.triangles.is_empty() {
        bail!(
            "{id}: no surface at isovalue {} with spacing {spacing}: every sample lies on one side",
            object.isovalue
        );
    }
    let accuracy = extract::accuracy(&extraction.mesh, field, settings.isovalue, &lattice, &execution)?;
    let record = mesh_record(&id, Purpose::Benchmark, spacing, &lattice, &extraction, &accuracy);
    // The extraction above was the warm-up.
    let mut samples = Vec::new();
    for iteration in 0..arguments.iterations {
        let times = extract(field, &lattice, &settings, &execution)?.times;
        samples.push(StageSeconds::from(&times).sample(id.clone(), [0, iteration, 0], None));
    }
    let threads = match arguments.threads {
        0 => std::thread::available_parallelism().map_or(1, |n| n.get() as u32),
        threads => threads,
    };
    let panel = Panel::new(&study, configuration, machine, record, &samples, threads);
    say(&if arguments.json { serde_json::to_string_pretty(&panel)? } else { panel.to_text() })
}
