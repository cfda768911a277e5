//! The run itself: turn by turn, every sample kept.

use crate::error::BenchError;
use crate::plan::{Plan, Round};
use crate::profile::differences;
use crate::stages::StageSeconds;
use design::ConfigurationId;
use design::machine::Machine;
use design::record::{BenchRun, BenchSample};
use std::collections::HashSet;

/// The version of [`BenchRun`]'s layout that is written here.
const SCHEMA: u32 = 1;

/// Carries out one configuration and says how long its stages took. The only part of a run that takes time, so a
/// test can stand in for it.
pub trait Executor {
    /// Executes the configuration with this index.
    ///
    /// # Errors
    /// Whatever stopped it; [`run`] adds which configuration it was.
    fn execute(&mut self, subject: usize) -> Result<StageSeconds, BenchError>;
}

/// Runs the plan over the configurations and returns every sample of the measured rounds, in the order measured.
///
/// `executor` is called with indices into `ids`, in the order of [`Plan::turns`]; `on_sample` after each call, warm-up
/// included, with the number of calls done and to be done. `machine` is recorded as given, and so are the ways in
/// which it differs from the plan's target. 0 threads in the plan are recorded as the machine's.
///
/// # Errors
/// [`BenchError`] if there is nothing to run, an id is there twice, or a configuration fails; the run ends there.
pub fn run(
    plan: &Plan,
    ids: &[ConfigurationId],
    executor: &mut dyn Executor,
    machine: Machine,
    on_sample: &mut dyn FnMut(u64, u64),
) -> Result<BenchRun, BenchError> {
    check(plan, ids)?;
    let total = (u64::from(plan.warmup) + u64::from(plan.iterations)) * ids.len() as u64;
    let mut samples = Vec::new();
    for (turn, done) in plan.turns(ids.len()).zip(1..) {
        let id = &ids[turn.subject];
        let stages = executor.execute(turn.subject).and_then(durations).map_err(|error| {
            BenchError::Configuration { id: id.clone(), round: turn.round, source: Box::new(error) }
        })?;
        if let Round::Measured(iteration) = turn.round {
            samples.push(sample(id, iteration, turn.place, &stages));
        }
        on_sample(done, total);
    }
    Ok(BenchRun {
        schema: SCHEMA,
        study: plan.study.clone(),
        warmup: plan.warmup,
        iterations: plan.iterations,
        seed: plan.seed,
        threads: if plan.threads == 0 { machine.threads } else { plan.threads },
        target: plan.target.clone(),
        differences: differences(&plan.target, &machine),
        machine,
        samples,
    })
}

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

/// A NaN would become `null` in JSON and spoil every mean: better to stop where it came from.
fn durations(stages: StageSeconds) -> Result<StageSeconds, BenchError> {
    match stages.by_stage().into_iter().find(|(_, seconds)| !(seconds.is_finite() && *seconds >= 0.0)) {
        Some((stage, seconds)) => Err(BenchError::NotADuration { stage, seconds }),
        None => Ok(stages),
    }
}

