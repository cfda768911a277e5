use super::*;
use isostudy_design::Stage;
use isostudy_design::machine::{Build, IsaLevel};
use isostudy_design::record::StageCounts;
use std::collections::HashMap;
use std::error::Error;

/// Times made up from the subject and the number of the call, and a list of the calls. Every call is 30 ticks of CPU time:
/// 20 its own, and of the rest what `others` says.
#[derive(Default)]
pub(crate) struct Mock {
    pub(crate) calls: Vec<usize>,
    pub(crate) invocations: Vec<usize>,
    fail_at_call: Option<usize>,
    nan_at_call: Option<usize>,
    /// Whether the run goes on without what failed.
    leaves_out: bool,
    others: u64,
    waited: u64,
    memory_asked: Vec<usize>,
    without_memory: bool,
}

impl Mock {
    /// One that fails at this call, counted from 0; the run then goes on without what failed, or ends.
    pub(crate) fn failing_at(call: usize, leaves_out: bool) -> Self {
        Self { fail_at_call: Some(call), leaves_out, ..Self::default() }
    }
}

impl Executor for Mock {
    fn begin(&mut self) -> Result<Option<Vec<u32>>, BenchError> {
        self.invocations.push(self.calls.len());
        Ok(Some(vec![0, 2]))
    }

    fn execute(&mut self, subject: usize) -> Result<Measurement, BenchError> {
        assert!(!self.invocations.is_empty(), "executed before the first invocation");
        let call = self.calls.len();
        self.calls.push(subject);
        if self.fail_at_call == Some(call) {
            return Err(BenchError::Execution("the mock was told to fail".into()));
        }
        let normals_s = if self.nan_at_call == Some(call) { f64::NAN } else { 1e-7 * call as f64 };
        let stages = StageSeconds {
            allocation_s: 0.001,
            sampling_s: 0.01 * (subject + 1) as f64,
            vertex_s: 0.1,
            geometry_s: 0.3,
            clustering_s: 0.7,
            normals_s,
            finishing_s: 0.0,
        };
        let counters = Counters { page_faults: Some(subject as u64), ..Counters::default() };
        Ok(Measurement { stages, reference_s: Some(0.001), counters })
    }

    fn leave_out(&mut self, _: usize, error: BenchError) -> Result<String, BenchError> {
        if self.leaves_out { Ok(error.to_string()) } else { Err(error) }
    }

    fn peak_memory(&mut self, subject: usize) -> Result<Option<PeakBytes>, BenchError> {
        self.memory_asked.push(subject);
        let bytes = PeakBytes { before_bytes: 1, peak_before_bytes: 2, peak_bytes: 3 + subject as u64 };
        Ok((!self.without_memory).then_some(bytes))
    }

    fn allocations(&mut self, subject: usize) -> Result<Option<AllocationCounts>, BenchError> {
        assert_eq!(self.memory_asked.last(), Some(&subject), "in the process that measured its memory");
        let of = |count| StageCounts { total: count, ..StageCounts::default() };
        Ok((!self.without_memory).then(|| AllocationCounts { calls: of(7), bytes: of(subject as u64) }))
    }

    fn cpu_times(&mut self) -> Option<CpuTimes> {
        let calls = self.calls.len() as u64;
        let idle = (10 - self.others) * calls + 90 * self.waited;
        Some(CpuTimes { total: 30 * calls + 100 * self.waited, idle, steal: 0, own: 20 * calls })
    }

    fn load_average(&mut self) -> Option<f64> {
        Some(1.5)
    }

    fn wait(&mut self) {
        self.waited += 1;
    }
}

