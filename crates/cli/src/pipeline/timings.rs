//! The benchmark: every configuration timed, in rounds, in processes of its own; and what follows from the samples.

use super::Pipeline;
use super::formats::write_table;
use super::worker::{Job, timed};
use crate::store::{Inputs, Stamp, remove_if_there};
use crate::terminal::progress::Step;
use crate::{machine, recipe, run_file, source_digests};
use anyhow::Result;
use bench::Plan;
use design::Configuration;
use design::machine::Machine;
use design::record::{BenchRun, Purpose, Workload};

/// How many rounds are run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum PlanLength {
    /// `benchmark.short_iterations` and no more, for a whole study in minutes.
    Short,
    /// `benchmark.iterations`, as in the paper, with A/A block and peak memory.
    Full,
}

impl Pipeline<'_> {
    /// Times every configuration. The short plan is not run where a full run is up to date: the full one stands for it.
    pub(crate) fn timings(&self, length: PlanLength) -> Result<Stamp> {
        if self.spacings().is_empty() {
            self.budgets(&[Purpose::Benchmark], &[])?;
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
            let job = Job { plan: &plan, configurations: self.timed()?, cells: None };
            let run = self.run(&job, machine, &journal, &key, &step)?;
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
        // Said again by every run that goes on from these times.
        self.leave_out_failed(&self.bench_run(&stamp)?);
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
        let inputs = Inputs::of_sources(source_digests::TABLES).stamp(timings);
        self.store.stage(&format!("{}/statements", timings.stage), inputs, |writer| {
            let folder = &timings.stage;
            writer.write_json(&format!("{folder}/statements.json"), &statements)?;
            for table in &tables {
                write_table(writer, folder, table)?;
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
            workloads: self.workloads(&self.timed()?, None)?,
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

    /// What a run depends on: the extractions, the plan, and the machine, but not how busy the machine is.
    fn inputs(&self, length: PlanLength, machine: &Machine) -> Result<Inputs> {
        Ok(Inputs::of_sources(source_digests::TIMINGS)
            .value("machine", &machine.lasting())
            .value("plan", &self.plan(length)?))
    }

    /// What has a time and has not failed.
    fn timed(&self) -> Result<Vec<&Configuration>> {
        let mut timed = timed(self.study)?;
        timed.retain(|configuration| !self.has_failed(&configuration.id));
        Ok(timed)
    }

    /// What is asked of the extractor for each configuration: at so many cells along the longest axis, or at the benchmark's spacing.
    pub(super) fn workloads(
        &self,
        configurations: &[&Configuration],
        cells: Option<u32>,
    ) -> Result<Vec<Workload>> {
        let workload = |configuration: &&Configuration| {
            let object = self.study.object(configuration);
            let method = configuration.id.method;
            let spacing = self.spacings().of(&configuration.id, Purpose::Benchmark);
            let mut inputs = Inputs::default()
                .value("volume", &(object.min, object.max, object.isovalue))
                .text("field", self.fields.inputs(configuration.object)?)
                .value("recipe", &self.study.method(method).recipe)
                .value("recipe files", &recipe::inputs(self.study, method)?);
            inputs = match cells {
                Some(cells) => inputs.value("cells", &cells),
                None => inputs.value("spacing", &spacing.unwrap_or(object.benchmark_spacing)),
            };
            Ok(Workload { id: configuration.id.clone(), digest: inputs.finish() })
        };
        configurations.iter().map(workload).collect()
    }
}

fn stage_name(length: PlanLength) -> &'static str {
    match length {
        PlanLength::Short => "bench/short",
        PlanLength::Full => "bench/full",
    }
}
