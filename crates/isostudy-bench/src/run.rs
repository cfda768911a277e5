//! The run itself: invocation by invocation, turn by turn, every sample kept.

use crate::allocations::AllocationCounts;
use crate::error::BenchError;
use crate::journal::{Entry, JournalError};
use crate::load::{CpuTimes, LEAST_TICKS};
use crate::plan::{Invocation, Plan, Round, Turn};
use crate::profile::differences;
use crate::stages::StageSeconds;
use isostudy_design::ConfigurationId;
use isostudy_design::machine::Machine;
use isostudy_design::record::{
    Allocations, BenchRun, BenchSample, Counters, Failure, LoadWindow, PeakMemory, Resumption,
};
use std::collections::HashSet;
use std::io;

/// Carries out one configuration and says how long its stages took. The only part of a run that takes time, so a
/// test can stand in for it.
pub trait Executor {
    /// Begins an invocation: what is executed from now on must not profit or suffer from what was before. Returns the CPUs
    /// that it is pinned to, if it is.
    ///
    /// # Errors
    /// Whatever stopped it.
    fn begin(&mut self) -> Result<Option<Vec<u32>>, BenchError>;

    /// Executes the configuration with this index.
    ///
    /// # Errors
    /// Whatever stopped it; [`run`] adds which configuration it was.
    fn execute(&mut self, subject: usize) -> Result<Measurement, BenchError>;

    /// What one extraction of the configuration with this index needs, in fresh circumstances; `None` where that cannot
    /// be measured.
    ///
    /// # Errors
    /// Whatever stopped it.
    fn peak_memory(&mut self, subject: usize) -> Result<Option<PeakBytes>, BenchError>;

    /// What one extraction of the configuration with this index, whose memory was measured just before, asks of the allocator; `None`
    /// where nobody counts, which is so unless an executor says otherwise.
    ///
    /// # Errors
    /// Whatever stopped it.
    fn allocations(&mut self, subject: usize) -> Result<Option<AllocationCounts>, BenchError> {
        let _ = subject;
        Ok(None)
    }

    /// Why the configuration with this index may be left out, if it may be after such an error: the others go on without it.
    ///
    /// # Errors
    /// The error given, if the run must end. So it is unless an executor says otherwise.
    fn leave_out(&mut self, subject: usize, error: BenchError) -> Result<String, BenchError> {
        let _ = subject;
        Err(error)
    }

    /// What the CPUs spent their time on until now; `None` where that is not told.
    fn cpu_times(&mut self) -> Option<CpuTimes>;

    /// The one-minute load average; `None` where that is not told.
    fn load_average(&mut self) -> Option<f64>;

    /// Waits long enough for [`Executor::cpu_times`] to show what others do when this program does nothing.
    fn wait(&mut self);
}

/// What one execution took.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Measurement {
    /// Its stages.
    pub stages: StageSeconds,
    /// The [reference work](crate::Reference) just before it, in seconds.
    pub reference_s: Option<f64>,
    /// What else was counted during the execution. A program of before they were counted tells none.
    #[serde(default)]
    pub counters: Counters,
}

/// Resident memory in bytes, as in [`PeakMemory`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[expect(missing_docs, reason = "defined in `PeakMemory`")]
pub struct PeakBytes {
    pub before_bytes: u64,
    pub peak_before_bytes: u64,
    pub peak_bytes: u64,
}