pub(crate) fn machine() -> Machine {
    Machine {
        model: Some("11th Gen Intel(R) Core(TM) i7-11700 @ 2.50GHz".into()),
        cores: Some(8),
        threads: 16,
        memory_bytes: Some(33_421_000_000),
        l1d_kib: Some(48),
        l2_kib: Some(512),
        l3_kib: Some(16384),
        os: "windows".into(),
        isa: Some(IsaLevel::V3),
        features: ["avx2", "bmi1", "bmi2", "fma"].map(String::from).into(),
        load: Some(0.25),
        build: Build { compiler: "rustc 1.95.0".into(), target_cpu: "x86-64-v3".into(), ..Build::default() },
        ..Machine::default()
    }
}

/// Invocations of 2, 1, 1, 1 and 2 rounds, the second and fourth of the A/A block.
pub(crate) fn plan() -> Plan {
    Plan {
        study: "mock".into(),
        workloads: Vec::new(),
        warmup: 2,
        iterations: 5,
        batches: 1,
        until: None,
        aa_iterations: 2,
        memory: true,
        allocations: true,
        seed: 2026,
        threads: 0,
        pin: true,
        target: toml::from_str("name = \"any\"\nmodel = \"\"").unwrap(),
    }
}

pub(crate) fn ids() -> Vec<ConfigurationId> {
    ["ss_bu", "ss_bi", "as_sp", "bs_su"].iter().map(|id| id.parse().unwrap()).collect()
}

#[test]
fn a_run_ends_after_the_batch_that_is_enough() {
    let plan = Plan { batches: 4, until: Some(0.05), memory: false, ..plan() };
    let until = |batches: usize, done: Vec<Entry>, mock: &mut Mock| {
        let mut entries = Vec::new();
        let mut record = |entry: &Entry| {
            entries.push(entry.clone());
            Ok(())
        };
        let enough = |run: &BenchRun| run.samples.len() >= batches * 5 * 4;
        let run = run_until(&plan, &ids(), mock, machine(), done, &mut record, &mut |_, _| (), &enough);
        (run, entries)
    };
    let (run, entries) = until(2, Vec::new(), &mut Mock::default());
    let run = run.unwrap();
    assert_eq!((run.iterations, run.aa_iterations), (10, 4));
    assert_eq!((run.samples.len(), run.aa_samples.len()), (10 * 4, 4 * 4));
    assert_eq!(run.check(), Ok(()));
    // Killed in its second batch and taken up again, it ends with the same batch and measures nothing twice.
    let done: Vec<Entry> =
        entries.into_iter().filter(|entry| !matches!(entry, Entry::Load(_))).take(35).collect();
    let mut mock = Mock::default();
    let (again, _) = until(2, done, &mut mock);
    let again = again.unwrap();
    assert_eq!((again.iterations, again.samples.len()), (10, 40));
    // A whole batch is 68 calls, with warm-up.
    assert!(mock.calls.len() < 68, "{}", mock.calls.len());
    let (all, _) = until(9, Vec::new(), &mut Mock::default());
    assert_eq!(all.unwrap().iterations, 20, "and no more than the plan has");
}

fn run_with(plan: &Plan, mock: &mut Mock) -> Result<BenchRun, BenchError> {
    run(plan, &ids(), mock, machine(), Vec::new(), &mut |_| Ok(()), &mut |_, _| ())
}

pub(crate) fn mock_run() -> BenchRun {
    run_with(&plan(), &mut Mock::default()).unwrap()
}

/// A run as far as call `calls`, where the executor fails, and what it had recorded by then.
fn broken_off(calls: usize) -> Vec<Entry> {
    let mut entries = Vec::new();
    let mut record = |entry: &Entry| {
        entries.push(entry.clone());
        Ok(())
    };
    let mut mock = Mock { fail_at_call: Some(calls), ..Default::default() };
    run(&plan(), &ids(), &mut mock, machine(), Vec::new(), &mut record, &mut |_, _| ()).unwrap_err();
    entries
}

fn resumed(done: Vec<Entry>, mock: &mut Mock) -> Result<BenchRun, BenchError> {
    run(&plan(), &ids(), mock, machine(), done, &mut |_| Ok(()), &mut |_, _| ())
}

