//! What is simulated, and how often.

use super::chance::Chance;
use super::disk::{End, Fault, Kind};
use super::machine::Simulated;
use super::people::{Session, TRAINING};
use super::{Checked, FOLDER, Outcome, Plan, QUESTIONS, Simulation, TOKEN, simulate};
use crate::journal::Loss;
use crate::page::{Media, MediaFormat};
use crate::server::{Limits, Settings};
use isostudy_design::config::Way;
use isostudy_design::forms::{FormEntry, FormFile, KeyEntry, Role};
use std::net::SocketAddr;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicU64, Ordering};

const FORMS: usize = 3;

/// People are asked in a way that the seed says.
fn settings_of(seed: u64) -> Settings {
    let way = Way::ALL[(seed % Way::ALL.len() as u64) as usize];
    let mut plain = settings();
    if !way.is_of_pairs() {
        plain.key.iter_mut().for_each(|entry| entry.shown = "a b c".into());
    }
    Settings { file: FormFile { way, ..plain.file.clone() }, ..plain }
}

fn settings() -> Settings {
    let stimulus = |form: usize, place: usize| format!("pair{form}{place}");
    let form = |form| FormEntry {
        form,
        training: vec!["tani".into(); TRAINING],
        questions: (0..QUESTIONS).map(|place| stimulus(form, place)).collect(),
    };
    let entry = |form, place| KeyEntry {
        form,
        order: place + TRAINING + 1,
        stimulus: stimulus(form, place),
        role: Role::Comparison,
        question: format!("Q{place}"),
        object: "sphere".into(),
        group: "g".into(),
        left: "a".into(),
        right: "b".into(),
        shown: String::new(),
    };
    Settings {
        file: FormFile { forms: (1..=FORMS).map(form).collect(), ..crate::export::tests::empty_file() },
        key: (1..=FORMS).flat_map(|form| (0..QUESTIONS).map(move |place| entry(form, place))).collect(),
        digest: "d".into(),
        stimuli: "/simulated/stimuli".into(),
        media: Media { kinds: vec![(MediaFormat::Gif, 1, 10)], surface: [8, 8], shading: None },
        library: Vec::new(),
        answers: FOLDER.into(),
        address: SocketAddr::from(([127, 0, 0, 1], 0)),
        admin_token: TOKEN.into(),
        completions: Default::default(),
        panel: Default::default(),
        quotas: Default::default(),
        chooser: None,
        attention: Vec::new(),
        rule: None,
        public_url: None,
        limits: Limits { sessions_per_address: 0, ..Limits::default() },
        loss: Loss::Refuse,
    }
}

/// Simulates, and turns a panic into what is wrong.
fn attempt(machine: &Simulated, settings: &Settings, plan: Plan) -> Checked<Outcome> {
    let simulated = catch_unwind(AssertUnwindSafe(|| simulate(machine, settings, plan)));
    simulated.unwrap_or_else(|panic| {
        let text = panic.downcast_ref::<String>().map(String::as_str);
        Err(format!("panic: {}", text.or(panic.downcast_ref::<&str>().copied()).unwrap_or("?")))
    })
}

/// Handlers set timers, which never run out.
fn with_timers(work: impl FnOnce()) {
    let runtime = tokio::runtime::Builder::new_current_thread().enable_time().build().unwrap();
    let _inside = runtime.enter();
    work();
}

/// Each thread has simulations of its own, and no thread is in one. The first panic of one is the caller's.
fn on_all_threads(work: impl Fn() + Sync) {
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    std::thread::scope(|scope| {
        let threads: Vec<_> = (0..threads).map(|_| scope.spawn(|| with_timers(&work))).collect();
        for thread in threads {
            if let Err(panic) = thread.join() {
                std::panic::resume_unwind(panic);
            }
        }
    });
}

fn wild(seed: u64) -> Plan {
    Plan { seed, fault: None, wild: true, told: false }
}

/// The first seed: one for all of a run, as for the other random tests.
fn first_seed() -> u64 {
    let text = std::env::var("PROPTEST_RNG_SEED").ok();
    text.and_then(|text| text.parse().ok()).unwrap_or(20261123)
}

