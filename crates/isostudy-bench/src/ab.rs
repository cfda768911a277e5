//! Two programs in the same rounds: each configuration by one and at once by the other.
//!
//! A pair of processes, one of each program, measures for a while and ends; then the next pair begins. What chance gives a process
//! stays with it, so that only the medians of many pairs of processes are evidence (see [`Invocation`](crate::Invocation)).

use crate::error::BenchError;
use crate::journal::{self, JournalError};
use crate::load::CpuTimes;
use crate::plan::{Round, order};
use crate::run::{Executor, Measurement};
use isostudy_design::ConfigurationId;
use isostudy_design::record::{AbPair, BenchSample, Failure, LoadWindow};
use serde::{Deserialize, Serialize};
use std::io;
use std::time::{Duration, Instant};

/// Rounds of a pair of processes, however long they take: a median needs some.
pub const LEAST_ROUNDS: u32 = 3;

/// What is run, apart from the configurations.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct AbPlan {
    /// Rounds run and thrown away at the start of every pair of processes.
    pub warmup: u32,
    /// Pairs of processes; at least 1.
    pub processes: u32,
    /// How long all of them take together, in seconds, but that each has three rounds at least.
    pub seconds: f64,
    /// Seed of the order within each round.
    pub seed: u64,
}

/// What was measured.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct AbMeasured {
    /// Pairs, in the order measured.
    pub pairs: Vec<AbPair>,
    /// A window for each pair of processes, where the system tells.
    pub load: Vec<LoadWindow>,
    /// The CPUs that the processes were pinned to.
    pub pinned: Option<Vec<u32>>,
    /// Configurations that were left out, and what was said of each.
    pub failed: Vec<Failure>,
}

/// One line of the journal of such a run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "entry", rename_all = "kebab-case")]
pub enum AbEntry {
    /// The first line.
    Begun {
        /// Digest of everything that the run depends on.
        key: String,
    },
    /// A measured pair.
    Pair(Box<AbPair>),
    /// What the machine did meanwhile.
    Load(LoadWindow),
    /// A configuration failed; from here on it is left out.
    Failed(Failure),
    /// A pair of processes has measured all it should.
    Ended {
        /// Which, from 0.
        invocation: u32,
        /// The CPUs it was pinned to.
        pinned: Option<Vec<u32>>,
    },
}

impl AbEntry {
    /// The entry as a line of JSON, with its end.
    ///
    /// # Panics
    /// Never: the entry is plain data, and its numbers are finite.
    pub fn line(&self) -> String {
        journal::line(self)
    }
}

/// The pairs of processes that a journal has to their ends, as entries; a pair that was broken off is left out, and measured anew.
///
/// # Errors
/// [`JournalError`] if it belongs to another run or is damaged.
pub fn read_ab_journal(text: &str, key: &str) -> Result<Vec<AbEntry>, JournalError> {
    let mut entries: Vec<AbEntry> = journal::entries(text).collect::<Result<_, _>>()?;
    match entries.first() {
        None => return Ok(Vec::new()),
        Some(AbEntry::Begun { key: found }) if found == key => drop(entries.remove(0)),
        Some(_) => return Err(JournalError::OtherRun),
    }
    let ended = entries.iter().rposition(|entry| matches!(entry, AbEntry::Ended { .. }));
    entries.truncate(ended.map_or(0, |last| last + 1));
    Ok(entries)
}

