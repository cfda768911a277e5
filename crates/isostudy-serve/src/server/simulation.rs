//! Simulations of the server: clients, a network that loses, repeats and reorders, a clock, kills, power cuts, and a disk that
//! fails at any operation, all from one seed. What answers is the real router, its handlers and the real journal over SQLite.
//!
//! The oracle ([`people`]): each answer that was acknowledged is in every export once, as it was sent, and nothing is there that
//! nobody sent. The server starts again after every crash, and everybody can go on to the end.

mod chance;
mod disk;
mod machine;
mod people;
mod running;

use super::{Limits, Settings};
use crate::deidentify::deidentified;
use crate::journal::{Loss, kept_on};
use crate::page::{Media, MediaFormat};
use crate::record::Choice;
use chance::Chance;
use disk::{End, Fault, Kind};
use isostudy_design::forms::{FormEntry, FormFile, KeyEntry, Role};
use machine::Simulated;
use people::{Asked, People, Said, TRAINING, panel_session, rows, rows_of};
use running::{Reply, Running};
use serde_json::{Value, json};
use std::net::SocketAddr;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicU64, Ordering};

const TOKEN: &str = "a-token-for-simulations";
const FOLDER: &str = "/simulated/answers";
const FORMS: usize = 3;
const QUESTIONS: usize = 4;
/// Most requests on their way.
const NETWORK: usize = 12;

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
    };
    Settings {
        file: FormFile {
            schema: 1,
            study: "trial".into(),
            title: "Trial".into(),
            prompt: "Which?".into(),
            choices: ["Left".into(), "None".into(), "Right".into()],
            choices_stacked: None,
            min_surface_px: None,
            consent: "Yes".into(),
            instructions: "Look".into(),
            loop_ms: 100,
            page_scale: 1,
            forms: (1..=FORMS).map(form).collect(),
        },
        key: (1..=FORMS).flat_map(|form| (0..QUESTIONS).map(move |place| entry(form, place))).collect(),
        digest: "d".into(),
        stimuli: "/simulated/stimuli".into(),
        media: Media { kinds: vec![(MediaFormat::Gif, 1, 10)], surface: [8, 8] },
        answers: FOLDER.into(),
        address: SocketAddr::from(([127, 0, 0, 1], 0)),
        admin_token: TOKEN.into(),
        completion: None,
        public_url: None,
        limits: Limits { sessions_per_address: 0, ..Limits::default() },
        loss: Loss::Refuse,
    }
}

/// A page in somebody's browser.
#[derive(Default)]
struct Client {
    panel: Option<usize>,
    token: Option<String>,
    /// The next place, as far as the page knows.
    next: usize,
    /// What is being sent to it.
    said: Option<Said>,
    done: bool,
}

/// What happens in a simulation.
#[derive(Clone, Copy)]
struct Plan {
    seed: u64,
    /// A fault that many operations after the beginning, in an otherwise quiet world.
    fault: Option<(u64, Fault)>,
    /// Whether chance does all that it can.
    wild: bool,
    /// Whether everything is printed.
    told: bool,
}

/// What came of it.
#[derive(Debug, Clone, PartialEq, Eq)]
struct Outcome {
    /// Sessions of which an answer was acknowledged.
    sessions: usize,
    answers: usize,
    operations: u64,
    failed: u64,
    ends: u64,
    /// The last export.
    export: String,
}

struct Simulation<'a> {
    machine: &'a Simulated,
    settings: &'a Settings,
    plan: Plan,
    chance: Chance,
    people: People,
    clients: Vec<Client>,
    /// Whose request, and what.
    network: Vec<(usize, Asked)>,
    server: Option<Running>,
    ends: u64,
    export: String,
}

/// What was promised and is not so.
type Checked<T = ()> = Result<T, String>;