/// Runs the plan over the configurations and returns every sample of the measured rounds and of the A/A block, in the
/// order measured.
///
/// `executor` is called with indices into `ids`, in the order of [`Plan::warm_up`] and [`Plan::turns`] of each of
/// [`Plan::invocations`]. `record` is given every entry as soon as it is there, between executions, never during one.
/// `done` are the entries of a run that was broken off: what they hold is not executed again, and an invocation that was
/// broken off begins anew with its warm-up. `on_turn` is told after each execution how many are done and to be done,
/// those in `done` included. `machine` is recorded as given, and so are the ways in which it differs from the plan's
/// target. 0 threads in the plan are recorded as the machine's.
///
/// # Errors
/// [`BenchError`] if there is nothing to run, an id is there twice, `done` does not follow the plan, an entry cannot be
/// recorded or a configuration fails that the executor does not [leave out](Executor::leave_out), or all have failed; the
/// run ends there.
pub fn run(
    plan: &Plan,
    ids: &[ConfigurationId],
    executor: &mut dyn Executor,
    machine: Machine,
    done: Vec<Entry>,
    record: &mut dyn FnMut(&Entry) -> io::Result<()>,
    on_turn: &mut dyn FnMut(u64, u64),
) -> Result<BenchRun, BenchError> {
    run_until(plan, ids, executor, machine, done, record, on_turn, &|_| false)
}

/// As [`run`], and ends after the first batch with which `enough` is content. It is asked of all that was measured until then.
///
/// # Errors
/// As [`run`].
pub fn run_until(
    plan: &Plan,
    ids: &[ConfigurationId],
    executor: &mut dyn Executor,
    machine: Machine,
    done: Vec<Entry>,
    record: &mut dyn FnMut(&Entry) -> io::Result<()>,
    on_turn: &mut dyn FnMut(u64, u64),
    enough: &dyn Fn(&BenchRun) -> bool,
) -> Result<BenchRun, BenchError> {
    check(plan, ids)?;
    let invocations = plan.invocations();
    let turns: usize =
        invocations.iter().map(|s| plan.warm_up(s, ids.len()).len() + plan.turns(s, ids.len()).len()).sum();
    let memory = if plan.memory { ids.len() } else { 0 };
    let mut running = Running {
        plan,
        ids,
        executor,
        record,
        run: empty(plan, machine),
        failed: vec![false; ids.len()],
        turns_done: 0,
        on_turn,
        total: (turns + memory) as u64,
    };
    let fresh = done.is_empty();
    check_journal(plan, ids, &done)?;
    done.into_iter().for_each(|entry| running.keep(entry));
    if fresh {
        running.watch_idle()?;
    }
    for (batch, number) in invocations.chunks(plan.batch().len()).zip(1..) {
        for invocation in batch {
            running.invoke(invocation)?;
        }
        let [rounds, aa_rounds] = [plan.iterations, plan.aa_iterations].map(|rounds| number * rounds);
        (running.run.iterations, running.run.aa_iterations) = (rounds, aa_rounds);
        // A run that was killed later than this had not had enough here.
        let last = running.run.samples.iter().all(|sample| sample.iteration < rounds);
        if last && enough(&running.run) {
            break;
        }
    }
    running.measure_memory()?;
    Ok(running.finished())
}

/// Rounds per kind and configurations, before anything is measured.
fn check(plan: &Plan, ids: &[ConfigurationId]) -> Result<(), BenchError> {
    if plan.iterations == 0 {
        return Err(BenchError::NoIterations);
    }
    if ids.is_empty() {
        return Err(BenchError::NoConfigurations);
    }
    let mut seen = HashSet::new();
    match ids.iter().find(|id| !seen.insert(*id)) {
        Some(id) => Err(BenchError::Repeated(id.clone())),
        None => Ok(()),
    }
}