/// Runs the plan with the old program's executor and the new one's, from where `done` ended.
///
/// Which of both is first changes from round to round and from configuration to configuration, so that each is as often first.
/// `record` is given every entry as soon as it is there; `on_pair` how many pairs of processes are done, and of how many. A
/// configuration that fails in either, and that its executor [leaves out](Executor::leave_out), is measured by neither from then on,
/// and nothing of it is returned.
///
/// # Errors
/// [`BenchError`] if there is nothing to run, an entry cannot be recorded, a configuration fails that is not left out, or all have
/// failed.
pub fn run_ab<'a>(
    plan: &'a AbPlan,
    ids: &'a [ConfigurationId],
    programs: [&'a mut (dyn Executor + 'a); 2],
    done: Vec<AbEntry>,
    record: &'a mut (dyn FnMut(&AbEntry) -> io::Result<()> + 'a),
    on_pair: &mut dyn FnMut(u64, u64),
) -> Result<AbMeasured, BenchError> {
    if ids.is_empty() {
        return Err(BenchError::NoConfigurations);
    }
    let mut running = Running { plan, ids, programs, record, measured: AbMeasured::default() };
    let mut ended = 0;
    for entry in done {
        if let AbEntry::Ended { invocation, .. } = &entry {
            ended = invocation + 1;
        }
        running.measured.keep(entry);
    }
    for invocation in ended..plan.processes.max(1) {
        on_pair(u64::from(invocation), u64::from(plan.processes));
        running.invoke(invocation)?;
    }
    on_pair(u64::from(plan.processes), u64::from(plan.processes));
    Ok(running.measured.finished())
}

impl AbMeasured {
    fn keep(&mut self, entry: AbEntry) {
        match entry {
            AbEntry::Begun { .. } => {}
            AbEntry::Pair(pair) => self.pairs.push(*pair),
            AbEntry::Load(window) => self.load.push(window),
            AbEntry::Failed(failure) => self.failed.push(failure),
            AbEntry::Ended { pinned, .. } => self.pinned = pinned,
        }
    }

    fn has_failed(&self, id: &ConfigurationId) -> bool {
        self.failed.iter().any(|failure| failure.id == *id)
    }

    /// Without anything of configurations that failed: some processes would have them and others not.
    fn finished(self) -> Self {
        let failed = self.failed.clone();
        let mut measured = self;
        measured.pairs.retain(|pair| failed.iter().all(|failure| failure.id != pair.old.id));
        measured
    }
}

/// The run: what a pair of processes measures, one after the other.
struct Running<'a> {
    plan: &'a AbPlan,
    ids: &'a [ConfigurationId],
    /// The old one and the new one.
    programs: [&'a mut (dyn Executor + 'a); 2],
    record: &'a mut (dyn FnMut(&AbEntry) -> io::Result<()> + 'a),
    measured: AbMeasured,
}

