//! The benchmark: every configuration timed, in rounds, in processes of its own; and what follows from the samples.

use super::{Pipeline, sweep};
use crate::args::Worker;
use crate::fields::Fields;
use crate::measured::Clock;
use crate::prepare::{Prepared, Spacings, Wanted, prepare};
use crate::progress::Step;
use crate::recipe::{self, Recipe};
use crate::store::{Inputs, Stamp, remove_if_there, sha256, write_whole};
use crate::{input, machine, rooms, run_file};
use anyhow::{Context, Result, bail};
use bench::{BenchError, Entry, Plan, ProcessExecutor};
use design::machine::Machine;
use design::record::{BenchRun, Purpose};
use design::{Configuration, ConfigurationId};
use std::fs::File;
use std::io::Write;
use std::process::Command;

/// How many rounds are run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum PlanLength {
    /// `benchmark.short_iterations` and no more, for a whole study in minutes.
    Short,
    /// `benchmark.iterations`, as in the paper, with A/A block and peak memory.
    Full,
}

/// What one run measures.
pub(super) struct Bout<'a> {
    pub(super) plan: &'a Plan,
    /// In the order that the measuring process counts them.
    pub(super) configurations: Vec<&'a Configuration>,
    /// Cells per axis of the study's sweep; `None` for the benchmark's own spacing.
    pub(super) cells: Option<u32>,
}

impl Bout<'_> {
    fn ids(&self) -> Vec<ConfigurationId> {
        self.configurations.iter().map(|configuration| configuration.id.clone()).collect()
    }
}

