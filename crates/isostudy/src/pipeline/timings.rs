//! The benchmark: every configuration timed, in rounds, in processes of its own; and what follows from the samples.

use super::formats::write_table;
use super::worker::{Measurement, timed};
use super::{Making, Pipeline};
use crate::store::{Inputs, Stamp, remove_if_there};
use crate::terminal::progress::Step;
use crate::{machine, recipe, run_file, source_digests};
use anyhow::{Result, bail};
use isostudy_bench::Plan;
use isostudy_design::machine::{Build, Machine};
use isostudy_design::record::{BenchRun, Purpose, Workload};
use isostudy_design::{Configuration, ConfigurationId};
use std::borrow::Cow;

/// How many rounds are run, and of what.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum PlanLength {
    /// `benchmark.short_iterations` and no more, for a whole study in minutes.
    Short,
    /// `benchmark.iterations`, as in the paper, with A/A block and peak memory.
    Full,
    /// As the full one, of some configurations or with other rounds.
    Selected(Choice),
    /// As the full one, on the machine that the study calls so.
    On(String),
}

/// What of a study is measured, and for how long.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Choice {
    /// Configurations; none for all.
    pub(crate) only: Vec<ConfigurationId>,
    /// Rounds; with `until`, rounds at most.
    pub(crate) rounds: Option<u32>,
    /// Growth of a total, as a share: rounds are measured until a second run like this would tell it of every total.
    pub(crate) until: Option<f64>,
}

/// How many batches there are at most where nothing else is said.
const BATCHES: u32 = 10;