fn simulate(machine: &Simulated, settings: &Settings, plan: Plan) -> Checked<Outcome> {
    let mut simulation = Simulation::new(machine, settings, plan);
    if let Some((at, fault)) = plan.fault {
        machine.state().disk.arm(at, fault);
    }
    simulation.run()?;
    let Simulation { people, ends, export, .. } = simulation;
    let disk = &machine.state().disk;
    let (operations, failed) = (disk.operations(), disk.failed());
    let answers = people.sessions.values().map(people::Session::acknowledged).sum();
    Ok(Outcome { sessions: people.answered(), answers, operations, failed, ends, export })
}

impl<'a> Simulation<'a> {
    fn new(machine: &'a Simulated, settings: &'a Settings, plan: Plan) -> Self {
        machine.reset(plan.seed);
        let mut chance = Chance::new(plan.seed ^ 0x5eed);
        let panels = [None, Some(0), Some(1), Some(1)];
        let count = if plan.wild { 2 + chance.below(5) } else { 2 };
        let client = |panel| Client { panel, ..Client::default() };
        let clients = (0..count).map(|number| client(panels[number % panels.len()])).collect();
        Self {
            machine,
            settings,
            plan,
            chance,
            people: People::default(),
            clients,
            network: Vec::new(),
            server: None,
            ends: 0,
            export: String::new(),
        }
    }

    fn tell(&self, line: impl FnOnce() -> String) {
        if self.plan.told {
            println!("{:>6} {}", self.machine.state().disk.operations(), line());
            self.machine.notes().iter().for_each(|note| println!("       log: {note}"));
        }
    }

    fn run(&mut self) -> Checked {
        self.start()?;
        if self.plan.wild {
            for _ in 0..20 + self.chance.below(40) {
                self.step()?;
            }
            self.machine.state().disk.heal();
        } else {
            self.finish_all()?;
            self.restart()?;
            // What comes late, and after a stop.
            let late = Client { panel: Some(7), ..Client::default() };
            self.clients.push(late);
        }
        self.finish_all()?;
        self.machine.state().disk.heal();
        self.check()?;
        match self.chance.below(3) {
            0 => self.restart()?,
            1 => self.crash(End::Killed)?,
            _ => self.crash(End::PowerGone)?,
        }
        self.check()?;
        self.stop()?;
        self.read_folder(false)
    }

    /// Everybody goes on until they have answered all, which has to come.
    fn finish_all(&mut self) -> Checked {
        for _ in 0..400 {
            if self.clients.iter().all(|client| client.done) {
                return Ok(());
            }
            for number in 0..self.clients.len() {
                self.act(number, false);
                self.deliver(false)?;
            }
        }
        Err("not everybody could finish".into())
    }

    fn step(&mut self) -> Checked {
        let later = match self.chance.below(100) {
            0..3 => 3 * 3_600_000,
            3..5 => -3_600_000,
            _ => self.chance.below(5000) as i64,
        };
        self.machine.state().now_ms += later;
        for _ in 0..1 + self.chance.below(3) {
            let number = self.chance.below(self.clients.len());
            self.act(number, true);
        }
        match self.chance.below(100) {
            0..4 => self.restart()?,
            4..8 => self.crash(End::Killed)?,
            8..11 => self.crash(End::PowerGone)?,
            11..25 => {
                let fault = match self.chance.below(9) {
                    0 | 1 => Fault::Error,
                    2 => Fault::Short,
                    3 => Fault::Full(1 + self.chance.below(40) as u64),
                    4 | 5 => Fault::End(End::Killed),
                    _ => Fault::End(End::PowerGone),
                };
                let ahead = 1 + self.chance.below(80) as u64;
                self.tell(|| format!("{fault:?} in {ahead}"));
                self.machine.state().disk.arm(ahead, fault);
            }
            25..30 => self.check()?,
            _ => {}
        }
        self.deliver(true)
    }