impl Pipeline<'_> {
    /// Times every configuration. The short plan is not run where a full run is up to date: the full one stands for it.
    pub(crate) fn timings(&self, length: PlanLength) -> Result<Stamp> {
        if self.spacings().is_empty() {
            self.budgets(&[Purpose::Benchmark])?;
        }
        let machine = machine::read();
        if length == PlanLength::Short
            && let Some(full) =
                self.store.peek(stage_name(PlanLength::Full), self.inputs(PlanLength::Full, &machine)?)
        {
            tell!("timings: the full run is up to date and stands for the short one");
            return Ok(full);
        }
        let plan = self.plan(length)?;
        let inputs = self.inputs(length, &machine)?;
        let key = self.inputs(length, &machine)?.finish();
        let count = self.timed()?.len();
        let step = Step::begin("timings", count * plan.iterations as usize, 0);
        let journal = self.store.journal(stage_name(length));
        let stamp = self.stage(stage_name(length), inputs, |writer| {
            let bout = Bout { plan: &plan, configurations: self.timed()?, cells: None };
            let run = self.run(&bout, machine, &journal, &key, &step)?;
            let folder = stage_name(length);
            writer.write_json(&format!("{folder}/run.json"), &run)?;
            writer.write(&format!("{folder}/samples.csv"), bench::samples_csv(&run.samples).as_bytes())?;
            writer
                .write(&format!("{folder}/aa_samples.csv"), bench::samples_csv(&run.aa_samples).as_bytes())?;
            writer.write(&format!("{folder}/machine.csv"), bench::machine_csv(&run).as_bytes())?;
            for warning in timing::warnings(&run) {
                tell!("timings: {warning}");
            }
            Ok(())
        })?;
        remove_if_there(&journal)?;
        step.count_all(stamp.redone);
        step.end();
        Ok(stamp)
    }

    /// Writes what follows from a run, as JSON, CSV, Markdown and LaTeX, and returns those tables as Markdown that a terminal
    /// has room for.
    pub(crate) fn timing_statements(&self, timings: &Stamp) -> Result<Vec<String>> {
        let run = self.bench_run(timings)?;
        let statements = timing::statements(&run);
        let tables = timing::statement_tables(&run, &statements);
        let inputs = Inputs::of_rooms(rooms::TABLES).stamp(timings);
        self.store.stage(&format!("{}/statements", timings.stage), inputs, |writer| {
            let folder = &timings.stage;
            writer.write_json(&format!("{folder}/statements.json"), &statements)?;
            for table in &tables {
                let path = format!("{folder}/{}", table.name);
                writer.write(&format!("{path}.csv"), table.to_csv().as_bytes())?;
                writer.write(&format!("{path}.md"), table.to_markdown().as_bytes())?;
                writer.write(&format!("{path}.tex"), table.to_latex().as_bytes())?;
            }
            Ok(())
        })?;
        let short = timing::statement_tables_in_short(&run, &statements);
        Ok(short.iter().map(table::Table::to_markdown).collect())
    }

    /// A finished run.
    pub(crate) fn bench_run(&self, stamp: &Stamp) -> Result<BenchRun> {
        run_file::read(&self.store.root().join(stamp.file("run.json")))
    }

    fn plan(&self, length: PlanLength) -> Result<Plan> {
        let section = &self.study.file.benchmark;
        let full = length == PlanLength::Full;
        Ok(Plan {
            study: self.study.file.study.id.clone(),
            workload: self.workload(Inputs::default())?.finish(),
            warmup: section.warmup,
            iterations: if full { section.iterations } else { section.short_iterations },
            aa_iterations: if full { section.aa_iterations } else { 0 },
            memory: full,
            seed: self.study.file.study.seed,
            threads: section.threads,
            pin: section.pin,
            target: self.study.target.clone(),
        })
    }

    pub(super) fn run(
        &self,
        bout: &Bout<'_>,
        machine: Machine,
        journal: &std::path::Path,
        key: &str,
        step: &Step,
    ) -> Result<BenchRun> {
        let plan = bout.plan;
        let done = self.take_up(journal, key, bout)?;
        let lines: String = [Entry::Begun { key: key.into() }].iter().chain(&done).map(Entry::line).collect();
        write_whole(journal, lines.as_bytes())?;
        let mut file = File::options().append(true).open(journal)?;
        let program = std::env::current_exe().context("cannot find this program to start it again")?;
        let digest = sha256(&std::fs::read(&self.study.path)?);
        let mut spacings = tempfile::NamedTempFile::new()?;
        spacings.write_all(&serde_json::to_vec(&*self.spacings())?)?;
        let worker = || {
            let mut command = Command::new(&program);
            command.args(["bench", "worker"]).arg(&self.study.path);
            command.args(["--sha256", &digest, "--threads", &plan.threads.to_string()]);
            command.args(plan.pin.then_some("--pin"));
            if let Some(cells) = bout.cells {
                command.args(["--cells", &cells.to_string()]);
            }
            for id in self.failed() {
                command.args(["--without", &id.to_string()]);
            }
            command.arg("--spacings").arg(spacings.path());
            command
        };
        let mut record = |entry: &Entry| file.write_all(entry.line().as_bytes());
        let mut executor = ProcessExecutor::new(&worker);
        let on_turn = &mut |done, all| step.set(done, all);
        Ok(bench::run(plan, &bout.ids(), &mut executor, machine, done, &mut record, on_turn)?)
    }

    /// What a killed run of the same plan, machine and code left behind.
    fn take_up(&self, journal: &std::path::Path, key: &str, bout: &Bout<'_>) -> Result<Vec<Entry>> {
        let Ok(text) = std::fs::read_to_string(journal) else { return Ok(Vec::new()) };
        if self.store.forced() {
            tell!("timings: begun anew, as --force says; an unfinished run is not gone on with");
            return Ok(Vec::new());
        }
        let read = bench::read_journal(&text, key).map_err(BenchError::from);
        match read.and_then(|done| bench::check_journal(bout.plan, &bout.ids(), &done).map(|()| done)) {
            Ok(done) => {
                if !done.is_empty() {
                    tell!("timings: an unfinished run is gone on with ({} entries)", done.len());
                }
                Ok(done)
            }
            Err(error) => {
                let error = anyhow::Error::from(error);
                tell!("timings: begun anew; {} is not gone on from: {error:#}", journal.display());
                Ok(Vec::new())
            }
        }
    }

    /// What a run depends on: the extractions, the plan, and the machine, but not how busy the machine is.
    fn inputs(&self, length: PlanLength, machine: &Machine) -> Result<Inputs> {
        let inputs = Inputs::of_rooms(rooms::TIMINGS)
            .value("machine", &machine.lasting())
            .value("plan", &self.plan(length)?);
        self.workload(inputs)
    }

    /// What has a time and has not failed.
    fn timed(&self) -> Result<Vec<&Configuration>> {
        let mut timed = timed(self.study)?;
        timed.retain(|configuration| !self.has_failed(&configuration.id));
        Ok(timed)
    }

    /// What is asked of the extractor.
    pub(super) fn workload(&self, inputs: Inputs) -> Result<Inputs> {
        let recipes: Vec<_> = self.study.methods.iter().map(|method| (method.id, &method.recipe)).collect();
        let failed = self.failed();
        let mut inputs = inputs
            .value("methods", &recipes)
            .value("spacings", &self.spacings().only_for(Purpose::Benchmark));
        if !failed.is_empty() {
            inputs = inputs.value("failed", &failed);
        }
        for method in &self.study.methods {
            for digest in recipe::inputs(self.study, method.id)? {
                inputs = inputs.text("recipe file", &digest);
            }
        }
        for (number, object) in self.study.file.objects.iter().enumerate() {
            inputs = inputs
                .value("volume", &(object.min, object.max, object.benchmark_spacing, object.isovalue))
                .text("field", self.fields.inputs(number)?);
        }
        Ok(inputs)
    }
}