/// Simulates until there were so many sessions.
fn sessions(wanted: u64) {
    let first = Chance::new(first_seed()).next();
    let (number, done) = (AtomicU64::new(0), AtomicU64::new(0));
    let totals: [AtomicU64; 4] = Default::default();
    on_all_threads(|| {
        let machine = Simulated::new();
        while done.load(Ordering::Relaxed) < wanted {
            let seed = first.wrapping_add(number.fetch_add(1, Ordering::Relaxed));
            match attempt(&machine, &settings_of(seed), wild(seed)) {
                Ok(Outcome { sessions, answers, operations, failed, ends, .. }) => {
                    done.fetch_add(sessions as u64, Ordering::Relaxed);
                    let counts = [answers as u64, operations, failed, ends];
                    for (total, count) in totals.iter().zip(counts) {
                        total.fetch_add(count, Ordering::Relaxed);
                    }
                }
                Err(wrong) => {
                    // The others may end.
                    let done = done.swap(wanted, Ordering::Relaxed);
                    panic!(
                        "{wrong}\n\nafter {done} sessions; repeat it, told line by line, by\n\
                         ISOSTUDY_SEED={seed} cargo test --release --locked -p isostudy-serve --lib simulation::tests::one -- --nocapture"
                    );
                }
            }
        }
    });
    let [answers, operations, failed, ends] = totals.map(AtomicU64::into_inner);
    println!(
        "{} simulations, {} sessions, {answers} acknowledged answers, {operations} operations of the disk, {failed} of which failed, \
         {ends} crashes",
        number.into_inner(),
        done.into_inner(),
    );
    assert!(failed > 0 && ends > 0, "nothing went wrong, so that nothing was tested");
}

#[test]
fn every_acknowledged_answer_is_in_every_export_once() {
    sessions(2_000);
}

#[test]
#[ignore = "minutes: run by make test-long"]
fn every_acknowledged_answer_is_in_every_export_once_in_many_sessions() {
    sessions(200_000);
}

/// `ISOSTUDY_SEED=n` repeats a simulation that failed; without it one is simulated twice, and must be the same.
#[test]
fn one() {
    let given = std::env::var("ISOSTUDY_SEED").ok().and_then(|text| text.parse().ok());
    let plan = Plan { told: given.is_some(), ..wild(given.unwrap_or(first_seed())) };
    with_timers(|| {
        let (machine, settings) = (Simulated::new(), settings_of(plan.seed));
        let once = simulate(&machine, &settings, plan).unwrap_or_else(|wrong| panic!("{wrong}"));
        let again = simulate(&machine, &settings, Plan { told: false, ..plan });
        assert_eq!(again, Ok(once), "a seed says all");
    });
}

/// A short script of two people, a stop, and a third. Each of its operations fails in each way, for each of so many seeds: of what
/// was not synced, each keeps something else.
fn faults_everywhere(seeds: u64) {
    let first = Chance::new(first_seed()).next();
    let number = AtomicU64::new(0);
    let (operations, runs) = (AtomicU64::new(0), AtomicU64::new(0));
    on_all_threads(|| {
        let (machine, settings) = (Simulated::new(), settings());
        // One thread takes all faults at an operation.
        let mut taken = number.fetch_add(1, Ordering::Relaxed);
        let mut before = 0;
        for seed in (0..seeds).map(|number| first.wrapping_add(number)) {
            let whole = simulate(&machine, &settings, quiet(seed)).unwrap();
            assert_eq!((whole.sessions, whole.answers, whole.failed), (3, 3 * QUESTIONS, 0));
            let kinds = machine.state().disk.kinds().to_vec();
            while let Some(&kind) = kinds.get((taken - before) as usize) {
                let at = taken - before + 1;
                for &fault in faults_of(kind) {
                    runs.fetch_add(1, Ordering::Relaxed);
                    let plan = Plan { fault: Some((at, fault)), ..quiet(seed) };
                    if let Err(wrong) = attempt(&machine, &settings, plan) {
                        // Once more, told line by line.
                        drop(attempt(&machine, &settings, Plan { told: true, ..plan }));
                        panic!("{fault:?} at operation {at} of {}, seed {seed}: {wrong}", kinds.len());
                    }
                }
                taken = number.fetch_add(1, Ordering::Relaxed);
            }
            before += kinds.len() as u64;
            operations.store(before, Ordering::Relaxed);
        }
    });
    println!("{} operations, {} faults", operations.into_inner(), runs.into_inner());
}

/// Those that differ from the same at another operation: a process that ends before a read might as well end before the next
/// write, and a disk that is full before a sync is full at the next write.
fn faults_of(kind: Kind) -> &'static [Fault] {
    const ALL: [Fault; 6] = [
        Fault::Error,
        Fault::End(End::Killed),
        Fault::End(End::PowerGone),
        Fault::Short,
        Fault::Full(5),
        Fault::Full(60),
    ];
    match kind {
        Kind::Look => &ALL[..1],
        Kind::Other => &ALL[..3],
        Kind::Write => &ALL,
    }
}