#[test]
fn every_invocation_is_a_fresh_one_and_warms_up() {
    let mut mock = Mock::default();
    let run = run_with(&plan(), &mut mock).unwrap();
    // Each of the five has two rounds of warm-up, of four configurations, before its own.
    assert_eq!(mock.invocations, [0, 4 * 3, 4 * 6, 4 * 10, 4 * 13]);
    assert_eq!(mock.calls.len(), 4 * (5 * 2 + 5 + 2));
    assert_eq!((run.samples.len(), run.aa_samples.len()), (5 * 4, 2 * 4));
    // The mock's normals count calls: the first sample kept is the ninth call.
    assert_eq!(run.samples[0].normals_s, 1e-7 * 8.0);
    let faults = |sample: &BenchSample| sample.counters.page_faults.unwrap() as usize;
    assert!(run.samples.iter().all(|sample| sample.id == ids()[faults(sample)]), "counted with its sample");
    let invocations: Vec<u32> = run.samples.iter().map(|sample| sample.invocation).collect();
    assert_eq!(invocations, [[0; 4], [2; 4], [2; 4], [4; 4], [4; 4]].concat());
    assert_eq!(run.pinned, Some(vec![0, 2]));
}

#[test]
fn every_configuration_once_a_round() {
    let run = mock_run();
    for samples in [&run.samples, &run.aa_samples] {
        for (round, iteration) in samples.chunks(4).zip(0..) {
            assert!(round.iter().all(|sample| sample.iteration == iteration));
            assert_eq!(round.iter().map(|sample| sample.place).collect::<Vec<_>>(), [0, 1, 2, 3]);
            let seen: HashSet<_> = round.iter().map(|sample| &sample.id).collect();
            assert_eq!(seen.len(), 4);
        }
    }
    let mut counts = HashMap::new();
    run.samples.iter().for_each(|sample| *counts.entry(&sample.id).or_insert(0) += 1);
    assert!(counts.values().all(|count| *count == 5), "{counts:?}");
}

#[test]
fn samples_carry_the_id_that_was_executed() {
    let run = mock_run();
    for sample in run.samples.iter().chain(&run.aa_samples) {
        let subject = ids().iter().position(|id| *id == sample.id).unwrap();
        assert_eq!(sample.sampling_s, 0.01 * (subject + 1) as f64);
    }
}

#[test]
fn stages_add_up() {
    for sample in mock_run().samples {
        let sum = Stage::ALL[..6].iter().fold(0.0, |sum, stage| sum + stage.of(&sample));
        assert_eq!(sum, sample.total_s);
        assert!(Stage::ALL[..6].iter().all(|stage| stage.of(&sample) > 0.0), "no stage is left out");
    }
}

#[test]
fn the_same_plan_gives_the_same_run() {
    assert_eq!(mock_run(), mock_run());
    let other = run_with(&Plan { seed: 1, ..plan() }, &mut Mock::default());
    let order = |run: &BenchRun| run.samples.iter().map(|s| s.id.to_string()).collect::<Vec<_>>();
    assert_ne!(order(&other.unwrap()), order(&mock_run()));
}

#[test]
fn progress_counts_every_turn() {
    let mut seen = Vec::new();
    let mut note = |done, total| seen.push((done, total));
    run(&plan(), &ids(), &mut Mock::default(), machine(), Vec::new(), &mut |_| Ok(()), &mut note).unwrap();
    let total = 4 * 17 + 4;
    assert_eq!(*seen.last().unwrap(), (total, total));
    assert!(seen.is_sorted_by_key(|(done, _)| *done));
}

#[test]
fn the_record_says_what_was_planned() {
    let run = mock_run();
    assert_eq!(
        (run.schema, run.study.as_str(), run.imported_from.as_ref()),
        (BenchRun::SCHEMA, "mock", None)
    );
    assert_eq!((run.warmup, run.iterations, run.aa_iterations), (2, 5, 2));
    assert_eq!((run.seed, run.threads), (2026, 16), "0 threads are the machine's");
    assert_eq!(run.machine, machine());
    assert!(run.differences.is_empty() && run.resumed.is_empty());
    let run = run_with(&Plan { threads: 3, ..plan() }, &mut Mock::default()).unwrap();
    assert_eq!(run.threads, 3);
}

