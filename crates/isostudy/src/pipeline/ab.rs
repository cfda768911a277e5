//! Two builds of this program, timed in turn.

use super::formats::write_table;
use super::worker::is_program;
use super::{Pipeline, expected};
use crate::store::{Inputs, remove_if_there, sha256, write_whole};
use crate::terminal::progress::Step;
use crate::terminal::tell_once;
use crate::{input, machine};
use anyhow::{Context, Result};
use isostudy_bench::{AbEntry, AbPlan, Allowance, BenchError, LEAST_ROUNDS, ProcessExecutor, run_ab};
use isostudy_design::ConfigurationId;
use isostudy_design::record::{AbProgram, AbRun, Purpose};
use isostudy_timing::{CountRow, CountRun};
use std::cell::Cell;
use std::fs::File;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;

const STAGE: &str = "bench/ab";
const COUNT_STAGE: &str = "bench/count";

/// What is timed, and how.
#[derive(Debug, Clone)]
pub(crate) struct AbChoice {
    pub(crate) old: Build,
    pub(crate) new: Build,
    /// Configurations; none for all.
    pub(crate) only: Vec<ConfigurationId>,
    /// Pairs of processes.
    pub(crate) processes: u32,
    /// For all of them together.
    pub(crate) seconds: f64,
    /// For each answer of a program.
    pub(crate) time_limit: Duration,
}

/// A build of this program.
#[derive(Debug, Clone)]
pub(crate) struct Build {
    /// The program, or a folder of its links.
    pub(crate) path: PathBuf,
    /// Its links, one or more, whose code is in another order each.
    pub(crate) links: Vec<PathBuf>,
}