#[test]
fn a_fault_at_every_operation_loses_nothing() {
    faults_everywhere(1);
}

#[test]
#[ignore = "minutes: run by make test-long"]
fn a_fault_at_every_operation_loses_nothing_whatever_is_kept() {
    faults_everywhere(20);
}

fn quiet(seed: u64) -> Plan {
    Plan { seed, fault: None, wild: false, told: false }
}

/// A kill before the sync of a commit leaves its bytes to the system. They are read again, and told to whoever asks; then the
/// power goes.
#[test]
fn what_a_restart_tells_of_is_on_disk() {
    with_timers(|| {
        let (machine, settings) = (Simulated::new(), settings());
        let mut revived = 0;
        for (ahead, seed) in (1..30).flat_map(|ahead| (0..8).map(move |seed| (ahead, seed))) {
            let mut simulation = Simulation::new(&machine, &settings, quiet(seed));
            let mut run = || -> Checked {
                simulation.start()?;
                simulation.act(0, false);
                simulation.deliver(false)?;
                simulation.act(0, false);
                machine.state().disk.arm(ahead, Fault::End(End::Killed));
                simulation.deliver(false)?;
                machine.state().disk.heal();
                let told = simulation.clients[0].next;
                revived += usize::from(simulation.people.answered() > told);
                simulation.crash(End::PowerGone)?;
                simulation.check()
            };
            run().unwrap_or_else(|wrong| panic!("killed after {ahead} operations, seed {seed}: {wrong}"));
        }
        assert!(revived > 0, "no kill came between a write and its sync");
    });
}

/// Where a folder is made, SQLite has a journal and no log yet.
#[test]
fn the_first_start_may_end_anywhere() {
    with_timers(|| {
        let (machine, settings) = (Simulated::new(), settings());
        Simulation::new(&machine, &settings, quiet(0)).start().unwrap();
        let kinds = machine.state().disk.kinds().to_vec();
        let changes = (1..).zip(kinds).filter(|(_, kind)| *kind != Kind::Look);
        for (at, seed) in changes.flat_map(|(at, _)| (0..8).map(move |seed| (at, seed))) {
            let mut simulation = Simulation::new(&machine, &settings, quiet(seed));
            machine.state().disk.arm(at, Fault::End(End::PowerGone));
            simulation
                .start()
                .unwrap_or_else(|wrong| panic!("no power at operation {at}, seed {seed}: {wrong}"));
        }
    });
}

/// A commit fails at its sync, and a kill brings it back: the answer is there, the first one or another, and who gave it, also when
/// the power goes then.
#[test]
fn answers_that_come_back_stay_with_their_identifiers() {
    with_timers(|| {
        let (machine, settings) = (Simulated::new(), settings());
        let mut revived = [0; 2];
        let cases = (0..2)
            .flat_map(|saved| (1..30).flat_map(move |ahead| (0..8).map(move |seed| (saved, ahead, seed))));
        for (saved, ahead, seed) in cases {
            let mut simulation = Simulation::new(&machine, &settings, quiet(seed));
            // The second client is of a panel.
            let next = |simulation: &mut Simulation<'_>| {
                simulation.act(1, false);
                simulation.deliver(false)
            };
            let answers = |simulation: &Simulation<'_>| {
                simulation.people.sessions.values().map(Session::acknowledged).sum::<usize>()
            };
            let mut run = || -> Checked {
                simulation.start()?;
                (0..1 + saved).try_for_each(|_| next(&mut simulation))?;
                machine.state().disk.arm(ahead, Fault::Error);
                next(&mut simulation)?;
                machine.state().disk.heal();
                let told = answers(&simulation);
                simulation.crash(End::Killed)?;
                revived[saved] += answers(&simulation) - told;
                simulation.check_exactly()?;
                simulation.crash(End::PowerGone)
            };
            run().unwrap_or_else(|wrong| {
                panic!("an error at operation {ahead} after {saved} answers, seed {seed}: {wrong}")
            });
        }
        assert!(revived.iter().all(|count| *count > 0), "no sync of a commit failed: {revived:?}");
    });
}

/// Without it nobody could tell what is missing, and identifiers of those without an answer would stay.
#[test]
fn the_count_outlives_the_first_power_cut() {
    with_timers(|| {
        let (machine, settings) = (Simulated::new(), settings());
        for seed in 0..32 {
            Simulation::new(&machine, &settings, quiet(seed)).start().unwrap();
            let disk = &mut machine.state().disk;
            disk.stop(End::PowerGone);
            disk.restart();
            assert!(disk.exists(&format!("{FOLDER}/count")), "seed {seed}");
        }
    });
}