#[test]
fn others_are_watched_before_and_during() {
    let run = run_with(&plan(), &mut Mock { others: 6, ..Default::default() }).unwrap();
    // Before: 100 ticks, of them 90 idle. Then every round: 120 ticks, of them 80 ours and 24 somebody else's.
    let shares: Vec<f64> = run.load.iter().map(|window| window.others).collect();
    assert_eq!(shares, [[0.1].as_slice(), &[0.2; 7]].concat());
    let windows: Vec<_> = run.load.iter().map(|window| (window.invocation, window.rounds)).collect();
    let at = |invocation, round| (Some(invocation), Some((round, round)));
    let want = [(None, None), at(0, 0), at(1, 0), at(2, 1), at(2, 2), at(3, 1), at(4, 3), at(4, 4)];
    assert_eq!(windows, want);
    assert!(run.load.iter().all(|window| window.load_average == Some(1.5) && window.steal == 0.0));
}

#[test]
fn short_rounds_share_a_window() {
    // One configuration: 30 ticks a round, and 100 are needed; an invocation of 9 rounds has windows of 4, 4 and 1.
    let plan = Plan { iterations: 9, aa_iterations: 0, ..plan() };
    let run =
        run(&plan, &ids()[..1], &mut Mock::default(), machine(), vec![], &mut |_| Ok(()), &mut |_, _| ());
    let windows: Vec<_> = run.unwrap().load.iter().map(|window| window.rounds).collect();
    assert_eq!(windows, [None, Some((0, 3)), Some((4, 7)), Some((8, 8))]);
}

#[test]
fn memory_is_asked_once_for_each_configuration_if_at_all() {
    let mut mock = Mock::default();
    let memory = run_with(&plan(), &mut mock).unwrap().memory;
    assert_eq!(mock.memory_asked, [0, 1, 2, 3]);
    assert_eq!(memory.iter().map(|m| m.id.clone()).collect::<Vec<_>>(), ids());
    assert_eq!(memory[2].peak_bytes, 5);
    let allocations = run_with(&plan(), &mut Mock::default()).unwrap().allocations;
    let counts: Vec<_> = allocations.iter().map(|of| (of.id.clone(), of.bytes.total)).collect();
    assert_eq!(counts, ids().into_iter().zip(0..).collect::<Vec<_>>());
    let without = Plan { allocations: false, ..plan() };
    assert!(run_with(&without, &mut Mock::default()).unwrap().allocations.is_empty());
    let mut silent = Mock { without_memory: true, ..Default::default() };
    assert!(run_with(&plan(), &mut silent).unwrap().memory.is_empty());
    assert_eq!(silent.memory_asked, [0]);
    let mut unasked = Mock::default();
    run_with(&Plan { memory: false, ..plan() }, &mut unasked).unwrap();
    assert!(unasked.memory_asked.is_empty());
}

/// Wherever a run is broken off, going on gives every sample that the plan has, once, in the plan's order.
#[test]
fn a_run_broken_off_anywhere_is_completed() {
    let whole = mock_run();
    let keys = |run: &BenchRun| -> Vec<(u32, u32, u32, ConfigurationId)> {
        let all = run.samples.iter().chain(&run.aa_samples);
        all.map(|s| (s.invocation, s.iteration, s.place, s.id.clone())).collect()
    };
    for calls in 0..68 {
        let done = broken_off(calls);
        let samples_before =
            done.iter().filter(|e| matches!(e, Entry::Sample(_) | Entry::AaSample(_))).count();
        let mut mock = Mock::default();
        let run = resumed(done.clone(), &mut mock).unwrap();
        assert_eq!(keys(&run), keys(&whole), "broken off at call {calls}");
        assert_eq!((&run.memory, &run.allocations), (&whole.memory, &whole.allocations));
        // What had been measured stays as it was, and is not measured again.
        for entry in &done {
            match entry {
                Entry::Sample(sample) => assert!(run.samples.contains(sample)),
                Entry::AaSample(sample) => assert!(run.aa_samples.contains(sample)),
                _ => {}
            }
        }
        let warm_ups = mock.invocations.len() * 8;
        assert_eq!(mock.calls.len(), warm_ups + 28 - samples_before, "broken off at call {calls}");
    }
}