impl Pipeline<'_> {
    /// Times both, and returns what was measured; a killed run goes on after the last pair of processes that ended.
    ///
    /// # Errors
    /// If a program cannot be read, started or asked, or a file not be written.
    pub(crate) fn ab(&self, choice: &AbChoice) -> Result<AbRun> {
        if self.spacings().is_empty() {
            self.budgets(&[Purpose::Benchmark], &choice.only)?;
        }
        let machine = machine::read();
        // Either may be anybody's. Three quarters leave the machine to go on with.
        let memory_bytes = machine.memory_bytes.map(|bytes| bytes / 4 * 3);
        let allowance = Allowance { time: choice.time_limit, memory_bytes };
        let section = &self.study.file.benchmark;
        let configurations = self.timed_of(&choice.only)?;
        let plan = AbPlan {
            warmup: section.warmup.min(1),
            processes: choice.processes,
            seconds: choice.seconds,
            seed: self.study.file.study.seed,
        };
        let [old, new] = [program(&choice.old)?, program(&choice.new)?];
        let workloads = self.workloads(&configurations, None)?;
        let inputs = || {
            Inputs::default()
                .value("programs", &[&old.sha256, &new.sha256])
                .value("plan", &plan)
                .value("threads", &(section.threads, section.pin))
                .value("workloads", &workloads)
                .value("machine", &machine.lasting())
        };
        let (journal, key) = (self.store.journal(STAGE), inputs().finish());
        let ids: Vec<ConfigurationId> = configurations.iter().map(|c| c.id.clone()).collect();
        let step = Step::begin("bench ab", plan.processes as usize, 0);
        let stamp = self.stage(STAGE, inputs(), |writer| {
            let done = self.take_up_ab(&journal, &key)?;
            // Each pair of processes has its least number of rounds, however long they take.
            let cost = self.round_cost(&configurations)?;
            let least = f64::from(plan.processes * (plan.warmup + LEAST_ROUNDS)) * 2.0 * cost.seconds;
            tell!(
                "bench ab: {}, {} by both in {} pairs of processes{}",
                expected::about(least.max(plan.seconds)),
                expected::configurations_in_words(configurations.len()),
                plan.processes,
                expected::beside(cost.untried)
            );
            let begun = AbEntry::Begun { key: key.clone() };
            let lines: String = [&begun].into_iter().chain(&done).map(AbEntry::line).collect();
            write_whole(&journal, lines.as_bytes())?;
            let mut file =
                File::options().append(true).open(&journal).with_context(|| journal.display().to_string())?;
            let mut record = |entry: &AbEntry| file.write_all(entry.line().as_bytes());
            let (_folder, spacings) = self.spacings_file()?;
            let told = self.invocation([section.threads, u32::from(section.pin)], &ids, &spacings)?;
            // A pair of processes has the links of its own number.
            let ended = done.iter().filter(|entry| matches!(entry, AbEntry::Ended { .. })).count();
            let begun = [Cell::new(ended), Cell::new(ended)];
            let command = |side: usize, build: &Build| -> Command {
                let number = begun[side].replace(begun[side].get() + 1);
                told.command(&build.links[number % build.links.len()])
            };
            let (of_old, of_new) = (|| command(0, &choice.old), || command(1, &choice.new));
            let may_fail = |number: usize| is_program(self.study, configurations[number]);
            let [mut of_old, mut of_new] = [&of_old as &dyn Fn() -> Command, &of_new]
                .map(|command| ProcessExecutor::new(command).leaving_out(&may_fail).telling(tell_once))
                .map(|executor| executor.within(allowance));
            let on_pair = &mut |done, all| step.set(done, all);
            let measured = run_ab(&plan, &ids, [&mut of_old, &mut of_new], done, &mut record, on_pair)?;
            let mut workloads = workloads.clone();
            workloads.retain(|workload| measured.failed.iter().all(|failure| failure.id != workload.id));
            let run = AbRun {
                schema: AbRun::SCHEMA,
                study: self.study.file.study.id.clone(),
                workloads,
                old: old.clone(),
                new: new.clone(),
                warmup: plan.warmup,
                processes: plan.processes,
                seed: plan.seed,
                threads: if section.threads == 0 { machine.threads } else { section.threads },
                pinned: measured.pinned,
                machine: machine.clone(),
                pairs: measured.pairs,
                load: measured.load,
                failed: measured.failed,
            };
            writer.write_json(&format!("{STAGE}/ab.json"), &run)?;
            write_table(writer, STAGE, &isostudy_timing::ab(&run).table())
        })?;
        remove_if_there(&journal)?;
        step.count_all(stamp.redone);
        step.end();
        if !stamp.redone {
            tell!("bench ab: nothing was measured; --force measures again");
        }
        let path = self.store.root().join(stamp.file("ab.json"));
        let run: AbRun =
            serde_json::from_slice(&input::bytes(&path)?).with_context(|| path.display().to_string())?;
        for (pair, place) in run.pairs.iter().zip(0..) {
            pair.check().with_context(|| format!("{}: pairs[{place}]", path.display()))?;
        }
        // Said again by every run that goes on from these times.
        self.leave_out_failed(&run.failed);
        Ok(run)
    }

    /// Counts the instructions of an extraction by both builds, and returns them. Configurations of programs are left out: valgrind
    /// would count the program that asks them.
    ///
    /// # Errors
    /// If a program or valgrind cannot be read, started or asked, or a file not be written.
    pub(crate) fn counted(
        &self,
        builds: &[Build; 2],
        only: &[ConfigurationId],
        time_limit: Duration,
    ) -> Result<CountRun> {
        if self.spacings().is_empty() {
            self.budgets(&[Purpose::Benchmark], only)?;
        }
        let mut configurations = self.timed_of(only)?;
        let all = configurations.len();
        configurations.retain(|configuration| !is_program(self.study, configuration));
        if configurations.len() < all {
            let left_out = expected::configurations_in_words(all - configurations.len());
            tell!(
                "bench count: {left_out} of programs are left out: valgrind would count the program that asks them"
            );
        }
        anyhow::ensure!(
            !configurations.is_empty(),
            "all configurations are programs: nothing can be counted"
        );
        let [old, new] = [program(&builds[0])?, program(&builds[1])?];
        let workloads = self.workloads(&configurations, None)?;
        let inputs =
            Inputs::default().value("programs", &[&old.sha256, &new.sha256]).value("workloads", &workloads);
        let step = Step::begin("bench count", 2 * configurations.len(), 0);
        let stamp = self.stage(COUNT_STAGE, inputs, |writer| {
            let (_folder, spacings) = self.spacings_file()?;
            let ids: Vec<ConfigurationId> = configurations.iter().map(|c| c.id.clone()).collect();
            // One thread, wherever it is.
            let told = self.invocation([1, 0], &ids, &spacings)?;
            let allowance = Allowance { time: time_limit, memory_bytes: None };
            let mut rows = Vec::new();
            for (subject, id) in ids.iter().enumerate() {
                let count = |side: usize| -> Result<u64> {
                    let command = || told.command(&builds[side].links[0]);
                    let found = isostudy_bench::instructions(&command, subject, allowance);
                    step.set(2 * subject as u64 + side as u64 + 1, 2 * ids.len() as u64);
                    let side = ["OLD", "NEW"][side];
                    found.with_context(|| {
                        format!("{id} by {side}, under valgrind (Debian: apt install valgrind)")
                    })
                };
                rows.push(CountRow { id: id.clone(), old: count(0)?, new: count(1)? });
            }
            let study = self.study.file.study.id.clone();
            let run = CountRun { schema: CountRun::SCHEMA, study, old: old.clone(), new: new.clone(), rows };
            writer.write_json(&format!("{COUNT_STAGE}/count.json"), &run)?;
            write_table(writer, COUNT_STAGE, &run.table())
        })?;
        step.count_all(stamp.redone);
        step.end();
        let path = self.store.root().join(stamp.file("count.json"));
        serde_json::from_slice(&input::bytes(&path)?).with_context(|| path.display().to_string())
    }

    fn take_up_ab(&self, journal: &Path, key: &str) -> Result<Vec<AbEntry>> {
        let Ok(text) = std::fs::read_to_string(journal) else { return Ok(Vec::new()) };
        if self.store.forced() {
            return Ok(Vec::new());
        }
        match isostudy_bench::read_ab_journal(&text, key).map_err(BenchError::from) {
            Ok(done) => {
                if !done.is_empty() {
                    tell!("bench ab: an unfinished run is gone on with ({} entries)", done.len());
                }
                Ok(done)
            }
            Err(error) => {
                let error = anyhow::Error::from(error);
                tell!("bench ab: begun anew; {} is not gone on from: {error:#}", journal.display());
                Ok(Vec::new())
            }
        }
    }
}

/// What a program's file holds is what it is, wherever it lies.
fn program(build: &Build) -> Result<AbProgram> {
    let digest = |path: &PathBuf| -> Result<String> {
        let bytes = input::bytes(path).context("cannot read the program")?;
        Ok(sha256(&bytes))
    };
    let digests: Vec<String> = build.links.iter().map(digest).collect::<Result<_>>()?;
    let digest = match &digests[..] {
        [one] => one.clone(),
        all => sha256(all.concat().as_bytes()),
    };
    Ok(AbProgram { path: build.path.display().to_string(), sha256: digest, links: digests.len() as u32 })
}
