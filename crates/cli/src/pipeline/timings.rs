//! The benchmark: every configuration timed, in rounds.

use super::Pipeline;
use crate::progress::Step;
use crate::store::{Inputs, Stamp};
use crate::{rooms, subject};
use anyhow::Result;
use bench::{ExtractExecutor, Plan, Subject};
use design::ConfigurationId;
use design::machine::Machine;
use design::record::{BenchRun, Purpose};

/// How many rounds are run.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum PlanLength {
    /// `benchmark.short_iterations`, for a whole study in minutes.
    Short,
    /// `benchmark.iterations`, as in the paper.
    Full,
}

impl Pipeline<'_> {
    /// Times every configuration. The short plan is not run where a full run is up to date: the full one stands for it.
    pub(crate) fn timings(&self, length: PlanLength) -> Result<Stamp> {
        let machine = bench::read_machine();
        if length == PlanLength::Short
            && let Some(full) =
                self.store.peek(stage_name(PlanLength::Full), self.inputs(PlanLength::Full, &machine)?)
        {
            return Ok(full);
        }
        let plan = self.plan(length);
        let inputs = self.inputs(length, &machine)?;
        let rounds = (plan.warmup + plan.iterations) as usize;
        let count = self.study.configurations.len();
        let step = Step::begin("timings", count * plan.iterations as usize, count * rounds);
        let stamp = self.stage(stage_name(length), inputs, |writer| {
            let run = self.run(&plan, machine, &step)?;
            let folder = stage_name(length);
            writer.write_json(&format!("{folder}/run.json"), &run)?;
            writer.write(&format!("{folder}/samples.csv"), bench::samples_csv(&run).as_bytes())?;
            writer.write(&format!("{folder}/machine.csv"), bench::machine_csv(&run).as_bytes())
        })?;
        step.count_all(stamp.redone);
        step.end();
        Ok(stamp)
    }

    /// A finished run.
    pub(crate) fn bench_run(&self, stamp: &Stamp) -> Result<BenchRun> {
        let text = std::fs::read(self.store.root().join(stamp.file("run.json")))?;
        Ok(serde_json::from_slice(&text)?)
    }

    fn plan(&self, length: PlanLength) -> Plan {
        let section = &self.study.file.benchmark;
        Plan {
            study: self.study.file.study.id.clone(),
            warmup: section.warmup,
            iterations: match length {
                PlanLength::Short => section.short_iterations,
                PlanLength::Full => section.iterations,
            },
            seed: self.study.file.study.seed,
            threads: section.threads,
            target: self.study.target.clone(),
        }
    }

    fn run(&self, plan: &Plan, machine: Machine, step: &Step) -> Result<BenchRun> {
        let mut subjects = Vec::new();
        for configuration in &self.study.configurations {
            let object = self.study.object(configuration);
            let (spacing, _) = subject::spacing(object, Purpose::Benchmark);
            subjects.push(Subject {
                id: configuration.id.clone(),
                field: self.fields.get(configuration.object)?,
                lattice: subject::lattice(object, configuration.id.method.arrangement, spacing)?,
                settings: subject::settings(self.study, configuration, Purpose::Benchmark),
            });
        }
        let ids: Vec<ConfigurationId> = subjects.iter().map(|subject| subject.id.clone()).collect();
        let mut executor = ExtractExecutor::new(&subjects, plan.threads);
        Ok(bench::run(plan, &ids, &mut executor, machine, &mut |_, _| step.tick(1))?)
    }

    /// What a run depends on: the extractions, the plan, and the machine, but not how busy the machine is.
    fn inputs(&self, length: PlanLength, machine: &Machine) -> Result<Inputs> {
        let machine = Machine { load: None, governor: None, ..machine.clone() };
        let plan = self.plan(length);
        let mut inputs = Inputs::of_rooms(rooms::TIMINGS)
            .value("machine", &machine)
            .value("target", &plan.target)
            .value("plan", &(plan.warmup, plan.iterations, plan.seed, plan.threads))
            .value("extraction", &self.study.file.extraction)
            .value("methods", &self.study.methods());
        for object in &self.study.file.objects {
            inputs = inputs
                .value("volume", &(object.min, object.max, object.benchmark_spacing, object.isovalue))
                .text("field", &subject::field_inputs(self.study, object)?);
        }
        Ok(inputs)
    }
}

fn stage_name(length: PlanLength) -> &'static str {
    match length {
        PlanLength::Short => "bench/short",
        PlanLength::Full => "bench/full",
    }
}