/// The configurations that can be timed: all but those whose meshes are there.
fn timed(study: &design::Study) -> Result<Vec<&Configuration>> {
    let mut timed = Vec::new();
    for configuration in &study.configurations {
        match recipe::recipe(study, configuration.id.method, Purpose::Benchmark)? {
            Recipe::Meshes(_) => {}
            Recipe::Extractor(_) | Recipe::Program(_) => timed.push(configuration),
        }
    }
    Ok(timed)
}

/// The measuring process: answers requests on standard input until there are no more.
pub(crate) fn measure(arguments: &Worker) -> Result<()> {
    let pinned = if arguments.pin { bench::pin(arguments.threads) } else { None };
    let study = input::study(&arguments.study)?;
    if sha256(&std::fs::read(&study.path)?) != arguments.sha256 {
        bail!("{} was changed while the benchmark ran", study.path.display());
    }
    let fields = Fields::new(&study);
    let sweep = match (arguments.cells, &study.file.benchmark.sweep) {
        (Some(cells), Some(section)) => Some((cells, section)),
        (Some(_), None) => bail!("{}: there is no [benchmark.sweep]", study.path.display()),
        (None, _) => None,
    };
    let configurations: Vec<&Configuration> = match sweep {
        Some((_, section)) => sweep::configurations(&study, section),
        None => {
            let mut timed = timed(&study)?;
            timed.retain(|configuration| !arguments.without.contains(&configuration.id.to_string()));
            timed
        }
    };
    let spacings: Spacings = match &arguments.spacings {
        Some(path) => {
            serde_json::from_slice(&input::bytes(path)?).with_context(|| path.display().to_string())?
        }
        None => Spacings::default(),
    };
    let prepared = |number: usize| -> Result<Prepared<'_>, String> {
        let configuration = *configurations.get(number).ok_or("there is no such configuration")?;
        let wanted = match sweep {
            Some((cells, _)) => Wanted::Cells(cells, Purpose::Indexed),
            None => Wanted::For(Purpose::Benchmark),
        };
        prepare(&study, &fields, &spacings, configuration, wanted).map_err(|error| format!("{error:#}"))
    };
    let (requests, replies) = (std::io::stdin().lock(), std::io::stdout().lock());
    Ok(bench::serve(requests, replies, pinned, arguments.threads, &mut Clock::new(prepared))?)
}

fn stage_name(length: PlanLength) -> &'static str {
    match length {
        PlanLength::Short => "bench/short",
        PlanLength::Full => "bench/full",
    }
}