#[test]
fn a_run_goes_on_in_the_middle_of_a_round_and_says_so() {
    // The third invocation has rounds 1 and 2; its calls begin at 24, eight of them warm-up. Call 38 is place 2 of round 2.
    let mut mock = Mock::default();
    let run = resumed(broken_off(38), &mut mock).unwrap();
    assert_eq!(run.resumed, [Resumption { invocation: 2, iteration: 2, place: 2 }]);
    // It warms up, measures the two that are left, and goes to the next invocation.
    assert_eq!(mock.invocations, [0, 8 + 2, 10 + 12]);
    // Broken off between invocations, nothing is in the middle.
    let run = resumed(broken_off(24), &mut Mock::default()).unwrap();
    assert_eq!(run.resumed, []);
}

/// Wherever a configuration fails, every other has all of its samples, in the plan's order, and nothing of the failed one is kept;
/// a run that goes on from the journal has the same.
#[test]
fn a_configuration_that_may_fail_is_left_out_wherever_it_fails() {
    type Key = (u32, u32, u32, ConfigurationId);
    let key = |s: &BenchSample| -> Key { (s.invocation, s.iteration, s.place, s.id.clone()) };
    let keys = |run: &BenchRun| -> Vec<Key> { run.samples.iter().chain(&run.aa_samples).map(key).collect() };
    let whole = keys(&mock_run());
    for call in 0..68 {
        let mut entries = Vec::new();
        let mut record = |entry: &Entry| {
            entries.push(entry.clone());
            Ok(())
        };
        let mut mock = Mock { fail_at_call: Some(call), leaves_out: true, ..Default::default() };
        let found = run(&plan(), &ids(), &mut mock, machine(), vec![], &mut record, &mut |_, _| ()).unwrap();
        let failed = &ids()[mock.calls[call]];
        let want = [Failure { id: failed.clone(), reason: "the mock was told to fail".into() }];
        assert_eq!(found.failed, want, "at call {call}");
        let others: Vec<Key> = whole.iter().filter(|(.., id)| id != failed).cloned().collect();
        assert_eq!(keys(&found), others, "at call {call}");
        assert!(found.memory.iter().all(|peak| peak.id != *failed) && found.memory.len() == 3);
        assert!(!mock.calls[call + 1..].contains(&mock.calls[call]), "asked again after call {call}");
        // Broken off after any entry, it is completed without asking the failed one again once that is written.
        for kept in (0..entries.len()).step_by(5) {
            let done = entries[..kept].to_vec();
            let known = done.iter().any(|entry| matches!(entry, Entry::Failed(_)));
            let mut rest = Mock { leaves_out: true, ..Default::default() };
            let again = resumed(done, &mut rest).unwrap();
            assert_eq!(keys(&again), if known { others.clone() } else { whole.clone() });
            assert!(!known || !rest.calls.contains(&mock.calls[call]));
        }
    }
}

#[test]
fn nothing_left_to_measure_ends_the_run() {
    let one = &ids()[..1];
    let mut mock = Mock { fail_at_call: Some(3), leaves_out: true, ..Default::default() };
    let error = run(&plan(), one, &mut mock, machine(), vec![], &mut |_| Ok(()), &mut |_, _| ()).unwrap_err();
    assert_eq!(error.to_string(), "every configuration failed, ss_bu last");
    assert_eq!(error.source().unwrap().to_string(), "the mock was told to fail");
}