impl Pipeline<'_> {
    /// Times every configuration. The short plan is not run where a full run is up to date: the full one stands for it.
    pub(crate) fn timings(&self, length: &PlanLength) -> Result<Stamp> {
        if self.spacings().is_empty() {
            self.budgets(&[Purpose::Benchmark], &[])?;
        }
        let name = stage_name(length);
        let (machine, full) = (self.machine(&name)?, PlanLength::Full);
        if *length == PlanLength::Short
            && let Some(full) =
                self.store.peek(&stage_name(&full), self.inputs(&full, &self.machine(&stage_name(&full))?)?)
        {
            tell!("timings: the full run is up to date and stands for the short one");
            return Ok(full);
        }
        if matches!(length, PlanLength::On(_)) {
            self.check_is_same_machine(&name, &machine)?;
        }
        let plan = self.plan(length)?;
        let inputs = self.inputs(length, &machine)?;
        let key = self.inputs(length, &machine)?.finish();
        let count = self.chosen(length)?.len();
        let step = Step::begin("timings", count * plan.iterations as usize, 0);
        let journal = self.store.journal(&name);
        let stamp = self.stage(&name, inputs, |writer| {
            let measurement =
                Measurement { plan: &plan, configurations: self.chosen(length)?, cells: None, case: None };
            let enough = |run: &BenchRun| {
                let told = isostudy_timing::would_tell(run);
                plan.until.is_some_and(|share| told.is_some_and(|(_, most)| most <= 1.0 + share))
            };
            self.say_expected(&plan, &measurement.configurations)?;
            let run = self.run(&measurement, machine, &journal, &key, &step, &enough)?;
            let folder = &name;
            writer.write_json(&format!("{folder}/run.json"), &run)?;
            writer.write(
                &format!("{folder}/samples.csv"),
                isostudy_bench::samples_csv(&run.samples).as_bytes(),
            )?;
            writer.write(
                &format!("{folder}/aa_samples.csv"),
                isostudy_bench::samples_csv(&run.aa_samples).as_bytes(),
            )?;
            writer.write(&format!("{folder}/machine.csv"), isostudy_bench::machine_csv(&run).as_bytes())?;
            for warning in isostudy_timing::warnings(&run) {
                tell!("timings: {warning}");
            }
            Ok(())
        })?;
        remove_if_there(&journal)?;
        // Said again by every run that goes on from these times.
        self.leave_out_failed(&self.bench_run(&stamp)?.failed);
        step.count_all(stamp.redone);
        step.end();
        Ok(stamp)
    }

    /// Refuses to put times of this machine in the place of another's.
    fn check_is_same_machine(&self, stage: &str, machine: &Machine) -> Result<()> {
        let path = self.store.root().join(stage).join("run.json");
        if self.store.forced() || !path.is_file() {
            return Ok(());
        }
        let hardware = |of: &Machine| Machine { build: Build::default(), ..of.lasting() };
        let before = run_file::read(&path)?.machine;
        if hardware(&before) != hardware(machine) {
            let model = |of: &Machine| of.model.clone().unwrap_or_else(|| "an unknown processor".into());
            bail!(
                "{stage}: it was measured on another machine, {} ({} threads), and this is {} ({} threads). Name this machine in \
                 benchmark.machines, or take --force to put its times in their place",
                model(&before),
                before.threads,
                model(machine),
                machine.threads
            );
        }
        Ok(())
    }

    /// The runs of the machines that the study names, with their stamps; and the names of those that have none of the study as it is.
    pub(super) fn machine_runs(&self) -> Result<(Vec<OnMachine>, Vec<String>)> {
        let (mut runs, mut missing) = (Vec::new(), Vec::new());
        for name in &self.study.file.benchmark.machines {
            let length = PlanLength::On(name.clone());
            let stage = stage_name(&length);
            let path = self.store.root().join(&*stage).join("run.json");
            let measured = match path.is_file() {
                true => self.store.peek(&stage, self.inputs(&length, &run_file::read(&path)?.machine)?),
                false => None,
            };
            match measured {
                Some(stamp) => runs.push((name.clone(), stamp)),
                None => {
                    let file = self.study.path.display();
                    tell!(
                        "machine {name} has not measured the study as it is: run `isostudy job {file} {stage}` there"
                    );
                    missing.push(name.clone());
                }
            }
        }
        Ok((runs, missing))
    }

    /// The machine whose times a stage has: this one, or where times are only looked up that which measured them.
    pub(super) fn machine(&self, stage: &str) -> Result<Machine> {
        let is_made = match &self.making {
            Making::All => true,
            Making::Only(job) => job == stage,
            Making::None => false,
        };
        let run = ["bench/full", "bench/short"].map(|name| self.store.root().join(name).join("run.json"));
        let measured = match stage {
            "bench/full" => &run[..1],
            "bench/short" => &run[1..],
            _ => &run[..],
        };
        let own = stage.strip_prefix(MACHINES).map(|_| self.store.root().join(stage).join("run.json"));
        let measured = own.as_ref().map_or(measured, std::slice::from_ref);
        match measured.iter().find(|path| path.is_file()).filter(|_| !is_made) {
            Some(path) => Ok(run_file::read(path)?.machine),
            None => Ok(machine::read()),
        }
    }

    /// Writes what follows from a run, as JSON, CSV, Markdown and LaTeX, and returns those tables as Markdown that a terminal
    /// has room for.
    pub(crate) fn timing_statements(&self, timings: &Stamp) -> Result<Vec<String>> {
        let run = self.bench_run(timings)?;
        let statements = isostudy_timing::statements(&run);
        let tables = isostudy_timing::statement_tables(&run, &statements);
        let inputs = Inputs::of_sources(source_digests::TABLES).stamp(timings);
        self.store.stage(&format!("{}/statements", timings.stage), inputs, |writer| {
            let folder = &timings.stage;
            writer.write_json(&format!("{folder}/statements.json"), &statements)?;
            for table in &tables {
                write_table(writer, folder, table)?;
            }
            Ok(())
        })?;
        let short = isostudy_timing::statement_tables_in_short(&run, &statements);
        Ok(short.iter().map(isostudy_table::Table::to_markdown).collect())
    }

    /// A finished run.
    pub(crate) fn bench_run(&self, stamp: &Stamp) -> Result<BenchRun> {
        run_file::of(&self.store.read(stamp, "run.json")?, &self.store.root().join(stamp.file("run.json")))
    }

    fn plan(&self, length: &PlanLength) -> Result<Plan> {
        let section = &self.study.file.benchmark;
        let full = *length != PlanLength::Short;
        let (mut iterations, mut batches, mut until) = (section.iterations, 1, None);
        match length {
            PlanLength::Short => iterations = section.short_iterations,
            PlanLength::Full | PlanLength::On(_) => {}
            PlanLength::Selected(Choice { until: share @ Some(_), rounds, .. }) => {
                until = *share;
                batches = rounds.map_or(BATCHES, |rounds| rounds.div_ceil(iterations));
            }
            PlanLength::Selected(Choice { rounds, .. }) => iterations = rounds.unwrap_or(iterations),
        }
        Ok(Plan {
            study: self.study.file.study.id.clone(),
            workloads: self.workloads(&self.chosen(length)?, None)?,
            warmup: section.warmup,
            iterations,
            batches,
            until,
            aa_iterations: if full { section.aa_iterations } else { 0 },
            memory: full || section.memory,
            allocations: full,
            seed: self.study.file.study.seed,
            threads: section.threads,
            pin: section.pin,
            target: self.study.target.clone(),
        })
    }

    /// What a run depends on: the extractions, the plan, and the machine, but not how busy the machine is.
    fn inputs(&self, length: &PlanLength, machine: &Machine) -> Result<Inputs> {
        Ok(Inputs::of_sources(source_digests::TIMINGS)
            .value("machine", &machine.lasting())
            .value("plan", &self.plan(length)?))
    }

    /// What has a time, has not failed and was asked for.
    fn chosen(&self, length: &PlanLength) -> Result<Vec<&Configuration>> {
        match length {
            PlanLength::Selected(Choice { only, .. }) => self.timed_of(only),
            _ => self.timed(),
        }
    }

    /// Of these configurations, or of all where none is named, those that have a time and have not failed.
    pub(super) fn timed_of(&self, only: &[ConfigurationId]) -> Result<Vec<&Configuration>> {
        let mut timed = self.timed()?;
        timed.retain(|configuration| only.is_empty() || only.contains(&configuration.id));
        if timed.is_empty() {
            bail!("none of the configurations that were asked for has a time");
        }
        Ok(timed)
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

/// What the study calls a machine, and the run that it measured.
pub(super) type OnMachine = (String, Stamp);

/// Where the runs of other machines are.
const MACHINES: &str = "bench/machine/";

/// The stage of a machine that the study names.
pub(super) fn machine_stage(name: &str) -> String {
    format!("{MACHINES}{name}")
}

fn stage_name(length: &PlanLength) -> Cow<'static, str> {
    match length {
        PlanLength::Short => "bench/short".into(),
        PlanLength::Full => "bench/full".into(),
        PlanLength::Selected(_) => "bench/selected".into(),
        PlanLength::On(machine) => machine_stage(machine).into(),
    }
}