impl Running<'_> {
    fn note(&mut self, entry: AbEntry) -> Result<(), BenchError> {
        (self.record)(&entry).map_err(BenchError::Record)?;
        self.measured.keep(entry);
        Ok(())
    }

    fn invoke(&mut self, invocation: u32) -> Result<(), BenchError> {
        // Who starts first may get other memory.
        let first = (invocation % 2) as usize;
        let began = Instant::now();
        self.programs[first].begin()?;
        let pinned = self.programs[1 - first].begin()?;
        for round in 0..self.plan.warmup {
            self.round(invocation, Round::WarmUp(round))?;
        }
        let budget = Duration::from_secs_f64(self.plan.seconds / f64::from(self.plan.processes.max(1)));
        let before = busy(&mut self.programs);
        let mut round = 0;
        while round < LEAST_ROUNDS || began.elapsed() < budget {
            for pair in self.round(invocation, Round::Measured(round))? {
                self.note(AbEntry::Pair(Box::new(pair)))?;
            }
            round += 1;
        }
        if let Some(window) = self.load(before, invocation, round) {
            self.note(AbEntry::Load(window))?;
        }
        self.note(AbEntry::Ended { invocation, pinned })
    }

    fn round(&mut self, invocation: u32, round: Round) -> Result<Vec<AbPair>, BenchError> {
        let (Round::WarmUp(number) | Round::Measured(number) | Round::Again(number)) = round;
        // No order twice, as far as 65,536 rounds go.
        let stream = (invocation << 16) + number;
        let places = order(self.plan.seed, stream, self.ids.len()).into_iter().zip(0_u32..);
        let mut pairs = Vec::new();
        for (subject, place) in places {
            let id = &self.ids[subject];
            if self.measured.has_failed(id) {
                continue;
            }
            let new_first = (number as usize + subject + invocation as usize) % 2 == 1;
            let mut sides = [None; 2];
            for side in if new_first { [1, 0] } else { [0, 1] } {
                match self.programs[side].execute(subject) {
                    Ok(measurement) => sides[side] = Some(measurement),
                    Err(error) => {
                        self.leave_out((side, subject), round, error)?;
                        break;
                    }
                }
            }
            let at = [invocation, number, place];
            let [old, new] = sides.map(|side| side.map(|side| sample(&side, id, at)));
            // One that failed has no pair.
            if let (Some(old), Some(new)) = (old, new) {
                old.check(u32::MAX)?;
                new.check(u32::MAX)?;
                pairs.push(AbPair { new_first, old, new });
            }
        }
        Ok(pairs)
    }

    /// Goes on without a configuration, if its executor lets it.
    fn leave_out(
        &mut self,
        (side, subject): (usize, usize),
        round: Round,
        error: BenchError,
    ) -> Result<(), BenchError> {
        let id = self.ids[subject].clone();
        let failed = |source| BenchError::Configuration { id: id.clone(), round, source: Box::new(source) };
        let reason = self.programs[side].leave_out(subject, error).map_err(failed)?;
        let reason = format!("asked by {}: {reason}", ["OLD", "NEW"][side]);
        self.note(AbEntry::Failed(Failure { id: id.clone(), reason: reason.clone() }))?;
        if self.ids.iter().all(|id| self.measured.has_failed(id)) {
            let source = Box::new(BenchError::Execution(reason.into()));
            return Err(BenchError::AllFailed { id, source });
        }
        Ok(())
    }

    fn load(&mut self, before: Option<CpuTimes>, invocation: u32, rounds: u32) -> Option<LoadWindow> {
        let shares = busy(&mut self.programs)?.shares_since(&before?)?;
        Some(LoadWindow {
            invocation: Some(invocation),
            rounds: Some((0, rounds - 1)),
            others: shares.others,
            steal: shares.steal,
            load_average: self.programs[0].load_average(),
        })
    }
}

fn sample(measurement: &Measurement, id: &ConfigurationId, at: [u32; 3]) -> BenchSample {
    let sample = measurement.stages.sample(id.clone(), at, measurement.reference_s);
    BenchSample { counters: measurement.counters, ..sample }
}