    fn start(&mut self) -> Checked {
        for _ in 0..100 {
            let failed = self.machine.state().disk.failed();
            let pages = [1, 4, 20, 1000][self.chance.below(4)];
            let started = Running::start(self.machine, self.settings, pages);
            let (ended, untroubled) = {
                let disk = &self.machine.state().disk;
                (disk.end().is_some(), disk.failed() == failed)
            };
            match started {
                Ok(server) if !ended => {
                    self.tell(|| "started".into());
                    self.server = Some(server);
                    self.people.life += 1;
                    return if untroubled { self.check_exactly() } else { Ok(()) };
                }
                Err(error) if !ended && untroubled => return Err(format!("it does not start: {error}")),
                started => {
                    self.tell(|| format!("not started: {:?}", started.as_ref().err()));
                    drop(started);
                }
            }
            if ended {
                self.restart_machine()?;
            }
        }
        Err("it does not start".into())
    }

    fn stop(&mut self) -> Checked {
        let Some(server) = self.server.take() else { return Ok(()) };
        let stopped = server.stop();
        self.tell(|| format!("stopped: {stopped:?}"));
        if self.machine.state().disk.end().is_some() {
            return self.restart_machine();
        }
        stopped.map_err(|error| format!("it does not stop: {error}"))
    }

    fn restart(&mut self) -> Checked {
        self.stop()?;
        self.start()
    }

    /// Ends the server where it is, and starts it again.
    fn crash(&mut self, end: End) -> Checked {
        self.machine.state().disk.stop(end);
        self.again()
    }

    /// The server has ended, and is started.
    fn again(&mut self) -> Checked {
        self.server = None;
        if self.machine.state().disk.end().is_some() {
            self.restart_machine()?;
        }
        self.start()
    }

    fn restart_machine(&mut self) -> Checked {
        let end = self.machine.state().disk.end();
        self.tell(|| format!("{end:?}"));
        self.ends += 1;
        self.machine.state().disk.restart();
        if self.plan.wild && self.chance.percent(20) { self.read_folder(false) } else { Ok(()) }
    }

    /// Has a page do the next thing, or something odd.
    fn act(&mut self, number: usize, wild: bool) {
        if self.network.len() >= NETWORK {
            return;
        }
        let chance = &mut self.chance;
        let client = &mut self.clients[number];
        let Some(token) = client.token.clone() else {
            self.network.push((number, Asked::Begin { panel: client.panel }));
            return;
        };
        let mut say = || Said {
            choice: [Choice::L, Choice::Np, Choice::R][chance.below(3)],
            rt_ms: chance.below(9000) as u32,
            width: chance.percent(50).then(|| 300 + chance.below(1000) as u32),
        };
        let mut asked = Vec::new();
        if client.next < QUESTIONS {
            let said = *client.said.get_or_insert_with(&mut say);
            asked.push(Asked::Answer { token: token.clone(), place: client.next, said });
        } else if !client.done {
            asked.push(Asked::Finish { token: token.clone() });
        }
        if wild {
            let other = say();
            match self.chance.below(100) {
                0..10 => asked.extend(asked.first().cloned()),
                10..18 => {
                    let place = self.chance.below(QUESTIONS.min(client.next + 1));
                    asked.push(Asked::Answer { token, place, said: other });
                }
                18..24 if client.next + 1 < QUESTIONS => {
                    asked.push(Asked::Answer { token, place: client.next + 1, said: other });
                }
                24..32 if client.next > 0 => {
                    let place = self.chance.below(client.next);
                    let sent = self.people.sessions[&token].sent(place);
                    if let Some(&said) = sent.first() {
                        asked.push(Asked::Answer { token, place, said });
                    }
                }
                32..38 => asked.push(Asked::State { token }),
                38..42 => client.token = None,
                42..45 => asked.push(Asked::Finish { token }),
                _ => {}
            }
        }
        for asked in asked {
            if let Asked::Answer { token, place, said } = &asked {
                self.people.send(token, *place, *said);
            }
            self.network.push((number, asked));
        }
    }