fn sample(id: &ConfigurationId, iteration: u32, place: u32, stages: &StageSeconds) -> BenchSample {
    let StageSeconds { allocation_s, sampling_s, vertex_s, geometry_s, normals_s } = *stages;
    BenchSample {
        id: id.clone(),
        iteration,
        place,
        allocation_s,
        sampling_s,
        vertex_s,
        geometry_s,
        normals_s,
        total_s: stages.total(),
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::stages::Stage;
    use std::collections::HashMap;
    use std::error::Error;

    /// Times made up from the subject and the number of the call, and a journal of the calls.
    #[derive(Default)]
    struct Mock {
        calls: Vec<usize>,
        fail_at_call: Option<usize>,
        nan_at_call: Option<usize>,
    }

    impl Executor for Mock {
        fn execute(&mut self, subject: usize) -> Result<StageSeconds, BenchError> {
            let call = self.calls.len();
            self.calls.push(subject);
            if self.fail_at_call == Some(call) {
                return Err(BenchError::Execution("the mock was told to fail".into()));
            }
            let normals_s = if self.nan_at_call == Some(call) { f64::NAN } else { 1e-7 * call as f64 };
            Ok(StageSeconds {
                allocation_s: 0.001,
                sampling_s: 0.01 * (subject + 1) as f64,
                vertex_s: 0.1,
                geometry_s: 0.3,
                normals_s,
            })
        }
    }

    pub(crate) fn machine() -> Machine {
        Machine {
            model: Some("11th Gen Intel(R) Core(TM) i7-11700 @ 2.50GHz".into()),
            cores: Some(8),
            threads: 16,
            memory_bytes: Some(33_421_000_000),
            os: "windows".into(),
            features: ["avx2", "bmi1", "bmi2", "fma"].map(String::from).into(),
            governor: None,
            load: Some(0.25),
            compiler: "rustc 1.95.0".into(),
        }
    }

    pub(crate) fn plan() -> Plan {
        Plan {
            study: "mock".into(),
            warmup: 2,
            iterations: 5,
            seed: 2026,
            threads: 0,
            target: toml::from_str("name = \"any\"\nmodel = \"\"").unwrap(),
        }
    }

    pub(crate) fn ids() -> Vec<ConfigurationId> {
        ["ss_bu", "ss_bi", "as_sp", "bs_su"].iter().map(|id| id.parse().unwrap()).collect()
    }

    pub(crate) fn mock_run() -> BenchRun {
        run(&plan(), &ids(), &mut Mock::default(), machine(), &mut |_, _| ()).unwrap()
    }

    fn error_of(plan: &Plan, ids: &[ConfigurationId], mut mock: Mock) -> (BenchError, usize) {
        let error = run(plan, ids, &mut mock, machine(), &mut |_, _| ()).unwrap_err();
        (error, mock.calls.len())
    }

    #[test]
    fn warm_up_is_executed_and_not_kept() {
        let mut mock = Mock::default();
        let run = run(&plan(), &ids(), &mut mock, machine(), &mut |_, _| ()).unwrap();
        assert_eq!(mock.calls.len(), (2 + 5) * 4);
        assert_eq!(run.samples.len(), 5 * 4);
        // The mock's normals count calls: the first sample kept is the ninth call.
        assert_eq!(run.samples[0].normals_s, 8e-7);
    }

    #[test]
    fn every_configuration_once_a_round() {
        let run = mock_run();
        for (round, iteration) in run.samples.chunks(4).zip(0..) {
            assert!(round.iter().all(|sample| sample.iteration == iteration));
            assert_eq!(round.iter().map(|sample| sample.place).collect::<Vec<_>>(), [0, 1, 2, 3]);
            let seen: HashSet<_> = round.iter().map(|sample| &sample.id).collect();
            assert_eq!(seen.len(), 4);
        }
        let mut counts = HashMap::new();
        run.samples.iter().for_each(|sample| *counts.entry(&sample.id).or_insert(0) += 1);
        assert!(counts.values().all(|count| *count == 5), "{counts:?}");
    }

    #[test]
    fn samples_carry_the_id_that_was_executed() {
        let mut mock = Mock::default();
        let run = run(&plan(), &ids(), &mut mock, machine(), &mut |_, _| ()).unwrap();
        for (sample, subject) in run.samples.iter().zip(&mock.calls[8..]) {
            assert_eq!(sample.id, ids()[*subject]);
            assert_eq!(sample.sampling_s, 0.01 * (subject + 1) as f64);
        }
    }

    #[test]
    fn stages_add_up() {
        for sample in mock_run().samples {
            let stages = &Stage::ALL[..5];
            let sum = stages.iter().fold(0.0, |sum, stage| sum + stage.of(&sample));
            assert_eq!(sum, sample.total_s);
        }
    }

    #[test]
    fn the_same_plan_gives_the_same_run() {
        assert_eq!(mock_run(), mock_run());
        let other = run(&Plan { seed: 1, ..plan() }, &ids(), &mut Mock::default(), machine(), &mut |_, _| ());
        let order = |run: &BenchRun| run.samples.iter().map(|s| s.id.to_string()).collect::<Vec<_>>();
        assert_ne!(order(&other.unwrap()), order(&mock_run()));
    }

    #[test]
    fn progress_counts_every_call() {
        let mut seen = Vec::new();
        let mut note = |done, total| seen.push((done, total));
        run(&plan(), &ids(), &mut Mock::default(), machine(), &mut note).unwrap();
        assert_eq!(seen, (1..=28).map(|done| (done, 28)).collect::<Vec<_>>());
    }

    #[test]
    fn the_record_says_what_was_planned() {
        let run = mock_run();
        assert_eq!((run.schema, run.study.as_str(), run.warmup, run.iterations), (1, "mock", 2, 5));
        assert_eq!((run.seed, run.threads), (2026, 16), "0 threads are the machine's");
        assert_eq!(run.machine, machine());
        assert!(run.differences.is_empty());
        let narrow = Plan { threads: 3, ..plan() };
        let run = super::run(&narrow, &ids(), &mut Mock::default(), machine(), &mut |_, _| ()).unwrap();
        assert_eq!(run.threads, 3);
    }

    #[test]
    fn a_failure_names_the_configuration_and_ends_the_run() {
        let failing = |call| Mock { fail_at_call: Some(call), ..Default::default() };
        let (error, calls) = error_of(&plan(), &ids(), failing(13));
        let turn = plan().turns(4).nth(13).unwrap();
        assert_eq!(calls, 14);
        assert_eq!(error.to_string(), format!("{} failed in iteration 1", ids()[turn.subject]));
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
        assert_eq!(source, "normals took NaN s: must be finite and not negative");
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

    /// JSON holds every digit. serde_json reads numbers back to the last digit only with its `float_roundtrip`, which is
    /// the reader's choice, so that one digit is allowed for here.
    #[test]
    fn json_gives_the_run_back() {
        let run = mock_run();
        let mut back: BenchRun = serde_json::from_str(&serde_json::to_string(&run).unwrap()).unwrap();
        for (back, sample) in back.samples.iter_mut().zip(&run.samples) {
            for stage in Stage::ALL {
                let (read, measured) = (stage.of(back), stage.of(sample));
                assert!((read - measured).abs() <= measured * f64::EPSILON, "{read} {measured}");
            }
            *back = BenchSample {
                id: back.id.clone(),
                iteration: back.iteration,
                place: back.place,
                ..sample.clone()
            };
        }
        assert_eq!(back, run);
    }
}