/// Checks that what has been measured is what the plan begins with, and can have been measured.
///
/// # Errors
/// [`JournalError::OtherOrder`] or [`JournalError::Invalid`] if it is not.
pub fn check_journal(plan: &Plan, ids: &[ConfigurationId], done: &[Entry]) -> Result<(), BenchError> {
    let invocations = plan.invocations();
    let planned = |aa: bool| {
        let invocations = invocations.iter().filter(move |invocation| invocation.aa == aa);
        invocations.flat_map(|invocation| {
            plan.turns(invocation, ids.len()).into_iter().map(|turn| (invocation.number, turn))
        })
    };
    let (mut measured, mut again, mut memory) = (planned(false), planned(true), ids.iter());
    let mut failed: HashSet<&ConfigurationId> = HashSet::new();
    let is = |next: Option<(u32, Turn)>, sample: &BenchSample| {
        next.is_some_and(|(invocation, turn)| {
            let planned = (invocation, number(turn.round), turn.place, &ids[turn.subject]);
            planned == (sample.invocation, sample.iteration, sample.place, &sample.id)
        })
    };
    let mut follows = true;
    for entry in done {
        let goes_on = |(_, turn): &(u32, Turn)| !failed.contains(&ids[turn.subject]);
        follows &= match entry {
            Entry::Sample(sample) => is(measured.find(goes_on), sample),
            Entry::AaSample(sample) => is(again.find(goes_on), sample),
            Entry::Memory(peak) => memory.find(|id| !failed.contains(id)) == Some(&peak.id),
            Entry::Failed(failure) => ids.contains(&failure.id) && failed.insert(&failure.id),
            Entry::Begun { .. } | Entry::Load(_) | Entry::Allocations(_) | Entry::Resumed(_) => true,
        };
    }
    if !follows {
        return Err(JournalError::OtherOrder.into());
    }
    for entry in done {
        let (sample, rounds) = match entry {
            Entry::Sample(sample) => (sample, plan.iterations * plan.batches.max(1)),
            Entry::AaSample(sample) => (sample, plan.aa_iterations * plan.batches.max(1)),
            _ => continue,
        };
        let invalid = |reason| JournalError::Invalid { id: sample.id.clone(), reason };
        sample.check(rounds).map_err(invalid)?;
    }
    Ok(())
}

fn empty(plan: &Plan, machine: Machine) -> BenchRun {
    let threads = if plan.threads == 0 { machine.threads } else { plan.threads };
    BenchRun {
        schema: BenchRun::SCHEMA,
        study: plan.study.clone(),
        workloads: plan.workloads.clone(),
        imported_from: None,
        warmup: plan.warmup,
        iterations: plan.iterations,
        aa_iterations: plan.aa_iterations,
        seed: plan.seed,
        threads,
        reference_threads: threads,
        pinned: None,
        target: plan.target.clone(),
        differences: differences(&plan.target, &machine),
        machine,
        samples: Vec::new(),
        aa_samples: Vec::new(),
        load: Vec::new(),
        memory: Vec::new(),
        resumed: Vec::new(),
        failed: Vec::new(),
        allocations: Vec::new(),
    }
}

struct Running<'a> {
    plan: &'a Plan,
    ids: &'a [ConfigurationId],
    executor: &'a mut dyn Executor,
    record: &'a mut dyn FnMut(&Entry) -> io::Result<()>,
    run: BenchRun,
    /// Which configurations are left out, by index.
    failed: Vec<bool>,
    on_turn: &'a mut dyn FnMut(u64, u64),
    turns_done: u64,
    total: u64,
}