    /// Hands some requests to the server at once, and what it says to whoever asked.
    fn deliver(&mut self, wild: bool) -> Checked {
        let Some(server) = &mut self.server else { return Err("no server".into()) };
        let mut sent = Vec::new();
        for _ in 0..1 + self.chance.below(4) {
            if self.network.is_empty() {
                break;
            }
            let (number, asked) = self.network.swap_remove(self.chance.below(self.network.len()));
            if wild && self.chance.percent(8) {
                self.network.push((number, asked.clone()));
            }
            let before = self.people.acknowledged(&asked);
            let pending = server.send(path(&asked), Some(body(&self.people, &asked)));
            sent.push((number, asked, before, pending));
        }
        if wild && self.chance.percent(5) {
            // Somebody closes the page.
            sent.pop();
        }
        let worked = server.work();
        let ended = self.machine.state().disk.end().is_some();
        for (number, asked, before, pending) in sent {
            let reply = pending.reply();
            self.tell(|| format!("{number}: {asked:?}: {reply:?}"));
            match reply {
                Some(reply) => {
                    self.people.learn(&asked, before, &reply)?;
                    if !(wild && self.chance.percent(10)) {
                        self.hear(number, &asked, &reply);
                    }
                }
                None if ended || worked.is_err() => {}
                None => return Err(format!("nobody answered {asked:?}")),
            }
        }
        if let Err(error) = &worked {
            self.tell(|| format!("ended by itself: {error}"));
        }
        if ended || worked.is_err() { self.again() } else { Ok(()) }
    }

    /// What a page makes of a reply.
    fn hear(&mut self, number: usize, asked: &Asked, reply: &Reply) {
        let client = &mut self.clients[number];
        if client.token.as_deref() != asked.token() {
            return;
        }
        let said: Value = serde_json::from_str(&reply.text).unwrap_or_default();
        match (asked, reply.status) {
            (Asked::Begin { .. } | Asked::State { .. }, 200) => {
                client.token = said["token"].as_str().map(str::to_owned);
                client.next = said["answered"].as_u64().unwrap_or(0) as usize;
                client.said = None;
            }
            (Asked::Answer { place, .. }, 200) if *place == client.next => {
                client.next += 1;
                client.said = None;
            }
            (Asked::Finish { .. }, 200) => client.done = true,
            (_, 404) => *client = Client { panel: client.panel, ..Client::default() },
            (_, 409) => {
                let token = client.token.clone().expect("it asked with it");
                self.network.push((number, Asked::State { token }));
            }
            _ => {}
        }
    }

    /// Reads every export, and holds it against what was told.
    fn check(&mut self) -> Checked {
        self.compare(false)
    }

    /// The same where nothing may be there but what belongs to an answer.
    fn check_exactly(&mut self) -> Checked {
        self.compare(true)
    }

    fn compare(&mut self, exact: bool) -> Checked {
        let failed = self.machine.state().disk.failed();
        let paths = ["/api/admin/answers.csv", "/api/admin/identities.csv", "/api/admin/summary"];
        let Some(server) = &mut self.server else { return Err("no server".into()) };
        let replies = paths.map(|path| server.ask(path));
        let troubled = self.machine.state().disk.failed() != failed;
        let mut texts = Vec::new();
        for (reply, path) in replies.into_iter().zip(paths) {
            match reply {
                Some(Reply { status: 200, text }) => texts.push(text),
                _ if troubled => {}
                other => return Err(format!("{path}: {other:?}")),
            }
        }
        if let [answers, identities, summary] = &texts[..] {
            let rows = rows(answers)?;
            self.people.check_rows("answers.csv", &rows, true)?;
            self.people.check_identities(identities, &rows, exact)?;
            self.people.check_summary(summary, &rows)?;
            self.export.clone_from(answers);
        }
        if self.machine.state().disk.end().is_some() {
            return self.again();
        }
        self.read_folder(true)?;
        if self.machine.state().disk.end().is_some() { self.again() } else { Ok(()) }
    }