#[test]
fn a_journal_that_does_not_follow_the_plan_is_refused() {
    let mut done = broken_off(20);
    let samples: Vec<usize> =
        done.iter().enumerate().filter(|(_, e)| matches!(e, Entry::Sample(_))).map(|(at, _)| at).collect();
    done.swap(samples[0], samples[1]);
    let mut mock = Mock::default();
    let error = resumed(done, &mut mock).unwrap_err();
    assert!(matches!(error, BenchError::Journal(JournalError::OtherOrder)), "{error}");
    assert!(mock.calls.is_empty());
}

#[test]
fn a_journal_with_a_time_that_no_clock_gives_is_refused() {
    let mut done = broken_off(20);
    let first = done.iter_mut().find_map(|e| if let Entry::Sample(sample) = e { Some(sample) } else { None });
    first.unwrap().vertex_s = -0.1;
    let error = resumed(done, &mut Mock::default()).unwrap_err();
    let text = error.source().unwrap().to_string();
    assert!(text.contains("vertex = -0.1 s: must be finite and not negative"), "{text}");
}

#[test]
fn a_record_that_cannot_be_written_ends_the_run() {
    let mut record = |_: &Entry| Err(io::Error::other("disk full"));
    let mut mock = Mock::default();
    let error =
        run(&plan(), &ids(), &mut mock, machine(), Vec::new(), &mut record, &mut |_, _| ()).unwrap_err();
    assert_eq!(error.source().unwrap().to_string(), "disk full");
}

fn error_of(plan: &Plan, ids: &[ConfigurationId], mut mock: Mock) -> (BenchError, usize) {
    let error =
        run(plan, ids, &mut mock, machine(), Vec::new(), &mut |_| Ok(()), &mut |_, _| ()).unwrap_err();
    (error, mock.calls.len())
}

#[test]
fn a_failure_names_the_configuration_and_ends_the_run() {
    let failing = |call| Mock { fail_at_call: Some(call), ..Default::default() };
    let (error, calls) = error_of(&plan(), &ids(), failing(9));
    let invocation = &plan().invocations()[0];
    let turn = plan().turns(invocation, 4)[1];
    assert_eq!(calls, 10);
    assert_eq!(error.to_string(), format!("{} failed in iteration 0", ids()[turn.subject]));
    assert_eq!(error.source().unwrap().to_string(), "the mock was told to fail");
    let (error, calls) = error_of(&plan(), &ids(), failing(0));
    assert_eq!(calls, 1);
    assert!(error.to_string().ends_with(" failed in warm-up round 0"), "{error}");
}

#[test]
fn what_is_not_a_duration_is_refused() {
    let (error, calls) = error_of(&plan(), &ids(), Mock { nan_at_call: Some(9), ..Default::default() });
    assert_eq!(calls, 10);
    let source = error.source().unwrap().to_string();
    assert_eq!(source, "normals = NaN s: must be finite and not negative");
}

#[test]
fn nothing_to_do_is_refused_before_anything_runs() {
    let error = |plan: &Plan, ids: &[ConfigurationId]| {
        let (error, calls) = error_of(plan, ids, Mock::default());
        assert_eq!(calls, 0);
        error
    };
    assert!(matches!(error(&Plan { iterations: 0, ..plan() }, &ids()), BenchError::NoIterations));
    assert!(matches!(error(&plan(), &[]), BenchError::NoConfigurations));
    let twice = [ids(), ids()].concat();
    assert!(matches!(error(&plan(), &twice), BenchError::Repeated(id) if id == ids()[0]));
}

/// JSON holds every digit, and the workspace reads them all back (`float_roundtrip`): stages still add up.
#[test]
fn json_gives_the_run_back() {
    let run = mock_run();
    let back: BenchRun = serde_json::from_str(&serde_json::to_string(&run).unwrap()).unwrap();
    assert_eq!(back, run);
}