impl Running<'_> {
    fn keep(&mut self, entry: Entry) {
        match entry {
            Entry::Begun { .. } => {}
            Entry::Sample(sample) => self.run.samples.push(sample),
            Entry::AaSample(sample) => self.run.aa_samples.push(sample),
            Entry::Load(window) => self.run.load.push(window),
            Entry::Memory(memory) => self.run.memory.push(memory),
            Entry::Allocations(counts) => {
                // A run that was killed between them and the memory counted them once more.
                self.run.allocations.retain(|before| before.id != counts.id);
                self.run.allocations.push(counts);
            }
            Entry::Resumed(resumption) => self.run.resumed.push(resumption),
            Entry::Failed(failure) => {
                if let Some(subject) = self.ids.iter().position(|id| *id == failure.id) {
                    self.failed[subject] = true;
                }
                self.run.failed.push(failure);
            }
        }
    }

    fn note(&mut self, entry: Entry) -> Result<(), BenchError> {
        (self.record)(&entry).map_err(BenchError::Record)?;
        self.keep(entry);
        Ok(())
    }

    fn tick(&mut self, turns: u64) {
        self.turns_done += turns;
        (self.on_turn)(self.turns_done, self.total);
    }

    /// Before the first invocation: what others do while this program does nothing.
    fn watch_idle(&mut self) -> Result<(), BenchError> {
        let before = self.executor.cpu_times();
        self.executor.wait();
        self.note_load(before, None, None)
    }

    fn note_load(
        &mut self,
        before: Option<CpuTimes>,
        invocation: Option<u32>,
        rounds: Option<(u32, u32)>,
    ) -> Result<(), BenchError> {
        let shares =
            before.zip(self.executor.cpu_times()).and_then(|(before, after)| after.shares_since(&before));
        let Some(shares) = shares else { return Ok(()) };
        let load_average = self.executor.load_average();
        let window =
            LoadWindow { invocation, rounds, others: shares.others, steal: shares.steal, load_average };
        self.note(Entry::Load(window))
    }

    fn invoke(&mut self, invocation: &Invocation) -> Result<(), BenchError> {
        let turns = self.plan.turns(invocation, self.ids.len());
        let warm_up = self.plan.warm_up(invocation, self.ids.len());
        let samples = if invocation.aa { &self.run.aa_samples } else { &self.run.samples };
        let last = samples.iter().rfind(|sample| sample.invocation == invocation.number);
        // Samples follow the turns: what comes before the last one is measured, or failed.
        let after = |sample: &BenchSample| {
            let is = |turn: &Turn| (number(turn.round), turn.place) == (sample.iteration, sample.place);
            turns.iter().position(is).map_or(0, |place| place + 1)
        };
        let done = last.map_or(0, after);
        let Some(next) = turns[done..].iter().find(|turn| !self.failed[turn.subject]) else {
            self.tick((warm_up.len() + turns.len()) as u64);
            return Ok(());
        };
        if done > 0 {
            self.note(Entry::Resumed(Resumption {
                invocation: invocation.number,
                iteration: number(next.round),
                place: next.place,
            }))?;
        }
        self.run.pinned = self.executor.begin()?;
        for turn in &warm_up {
            self.execute(turn)?;
            self.tick(1);
        }
        self.tick(done as u64);
        let mut window = Window { began: self.executor.cpu_times(), first: None };
        for (place, turn) in turns.iter().enumerate().skip(done) {
            if let Some(measurement) = self.execute(turn)? {
                let sample = self.sample(invocation, turn, &measurement);
                self.note(if invocation.aa { Entry::AaSample(sample) } else { Entry::Sample(sample) })?;
            }
            self.tick(1);
            let last = place + 1 == turns.len();
            if last || turns[place + 1].round != turn.round {
                self.close(invocation, &mut window, number(turn.round), last)?;
            }
        }
        Ok(())
    }

    /// At the end of a round: ends the window if it is long enough to take shares of.
    fn close(
        &mut self,
        invocation: &Invocation,
        window: &mut Window,
        round: u32,
        last: bool,
    ) -> Result<(), BenchError> {
        let first = *window.first.get_or_insert(round);
        let now = self.executor.cpu_times();
        let ticks = window.began.zip(now).map_or(0, |(began, now)| now.ticks_since(&began));
        if last || ticks >= LEAST_TICKS {
            self.note_load(window.began, Some(invocation.number), Some((first, round)))?;
            *window = Window { began: now, first: None };
        }
        Ok(())
    }

    /// One extraction; `None` if the configuration is left out, from now on or before.
    fn execute(&mut self, turn: &Turn) -> Result<Option<Measurement>, BenchError> {
        if self.failed[turn.subject] {
            return Ok(None);
        }
        let ids = self.ids;
        let id = &ids[turn.subject];
        // A NaN would become `null` in the record and spoil every mean: better to stop where it came from.
        let valid = |measurement: Measurement| {
            let sample = measurement.stages.sample(id.clone(), [0; 3], measurement.reference_s);
            BenchSample { counters: measurement.counters, ..sample }.check(1)?;
            Ok(measurement)
        };
        match self.executor.execute(turn.subject).and_then(valid) {
            Ok(measurement) => Ok(Some(measurement)),
            Err(error) => {
                let round = turn.round;
                let failed =
                    |source| BenchError::Configuration { id: id.clone(), round, source: Box::new(source) };
                let reason = self.executor.leave_out(turn.subject, error).map_err(failed)?;
                self.leave_out(turn.subject, reason)?;
                Ok(None)
            }
        }
    }

    /// Goes on without a configuration.
    fn leave_out(&mut self, subject: usize, reason: String) -> Result<(), BenchError> {
        let id = self.ids[subject].clone();
        self.note(Entry::Failed(Failure { id: id.clone(), reason: reason.clone() }))?;
        if self.failed.iter().all(|failed| *failed) {
            let source = Box::new(BenchError::Execution(reason.into()));
            return Err(BenchError::AllFailed { id, source });
        }
        Ok(())
    }

    fn sample(&self, invocation: &Invocation, turn: &Turn, measurement: &Measurement) -> BenchSample {
        let at = [invocation.number, number(turn.round), turn.place];
        let sample = measurement.stages.sample(self.ids[turn.subject].clone(), at, measurement.reference_s);
        BenchSample { counters: measurement.counters, ..sample }
    }

    fn measure_memory(&mut self) -> Result<(), BenchError> {
        if !self.plan.memory {
            return Ok(());
        }
        let ids = self.ids;
        let last = self.run.memory.last().and_then(|last| ids.iter().position(|id| *id == last.id));
        let done = last.map_or(0, |place| place + 1);
        self.tick(done as u64);
        for (subject, id) in ids.iter().enumerate().skip(done) {
            if !self.failed[subject] {
                match self.peak_and_allocations(subject) {
                    // Told for none or for all: a system does not change its mind.
                    Ok((None, None)) => break,
                    Ok((peak, counts)) => {
                        if let Some(AllocationCounts { calls, bytes }) = counts {
                            let id = id.clone();
                            self.note(Entry::Allocations(Allocations { id, calls, bytes }))?;
                        }
                        if let Some(PeakBytes { before_bytes, peak_before_bytes, peak_bytes }) = peak {
                            let id = id.clone();
                            self.note(Entry::Memory(PeakMemory {
                                id,
                                before_bytes,
                                peak_before_bytes,
                                peak_bytes,
                            }))?;
                        }
                    }
                    Err(error) => {
                        let reason = self.executor.leave_out(subject, error)?;
                        self.leave_out(subject, reason)?;
                    }
                }
            }
            self.tick(1);
        }
        Ok(())
    }

    /// Both of one configuration; of a sweep, memory alone.
    fn peak_and_allocations(
        &mut self,
        subject: usize,
    ) -> Result<(Option<PeakBytes>, Option<AllocationCounts>), BenchError> {
        let peak = self.executor.peak_memory(subject)?;
        let counts = if self.plan.allocations { self.executor.allocations(subject)? } else { None };
        Ok((peak, counts))
    }

    /// The run, without anything of configurations that failed: part of the rounds would be compared with all of others'.
    fn finished(self) -> BenchRun {
        let mut run = self.run;
        let failed: Vec<ConfigurationId> = run.failed.iter().map(|failure| failure.id.clone()).collect();
        run.workloads.retain(|workload| !failed.contains(&workload.id));
        run.samples.retain(|sample| !failed.contains(&sample.id));
        run.aa_samples.retain(|sample| !failed.contains(&sample.id));
        run.memory.retain(|peak| !failed.contains(&peak.id));
        run.allocations.retain(|counts| !failed.contains(&counts.id));
        run
    }
}

/// Rounds of an invocation over which the machine is watched.
struct Window {
    began: Option<CpuTimes>,
    first: Option<u32>,
}

fn number(round: Round) -> u32 {
    match round {
        Round::WarmUp(number) | Round::Measured(number) | Round::Again(number) => number,
    }
}

#[cfg(test)]
pub(crate) mod tests;