    /// What `analyse` and `deidentify` read, beside a server or without one.
    fn read_folder(&mut self, served: bool) -> Checked {
        let failed = self.machine.state().disk.failed();
        let kept = kept_on(self.machine, FOLDER.as_ref(), "trial");
        let troubled = self.machine.state().disk.failed() != failed;
        let given = match kept {
            Ok(kept) => kept.given,
            // Nothing was made yet.
            Err(_) if troubled || self.people.sessions.is_empty() => return Ok(()),
            Err(error) => return Err(format!("the folder cannot be read: {error}")),
        };
        self.people.check_rows("the folder", &rows_of(&given)?, served)?;
        let shared = deidentified(&given);
        let without = |given: &[crate::export::Given]| {
            let mut answers: Vec<_> = given
                .iter()
                .map(|one| {
                    format!("{} {:?}", one.form, (one.answer.order, one.answer.choice, one.answer.rt_ms))
                })
                .collect();
            answers.sort();
            answers
        };
        if without(&shared) != without(&given) || rows_of(&shared)?.len() != given.len() {
            return Err("what is shared are other answers".into());
        }
        Ok(())
    }
}

fn body(people: &People, asked: &Asked) -> String {
    let body = match asked {
        Asked::Begin { panel: None } => json!({}),
        Asked::Begin { panel: Some(panel) } => {
            json!({"prolific_pid": "5f9", "study_id": "61a", "session_id": panel_session(*panel)})
        }
        Asked::State { token } | Asked::Finish { token } => json!({ "token": token }),
        Asked::Answer { token, place, said } => {
            let stimulus = &people.sessions[token].questions[*place];
            let screen = said.width.map(|width| {
                json!({
                    "viewport_width": width, "viewport_height": 800, "pixel_ratio": 1.5, "surface_px": 300,
                    "layout": "beside", "input": "mouse", "dropped": 0, "hidden_ms": 0, "shown_as": "gif",
                })
            });
            json!({
                "token": token, "order": place + TRAINING + 1, "stimulus": stimulus,
                "choice": said.choice, "rt_ms": said.rt_ms, "screen": screen,
            })
        }
    };
    body.to_string()
}

fn path(asked: &Asked) -> &'static str {
    match asked {
        Asked::Begin { .. } => "/api/sessions",
        Asked::State { .. } => "/api/state",
        Asked::Answer { .. } => "/api/answers",
        Asked::Finish { .. } => "/api/finish",
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
        let (machine, settings) = (Simulated::new(), settings());
        while done.load(Ordering::Relaxed) < wanted {
            let seed = first.wrapping_add(number.fetch_add(1, Ordering::Relaxed));
            match attempt(&machine, &settings, wild(seed)) {
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
                         ISOSTUDY_SEED={seed} cargo test --release --locked -p isostudy-serve --lib simulation::one -- --nocapture"
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
#[ignore = "minutes"]
fn every_acknowledged_answer_is_in_every_export_once_in_many_sessions() {
    sessions(200_000);
}

/// `ISOSTUDY_SEED=n` repeats a simulation that failed; without it one is simulated twice, and must be the same.
#[test]
fn one() {
    let given = std::env::var("ISOSTUDY_SEED").ok().and_then(|text| text.parse().ok());
    let plan = Plan { told: given.is_some(), ..wild(given.unwrap_or(first_seed())) };
    with_timers(|| {
        let (machine, settings) = (Simulated::new(), settings());
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
#[ignore = "minutes"]
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

/// A commit fails at its sync, and a kill brings it back: the answer is there, and who gave it.
#[test]
fn answers_that_come_back_have_their_identifiers() {
    with_timers(|| {
        let (machine, settings) = (Simulated::new(), settings());
        let mut revived = 0;
        for ahead in 1..40 {
            let mut simulation = Simulation::new(&machine, &settings, quiet(1));
            let panels = 1;
            let mut run = || -> Checked {
                simulation.start()?;
                simulation.act(panels, false);
                simulation.deliver(false)?;
                simulation.act(panels, false);
                machine.state().disk.arm(ahead, Fault::Error);
                simulation.deliver(false)?;
                machine.state().disk.heal();
                let told = simulation.people.answered();
                simulation.crash(End::Killed)?;
                revived += simulation.people.answered() - told;
                simulation.check_exactly()
            };
            run().unwrap_or_else(|wrong| panic!("an error at operation {ahead}: {wrong}"));
        }
        assert!(revived > 0, "no sync of a commit failed");
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