/// What the CPUs did: neither program is another one to us. Each reading has this process in it, which is counted once.
fn busy(programs: &mut [&mut (dyn Executor + '_); 2]) -> Option<CpuTimes> {
    let this = CpuTimes::read(&[std::process::id()], None).map_or(0, |times| times.own);
    let (old, new) = (programs[0].cpu_times()?, programs[1].cpu_times()?);
    Some(CpuTimes { own: (old.own + new.own).saturating_sub(this), ..new })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::tests::{Mock, ids};

    fn plan(processes: u32) -> AbPlan {
        AbPlan { warmup: 1, processes, seconds: 0.0, seed: 7 }
    }

    fn run(plan: &AbPlan, done: Vec<AbEntry>, mocks: [&mut Mock; 2]) -> (AbMeasured, Vec<AbEntry>) {
        let mut entries = Vec::new();
        let mut record = |entry: &AbEntry| {
            entries.push(entry.clone());
            Ok(())
        };
        let [old, new] = mocks;
        let measured = run_ab(plan, &ids(), [old, new], done, &mut record, &mut |_, _| ()).unwrap();
        (measured, entries)
    }

    #[test]
    fn each_round_has_every_configuration_by_both_and_both_are_as_often_first() {
        let (mut old, mut new) = (Mock::default(), Mock::default());
        let (measured, _) = run(&plan(4), Vec::new(), [&mut old, &mut new]);
        assert_eq!(measured.pairs.len(), 4 * 3 * 4);
        assert_eq!(
            old.invocations,
            [0, 16, 32, 48],
            "a process of its own for each, with a round of warm-up"
        );
        assert_eq!(old.calls, new.calls, "in one order");
        for id in ids() {
            let own: Vec<&AbPair> = measured.pairs.iter().filter(|pair| pair.old.id == id).collect();
            let first = own.iter().filter(|pair| pair.new_first).count();
            assert_eq!((own.len(), first), (12, 6));
        }
        assert!(measured.pairs.iter().all(|pair| pair.check() == Ok(())));
    }

    #[test]
    fn what_was_killed_goes_on_after_the_last_processes_that_ended() {
        let plan = plan(4);
        let (whole, entries) = run(&plan, Vec::new(), [&mut Mock::default(), &mut Mock::default()]);
        let begun = AbEntry::Begun { key: "k".into() };
        let text: String = [&begun].into_iter().chain(&entries).map(AbEntry::line).collect();
        assert_eq!(read_ab_journal(&text, "k").unwrap(), entries);
        assert_eq!(read_ab_journal(&text, "other"), Err(JournalError::OtherRun));
        // In the middle of a line of the third pair of processes.
        let cut = text.len() * 6 / 10;
        let done = read_ab_journal(&text[..cut], "k").unwrap();
        let (mut old, mut new) = (Mock::default(), Mock::default());
        let (again, _) = run(&plan, done, [&mut old, &mut new]);
        assert_eq!(old.invocations.len(), 2, "two of four were done");
        assert_eq!(new.invocations.len(), 2);
        let at = |run: &AbMeasured| -> Vec<(u32, u32, u32, bool)> {
            let of = |p: &AbPair| (p.old.invocation, p.old.iteration, p.old.place, p.new_first);
            run.pairs.iter().map(of).collect()
        };
        assert_eq!(at(&again), at(&whole), "and nothing is there twice");
    }

    /// A process pair of four rounds has 16 calls of each program. Call 22 is in the second, so three configurations are left for the
    /// rest of its run, and what was measured of the fourth is not returned.
    #[test]
    fn what_fails_in_one_program_is_measured_by_neither() {
        let (mut old, mut new) = (Mock::default(), Mock::failing_at(22, true));
        let (measured, entries) = run(&plan(3), Vec::new(), [&mut old, &mut new]);
        let [failure] = &measured.failed[..] else { panic!("{:?}", measured.failed) };
        let (failed, reason) = (new.calls[22], "asked by NEW: the mock was told to fail");
        assert_eq!((&failure.id, failure.reason.as_str()), (&ids()[failed], reason));
        assert_eq!(measured.pairs.len(), 3 * 3 * 3);
        assert!(measured.pairs.iter().all(|pair| pair.old.id != failure.id));
        for mock in [&old, &new] {
            assert_eq!(mock.calls[23..].iter().filter(|&&call| call == failed).count(), 0, "not asked again");
        }
        // What ended before it was killed knows who failed.
        let begun = AbEntry::Begun { key: "k".into() };
        let text: String = [&begun].into_iter().chain(&entries).map(AbEntry::line).collect();
        let last = text.trim_end().rfind('\n').unwrap();
        let done = read_ab_journal(&text[..last], "k").unwrap();
        let mut again = Mock::default();
        let (resumed, _) = run(&plan(3), done, [&mut again, &mut Mock::default()]);
        assert_eq!(resumed.failed, measured.failed);
        assert!(!again.calls.contains(&failed));
    }

    #[test]
    fn a_failure_that_is_not_left_out_ends_the_run_by_name() {
        let mut failing = Mock::failing_at(5, false);
        let mut nothing = |_: &AbEntry| Ok(());
        let programs: [&mut dyn Executor; 2] = [&mut failing, &mut Mock::default()];
        let error = run_ab(&plan(2), &ids(), programs, Vec::new(), &mut nothing, &mut |_, _| ()).unwrap_err();
        let BenchError::Configuration { id, round, .. } = error else { panic!("{error}") };
        assert_eq!((id, round), (ids()[failing.calls[5]].clone(), Round::Measured(0)));
    }
}
